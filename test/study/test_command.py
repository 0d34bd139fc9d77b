"""The study's command line: what its options do, and what a mistake in them is told."""

import re
import sys

import pytest
from support.paths import CONFIG
from support.study import rows, run, SHORT

FILES = sorted(CONFIG.glob('*.yaml'))


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


def test_failures_of_one_of_several_vehicles(undrawn, variant, mt2012, tmp_path):
    """VEHICLE:NAME has failed in that one alone, a bare name in all."""
    assert run(mt2012, variant({}), '--failed', 'mt2012:tunnel,left,vehicle:up', '--output',
               tmp_path / 'out', *SHORT) == 0
    fewest = {name: min((row['failed'] for row in rows(tmp_path / 'out' / 'grid.csv')
                         if row['layout'] == name), key=len) for name in ('mt2012', 'vehicle')}
    assert fewest == {'mt2012': 'tunnel left', 'vehicle': 'left up'}
    assert {row['case'] for row in rows(tmp_path / 'out' / 'candidates.csv')} == {
        'intact', 'worst single failure'}


@pytest.mark.parametrize('args, message', [
    (['--failed', 'mt201:tunnel'], '--failed: mt201 is no vehicle here, must be one of mt2012; did '
     'you mean mt2012?'),
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
     '-1e+09 to 1e+09'),
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
