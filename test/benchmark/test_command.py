"""The benchmark's command: a row for every solver, and mistakes. Nothing is timed."""

import subprocess
import sys

import pytest
from support.processes import run
from thrust_allocator.benchmark.solvers import Measured, RIVALS
from thrust_allocator.benchmark.ticks import paper_sweep


def test_a_rival_that_is_not_installed_is_reported(monkeypatch):
    """The table has a row for every rival, and says of one that it is missing."""
    monkeypatch.setitem(sys.modules, 'quadprog', None)
    rows = Measured(paper_sweep(20), repeats=1).table().splitlines()[2:]
    assert [row.split('|')[1].strip() for row in rows] == [rival.name for rival in RIVALS]
    row, = (row for row in rows if row.startswith('| quadprog '))
    assert row.split('|')[2].strip() == 'missing'


def command(*arguments: str) -> subprocess.CompletedProcess:
    """Run the benchmark's command as a stranger would."""
    return run('-m', 'thrust_allocator.benchmark', *arguments)


def test_command_prints_a_row_for_every_rival():
    """A quick run of the solvers: the machine, and one row per rival and sequence of ticks."""
    done = command('--quick', 'solvers')
    assert (done.returncode, done.stderr) == (0, '')
    assert 'Python' in done.stdout and 'numpy' in done.stdout
    for rival in RIVALS:
        assert done.stdout.count(f'\n| {rival.name} ') == 3


@pytest.mark.parametrize('arguments, named', [
    (('solver',), 'solver is no part, must be one of solvers, growth, saturation, evidence, '
     'node'),
    (('solvers', '--plot', 'x.svg'), '--plot draws the growth'),
    (('--plot', '/nowhere/x.svg'), '/nowhere/x.svg must end in .svg'),
    (('--plot', 'x.png'), 'x.png must end in .svg'),
    (('solvers', '--pictures', '.'), '--pictures draws the evidence')])
def test_mistakes_on_the_command_line(arguments, named):
    """A mistake ends in one plain sentence, before anything is measured."""
    done = command(*arguments)
    assert (done.returncode, done.stdout) == (2, '')
    assert named in done.stderr and 'Traceback' not in done.stderr
