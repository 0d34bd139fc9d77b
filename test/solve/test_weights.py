"""Weights from the ordinary to the absurd: each is solved on every tick, or refused."""

from collections.abc import Iterator
from dataclasses import replace
import re

import numpy as np
import pytest
from support.optimum import exact_optimum
from support.paths import CONFIG
from support.vehicles import mt2012, random_vehicle, thruster
from thrust_allocator.benchmark.ticks import paper_sweep, smooth_walk, switching_walk
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.active_set import ActiveSet
from thrust_allocator.solve.conditioning import IllConditioned
from thrust_allocator.solve.problem import AllocationProblem, ROUNDING


def weighted(vehicle: Vehicle, ratio: float) -> Vehicle:
    """Return the vehicle with all its R equal, all its Q equal, and R / Q as given."""
    largest = min(1e7, ratio)
    return replace(
        vehicle, thrusters=tuple(replace(one, weight=largest / ratio) for one in vehicle.thrusters),
        wrench_weights=tuple(largest if weight else 0.0 for weight in vehicle.wrench_weights))


def states(vehicle: Vehicle, rng: np.random.Generator,
           count: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield (wrench, limits): a tenth to 10,000 times what is within reach, also off its ways."""
    reverse, forward = vehicle.bollard_thrust
    for i in range(count):
        limits = vehicle.bollard_thrust * rng.uniform(0.0, 1.0, forward.shape)
        limits[:, rng.random(len(forward)) < 0.1] = 0.0
        wrench = vehicle.configuration_matrix @ rng.uniform(reverse, forward)
        if i % 3 == 0:
            wrench = rng.normal(size=6) * np.linalg.norm(wrench)
        yield wrench * 10.0**rng.uniform(-1.0, 4.0), limits


def assert_exact(vehicle: Vehicle, wrench, limits, thrusts, at_bound):
    """Check thrusts against the exact optimum, to what R / Q makes of the rounding of B."""
    exact = exact_optimum(vehicle, wrench, limits, at_bound)
    ratio = max(vehicle.wrench_weights) / min(one.weight for one in vehicle.thrusters)
    error = np.abs(thrusts - exact).max() / np.abs(vehicle.bollard_thrust).max()
    assert error <= max(2e-9, 1e-16 * ratio)


@pytest.mark.parametrize('power', range(2, 13))
def test_every_tick_of_an_accepted_vehicle_is_solved(power):
    """With R / Q from 1e2 to 1e12 no tick is unsolved, and the thrusts are the exact optimum."""
    rng = np.random.default_rng(power)
    accepted = 0
    for vehicle in (load_vehicle(CONFIG / 'mt2012.yaml'),
                    load_vehicle(CONFIG / 'bluerov2_heavy.yaml'),
                    random_vehicle(rng, 5 + power % 8)):
        vehicle = weighted(vehicle, 10.0**power)
        try:
            problem = AllocationProblem(vehicle)
        except IllConditioned:
            continue
        accepted += 1
        for i, (wrench, limits) in enumerate(states(vehicle, rng, 300)):
            allocation = problem.solve(wrench, limits)
            assert allocation.solved and allocation.iterations == 1
            assert (limits[0] <= allocation.thrusts).all()
            assert (allocation.thrusts <= limits[1]).all()
            if i % 15 == 0:
                assert_exact(vehicle, wrench, limits, allocation.thrusts, allocation.at_bound)
    assert accepted >= (3 if power < 12 else 2)


def test_all_weights_at_the_ends_of_their_ranges():
    """All R = 1e7 and all Q = 1e-3 is solved on every tick too, with weights 1e-3 among them."""
    rng = np.random.default_rng(0)
    for wrench_weights in ((1e7,) * 6, (1e7, 1e-3, 1e7, 1e-3, 1e7, 1e-3)):
        vehicle = replace(weighted(mt2012(), 1e10), wrench_weights=wrench_weights)
        problem = AllocationProblem(vehicle)
        for wrench, limits in states(vehicle, rng, 300):
            assert problem.solve(wrench, limits).solved


@pytest.mark.parametrize('power', [4, 10, 12])
def test_ties_are_solved(power):
    """Equal thrusters that meet their bounds together end at an optimum, whatever rounding says."""
    vehicle = weighted(load_vehicle(CONFIG / 'bluerov2_heavy.yaml'), 10.0**power)
    problem, rng = AllocationProblem(vehicle), np.random.default_rng(power)
    for _ in range(500):
        limits = vehicle.bollard_thrust * rng.choice([0.0, 0.5, 1.0])
        wrench = rng.integers(-1, 2, 6) * rng.choice([1.0, 200.0, 1e3, 1e6, 1e9])
        allocation = problem.solve(wrench, limits)
        assert allocation.solved and allocation.iterations == 1


def test_osqp_alone_vouches_for_ordinary_ticks(monkeypatch):
    """With weights to 1e4, on the benchmark's walks and ten times beyond reach, no one else is."""
    monkeypatch.delattr(ActiveSet, 'refine')
    walks = [paper_sweep(200), smooth_walk(mt2012(), 1000), switching_walk(mt2012(), 1000)]
    ticks = [(walk.vehicle, [(tick.wrench, tick.limits) for tick in walk.ticks]) for walk in walks]
    for name in ('mt2012', 'bluerov2_heavy', 'delphin2'):
        vehicle, rng = load_vehicle(CONFIG / f'{name}.yaml'), np.random.default_rng(1)
        vehicle = replace(vehicle, wrench_weights=tuple(np.minimum(vehicle.wrench_weights, 1e4)))
        reach = np.abs(vehicle.configuration_matrix) @ np.abs(vehicle.bollard_thrust).mean(axis=0)
        ticks.append((vehicle, [(rng.normal(size=6) * 10.0 * reach,
                                 vehicle.bollard_thrust * rng.uniform(0.0, 1.0, len(
                                     vehicle.thrusters))) for _ in range(500)]))
    for vehicle, given in ticks:
        problem = AllocationProblem(vehicle)
        for wrench, limits in given:
            allocation = problem.solve(wrench, limits)
            assert (allocation.status, allocation.iterations) == ('solved', 1)


def an_active_set(vehicle: Vehicle) -> ActiveSet:
    """Return the active set of a vehicle all of whose DOFs are controlled."""
    return ActiveSet(vehicle.configuration_matrix,
                     np.array([one.weight for one in vehicle.thrusters]),
                     np.array(vehicle.wrench_weights))


def test_refining_mends_a_start_that_is_wrong():
    """From thrusts that are off, or all at a bound, refining ends in the exact optimum, certain."""
    rng = np.random.default_rng(5)
    vehicle = replace(random_vehicle(rng, 8), wrench_weights=(1e6,) * 6)
    active_set, tolerance = an_active_set(vehicle), 8 * ROUNDING
    for wrench, limits in states(vehicle, rng, 100):
        _, thrusts, at_bound = active_set.solve(wrench, limits)
        off = np.clip(thrusts + (at_bound == 0) * rng.normal(size=8), *limits)
        sides = rng.integers(0, 2, 8)
        for start in ((off, at_bound),
                      (limits[sides, np.arange(8)], (2 * sides - 1).astype(np.int8))):
            refined, held, certain = active_set.refine(wrench, limits, *start, tolerance)
            assert certain
            assert_exact(vehicle, wrench, limits, refined, held)


def light(vehicle: Vehicle, *weights: float) -> Vehicle:
    """Return the vehicle with the weights of its first thrusters changed."""
    return replace(vehicle, thrusters=tuple(
        replace(one, weight=weights[i] if i < len(weights) else one.weight)
        for i, one in enumerate(vehicle.thrusters)))


@pytest.mark.parametrize('vehicle', [
    light(mt2012(), *[1e-9] * 5), light(mt2012(), 1e-9),
    replace(light(mt2012(), *[1e-8] * 5), wrench_weights=(1e7, 1.0, 1e3, 0.0, 1e5, 1e-3)),
    Vehicle((thruster(position=(0.0, 1e6, 0.0)), thruster('u', (0.0, -1e6, 0.0))), (1e7,) * 6)])
def test_what_a_refusal_says_would_do_does(vehicle):
    """Of each number in the message: it serves, and one that is 15 % on the wrong side does not."""
    with pytest.raises(IllConditioned, match='beyond double precision') as caught:
        AllocationProblem(vehicle)
    most, least = map(float, re.search(
        r'must be at most (\S+), or every thruster must weigh at least (\S+)$',
        str(caught.value)).groups())

    def with_weights(highest: float = np.inf, lowest: float = 0.0) -> Vehicle:
        return replace(
            vehicle, wrench_weights=tuple(min(one, highest) for one in vehicle.wrench_weights),
            thrusters=tuple(replace(one, weight=max(one.weight, lowest))
                            for one in vehicle.thrusters))

    AllocationProblem(with_weights(highest=most))
    AllocationProblem(with_weights(lowest=least))
    for wrong in (with_weights(highest=1.15 * most), with_weights(lowest=least / 1.15)):
        with pytest.raises(IllConditioned):
            AllocationProblem(wrong)


def test_no_wrench_weight_is_named_where_none_would_do():
    """Where the weights of the thrusters alone are too far apart, only they are named."""
    with pytest.raises(IllConditioned, match='precision, every thruster must weigh at least'):
        AllocationProblem(replace(light(mt2012(), 1.0, 1.0, 1.0, 1.0, 1e-14),
                                  wrench_weights=(1e4, 0.0, 0.0, 0.0, 0.0, 0.0)))
