"""The power that thrusts are predicted to take."""

from dataclasses import replace

import numpy as np
import pytest
from support.vehicles import mt2012, propeller, thruster
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant
from thrust_allocator.physics.power import FULLY_COUNTED, PredictedPower

STILL = (0.0, 0.0, 0.0)
AHEAD = (1.0, 0.0, 0.0)  # [m/s]


def power(one, thrust, flow=STILL):
    """Return the power of a single thruster [W]."""
    return PredictedPower((one,)).in_flow([flow], (one.model,))(np.array([thrust]))


def test_at_rest_it_goes_with_thrust_to_the_one_and_a_half():
    """In either sense from the power at its own Bollard limit."""
    one = replace(thruster(model=Constant((-50.0, 100.0))), bollard_power=(200.0, 300.0))
    assert power(one, 100.0) == pytest.approx(300.0)
    assert power(one, -50.0) == pytest.approx(200.0)
    assert power(one, 25.0) == pytest.approx(300.0 * 0.125)
    assert power(one, -12.5) == pytest.approx(200.0 * 0.125)
    assert power(one, 0.0) == 0.0


def test_in_a_flow_the_limit_takes_all_the_power():
    """And less thrust takes what the propeller's speed, not the thrust, is worth."""
    one = replace(thruster(model=propeller()), bollard_power=(200.0, 300.0))
    lower, upper = one.model.limits(*AHEAD)
    assert power(one, upper, AHEAD) == pytest.approx(300.0)
    assert power(one, lower, AHEAD) == pytest.approx(200.0)
    equivalent = one.model.bollard_equivalent(0.5 * upper, *AHEAD)
    assert power(one, 0.5 * upper, AHEAD) == pytest.approx(300.0 * (equivalent / 120.1)**1.5)
    assert power(one, 0.5 * upper, AHEAD) > power(one, 0.5 * upper)


def test_no_step_at_zero_thrust():
    """A propeller in a flow must turn to push at all, but what it takes grows from 0."""
    one = replace(thruster(model=propeller()), bollard_power=(200.0, 300.0))
    small = FULLY_COUNTED * 120.1
    whole = power(one, small, AHEAD)
    assert whole > 1.0
    assert power(one, 1e-6 * small, AHEAD) < 1e-5 * whole
    assert power(one, 0.5 * small, AHEAD) == pytest.approx(0.5 * whole, rel=0.1)


def test_of_a_vehicle_it_adds_up_and_nobody_else_counts():
    """Thrusters of no known power take none, and a vehicle without any says so."""
    vehicle = mt2012(thrusters__up__bollard_power=[100.0, 200.0],
                     thrusters__tunnel__bollard_power=[300.0, 300.0])
    bounds, predicted = ThrustBounds(vehicle), PredictedPower(vehicle.thrusters)
    still = bounds.flow(np.zeros(6))
    assert predicted.known and not PredictedPower(mt2012().thrusters).known
    assert predicted.in_flow(still, bounds.models)(vehicle.bollard_thrust[1]) \
        == pytest.approx(500.0)
