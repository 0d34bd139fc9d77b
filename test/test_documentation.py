"""The documents say what the code does."""

import re

from support.documents import shown
from support.paths import ROOT
from thrust_allocator.parameters.models import MODEL_PARAMETERS
from thrust_allocator.parameters.table import NODE, THRUSTER, THRUSTER_NAMES
from thrust_allocator.study.options import parser


def test_table_of_parameters_equals_the_code():
    """Each parameter has its row: name, what is allowed, unit, default, live, meaning; no other."""
    expected = {
        f'| `{one.name}` | {one.type} | {one.unit or "–"} | {shown(one.default)} | '
        f'{"yes" if one.live else "no"} | {one.meaning} |'
        for one in (THRUSTER_NAMES, *NODE, *THRUSTER,
                    *(one for model in MODEL_PARAMETERS.values() for one in model.all))}
    rows = set(re.findall(r'^\| `.*$', (ROOT / 'doc/parameters.md').read_text('utf-8'), re.M))
    assert rows == expected


def test_quick_start_is_two_blocks_of_one_line():
    """A newcomer finds two commands to copy, and CI the second one of them."""
    readme = (ROOT / 'README.md').read_text('utf-8')
    blocks = re.findall(r'^```bash\n(.*?)^```$', readme, re.M | re.S)
    assert len(blocks) == 2
    assert all(block.count('\n') == 1 for block in blocks)


def test_architecture_lists_every_module():
    """The list of modules is complete."""
    listed = re.findall(
        r'^\| `([\w/]+)` \|', (ROOT / 'doc/architecture.md').read_text('utf-8'), re.M)
    package = ROOT / 'thrust_allocator'
    modules = {str(file.relative_to(package).with_suffix('')) for file in package.rglob('*.py')
               if file.stem != '__init__' and file.parent.name not in (
                   'study', 'benchmark', 'import_vehicle', 'replay')}
    assert set(listed) == modules


def test_study_page_has_every_option():
    """The page of the study names each option of its command line, and no other."""
    page = (ROOT / 'doc/study.md').read_text('utf-8')
    assert set(re.findall(r'`[^`\n]*(--\w+)', page)) | {'--output'} == {
        option for option in parser()._option_string_actions} - {'-h', '--help'}
