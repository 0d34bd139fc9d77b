"""The moving bounds: numbers from closed forms, and properties that hold for every vehicle."""

from dataclasses import replace
import math

from hypothesis import given, settings, strategies as st
import numpy as np
import pytest
from support.vehicles import (
    limits_of, mt2012, PAPER_TEST, paper_test, propeller, random_vehicle, thruster)
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.flow import FlowAtThrusters
from thrust_allocator.physics.models import Tunnel

BOLLARD = (-68.2, 120.1)
seeds = st.integers(0, 2**32 - 1)


def propeller_at(speed: float, angle: float, model=None) -> np.ndarray:
    """Return (lower, upper) of an MT-2012 propeller that moves at an angle to its thrust axis."""
    velocity = [speed * math.cos(angle), speed * math.sin(angle), 0.0, 0.0, 0.0, 0.0]
    return limits_of(thruster(model=model or propeller()),
                     velocity=velocity)[:, 0]


@pytest.mark.parametrize('row', PAPER_TEST, ids=lambda row: f'{row[0]} m/s')
def test_paper_test_gives_the_tables_limits(row):
    """The limits of MT-2012 moving straight ahead are those of the table."""
    speed, _, stern, tunnel, _, _ = row
    lower, upper = ThrustBounds(mt2012())(paper_test(speed)[1])
    assert lower[:4] == pytest.approx([stern[0]] * 4, abs=0.05)
    assert upper[:4] == pytest.approx([stern[1]] * 4, abs=0.05)
    assert upper[4] == pytest.approx(tunnel, abs=0.05)


@pytest.mark.parametrize('speed, expected', [(1.0, 115.5), (2.5, 118.7)])
def test_limit_is_not_monotone_in_speed(speed, expected):
    """At 55 degrees the paper's law gives more thrust at 2.5 m/s than at 1 m/s."""
    assert propeller_at(speed, math.radians(55.0))[1] == pytest.approx(expected, abs=0.05)


def test_limit_does_not_turn_back_up_at_high_speed():
    """The floor of the first critical angle keeps the loss growing where eq. 3.11 would not."""
    angle = math.radians(22.5)
    assert propeller_at(3.0, angle)[1] == pytest.approx(63.8, abs=0.1)
    assert propeller_at(5.9, angle)[1] < propeller_at(3.0, angle)[1]


@given(speed=st.floats(0.0, 2.6), share=st.floats(0.0, 1.0), reverse=st.booleans())
def test_equals_equation_3_11_up_to_the_first_critical_angle(speed, share, reverse):
    """Within the first critical angle the limit is eq. 3.11, while that is not negative."""
    critical = math.pi / 2 - 0.20 * speed
    incoming = share * critical
    loss, bollard = (24.0, 68.2) if reverse else (42.2, 120.1)
    expected = bollard - loss * speed * (1.0 - math.sin(math.pi / 2 * incoming / critical))
    limits = propeller_at(speed, math.pi - incoming if reverse else incoming)
    assert abs(limits[0 if reverse else 1]) == pytest.approx(max(expected, 0.0), abs=1e-9)


@given(speed=st.floats(0.0, 5.0), across=st.floats(-5.0, 5.0), along=st.floats(-5.0, 5.0))
def test_tunnel_decays_with_the_transverse_speed_alone(speed, across, along):
    """Eq. 3.12 and 3.13: motion along the jet costs a tunnel thruster nothing."""
    tunnel = thruster(direction=(0.0, 0.0, 1.0),
                      model=Tunnel((-122.0, 122.1), 7.0, 1025.0 * 0.0707))
    lower, upper = limits_of(tunnel, velocity=[speed, across, along, 0.0, 0.0, 0.0])[:, 0]
    for limit, bollard in ((lower, -122.0), (upper, 122.1)):
        jet = abs(bollard) / (1025.0 * 0.0707)  # v_jet^2
        expected = bollard * math.exp(-7.0 * (speed**2 + across**2) / jet)
        assert limit == pytest.approx(expected, rel=1e-9, abs=1e-12)


@given(seed=seeds)
@settings(deadline=None)
def test_bounds_lie_between_zero_and_bollard(seed):
    """No motion turns a limit across zero or raises it above Bollard; at rest it is Bollard."""
    rng = np.random.default_rng(seed)
    vehicle = random_vehicle(rng)
    bounds = ThrustBounds(vehicle)
    lower, upper = bounds(rng.normal(size=6) * rng.choice([0.1, 1.0, 10.0]))
    reverse, forward = vehicle.bollard_thrust
    assert (reverse <= lower).all() and (lower <= 0.0).all()
    assert (0.0 <= upper).all() and (upper <= forward).all()
    assert (bounds(np.zeros(6)) == vehicle.bollard_thrust).all()


@given(seed=seeds)
@settings(deadline=None)
def test_bounds_are_mirror_symmetric(seed):
    """A vehicle mirrored port to starboard, with its motion mirrored, has the same bounds."""
    rng = np.random.default_rng(seed)
    vehicle = random_vehicle(rng)
    mirrored = replace(vehicle, thrusters=tuple(
        replace(one, position=tuple(np.multiply(one.position, (1, -1, 1))),
                direction=tuple(np.multiply(one.direction, (1, -1, 1))))
        for one in vehicle.thrusters))
    velocity = rng.normal(size=6)
    assert ThrustBounds(mirrored)(velocity * (1, -1, 1, -1, 1, -1)) == pytest.approx(
        ThrustBounds(vehicle)(velocity), abs=1e-9)


@given(seed=seeds)
@settings(deadline=None)
def test_turning_a_thruster_round_swaps_its_limits(seed):
    """The law treats both senses of thrust alike: reversed axis and data, reversed limits."""
    rng = np.random.default_rng(seed)
    one = thruster(direction=(0.6, 0.0, 0.8), model=propeller())
    other = thruster(direction=(-0.6, 0.0, -0.8), model=propeller(
        bollard_thrust=(-120.1, 68.2), speed_loss=(42.2, 24.0), opposed_loss=(17.5, 9.9)))
    limits = limits_of(one, other, velocity=rng.normal(size=6))
    assert limits[:, 1] == pytest.approx(-limits[::-1, 0], abs=1e-9)


@given(seed=seeds)
@settings(deadline=None)
def test_turning_adds_omega_cross_r(seed):
    """A thruster away from the origin feels the velocity of the place where it sits."""
    rng = np.random.default_rng(seed)
    position, velocity, turn = rng.normal(size=(3, 3))
    one = thruster(model=propeller())
    away = replace(one, position=tuple(position))
    assert limits_of(away, velocity=[*velocity, *turn]) == pytest.approx(
        limits_of(one, velocity=[*(velocity + np.cross(turn, position)), 0, 0, 0]), abs=1e-9)


def test_angle_of_attack_is_exact_straight_ahead_and_astern():
    """The angle is 0 and pi to the last bits there, where arccos would lose half the digits."""
    flow = FlowAtThrusters([thruster(direction=(0.6, 0.8, 0.0))])
    for sense in (1.0, -1.0):
        (along, *across), = flow(sense * np.array([0.6, 0.8, 0, 0, 0, 0]))
        assert along == pytest.approx(sense, abs=1e-15)
        assert across == pytest.approx([0.0, 0.0], abs=1e-15)


coefficients = st.fixed_dictionaries({
    'angle_law': st.sampled_from(['paper', 'cosine']),
    'speed_loss': st.tuples(*[st.floats(0.0, 1e6)] * 2),
    'speed_loss_quadratic': st.tuples(*[st.floats(0.0, 1e6)] * 2),
    'critical_angle_slope': st.floats(0.0, 1e6),
    'critical_angle_min': st.floats(1e-3, math.pi / 2),  # below, one bit of the angle is a step
    'second_critical_angle_offset': st.floats(-1e6, 1e6),
    'second_critical_angle_slope': st.floats(-1e6, 1e6),
    'opposed_loss': st.tuples(*[st.floats(0.0, 1e6)] * 2),
    'opposed_floor': st.floats(0.0, 1.0)})
flows = st.tuples(st.floats(0.0, 50.0), st.floats(0.0, math.pi))


@given(coefficients, st.floats(1e-3, 1e6), flows, flows)
@settings(deadline=None)
def test_propeller_limits_have_no_jump(changes, bollard, start, end):
    """Between two flows, halving towards the greater change leaves no change at all."""
    law = propeller(bollard_thrust=(-bollard, bollard), **changes).limits

    def at(share: float) -> np.ndarray:
        speed, angle = ((1.0 - share) * a + share * b for a, b in zip(start, end))
        return np.array(law(speed * math.cos(angle), speed * math.sin(angle)))

    low, high = 0.0, 1.0
    while (middle := (low + high) / 2.0) not in (low, high):
        if np.abs(at(middle) - at(low)).max() > np.abs(at(high) - at(middle)).max():
            high = middle
        else:
            low = middle
    steepest = max(*changes['speed_loss'], *changes['opposed_loss'],
                   50.0 * max(changes['speed_loss_quadratic'])) * 50.0 / 1e-3
    assert np.abs(at(high) - at(low)).max() <= 1e-13 * (bollard + steepest) * 1e3


@given(coefficients, st.floats(1e-3, 1e6), flows)
def test_propeller_limits_stay_in_range_for_every_coefficient(changes, bollard, flow):
    """Whatever the validator lets through, a limit is finite and between zero and Bollard."""
    speed, angle = flow
    lower, upper = propeller(bollard_thrust=(-bollard, bollard), **changes).limits(
        speed * math.cos(angle), speed * math.sin(angle))
    assert -bollard <= lower <= 0.0 <= upper <= bollard
