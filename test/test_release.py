"""A release has one version, wherever it stands, and CI covers what setup.py promises."""

import re
import xml.etree.ElementTree as ElementTree

from support.paths import ROOT
import yaml


def text(name):
    """Return the text of a file of the repository."""
    return (ROOT / name).read_text('utf-8')


def test_one_version_everywhere():
    """package.xml, setup.py and the newest section of the changelog agree; that one has a date."""
    version = ElementTree.parse(ROOT / 'package.xml').findtext('version')
    assert re.search(r"version='(.*)'", text('setup.py'))[1] == version
    headings = re.findall(r'^(.+)\n-+$', text('CHANGELOG.rst'), re.M)
    newest = next(one for one in headings if one != 'Forthcoming')
    assert re.fullmatch(re.escape(version) + r' \(\d{4}-\d\d-\d\d\)', newest)


def test_ci_runs_what_the_readme_says():
    """.ci/run, on the oldest Python that setup.py takes too, and a build on ROS 2 Jazzy."""
    jobs = yaml.safe_load(text('.github/workflows/ci.yml'))['jobs']
    wheels, jazzy = jobs['wheels'], jobs['jazzy']
    assert {'run': '.ci/run'} in wheels['steps']
    oldest = re.search(r"python_requires='>=(.*)'", text('setup.py'))[1]
    assert oldest in wheels['strategy']['matrix']['python']
    said = [step.get('run', '') for step in jazzy['steps']]
    assert jazzy['container'] == 'ros:jazzy'
    assert any('colcon build' in one for one in said) and 'colcon test-result' in said[-1]
