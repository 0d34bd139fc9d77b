"""The benchmark's ticks: exact, deterministic, and solved in few iterations. Nothing is timed."""

import numpy as np
import pytest
from support.optimum import daqp_optimum
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
