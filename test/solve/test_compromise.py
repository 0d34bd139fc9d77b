"""What gives way: direction keeping and the power limit, around the same QP."""

from dataclasses import replace

import numpy as np
import pytest
from support.vehicles import described, mt2012, random_vehicle, thruster
from thrust_allocator.physics.models import Constant
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.attainable import AttainableSet, TooManyFaces
from thrust_allocator.solve.authority import authority, authority_weights
from thrust_allocator.solve.compromise import Compromise, FULLY_KEPT
from thrust_allocator.solve.problem import AllocationProblem

SURGE, HEAVE, PITCH = 0, 2, 4
PLANE = (1e4, 1e4, 0.0, 0.0, 0.0, 1e4)  # weights of surge, sway and yaw alone


def compromise(vehicle, *rules):
    """Return a compromise over a problem of its own."""
    return Compromise(vehicle, AllocationProblem(vehicle), *rules)


def with_authority(vehicle):
    """Return a vehicle with weights by authority in all six DOFs."""
    reach = authority(vehicle.configuration_matrix, vehicle.bollard_thrust, np.ones(6, bool))
    return replace(vehicle, wrench_weights=tuple(authority_weights(reach).tolist()))


def weighted(seed):
    """Return a random vehicle with weights by authority, and a generator."""
    rng = np.random.default_rng(seed)
    return with_authority(random_vehicle(rng, int(rng.integers(6, 10)))), rng


def commands(vehicle, rng, count):
    """Return wrenches within reach and beyond, in every direction."""
    return [vehicle.configuration_matrix @ rng.uniform(*vehicle.bollard_thrust)
            * rng.uniform(0.1, 4.0) for _ in range(count)]


def power_of(vehicle):
    """Return a prediction for thrusters that lose nothing in a flow, 100 W each."""
    full = np.abs(vehicle.bollard_thrust).max(axis=0)
    return lambda thrusts: 100.0 * float(np.sum((np.abs(thrusts) / full)**1.5))


def angle(one, other, scale):
    """Return the angle between two wrenches whose components are divided by `scale` [deg]."""
    one, other = one / scale, other / scale
    return np.degrees(np.arccos(np.clip(
        one @ other / np.linalg.norm(one) / np.linalg.norm(other), -1.0, 1.0)))


def test_off_means_the_same_to_the_bit():
    """With k = 0 and no power limit nothing differs from the QP alone."""
    for seed in range(5):
        vehicle, rng = weighted(seed)
        plain, off = AllocationProblem(vehicle), compromise(vehicle)
        for wrench in commands(vehicle, rng, 40):
            expected = plain.solve(wrench, vehicle.bollard_thrust)
            found = off.solve(wrench, vehicle.bollard_thrust, vehicle.bollard_thrust)
            for one, other in zip(found, expected):
                np.testing.assert_array_equal(one, other)


def test_direction_is_kept_and_half_kept():
    """k = 1 keeps the direction of what can be served; k = 0.5 lies between that and k = 0."""
    for seed in range(8):
        vehicle, rng = weighted(seed)
        limits, matrix = vehicle.bollard_thrust, vehicle.configuration_matrix
        reach = authority(matrix, limits, np.ones(6, bool))
        if np.linalg.matrix_rank(matrix) < 6:
            continue
        rules = [compromise(vehicle, k) for k in (0.0, 0.5, 1.0)]
        angles = []
        for wrench in commands(vehicle, rng, 40):
            found = [one.solve(wrench, limits, limits) for one in rules]
            angles.append([angle(wrench, one.achieved, reach) for one in found])
            alpha = found[2].reach
            if alpha >= FULLY_KEPT:
                assert found[2].direction_scale == pytest.approx(alpha)
                assert found[1].direction_scale == pytest.approx(0.5 + 0.5 * alpha)
            for one in found:
                assert one.solved
                np.testing.assert_allclose(one.achieved + one.unallocated, wrench, atol=1e-9)
        none, half, whole = np.mean(angles, axis=0)
        assert whole < 0.1 < half < none


def test_within_reach_nothing_changes():
    """A wrench with a scale of 1 is allocated as it is, to the bit."""
    vehicle, rng = weighted(3)
    kept, plain = compromise(vehicle, 1.0), AllocationProblem(vehicle)
    attainable = AttainableSet(vehicle.configuration_matrix, vehicle.wrench_weights)
    limits = vehicle.bollard_thrust
    for wrench in commands(vehicle, rng, 50):
        wrench = 0.999 * attainable.scale(wrench, limits) * wrench
        np.testing.assert_array_equal(kept.solve(wrench, limits, limits).thrusts,
                                      plain.solve(wrench, limits).thrusts)


def test_scale_is_of_the_speed_limits_whatever_the_rate():
    """While the setpoints ramp, the wrench asked for stays the same share of the command."""
    vehicle, rng = weighted(4)
    kept, limits = compromise(vehicle, 1.0), vehicle.bollard_thrust
    wrench = 5.0 * vehicle.configuration_matrix @ limits[1]
    full = kept.solve(wrench, limits, limits)
    ramped = kept.solve(wrench, limits, 0.1 * limits)
    assert ramped.direction_scale == full.direction_scale < 0.5
    assert (np.abs(ramped.thrusts) <= 0.1 * np.abs(limits).max(axis=0) + 1e-12).all()


def test_dofs_that_are_left_out_are_not_scaled():
    """MT-2012 at 0.9 m/s cannot hold heave while it pitches; without heave in D all is kept."""
    vehicle = mt2012()
    limits = np.array([[-63.1] * 4 + [-4.2], [98.4] * 4 + [4.2]])
    wrench = np.array([32.4, 0.0, 0.0, 0.0, 50.0, 0.0])
    plain = AllocationProblem(vehicle).solve(wrench, limits)
    chosen = compromise(vehicle, 1.0, (0, 4, 5)).solve(wrench, limits, limits)
    np.testing.assert_array_equal(chosen.thrusts, plain.thrusts)
    every = compromise(vehicle, 1.0).solve(wrench, limits, limits)
    assert every.achieved[PITCH] < 0.3 * plain.achieved[PITCH]


def test_a_dead_thruster_does_not_take_every_dof_down():
    """Where hardly anything is left in the direction, the weights decide, without a step."""
    vehicle = mt2012()
    kept, plain = compromise(vehicle, 1.0), AllocationProblem(vehicle)
    wrench = np.array([32.4, 0.0, 0.0, 0.0, 50.0, 0.0])
    last = None
    for tunnel in np.geomspace(40.0, 1e-9, 3000):
        limits = np.array([[-63.1] * 4 + [-tunnel], [98.4] * 4 + [tunnel]])
        found = kept.solve(wrench, limits, limits).thrusts
        assert last is None or np.abs(found - last).max() < 1.0
        last = found
    np.testing.assert_allclose(last, plain.solve(wrench, limits).thrusts, atol=1e-4)


def test_one_sided_thrusters_give_the_nearest_wrench():
    """Two thrusters that only push ahead keep surge when sway, which they lack, is asked for."""
    vehicle = Vehicle((thruster('port', (0.0, -0.5, 0.0), model=Constant((0.0, 50.0))),
                       thruster('star', (0.0, 0.5, 0.0), model=Constant((0.0, 50.0))),
                       thruster('side', direction=(0.0, 1.0, 0.0), model=Constant((0.0, 20.0)))),
                      PLANE)
    kept, limits = compromise(vehicle, 1.0), vehicle.bollard_thrust
    found = kept.solve(np.array([300.0, -10.0, 0.0, 0.0, 0.0, 0.0]), limits, limits)
    np.testing.assert_allclose(found.achieved, [100.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=0.01)
    turning = kept.solve(np.array([40.0, 0.0, 0.0, 0.0, 0.0, 100.0]), limits, limits)
    # The nearest wrench that only the port one gives: 40 s + 0.5 * 100 s, s^2 (1 + 0.25)
    assert turning.thrusts == pytest.approx([50.0, 0.0, 0.0], abs=0.01)
    for lateral in (1e-6, -1e-6):  # either side of the cone
        thrusts = kept.solve(np.array([300.0, lateral, 0, 0, 0, 0]), limits, limits).thrusts
        np.testing.assert_allclose(thrusts, [50.0, 50.0, 0.0], atol=0.01)


def test_power_never_exceeds_its_limit_and_uses_it():
    """Whatever is commanded; where the limit acts, all of it is used."""
    acted = 0
    for seed in range(8):
        vehicle, rng = weighted(seed)
        power, limits = power_of(vehicle), vehicle.bollard_thrust
        limit = 30.0 * len(vehicle.thrusters)
        for k in (0.0, 1.0):
            rule = compromise(vehicle, k, range(6), limit)
            for wrench in commands(vehicle, rng, 25):
                found = rule.solve(wrench, limits, limits, lambda: power)
                assert found.power == power(found.thrusts) <= limit and found.solved
                assert (found.thrusts >= limits[0]).all() and (found.thrusts <= limits[1]).all()
                if found.power_scale < 1.0:
                    acted += 1
                    assert found.power > 0.99999 * limit
    assert acted > 100


def test_power_scales_a_wrench_of_any_size():
    """A command a billion times what there is still uses the power that there is."""
    vehicle, rng = weighted(1)
    power, limits = power_of(vehicle), vehicle.bollard_thrust
    rule = compromise(vehicle, 0.0, range(6), 100.0)
    for wrench in commands(vehicle, rng, 20):
        found = rule.solve(1e9 * wrench, limits, limits, lambda: power)
        assert 99.9 < found.power <= 100.0


def test_power_wins_over_the_rate():
    """Setpoints that may hardly change are moved all the same where they take too much."""
    vehicle, rng = weighted(2)
    power, full = power_of(vehicle), vehicle.bollard_thrust
    last = 0.9 * full[1]
    limits = np.array((last - 0.01, np.minimum(last + 0.01, full[1])))
    rule = compromise(vehicle, 0.0, range(6), 0.5 * power(last))
    for wrench in commands(vehicle, rng, 20):
        found = rule.solve(wrench, full, limits, lambda: power)
        assert 0.499 * power(last) < found.power <= 0.5 * power(last)
        assert found.power_scale == 0.0
        assert (found.thrusts >= found.limits[0]).all() and (found.limits[0] <= limits[0]).all()
        np.testing.assert_array_equal(found.limits[1], limits[1])


def test_too_many_faces():
    """Are refused where the direction is to be kept, and do not matter elsewhere."""
    rng = np.random.default_rng(5)
    vehicle = random_vehicle(rng, 16)
    vehicle = replace(vehicle, wrench_weights=(1e3,) * 6)
    with pytest.raises(TooManyFaces):
        compromise(vehicle, 0.5)
    assert compromise(vehicle, 0.0).solve(
        np.ones(6), vehicle.bollard_thrust, vehicle.bollard_thrust).solved


@pytest.mark.parametrize('k, power', [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (1.0, 0.4)])
def test_no_jump_across_the_boundary(k, power):
    """Along a line of wrenches the largest step of the setpoints goes with the step of the line."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        # Of any vehicle without a power limit; with one, where power grows all the way to a command
        vehicle = with_authority(described('bluerov2_heavy')) if power else weighted(seed)[0]
        limits, predict = vehicle.bollard_thrust, power_of(vehicle)
        rule = compromise(vehicle, k, range(6), power * 100.0 * limits.shape[1])
        start, end = commands(vehicle, rng, 2)
        places = np.linspace(0.0, 1.0, 201)
        for _ in range(3):  # the interval with the largest step, two times refined by a hundred
            thrusts = np.array([rule.solve(start + place * (end - start), limits, limits,
                                           lambda: predict).thrusts for place in places])
            steps = np.abs(np.diff(thrusts, axis=0)).max(axis=1)
            places = np.linspace(*places[steps.argmax():][:2], 101)
        assert steps.max() < 1e-3 * np.abs(limits).max(), seed
