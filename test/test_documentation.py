"""The documents say what the code does."""

from importlib import import_module
import inspect
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


def test_architecture_lists_every_folder_and_flat_module():
    """The table of what is where is complete, and nothing in it has gone."""
    listed = re.findall(
        r'^\| `(\w[\w/]*)` \|', (ROOT / 'doc/architecture.md').read_text('utf-8'), re.M)
    package = ROOT / 'thrust_allocator'
    folders = {f'{file.parent.relative_to(package)}/' for file in package.glob('*/**/__init__.py')}
    modules = {file.stem for file in package.glob('*.py')} - {'__init__'}
    assert sorted(listed) == sorted(folders | modules)


def test_paths_in_the_documents_exist():
    """Each file of the package that contributing and architecture name is there."""
    for page in ('architecture', 'contributing'):
        text = (ROOT / f'doc/{page}.md').read_text('utf-8')
        named = set(re.findall(r'`([\w/]+\.(?:py|md|rst))`', text)) - {'physics/models/rim.py'}
        assert len(named) > 5
        assert not {name for name in named if not (ROOT / name).exists()
                    and not (ROOT / 'thrust_allocator' / name).exists()}


def test_equations_are_marked_where_they_are_computed():
    """Each function of the table exists, and its code names the equations of its row."""
    rows = re.findall(r'^\| ([\d., ]+) \| .* \| `([\w/]+)\.py: ([\w.]+)` \|$',
                      (ROOT / 'doc/allocation.md').read_text('utf-8'), re.M)
    numbered = set()
    for numbers, module, name in rows:
        function = import_module(f'thrust_allocator.{module.replace("/", ".")}')
        for part in name.split('.'):
            function = inspect.getattr_static(function, part)
        code = inspect.getsource(getattr(function, 'func', function))
        for number in numbers.split(', '):
            assert re.search(rf'eq\. [\d., and]*\b{re.escape(number)}\b', code), (number, name)
            numbered.add(number)
    assert numbered == {'2.6', *(f'3.{i}' for i in range(7, 14))}


def test_study_page_has_every_option():
    """The page of the study names each option of its command line, and no other."""
    page = (ROOT / 'doc/study.md').read_text('utf-8')
    assert set(re.findall(r'`[^`\n]*(--\w+)', page)) | {'--output'} == {
        option for option in parser()._option_string_actions} - {'-h', '--help'}


def test_links_lead_somewhere():
    """Each link between the documents is to a file that exists, and to a heading in it."""
    pages = [ROOT / 'README.md', *(ROOT / 'doc').glob('*.md')]
    for page in pages:
        links = re.findall(r'\]\(([^)#\s]*)#?([^)\s]*)\)', page.read_text('utf-8'))
        for path, anchor in [link for link in links if '://' not in link[0]]:
            target = page.parent / path if path else page
            assert target.exists(), (page.name, path)
            headings = [re.sub(r'[^\w\- ]', '', line).lower().replace(' ', '-') for line in
                        re.findall(r'^#+ (.*)$', target.read_text('utf-8'), re.M)]
            assert not anchor or anchor in headings, (page.name, anchor)
