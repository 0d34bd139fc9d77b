"""What wear and the supply leave of a thruster: T_0' in every law, and what its driver is told."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
import numpy as np
import pytest
from support.vehicles import fin, limits_of, mt2012, propeller, thruster
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant, Tunnel
from thrust_allocator.physics.power import PredictedPower

BOLLARD = st.tuples(st.floats(-500.0, -1.0), st.floats(1.0, 500.0))
PAIR = st.tuples(st.floats(0.0, 60.0), st.floats(0.0, 60.0))
PUSHING = st.one_of(
    st.builds(Constant, bollard_thrust=BOLLARD),
    st.builds(Tunnel, bollard_thrust=BOLLARD, decay=st.floats(0.0, 7.0),
              jet_mass=st.floats(0.1, 100.0)),
    st.builds(propeller, bollard_thrust=BOLLARD, speed_loss=PAIR, opposed_loss=PAIR,
              speed_loss_quadratic=PAIR, angle_law=st.sampled_from(['paper', 'cosine'])))
FLOWS = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
SHARES = st.floats(0.01, 2.0)


def of_that_size(model, share):
    """Return a thruster of share times the Bollard thrust: C and C_a go with its revolutions."""
    changes = {'bollard_thrust': tuple(share * full for full in model.bollard_thrust)}
    if hasattr(model, 'speed_loss'):
        for name in ('speed_loss', 'opposed_loss'):
            changes[name] = tuple(math.sqrt(share) * loss for loss in getattr(model, name))
    return replace(model, **changes)


@given(PUSHING, FLOWS, SHARES, st.floats(0.01, 1.0), st.sampled_from([0, 1]))
def test_a_weaker_thruster_is_a_smaller_one(model, flow, share, part, side):
    """Its limits are those of one of that size, and its driver is told T_0 / T_0' times as much."""
    weaker, smaller = replace(model, strength=share), of_that_size(model, share)
    limits = weaker.limits(*flow)
    assert limits == pytest.approx(smaller.limits(*flow), rel=1e-9, abs=1e-9)
    thrust = part * limits[side]
    if abs(thrust) > 1e-6:
        told = weaker.bollard_equivalent(thrust, *flow)
        assert told == pytest.approx(smaller.bollard_equivalent(thrust, *flow) / share, rel=1e-6)
        assert weaker.thrust_in_flow(told, *flow) == pytest.approx(thrust, rel=1e-9, abs=1e-9)
        assert weaker.bollard_fraction(limits[side], *flow) == pytest.approx(
            [-1.0, 1.0][side], rel=1e-9)  # full throttle at any voltage


@given(PUSHING, FLOWS, SHARES, SHARES)
def test_wear_and_supply_multiply(model, flow, wear, supply):
    """At another voltage a worn thruster has the share of a share."""
    assert replace(model, strength=wear).at_supply(supply).limits(*flow) == \
        replace(model, strength=supply * wear).limits(*flow)


@given(st.floats(-3.0, 3.0), st.floats(0.01, 1.0), st.floats(0.1, 2.0))
def test_a_fin_has_no_battery(speed, left, supply):
    """Damage takes its share of the lift at every deflection, a low voltage takes nothing."""
    damaged = fin(strength=left)
    limits = damaged.limits(0.0, speed)
    assert limits == pytest.approx(np.array(fin().limits(0.0, speed)) * left, rel=1e-9)
    assert damaged.at_supply(supply) == damaged
    assert damaged.deflection(limits[1], 0.0, speed) == pytest.approx(
        fin().deflection(fin().limits(0.0, speed)[1], 0.0, speed), rel=1e-9)


@given(PUSHING, FLOWS, SHARES, st.floats(0.01, 0.9))
def test_the_cut_off_goes_by_what_is_left(model, flow, share, cutoff):
    """It is a share of T_0', so at rest the whole of that is there."""
    cut, plain = (thruster(model=replace(model, strength=share)) for _ in range(2))
    cut = replace(cut, cutoff=cutoff)
    at_rest = share * np.array(model.bollard_thrust)
    assert limits_of(cut, velocity=[0.0] * 6)[:, 0] == pytest.approx(at_rest, rel=1e-12)
    before = limits_of(plain, velocity=[*flow, 0.0, 0.0, 0.0])[:, 0]
    expected = np.maximum(0.0, np.abs(before) - cutoff * np.abs(at_rest)) / (1.0 - cutoff)
    assert np.abs(limits_of(cut, velocity=[*flow, 0.0, 0.0, 0.0])[:, 0]) == pytest.approx(
        expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize('model', [
    Constant((-1.0, 1.0)), Tunnel((-1.0, 1.0), 2.0, 3.0), propeller(), fin()],
    ids=lambda model: model.NAME)
def test_nothing_left(model):
    """With an effectiveness of 0 the limits are 0 to the bit, and so is what a driver is told."""
    gone = replace(model, strength=0.0)
    for flow in ((0.0, 0.0, 0.0), (1.0, 0.5, -0.2), (-1.0, -0.5, 0.0)):
        assert [math.copysign(1.0, limit) * (1.0 + limit) for limit in gone.limits(*flow)] == [1, 1]
        assert gone.bollard_equivalent(0.0, *flow) == gone.bollard_fraction(0.0, *flow) == 0.0
        assert gone.thrust_in_flow(0.3, *flow) == 0.0


def test_effectiveness_of_the_file():
    """`effectiveness: 0.7` is in the laws of that thruster and of no other."""
    velocity = np.array([0.8, 0.1, -0.1, 0.0, 0.05, 0.0])
    full, worn = (ThrustBounds(mt2012(thrusters__up__effectiveness=share))(velocity)
                  for share in (1.0, 0.7))
    smaller = of_that_size(mt2012().thrusters[2].model, 0.7)
    flow = ThrustBounds(mt2012()).flow(velocity)[2]
    assert worn[:, 2] == pytest.approx(smaller.limits(*flow), abs=1e-9)
    assert (np.delete(worn, 2, axis=1) == np.delete(full, 2, axis=1)).all()


def test_set_supply_and_back():
    """The bounds follow a voltage, and are what they were to the bit when it is nominal again."""
    vehicle, velocity = mt2012(), np.array([0.6, 0.0, 0.2, 0.0, 0.0, 0.0])
    bounds = ThrustBounds(vehicle)
    before = bounds(velocity)
    bounds.set_supply(0.5)
    lower = bounds(velocity)
    assert (np.abs(lower) < np.abs(before)).all()
    assert bounds(np.zeros(6)) == pytest.approx(0.5 * vehicle.bollard_thrust)
    bounds.set_supply(1.0)
    assert (bounds(velocity) == before).all()


def test_power_is_counted_without_the_battery():
    """At full throttle a worn thruster takes all of its power, a low voltage its share^1.5."""
    one = replace(thruster(model=propeller(strength=0.6)), bollard_power=(300.0, 400.0))
    flow = [(0.8, 0.1, 0.0)]
    for supply in (1.0, 0.7):
        model = one.model.at_supply(supply)
        power = PredictedPower([one]).in_flow(flow, [model], supply)
        for side, full in enumerate((300.0, 400.0)):
            assert power(np.array([model.limits(*flow[0])[side]])) == pytest.approx(
                full * supply**1.5, rel=1e-9)
