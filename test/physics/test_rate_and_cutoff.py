"""Rate limit and cut-off: what they leave of the limits."""

from dataclasses import replace

from hypothesis import given, strategies as st
import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from support.vehicles import limits_of, mt2012, propeller, thruster
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant, Tunnel
from thrust_allocator.physics.rate import rate_limited

SIZE = 4
thrusts = st.lists(st.floats(-200.0, 200.0), min_size=SIZE, max_size=SIZE).map(np.array)
limits = st.tuples(*[st.lists(st.floats(0.0, 200.0), min_size=SIZE, max_size=SIZE)] * 2).map(
    lambda rows: np.array([-np.array(rows[0]), rows[1]]))
steps = st.lists(st.floats(1e-6, 500.0) | st.just(np.inf), min_size=SIZE, max_size=SIZE).map(
    np.array)


@given(limits, thrusts, steps)
def test_rate_limits_are_those_documented(bounds, last, step):
    """The part of the limits within a step of the last setpoint; else the nearest limit."""
    lower, upper = rate_limited(bounds, last, step)
    assert (bounds[0] <= lower).all() and (lower <= upper).all() and (upper <= bounds[1]).all()
    for i in range(SIZE):
        low, high, around = *bounds[:, i], (last[i] - step[i], last[i] + step[i])
        if around[1] < low:  # the speed bound wins
            expected = low, low
        elif around[0] > high:
            expected = high, high
        else:
            expected = max(low, around[0]), min(high, around[1])
        assert (lower[i], upper[i]) == expected


@given(limits, limits, thrusts, thrusts, steps)
def test_rate_limits_are_continuous(bounds, other_bounds, last, other_last, step):
    """The limits change by no more than the greatest change of what they follow from."""
    change = np.abs(rate_limited(bounds, last, step) - rate_limited(other_bounds, other_last, step))
    most = np.maximum(np.abs(bounds - other_bounds).max(axis=0), np.abs(last - other_last))
    assert (change <= most + 1e-12).all()


def test_no_rate_limit_by_default():
    """An infinite step leaves the limits as they are, to the bit."""
    bounds = np.array([[-1.0, 0.0, -2.5, 0.0], [0.0, 3.1, 2.5, 0.0]])
    assert_array_equal(rate_limited(bounds, np.full(4, 1e6), np.full(4, np.inf)), bounds)


BOLLARD = (-68.2, 120.1)
MODELS = {'propeller': propeller(), 'tunnel': Tunnel(BOLLARD, 7.0, 1025.0 * 0.0707),
          'constant': Constant(BOLLARD)}
velocities = st.lists(st.floats(-5.0, 5.0), min_size=6, max_size=6)
cutoffs = st.floats(0.0, 0.99)
bollards = st.tuples(st.floats(-500.0, 0.0), st.floats(1e-3, 500.0))


@given(st.sampled_from([*MODELS.values()]), bollards, cutoffs, velocities)
def test_cutoff_is_the_formula(model, bollard, share, velocity):
    """In either sense the limit is max(0, (limit - share T0) / (1 - share)), in every model."""
    plain = thruster(model=replace(model, bollard_thrust=bollard))
    before, after = limits_of(plain, replace(plain, cutoff=share), velocity=velocity).T
    for limit, found, most in zip(np.abs(before), np.abs(after), np.abs(bollard)):
        expected = max(0.0, (limit - share * most) / (1.0 - share))
        assert found == pytest.approx(expected, abs=1e-9)
        assert found <= most and found <= limit + 1e-12 * most
        if limit < (share - 1e-12) * most:
            assert found == 0.0
    assert after[0] <= 0.0 <= after[1]


@given(st.sampled_from([*MODELS.values()]), bollards, st.floats(0.0, 1.0, exclude_max=True))
def test_cutoff_takes_nothing_at_rest(model, bollard, share):
    """At rest the limits are the Bollard ones exactly, whatever the share."""
    one = thruster(model=replace(model, bollard_thrust=bollard))
    assert limits_of(replace(one, cutoff=share), velocity=[0.0] * 6)[:, 0].tolist() == [*bollard]


@given(bollards, cutoffs, st.floats(0.0, 2.0), st.floats(0.0, 2.0))
def test_cutoff_has_no_jump(bollard, share, speed, other):
    """A limit with cut-off changes 1 / (1 - share) times as much as without, at most."""
    plain = thruster(model=replace(MODELS['tunnel'], bollard_thrust=bollard))
    cut = replace(plain, cutoff=share)
    one, two = (limits_of(plain, cut, velocity=[0.0, value, 0.0, 0.0, 0.0, 0.0])
                for value in (speed, other))
    change = np.abs(one - two)
    assert (change[:, 1] <= change[:, 0] / (1.0 - share) + 1e-9).all()


def test_cutoff_takes_the_tunnel_out():
    """MT-2012's tunnel with cut-off 0.2 is out at 0.9 m/s, and the stern keeps its limits."""
    cut = mt2012(thrusters__tunnel__cutoff=0.2)
    share = 0.2 * cut.bollard_thrust[:, 4]
    for speed, out in ((0.0, False), (0.3, False), (0.9, True)):
        full, found = (ThrustBounds(vehicle)(np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0]))
                       for vehicle in (mt2012(), cut))
        assert_array_equal(found[:, :4], full[:, :4])
        assert_allclose(found[:, 4], [0.0, 0.0] if out else (full[:, 4] - share) / 0.8)
