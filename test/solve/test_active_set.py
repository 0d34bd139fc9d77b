"""The active set alone: the optimum along any walk, and what becomes of it where rounding rules."""

from unittest.mock import Mock

import numpy as np
import pytest
from support.optimum import daqp_optimum
from support.vehicles import mt2012, NAMES, random_vehicle
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.active_set import ActiveSet


def parts(vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return which DOFs are controlled, B over them, and the diagonals of Q and R."""
    controlled = np.flatnonzero(vehicle.wrench_weights)
    return (controlled, vehicle.configuration_matrix[controlled],
            np.array([one.weight for one in vehicle.thrusters]),
            np.array(vehicle.wrench_weights)[controlled])


def without(vehicle: Vehicle, *names: str) -> np.ndarray:
    """Return the Bollard limits with some thrusters off."""
    limits = vehicle.bollard_thrust.copy()
    limits[:, [one.name in names for one in vehicle.thrusters]] = 0.0
    return limits


def walk(rng: np.random.Generator, vehicle: Vehicle, ticks: int):
    """Yield wrench and limits of each tick: small steps, with a leap or a switch now and then."""
    scale = vehicle.configuration_matrix @ vehicle.bollard_thrust[1]
    share, off = rng.uniform(0.1, 1.0, vehicle.bollard_thrust.shape), set()
    wrench = rng.normal(size=6) * np.abs(scale)
    for _ in range(ticks):
        if rng.random() < 0.1:
            wrench = rng.normal(size=6) * np.abs(scale) * rng.choice([0.0, 1.0, 10.0])
        if rng.random() < 0.1:
            off ^= {int(rng.integers(share.shape[1]))}
        wrench = wrench + 0.02 * rng.normal(size=6) * np.abs(scale)
        share = np.clip(share + 0.05 * rng.normal(size=share.shape), 0.0, 1.0)
        limits = vehicle.bollard_thrust * share
        limits[:, list(off)] = 0.0
        yield wrench, limits


@pytest.mark.parametrize('seed', range(12))
def test_follows_the_optimum_along_a_walk(seed):
    """Each tick: an independent solver's optimum, the bounds that hold it, and what they cost."""
    rng = np.random.default_rng(seed)
    vehicle = random_vehicle(rng)
    controlled, matrix, thrust_weights, wrench_weights = parts(vehicle)
    active_set, largest = ActiveSet(*parts(vehicle)[1:]), np.abs(vehicle.bollard_thrust).max()
    for wrench, limits in walk(rng, vehicle, 200):
        wanted, thrusts, at_bound = active_set.solve(wrench[controlled], limits)
        assert np.abs(thrusts - daqp_optimum(vehicle, wrench, limits)).max() <= 1e-6 * largest
        # What a thruster would give without its own bound: q x = b^T R (f - B tau)
        pull = matrix.T @ (wrench_weights * (wrench[controlled] - matrix @ thrusts))
        rounding = 1e-12 * np.abs(matrix.T @ (wrench_weights * np.abs(wrench[controlled]))).max()
        np.testing.assert_allclose(
            wanted * thrust_weights, pull, rtol=1e-6, atol=1e3 * rounding + 1e-3)
        assert (thrusts == np.clip(wanted, *limits)).all()
        assert (thrusts[at_bound < 0] == limits[0][at_bound < 0]).all()
        assert (thrusts[at_bound > 0] == limits[1][at_bound > 0]).all()
        assert (at_bound == (wanted > limits[1]).astype(int) - (wanted <= limits[0])).all()


def test_all_at_once_while_nothing_is_commanded():
    """No wrench, `down` off, then all the other stern thrusters off instead: exact zeros."""
    vehicle = mt2012()
    active_set = ActiveSet(*parts(vehicle)[1:])
    for off in ((), ('down',), ('left', 'up', 'right'), ('down',), tuple(NAMES), ()):
        wanted, thrusts, _ = active_set.solve(np.zeros(4), without(vehicle, *off))
        assert not wanted.any() and not thrusts.any()


@pytest.mark.parametrize('seed', range(20))
def test_a_tick_that_does_not_end_leaves_nothing_behind(monkeypatch, seed):
    """Where rounding keeps it from ending: inside the limits, and then as if it were new."""
    rng = np.random.default_rng(seed)
    vehicle = random_vehicle(rng)
    controlled, *problem = parts(vehicle)
    old, new = ActiveSet(*problem), ActiveSet(*problem)
    for i, (wrench, limits) in enumerate(walk(rng, vehicle, 40)):
        if i % 4:
            answer = old.solve(wrench[controlled], limits)
            for one, another in zip(answer, new.solve(wrench[controlled], limits)):
                assert one.tobytes() == another.tobytes()
            continue
        # Noise never agrees with the set that it is asked about; a set that stays needs no asking
        noise = Mock(side_effect=lambda wrench, limits, beyond: rng.normal(size=limits.shape))
        with monkeypatch.context() as patch:
            patch.setattr(ActiveSet, '_gap', noise)
            _, thrusts, _ = old.solve(10.0 * wrench[controlled], limits)
        assert (limits[0] <= thrusts).all() and (thrusts <= limits[1]).all()
        if noise.called:
            new = ActiveSet(*problem)
        else:
            new.solve(10.0 * wrench[controlled], limits)


def test_a_set_that_is_met_again_is_not_computed_again(monkeypatch):
    """What follows from a set is computed once, and confirmed by a product from then on."""
    vehicle = mt2012()
    active_set, limits = ActiveSet(*parts(vehicle)[1:]), without(vehicle, 'up')
    first = active_set.solve(np.array([50.0, 0.0, 20.0, 5.0]), limits)
    monkeypatch.setattr(np.linalg, 'solve', None)
    second = active_set.solve(np.array([50.0, 0.0, 20.0, 5.0]), limits)
    for one, another in zip(first, second):
        np.testing.assert_allclose(one, another, atol=1e-9)
