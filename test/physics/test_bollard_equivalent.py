"""Thrust in the flow and what a driver calibrated at rest must be told: inverses of each other."""

import math

from hypothesis import assume, given, strategies as st
import numpy as np
import pytest
from support.vehicles import mt2012, paper_test, PITCH, propeller_loss
from thrust_allocator.physics.bollard_equivalent import bollard_equivalent, thrust_in_flow
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models.tunnel import TunnelLoss
from thrust_allocator.solve.problem import AllocationProblem

LIMITS = st.tuples(st.floats(-500.0, -1.0), st.floats(1.0, 500.0))
SPEEDS = st.tuples(st.floats(-4.0, 4.0), st.floats(0.0, 4.0))  # along and across the thrust axis
LOSSES = st.one_of(
    st.none(),
    st.builds(TunnelLoss, decay=st.floats(0.0, 10.0), jet_mass=st.floats(0.1, 200.0)),
    st.builds(lambda loss, opposed, floor: propeller_loss(
        speed_loss=loss, opposed_loss=opposed, opposed_floor=floor),
        st.tuples(st.floats(0.0, 100.0), st.floats(0.0, 100.0)),
        st.tuples(st.floats(0.0, 50.0), st.floats(0.0, 50.0)), st.floats(0.0, 1.0)))
SIDES = st.sampled_from([0, 1])


def limit_of(loss, limits, side, speeds):
    """Return the limit of one sense of thrust in the flow."""
    return (limits if loss is None else loss.law(limits)(*speeds))[side]


@given(LOSSES, LIMITS, SIDES, SPEEDS, st.floats(1e-9, 1.0))
def test_inverse(loss, limits, side, speeds, share):
    """The equivalent thrust gives the wanted one back in the flow, and is within Bollard thrust."""
    thrust = share * limit_of(loss, limits, side, speeds)
    assume(thrust != 0.0)
    e = bollard_equivalent(thrust, loss, limits, *speeds)
    assert type(e) is float and math.copysign(1.0, e) == math.copysign(1.0, thrust)
    assert abs(thrust) * (1.0 - 1e-9) <= abs(e) <= abs(limits[side])
    assert thrust_in_flow(e, loss, limits, *speeds) == pytest.approx(thrust, rel=1e-9, abs=1e-9)


@given(LOSSES, LIMITS, SIDES, SPEEDS, st.floats(1e-6, 1.0), st.floats(1e-6, 1.0))
def test_monotone(loss, limits, side, speeds, one, other):
    """More thrust in the flow needs more at rest, and more at rest never gives less."""
    less, more = sorted((one, other))
    limit = limit_of(loss, limits, side, speeds)
    assume(limit != 0.0 and more - less > 1e-6)
    told = [abs(bollard_equivalent(share * limit, loss, limits, *speeds)) for share in (less, more)]
    assert told[0] <= told[1]
    got = [abs(thrust_in_flow(share * limits[side], loss, limits, *speeds))
           for share in (less, more)]
    assert got[0] <= got[1] <= abs(limit) * (1.0 + 1e-12)


@given(LOSSES, LIMITS, SIDES, SPEEDS)
def test_at_the_limit(loss, limits, side, speeds):
    """At the limit in the flow the equivalent is Bollard thrust, and the other way round."""
    limit = limit_of(loss, limits, side, speeds)
    assume(abs(limit) > 1e-9)
    assert bollard_equivalent(limit, loss, limits, *speeds) == pytest.approx(limits[side], rel=1e-9)
    assert thrust_in_flow(limits[side], loss, limits, *speeds) == pytest.approx(limit, rel=1e-9)


@given(LOSSES, LIMITS, SPEEDS)
def test_nothing_for_nothing(loss, limits, speeds):
    """Zero is zero both ways."""
    assert bollard_equivalent(0.0, loss, limits, *speeds) == 0.0
    assert thrust_in_flow(0.0, loss, limits, *speeds) == 0.0


@pytest.mark.parametrize('across', [0.0, 5e-324, 1e-163, 1e-160, 1e-12, 0.5, 5.0, 50.0])
@pytest.mark.parametrize('thrust', [5e-324, 1e-300, 1e-9, 1.0, 122.1])
def test_extremes_of_a_tunnel(across, thrust):
    """A flow that has nearly died out, or hardly any thrust left: finite, and within bounds."""
    loss, limits = TunnelLoss(7.0, 72.5), (-122.0, 122.1)
    for sign, limit in zip((-1.0, 1.0), loss.law(limits)(0.0, across)):
        wanted = sign * min(thrust, abs(limit))
        e = bollard_equivalent(wanted, loss, limits, 0.0, across)
        assert abs(wanted) <= abs(e) <= 122.1
        assert thrust_in_flow(e, loss, limits, 0.0, across) == pytest.approx(wanted, abs=1e-9)


def test_a_propeller_too_slow_to_push():
    """Told less than what the flow takes, a thruster delivers nothing, and never the opposite."""
    for loss in (propeller_loss(), TunnelLoss(7.0, 72.5)):
        for told in (1e-300, 1e-3, -1e-3):
            delivered = thrust_in_flow(told, loss, (-68.2, 120.1), 1.5, 0.5)
            assert delivered == pytest.approx(0.0, abs=1e-6) and delivered * told >= 0.0


def test_the_equations():
    """The values of physics 4a: tau = e - dL sqrt(e / T0), tau = e exp(-c rho S v^2 / e)."""
    limits = (-68.2, 120.1)
    forward = propeller_loss().law(limits)(1.0, 0.0)[1]
    assert thrust_in_flow(40.0, propeller_loss(), limits, 1.0, 0.0) == pytest.approx(
        40.0 - (120.1 - forward) * math.sqrt(40.0 / 120.1), abs=1e-12)
    assert thrust_in_flow(-40.0, TunnelLoss(7.0, 72.5), (-122.0, 122.1), 9.0, 0.5) == pytest.approx(
        -40.0 * math.exp(-7.0 * 72.5 * 0.25 / 40.0), abs=1e-12)
    assert thrust_in_flow(40.0, None, limits, 9.0, 9.0) == 40.0


def test_newtons_given_to_a_bollard_curve():
    """A driver calibrated at rest that is given the thrusts themselves delivers 36 of 50 N*m."""
    vehicle, (wrench, velocity) = mt2012(), paper_test(0.9)
    bounds = ThrustBounds(vehicle)
    thrusts = AllocationProblem(vehicle).solve(wrench, bounds(velocity)).thrusts
    delivered = np.array([
        thrust_in_flow(thrust, one.loss, one.bollard_thrust, *flow)
        for thrust, one, flow in zip(thrusts, vehicle.thrusters, bounds.flow(velocity))])
    assert (vehicle.configuration_matrix @ delivered)[PITCH] == pytest.approx(36.0, abs=0.5)
