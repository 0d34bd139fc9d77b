"""The command `thrust_allocator`: one table of programs, for a wheel and for `ros2 run` alike."""

import os
import runpy
import sys
from types import SimpleNamespace

import pytest
import setuptools
from support.paths import ROOT
from support.processes import run
from thrust_allocator import __main__ as command


@pytest.fixture
def called(monkeypatch):
    """Put a program of the test's own in the node's place; return the command lines it gets."""
    lines = []
    program = SimpleNamespace(main=lambda args: lines.append(args) or 7)
    monkeypatch.setitem(sys.modules, 'a_program', program)
    monkeypatch.setitem(command.COMMANDS, 'node', 'a_program')
    return lines


@pytest.mark.parametrize('arguments, received', [
    ([], []), (['node'], []), (['--ros-args', '-p', 'a:=1'], ['--ros-args', '-p', 'a:=1']),
    (['node', '--help'], ['--help']), (['--help'], ['--help']),
    (['my_vehicle.yaml'], ['my_vehicle.yaml']), (['__ns:=/a'], ['__ns:=/a'])])
def test_the_node_is_what_runs_by_itself(called, arguments, received):
    """Without a program's name the whole command line is the node's, and so is its exit status."""
    assert command.main(['thrust_allocator', *arguments]) == 7
    assert called == [['node', *received]]


@pytest.mark.parametrize('name', [
    'demo', 'import_vehicle', 'fit', 'study', 'replay', 'soak', 'benchmark'])
def test_each_program_has_a_usage(name, capsys):
    """`thrust_allocator NAME --help` prints that program's usage and ends with status 0."""
    with pytest.raises(SystemExit) as ended:
        command.main(['thrust_allocator', name, '--help'])
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith(f'usage: {name} ')


@pytest.mark.parametrize('name, said', [
    ('studdy', 'studdy: is no command, must be one of node, demo, import_vehicle, '
     'fit, study, replay, soak, benchmark'),
    ('studdy', '; did you mean study?'), ('nothing', 'nothing: is no command')])
def test_other_names_are_refused(called, name, said, capsys):
    """A name that is no program ends in one line and status 2."""
    assert command.main(['thrust_allocator', name]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count('\n'), called) == ('', 1, []) and said in err


def test_nothing_is_imported_before_it_is_called():
    """The table alone needs neither ROS nor the mathematics."""
    done = run('-c', 'import sys; from thrust_allocator import __main__\n'
               'print({"rclpy", "numpy", "osqp", "yaml"} & {*sys.modules})')
    assert done.stdout == 'set()\n', done.stderr


def test_an_interrupt_during_the_imports_ends_in_one_line(tmp_path):
    """SIGINT while a program is still being imported: one line and status 130, no traceback."""
    (tmp_path / 'slow.py').write_text(
        'import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(20)\n')
    done = run('-c', 'from thrust_allocator import __main__ as command\n'
               'command.COMMANDS["node"] = "slow"\ncommand.main(["thrust_allocator"])',
               PYTHONPATH=str(tmp_path))
    assert (done.returncode, done.stderr) == (130, 'thrust_allocator: interrupted\n')


def test_what_is_installed(monkeypatch):
    """A wheel has one command; lib/thrust_allocator has an executable for each program."""
    installed = {}
    monkeypatch.setattr(setuptools, 'setup', installed.update)
    monkeypatch.chdir(ROOT)
    runpy.run_path('setup.py')
    assert installed['entry_points'] == {
        'console_scripts': ['thrust_allocator = thrust_allocator.__main__:main']}
    files = dict(installed['data_files'])['lib/thrust_allocator']
    assert sorted(files) == sorted(f'resource/executables/{name}' for name in command.COMMANDS)
    assert all(os.access(file, os.X_OK) for file in files)


@pytest.mark.parametrize('name', ['demo', 'study'])
def test_an_executable_starts_its_program(name):
    """One small file, linked by the names of the programs, starts what it is called."""
    done = run(ROOT / 'resource/executables' / name, '--help', PYTHONPATH=str(ROOT))
    assert (done.returncode, done.stderr) == (0, '') and done.stdout.startswith(f'usage: {name} ')
