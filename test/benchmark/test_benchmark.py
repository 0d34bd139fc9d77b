"""The benchmark's ticks: exact, deterministic, and solved in few iterations. Nothing is timed."""

import subprocess
import sys

import numpy as np
import pytest
from support.optimum import daqp_optimum
from support.processes import run
from thrust_allocator.benchmark.solvers import Measured, RIVALS
from thrust_allocator.benchmark.ticks import (
    mt2012, paper_sweep, random_vehicle, smooth_walk, switching_walk, Walk)
from thrust_allocator.solve.problem import AllocationProblem

WALKS = {
    'sweep': lambda: paper_sweep(),
    'smooth': lambda: smooth_walk(mt2012()),
    'switching': lambda: switching_walk(mt2012())}


def exact(walk: Walk) -> np.ndarray:
    """Return daqp's optimum of each tick, (n, p)."""
    return np.array([daqp_optimum(walk.vehicle, wrench, limits)
                     for wrench, _, limits in walk.ticks])


@pytest.mark.parametrize('name, count, iterations', [
    ('sweep', 1801, 2.0), ('smooth', 10_000, 2.0), ('switching', 10_000, 5.0)])
def test_every_tick_is_exact_and_takes_few_iterations(name, count, iterations):
    """Inside the limits to the last bit, solved, 1e-6 of a bound from an independent solver."""
    walk = WALKS[name]()
    problem = AllocationProblem(walk.vehicle)
    answers = [problem.solve(wrench, limits) for wrench, _, limits in walk.ticks]
    thrusts = np.array([answer.thrusts for answer in answers])
    lower, upper = np.array([tick.limits for tick in walk.ticks]).swapaxes(0, 1)
    assert len(answers) == count and all(answer.solved for answer in answers)
    assert (lower <= thrusts).all() and (thrusts <= upper).all()
    assert np.abs(thrusts - exact(walk)).max() <= 1e-6 * np.abs(walk.vehicle.bollard_thrust).max()
    assert np.mean([answer.iterations for answer in answers]) <= iterations


@pytest.mark.parametrize('count', [4, 64])
def test_vehicles_of_other_sizes_are_solved_exactly_too(count):
    """Those on which growth is measured, the smallest and the largest."""
    walk = smooth_walk(random_vehicle(count), 1000)
    problem = AllocationProblem(walk.vehicle)
    answers = [problem.solve(wrench, limits) for wrench, _, limits in walk.ticks]
    assert len(walk.vehicle.thrusters) == count and all(answer.solved for answer in answers)
    error = np.abs(np.array([answer.thrusts for answer in answers]) - exact(walk)).max()
    assert error <= 1e-6 * np.abs(walk.vehicle.bollard_thrust).max()


@pytest.mark.parametrize('name', WALKS)
def test_ticks_are_the_same_at_every_run(name):
    """The same wrenches, velocities and limits, to the last bit."""
    first, second = ([b''.join(part.tobytes() for part in tick) for tick in WALKS[name]().ticks]
                     for _ in range(2))
    assert first == second


def test_walks_do_what_they_are_for():
    """The one respects what is controlled; the other reverses, and switches all off and on."""
    smooth, switching = (np.array([tick.wrench for tick in WALKS[name]().ticks])
                         for name in ('smooth', 'switching'))
    assert not smooth[:, [1, 3]].any(), 'DOFs that MT-2012 does not control'
    turned = (switching[1:] * switching[:-1])[:, [0, 2, 4, 5]].max(axis=1) < 0.0
    assert 100 < turned.sum() < 500, 'all components at once, about once a second'
    off = np.array([~tick.limits.any(axis=0) for tick in WALKS['switching']().ticks])
    assert (off.any(axis=0) & ~off.all(axis=0)).all()


def test_a_peer_that_is_not_installed_is_reported(monkeypatch):
    """The table has a row for every peer, and says of one that it is missing."""
    monkeypatch.setitem(sys.modules, 'quadprog', None)
    rows = Measured(paper_sweep(20), repeats=1).table().splitlines()[2:]
    assert [row.split('|')[1].strip() for row in rows] == [peer.name for peer in RIVALS]
    row, = (row for row in rows if row.startswith('| quadprog '))
    assert row.split('|')[2].strip() == 'missing'


def command(*arguments: str) -> subprocess.CompletedProcess:
    """Run the benchmark's command as a stranger would."""
    return run('-m', 'thrust_allocator.benchmark', *arguments)


def test_command_prints_a_row_for_every_peer():
    """A quick run of the solvers: the machine, and one row per peer and sequence of ticks."""
    done = command('--quick', 'solvers')
    assert (done.returncode, done.stderr) == (0, '')
    assert 'Python' in done.stdout and 'numpy' in done.stdout
    for peer in RIVALS:
        assert done.stdout.count(f'\n| {peer.name} ') == 3


@pytest.mark.parametrize('arguments, named', [
    (('solver',), 'solver is no part, must be one of solvers, growth, node'),
    (('solvers', '--plot', 'x.svg'), '--plot draws the growth'),
    (('--plot', '/nowhere/x.svg'), '/nowhere/x.svg must end in .svg'),
    (('--plot', 'x.png'), 'x.png must end in .svg')])
def test_mistakes_on_the_command_line(arguments, named):
    """A mistake ends in one plain sentence, before anything is measured."""
    done = command(*arguments)
    assert (done.returncode, done.stdout) == (2, '')
    assert named in done.stderr and 'Traceback' not in done.stderr
