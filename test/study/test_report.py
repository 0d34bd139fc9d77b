"""What a study writes: pictures, tables, report, and three lines; all of it reproducible."""

import re

import pytest
from support import processes
from support.study import rows, run, SHORT
from support.vehicles import mt2012 as paper_vehicle
from thrust_allocator.study import report
from thrust_allocator.study.authority import HELD
from thrust_allocator.study.grid import Case, evaluate
from thrust_allocator.study.manoeuvre import Manoeuvre
from thrust_allocator.study.sweep import ALLOCATORS, DRIVERS

PICTURES = ('allocation_against_speed', 'worth', 'authority', 'directions', 'giving_way')
SPEEDS = [0.0, 0.9, 1.8]


@pytest.fixture(scope='module')
def study(tmp_path_factory):
    """Return the folder of a short study of MT-2012."""
    folder = tmp_path_factory.mktemp('study') / 'not' / 'there yet'
    assert run('--output', folder, *SHORT) == 0
    return folder


@pytest.fixture(scope='module')
def outcome():
    """Return what the functions say of the same study."""
    return evaluate(Case('mt2012', paper_vehicle(), (), 0.0), Manoeuvre(), SPEEDS)


def test_every_picture_has_its_files(study):
    """PNG, SVG and CSV beside each other, and no more than the report and the whole grid."""
    expected = {f'{name}.{suffix}' for name in PICTURES for suffix in ('png', 'svg', 'csv')}
    assert {file.name for file in study.iterdir()} == expected | {'report.md', 'grid.csv'}
    for name in PICTURES:
        assert (study / f'{name}.png').read_bytes().startswith(b'\x89PNG')
        assert '</svg>' in (study / f'{name}.svg').read_text('utf-8')


def test_the_report_shows_every_picture_and_says_how_it_was_made(study):
    """Every link leads to a file; the command stands at the end."""
    text = (study / 'report.md').read_text('utf-8')
    links = re.findall(r'\]\(([^)]+)\)', text)
    assert {link for link in links if link.endswith('.png')} == {f'{n}.png' for n in PICTURES}
    assert all((study / link).is_file() for link in links)
    assert 'ros2 run thrust_allocator study --output' in text
    assert '18.857' in text and '0.232' in text and '29.556' in text


def test_table_of_allocation_equals_the_function(study, outcome):
    """Thrusts and bounds stand in the CSV to the last bit."""
    table = rows(study / 'allocation_against_speed.csv')
    assert [float(row['speed [m/s]']) for row in table] == SPEEDS
    for i, row in enumerate(table):
        assert float(row['tunnel thrust [N]']) == outcome.allocation.thrusts[i, 2, 4]
        assert float(row['up upper [N]']) == outcome.allocation.limits[i, 1, 2]


def test_table_of_worth_equals_the_function(study, outcome):
    """So do commanded and delivered wrench, for each driver and allocator."""
    table = iter(rows(study / 'worth.csv'))
    for d, driver in enumerate(DRIVERS):
        for a, allocator in enumerate(ALLOCATORS):
            for i in range(len(SPEEDS)):
                row = next(table)
                assert (row['driver'], row['allocator']) == (driver, allocator)
                assert float(row['delivered pitch [N*m]']) \
                    == outcome.allocation.delivered[i, a, d, 4]
                assert float(row['commanded surge [N]']) == outcome.allocation.commands[i, 0]


def test_table_of_authority_equals_the_function(study, outcome):
    """So does authority, intact and for each failure; what is not controlled is empty."""
    table = rows(study / 'authority.csv')
    assert list(dict.fromkeys(row['failed'] for row in table)) \
        == ['', 'down', 'left', 'up', 'right', 'tunnel']
    found = iter(table)
    for k, kind in enumerate(HELD):
        for i in range(len(SPEEDS)):
            row = next(found)
            assert row['holding'] == kind and row['smallest sway [N]'] == ''
            assert float(row['largest pitch [N*m]']) == outcome.authority[i, k, 4, 1]


@pytest.fixture(scope='module')
def process(tmp_path_factory):
    """Run the same study as a process of its own; return what it said, and its folder."""
    folder = tmp_path_factory.mktemp('process')
    return processes.run('-m', 'thrust_allocator.study', '--output', folder, *SHORT), folder


def test_two_short_tables_end_it(process):
    """The verdict on stdout, as the report begins, and nothing on stderr."""
    done, folder = process
    assert (done.returncode, done.stderr) == (0, '')
    lines = [re.sub(' +', ' ', line) for line in done.stdout.splitlines()]
    assert '| mt2012 | thrust as asked | 1.8 | pitch, N*m | -0.29 | -23.90 | -23.76 | smaller |' \
        in lines
    assert '| mt2012, intact | at every speed | at 0 m/s |' in lines
    assert max(map(len, done.stdout.splitlines())) <= 140
    assert done.stdout.replace('N*m', 'N·m').replace('v^2', 'v²').rstrip() in (
        folder / 'report.md').read_text('utf-8')


def test_every_picture_says_of_what_it_is(tmp_path, monkeypatch):
    """Vehicle, failures, heading and command where they count; the picture may leave its report."""
    pending = []
    monkeypatch.setattr(report.Drawings, 'draw', lambda self, jobs: pending.extend(self._pending))
    assert run('--output', tmp_path, '--headings', '10,20', '--failed', 'left', *SHORT) == 0
    settings = {path.name: setting for _, (path, setting, *_), _ in pending}
    whole = 'mt2012, without left; heading 10° to the current; 40 v² N of surge and 50 N·m of pitch'
    assert {name for name, setting in settings.items() if setting == whole} == {
        'allocation_against_speed', 'worth', 'authority'}
    assert settings['candidates'] == whole.replace('10°', '10, 20°')
    assert settings['directions'] == 'mt2012'
    assert settings['giving_way'].startswith('mt2012, without left; at rest; ')


def test_the_same_command_writes_the_same_bytes(study, process):
    """Pictures carry no date and no random names."""
    for file in study.iterdir():
        if file.name != 'report.md':  # which holds the path
            assert file.read_bytes() == (process[1] / file.name).read_bytes(), file.name


def test_a_vehicle_of_one_thruster_that_only_pushes(tmp_path):
    """The smallest vehicle has its pictures, too: no failure spared, no sense of thrust assumed."""
    file = tmp_path / 'one.yaml'
    file.write_text(
        '/**:\n  ros__parameters:\n    thruster_names: [t]\n'
        '    wrench_weights: {sway: 0.0, heave: 0.0, roll: 0.0, pitch: 0.0, yaw: 0.0}\n'
        '    thrusters: {t: {model: constant, position: [0.0, 0.0, 0.0], '
        'direction: [1.0, 0.0, 0.0], bollard_thrust: [0.0, 10.0]}}\n')
    assert run(file, '--output', tmp_path / 'out', *SHORT) == 0
    table = rows(tmp_path / 'out' / 'authority.csv')
    assert {(row['failed'], row['largest surge [N]']) for row in table} \
        == {('', '10.0'), ('t', '0.0')}
