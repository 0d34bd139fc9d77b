"""Thrust in the flow and what a driver calibrated at rest must be told: inverses of each other."""

from dataclasses import replace
import math

from hypothesis import assume, given, strategies as st
import numpy as np
import pytest
from support.vehicles import mt2012, paper_test, PITCH, propeller
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant, Tunnel
from thrust_allocator.physics.models.propeller import ANGLE_LAWS
from thrust_allocator.solve.problem import AllocationProblem

BOLLARD = st.tuples(st.floats(-500.0, -1.0), st.floats(1.0, 500.0))
FLOWS = st.tuples(st.floats(-4.0, 4.0), st.floats(-4.0, 4.0), st.floats(-4.0, 4.0))
MODELS = st.one_of(
    st.builds(Constant, bollard_thrust=BOLLARD),
    st.builds(Tunnel, bollard_thrust=BOLLARD, decay=st.floats(0.0, 10.0),
              jet_mass=st.floats(0.1, 200.0)),
    st.builds(propeller, bollard_thrust=BOLLARD,
              speed_loss=st.tuples(st.floats(0.0, 100.0), st.floats(0.0, 100.0)),
              opposed_loss=st.tuples(st.floats(0.0, 50.0), st.floats(0.0, 50.0)),
              opposed_floor=st.floats(0.0, 1.0), angle_law=st.sampled_from(ANGLE_LAWS),
              speed_loss_quadratic=st.tuples(st.floats(0.0, 30.0), st.floats(0.0, 30.0))))
SIDES = st.sampled_from([0, 1])
TUNNEL = Tunnel((-122.0, 122.1), 7.0, 72.5)


@given(MODELS, SIDES, FLOWS, st.floats(1e-9, 1.0))
def test_inverse(model, side, flow, share):
    """The equivalent thrust gives the wanted one back in the flow, and is within Bollard thrust."""
    thrust = share * model.limits(*flow)[side]
    assume(thrust != 0.0)
    e = model.bollard_equivalent(thrust, *flow)
    assert type(e) is float and math.copysign(1.0, e) == math.copysign(1.0, thrust)
    assert abs(thrust) * (1.0 - 1e-9) <= abs(e) <= abs(model.bollard_thrust[side])
    assert model.thrust_in_flow(e, *flow) == pytest.approx(thrust, rel=1e-9, abs=1e-9)
    assert model.bollard_fraction(thrust, *flow) == e / abs(model.bollard_thrust[side])


@given(MODELS, SIDES, FLOWS, st.floats(1e-6, 1.0), st.floats(1e-6, 1.0))
def test_monotone(model, side, flow, one, other):
    """More thrust in the flow needs more at rest, and more at rest never gives less."""
    less, more = sorted((one, other))
    limit = model.limits(*flow)[side]
    assume(limit != 0.0 and more - less > 1e-6)
    told = [abs(model.bollard_equivalent(share * limit, *flow)) for share in (less, more)]
    assert told[0] <= told[1]
    got = [abs(model.thrust_in_flow(share * model.bollard_thrust[side], *flow))
           for share in (less, more)]
    assert got[0] <= got[1] <= abs(limit) * (1.0 + 1e-12)


@given(MODELS, SIDES, FLOWS)
def test_at_the_limit(model, side, flow):
    """At the limit in the flow the equivalent is Bollard thrust, and the other way round."""
    limit, full = model.limits(*flow)[side], model.bollard_thrust[side]
    assume(abs(limit) > 1e-9)
    assert model.bollard_equivalent(limit, *flow) == pytest.approx(full, rel=1e-9)
    assert model.thrust_in_flow(full, *flow) == pytest.approx(limit, rel=1e-9)


@given(MODELS, FLOWS)
def test_nothing_for_nothing(model, flow):
    """Zero is zero both ways."""
    assert model.bollard_equivalent(0.0, *flow) == 0.0
    assert model.bollard_fraction(0.0, *flow) == 0.0
    assert model.thrust_in_flow(0.0, *flow) == 0.0


@pytest.mark.parametrize('across', [0.0, 5e-324, 1e-163, 1e-160, 1e-12, 0.5, 5.0, 50.0])
@pytest.mark.parametrize('thrust', [5e-324, 1e-300, 1e-9, 1.0, 122.1])
def test_extremes_of_a_tunnel(across, thrust):
    """A flow that has nearly died out, or hardly any thrust left: finite, and within bounds."""
    for sign, limit in zip((-1.0, 1.0), TUNNEL.limits(0.0, across)):
        wanted = sign * min(thrust, abs(limit))
        e = TUNNEL.bollard_equivalent(wanted, 0.0, across)
        assert abs(wanted) <= abs(e) <= 122.1
        assert TUNNEL.thrust_in_flow(e, 0.0, across) == pytest.approx(wanted, abs=1e-9)


def test_a_propeller_too_slow_to_push():
    """Told less than what the flow takes, a thruster delivers nothing, and never the opposite."""
    for model in (propeller(), replace(TUNNEL, bollard_thrust=(-68.2, 120.1))):
        for told in (1e-300, 1e-3, -1e-3):
            delivered = model.thrust_in_flow(told, 1.5, 0.5)
            assert delivered == pytest.approx(0.0, abs=1e-6) and delivered * told >= 0.0


def test_the_equations():
    """tau = e - dL sqrt(e / T0) of a propeller, tau = e exp(-c rho S v^2 / e) of a tunnel."""
    forward = propeller().limits(1.0, 0.0)[1]
    assert propeller().thrust_in_flow(40.0, 1.0, 0.0) == pytest.approx(
        40.0 - (120.1 - forward) * math.sqrt(40.0 / 120.1), abs=1e-12)
    assert TUNNEL.thrust_in_flow(-40.0, 9.0, 0.3, 0.4) == pytest.approx(
        -40.0 * math.exp(-7.0 * 72.5 * 0.25 / 40.0), abs=1e-12)
    assert Constant((-68.2, 120.1)).thrust_in_flow(40.0, 9.0, 9.0) == 40.0


def test_newtons_given_to_a_bollard_curve():
    """A driver calibrated at rest that is given the thrusts themselves delivers 36 of 50 N*m."""
    vehicle, (wrench, velocity) = mt2012(), paper_test(0.9)
    bounds = ThrustBounds(vehicle)
    thrusts = AllocationProblem(vehicle).solve(wrench, bounds(velocity)).thrusts
    delivered = np.array([
        one.model.thrust_in_flow(thrust, *flow)
        for thrust, one, flow in zip(thrusts, vehicle.thrusters, bounds.flow(velocity))])
    assert (vehicle.configuration_matrix @ delivered)[PITCH] == pytest.approx(36.0, abs=0.5)
