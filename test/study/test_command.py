"""The study's command line, end to end."""

import csv
import re
import subprocess
import sys

import numpy as np
import pytest
from support.paths import CONFIG
from support.vehicles import mt2012 as paper_vehicle
from thrust_allocator.study import grid, report
from thrust_allocator.study.__main__ import main
from thrust_allocator.study.authority import HELD
from thrust_allocator.study.grid import Case, evaluate
from thrust_allocator.study.manoeuvre import Manoeuvre
from thrust_allocator.study.sweep import ALLOCATORS, DRIVERS

PICTURES = ('allocation_against_speed', 'worth', 'authority', 'directions')
SPEEDS = [0.0, 0.9, 1.8]
FILES = sorted(CONFIG.glob('*.yaml'))
SHORT = ['--speeds', '0:1.8:3']


def run(*args):
    """Run the study in this process and return its exit status."""
    return main(['study', *map(str, args)])


def rows(path):
    """Return the rows of a CSV file as a list of dicts."""
    with path.open(encoding='utf-8', newline='') as file:
        return list(csv.DictReader(file))


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time of a short study."""
    monkeypatch.setattr(report.Drawings, 'draw', lambda self, jobs: None)


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
    return subprocess.run(
        [sys.executable, '-m', 'thrust_allocator.study', '--output', folder, *SHORT],
        capture_output=True, text=True), folder


def test_three_lines_end_it(process):
    """Three lines on stdout, each finding with its driver, and nothing on stderr."""
    done, _ = process
    assert (done.returncode, done.stderr) == (0, '')
    lines = done.stdout.splitlines()
    assert len(lines) == 3
    assert lines[0].startswith('With a driver that delivers the thrust asked for')
    assert 'Bollard curve' in lines[1] and lines[2].startswith('Authority: 50 N*m of pitch')


def test_the_same_command_writes_the_same_bytes(study, process):
    """Pictures carry no date and no random names."""
    for file in study.iterdir():
        if file.name != 'report.md':  # which holds the path
            assert file.read_bytes() == (process[1] / file.name).read_bytes(), file.name


def test_options_reach_the_numbers(undrawn, tmp_path):
    """Speeds, wrench, drag, failures and headings are those that were asked for."""
    assert run('--output', tmp_path, '--speeds', '0.4,1.0', '--wrench', 'yaw=20,heave=-3',
               '--drag', 'surge=30,sway=70', '--failed', 'left', '--headings', '30,0',
               '--thruster', 'tunnel') == 0
    table = rows(tmp_path / 'grid.csv')
    assert len(table) == 2 * 2 * 5
    assert {row['failed'] for row in table} == {
        'left', 'left down', 'left up', 'left right', 'left tunnel'}
    last = table[-1]
    assert (last['heading [deg]'], last['speed [m/s]']) == ('30.0', '1.0')
    assert float(last['commanded surge [N]']) == pytest.approx(30.0 * 0.75)
    assert float(last['commanded sway [N]']) == pytest.approx(-70.0 * 0.25)
    assert float(last['commanded yaw [N*m]']) == 20.0
    assert float(last['commanded heave [N]']) == -3.0
    text = (tmp_path / 'report.md').read_text('utf-8')
    assert 'Bounds in every direction: tunnel' in text and 'without left' in text
    assert (tmp_path / 'candidates.csv').is_file()


@pytest.mark.parametrize('file', FILES, ids=lambda file: file.stem)
def test_every_vehicle_of_the_package(undrawn, file, tmp_path):
    """Each file in config/ gives a study, with a command that the vehicle can follow."""
    assert run(file, '--output', tmp_path, *SHORT) == 0
    first = rows(tmp_path / 'authority.csv')[0]
    assert 0.0 < float(rows(tmp_path / 'grid.csv')[0]['commanded pitch [N*m]']) \
        <= float(first['largest pitch [N*m]'])


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


def test_several_files_are_candidate_layouts(undrawn, variant, mt2012, tmp_path):
    """Each has its own folder and pictures; one picture sets them side by side."""
    other = variant({'thrusters.tunnel.position': [1.6, 0.0, 0.0]})
    assert run(mt2012, other, '--output', tmp_path / 'out', *SHORT) == 0
    text = (tmp_path / 'out' / 'report.md').read_text('utf-8')
    links = [link for link in re.findall(r'\]\(([^)]+)\)', text) if link.endswith('.csv')]
    assert {link.rpartition('/')[0] for link in links} == {'', 'mt2012', 'vehicle'}
    assert all((tmp_path / 'out' / link).is_file() for link in links)
    table = rows(tmp_path / 'out' / 'candidates.csv')
    at_rest = {row['series']: float(row['both ways pitch [N*m]']) for row in table
               if row['case'] == 'intact' and row['speed [m/s]'] == '0.0'}
    assert at_rest['vehicle'] > at_rest['mt2012'] > 200.0


@pytest.mark.parametrize('args, message', [
    (['--failed', 'tunel'], '--failed: tunel is no thruster of mt2012, must be one of down, left, '
     'up, right, tunnel; did you mean tunnel?'),
    (['--thruster', 'bow'], '--thruster: bow is no thruster of mt2012, must be one of down, left, '
     'up, right, tunnel'),
    (['--speeds', '1'], "argument --speeds: '1' has fewer than 2 different values"),
    (['--speeds', '0,fast'], "argument --speeds: 'fast' is no speed in m/s, must be a number from "
     '-50 to 50'),
    (['--speeds', '0,nan'], "argument --speeds: 'nan' is no speed in m/s, must be a number from "
     '-50 to 50'),
    (['--speeds', '0:1'], "argument --speeds: '0:1' is no range, must be FIRST:LAST:COUNT with a "
     'count from 2 to 100000'),
    (['--wrench', 'pich=50'], "argument --wrench: 'pich=50' must be DOF=VALUE with a DOF of surge, "
     'sway, heave, roll, pitch, yaw; did you mean pitch?'),
    (['--wrench', 'roll=5'], '--wrench: mt2012 does not control roll: its wrench_weights.roll is '
     '0'),
    (['--drag', 'much'], "argument --drag: 'much' is no drag in N*s^2/m^2, must be a number from "
     '-1e+06 to 1e+06'),
    (['--drag', 'pitch=1'], 'argument --drag: drag is a force: surge, sway and heave'),
    (['--headings', '400'], "argument --headings: '400' is no heading in degrees, must be a number "
     'from -360 to 360'),
    (['--jobs', '0'], "argument --jobs: '0' must be a whole number of 1 or more"),
    (['--jobs', '2', '--dask', 'tcp://127.0.0.1:1'],
     'argument --dask: not allowed with argument --jobs'),
    (['--colour'], 'unrecognized arguments: --colour')])
def test_a_mistake_on_the_command_line(args, message, tmp_path, capsys):
    """One line on stderr that says what is wrong, and status 2; nothing is written."""
    with pytest.raises(SystemExit) as caught:
        run('--output', tmp_path / 'out', *args)
    assert caught.value.code == 2
    assert capsys.readouterr() == ('', f'study: {message}\n')
    assert not (tmp_path / 'out').exists()


def test_output_is_required_and_a_directory(undrawn, tmp_path, capsys):
    """Without a folder, or with a file in its place, it says so."""
    (tmp_path / 'file').write_text('')
    for args, message in ((['--output', tmp_path / 'file'],
                           f'--output: {tmp_path / "file"} is not a directory'),
                          ([], 'the following arguments are required: --output')):
        with pytest.raises(SystemExit) as caught:
            run(*args)
        assert caught.value.code == 2
        assert capsys.readouterr().err == f'study: {message}\n'
    assert run('--output', tmp_path / 'file' / 'below', *SHORT) == 1
    assert 'cannot be written: Not a directory' in capsys.readouterr().err


def test_a_mistake_in_a_parameter_file(undrawn, variant, tmp_path, capsys):
    """The message of the parameter, after the file's name; status 1, nothing written."""
    bad = variant({'thrusters.up.weight': -1.0})
    assert run(bad, '--output', tmp_path / 'out') == 1
    assert capsys.readouterr().err == (f'study: {bad}: thrusters.up.weight: is -1.0, must be a '
                                       'number in (0, 1000000]\n')
    assert run(tmp_path / 'none.yaml', '--output', tmp_path / 'out') == 1
    assert capsys.readouterr().err == (
        f'study: {tmp_path / "none.yaml"}: cannot be read: No such file or directory\n')
    other = variant({}, top_key='/my_auv/thrust_allocator')
    assert run(other, '--output', tmp_path / 'out') == 1
    assert 'has nothing for the node /thrust_allocator' in capsys.readouterr().err
    assert not (tmp_path / 'out').exists()
    assert run(other, '--node', '/my_auv/thrust_allocator', '--output', tmp_path / 'out',
               *SHORT) == 0


@pytest.mark.parametrize('module, args, extra', [
    ('matplotlib', [], 'plot'), ('distributed', ['--dask', 'tcp://127.0.0.1:1'], 'cluster')])
def test_what_is_not_installed_is_named(module, args, extra, tmp_path, capsys, monkeypatch):
    """It says plainly which extra brings it, before any long run."""
    monkeypatch.setitem(sys.modules, module, None)
    assert run('--output', tmp_path / 'out', *SHORT, *args) == 1
    error = capsys.readouterr().err
    assert error.count('\n') == 1
    assert f"is not installed: pip install '.[{extra}]'" in error
    assert not (tmp_path / 'out').exists()


def test_a_cluster_that_is_not_there(tmp_path, capsys, monkeypatch):
    """An address where nobody answers, or that is none, ends in one line."""
    monkeypatch.setattr(grid, 'CONNECT_TIMEOUT', 0.3)
    for address in ('tcp://127.0.0.1:1', 'nonsense://x'):
        assert run('--output', tmp_path / 'out', *SHORT, '--dask', address) == 1
        error = capsys.readouterr().err
        assert error.startswith(f'study: --dask {address}: ') and error.count('\n') == 1


@pytest.fixture(scope='module')
def cluster():
    """Return a local Dask cluster of two worker processes, on the loopback interface alone."""
    from distributed import LocalCluster  # of extra `test`; its absence is no reason to skip

    with LocalCluster(n_workers=2, threads_per_worker=1, host='127.0.0.1',
                      dashboard_address=None) as cluster:
        yield cluster


@pytest.fixture(scope='module')
def grid_of_one_core(tmp_path_factory):
    """Return the options of a grid, and all its numbers from one process, as bytes."""
    folder = tmp_path_factory.mktemp('one_core')
    options = ['--speeds', '0:1.8:31', '--headings', '0,20']
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report.Drawings, 'draw', lambda self, jobs: None)
        assert run('--output', folder, *options) == 0
    return options, (folder / 'grid.csv').read_bytes()


def test_the_same_numbers_with_two_jobs(undrawn, grid_of_one_core, tmp_path):
    """Two processes give the same grid to the last bit."""
    options, expected = grid_of_one_core
    assert run('--output', tmp_path, *options, '--jobs', 2) == 0
    assert (tmp_path / 'grid.csv').read_bytes() == expected


def test_the_same_numbers_on_a_cluster(undrawn, grid_of_one_core, cluster, tmp_path):
    """A Dask cluster of two processes gives them, too."""
    options, expected = grid_of_one_core
    assert run('--output', tmp_path, *options, '--dask', cluster.scheduler_address) == 0
    assert (tmp_path / 'grid.csv').read_bytes() == expected


def test_a_failure_on_the_cluster_ends_in_one_line(undrawn, cluster, tmp_path, capsys, monkeypatch):
    """Whatever a worker raises is told by its kind, without a traceback."""
    monkeypatch.setattr(grid, 'evaluate', _no_such_module)
    assert run('--output', tmp_path / 'out', *SHORT, '--dask', cluster.scheduler_address) == 1
    error = capsys.readouterr().err
    assert error == f'study: --dask {cluster.scheduler_address}: ZeroDivisionError: at sea\n'


def _no_such_module(case, manoeuvre, speeds):
    raise ZeroDivisionError('at sea')


def test_long_runs_show_progress(undrawn, tmp_path, capsys, monkeypatch):
    """Points done and the time left go to stderr."""
    from thrust_allocator.study import progress

    monkeypatch.setattr(progress, 'SILENCE', 0.0)
    monkeypatch.setattr(progress, 'INTERVAL', {True: 0.0, False: 0.0})
    assert run('--output', tmp_path, '--speeds', '0:1:30', '--failed', 'up') == 0
    notes = capsys.readouterr().err.splitlines()
    assert len(notes) == 10 and notes[-1].startswith('study: 150 of 150 points, ')
    assert np.all(['s to go' in note for note in notes])


def test_it_needs_no_ros():
    """The command can be imported and asked for help where no ROS is installed."""
    hidden = ('rclpy', 'ament_index_python', 'geometry_msgs', 'nav_msgs', 'std_msgs')
    program = ('import sys\n'
               f'sys.modules.update(dict.fromkeys({hidden}))\n'
               'from thrust_allocator.study.__main__ import main\n'
               "main(['study', '--help'])\n")
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True)
    assert done.returncode == 0 and '--output DIR' in done.stdout, done.stderr
