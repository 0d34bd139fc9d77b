"""The battery in the tick, without ROS: what a voltage does to limits, and what is no voltage."""

from dataclasses import replace
import math

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from support.vehicles import described, mt2012
from thrust_allocator.inputs import Inputs
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.setpoints import SETPOINTS
from thrust_allocator.supply import Rating
from thrust_allocator.tick import Allocator, Settings

SECOND = 10**9  # [ns]
RATING = Rating(nominal_voltage=16.0, voltage_exponent=1.2)
SETTINGS = Settings(message_frame='frd', rating=RATING)
AHEAD = np.array([10000.0, 0.0, 0.0, 0.0, 0.0, 0.0])  # beyond all limits


def told(*voltages, seconds=1.0):
    """Return inputs that had these voltages, one after another, and when the last one came."""
    inputs = Inputs()
    for i, voltage in enumerate(voltages):
        inputs.accept_voltage(voltage, round(i * seconds * SECOND), RATING)
    return inputs, round((len(voltages) - 1) * seconds * SECOND)


def limits(inputs, now, settings=SETTINGS):
    """Return the limits of MT-2012 at rest."""
    return Allocator(mt2012(), settings).tick(inputs, now).limits


def test_from_16_to_12_volts():
    """The closed form all the way, (V / 16)^1.2 with V through 2 s, and after settling."""
    bollard = mt2012().bollard_thrust
    inputs, now = told(16.0, 12.0)
    assert_allclose(limits(inputs, now), bollard, atol=1e-9)
    allocator = Allocator(mt2012(), SETTINGS)
    for seconds in (0.02, 0.5, 2.0, 7.0, 60.0):
        voltage = 12.0 + 4.0 * math.exp(-seconds / 2.0)
        found = allocator.tick(inputs, now + round(seconds * SECOND)).limits
        assert_allclose(found, bollard * (voltage / 16.0)**1.2, atol=1e-6)
    assert_allclose(found, bollard * 0.75**1.2, atol=1e-6)
    assert 1.0 - found[1, 0] / bollard[1, 0] == pytest.approx(0.29, abs=0.005)


def test_the_first_voltage_counts_at_once():
    """The filter starts there, and one of the nominal voltage changes nothing, to the bit."""
    assert_allclose(limits(*told(12.0)), mt2012().bollard_thrust * 0.75**1.2, atol=1e-9)
    assert_array_equal(limits(*told(16.0)), mt2012().bollard_thrust)


def test_a_battery_that_is_not_considered():
    """With a nominal voltage of 0 no voltage counts, and none is missing."""
    inputs, now = told(12.0)
    tick = Allocator(mt2012(), replace(SETTINGS, rating=Rating())).tick(inputs, now)
    assert_array_equal(tick.limits, mt2012().bollard_thrust)
    assert tick.supply == (1.0, '')


def test_silence():
    """None yet: nominal limits; after 10 s: those of the last one; both are said."""
    allocator = Allocator(mt2012(), SETTINGS)
    tick = allocator.tick(Inputs(), 0)
    assert tick.supply == (1.0, 'yet')
    inputs, now = told(12.0)
    assert allocator.tick(inputs, now + 10 * SECOND).supply.missing == ''
    tick = allocator.tick(inputs, now + 10 * SECOND + 1)
    assert tick.supply.missing == 'for 10.0 s'
    assert_allclose(tick.limits, mt2012().bollard_thrust * 0.75**1.2, atol=1e-9)
    inputs.forget()
    tick = allocator.tick(inputs, 0)
    assert tick.supply.missing == 'since the clock went back'
    assert_allclose(tick.limits, mt2012().bollard_thrust * 0.75**1.2, atol=1e-9)


@pytest.mark.parametrize('voltage, cause', [
    (0.0, 'battery outside 0 to 2 nominal_voltage'),
    (-12.0, 'battery outside 0 to 2 nominal_voltage'),
    (32.01, 'battery outside 0 to 2 nominal_voltage'), (math.nan, 'battery not finite'),
    (math.inf, 'battery not finite'), (-math.inf, 'battery not finite')])
def test_nonsense_is_dropped(voltage, cause):
    """It is counted by cause, changes nothing, and does not end a silence."""
    inputs, now = told(14.0)
    before = limits(inputs, now)
    inputs.accept_voltage(voltage, now + 11 * SECOND, RATING)
    assert_array_equal(limits(inputs, now), before)
    assert inputs.dropped == {cause: 1}
    assert inputs.supply(now + 11 * SECOND, RATING).missing == 'for 11.0 s'
    inputs.accept_voltage(32.0, now + 11 * SECOND, RATING)  # twice the nominal voltage
    assert inputs.supply(now + 11 * SECOND, RATING).missing == ''


def test_the_cut_off_and_the_fallback_follow_too():
    """Without odometry, and with a cut-off, limits are those of a smaller vehicle."""
    vehicle = mt2012(thrusters__tunnel__cutoff=0.3)
    settings = replace(SETTINGS, fallback_velocity=(0.3, 0.0, 0.0))
    low = Allocator(vehicle, settings).tick(*told(12.0)).limits
    share = 0.75**1.2
    tunnel, jet_mass = 122.1 * share, 1025.0 * 0.0707
    left = tunnel * math.exp(-7.0 * 0.09 * jet_mass / tunnel)
    assert low[1, 4] == pytest.approx((left - 0.3 * tunnel) / 0.7, abs=1e-9)


@pytest.mark.parametrize('unit', ['bollard_fraction', 'newton'])
@pytest.mark.parametrize('period', [0.05, 1.0])
def test_sag_does_not_swing(unit, period):
    """
    A pack of 0.05 ohm behind eight T200, full thrust at once: limits settle, once and for all.

    A T200 takes 389 W at 16 V and full throttle; power goes with thrust^1.5, at rest, and thrust
    at full throttle with V^1.2. Told newtons, a driver that goes by the curve at 16 V gives less
    throttle as the limits fall, and the voltage recovers: the loop that might swing.
    """
    vehicle = described('bluerov2_heavy')
    allocator, inputs = Allocator(vehicle, SETTINGS), Inputs()
    full = np.abs(vehicle.bollard_thrust)
    voltage, shares, forward = 16.0, [], []
    for i in range(30 * 50):
        now = round(i * SECOND / 50.0)
        if i % round(period * 50.0) == 0:
            inputs.accept_voltage(voltage, now, RATING)
        inputs.accept_wrench(AHEAD if i > 50 else np.zeros(6), now)
        tick = allocator.tick(inputs, now)
        thrusts = tick.thrusts.tolist()
        if unit == 'newton':
            throttles = np.abs(thrusts) / full[(tick.thrusts > 0.0).astype(int), np.arange(8)]
        else:
            throttles = np.abs(SETPOINTS[unit](thrusts, tick.models, tick.flow))
        # The voltage at which 16 V less the drop over 0.05 ohm is what draws that current
        for _ in range(50):
            watts = 389.0 * float((throttles**1.5).sum()) * (voltage / 16.0)**1.8
            voltage = 0.5 * (voltage + 16.0 - 0.05 * watts / voltage)
        shares.append(tick.supply.share)
        forward.append(tick.limits[1, 0])
    assert min(shares) < 0.9 and max(throttles) > 0.5  # it sags
    late = np.array(forward[-500:])
    assert np.ptp(late) < 0.01
    # No limit cycle: after the fall, at most one swing back of a tenth of it
    lowest = min(forward)
    assert late[-1] - lowest < 0.1 * (forward[0] - late[-1])


@pytest.mark.parametrize('keeping', [0.0, 1.0])
def test_no_effectiveness_is_off(keeping):
    """0 is `enabled: false` in all that a tick decides, to the bit."""
    rng = np.random.default_rng(3)
    given = read_parameter_file(default_parameter_file()) | {
        'direction_keeping': keeping, 'direction_keeping_dofs': ['surge', 'pitch', 'yaw']}
    gone = Allocator.of(describe(given | {'thrusters.left.effectiveness': 0.0}))
    off = Allocator.of(describe(given | {'thrusters.left.enabled': False}))
    for i in range(100):
        inputs = Inputs()
        inputs.accept_wrench(rng.normal(size=6) * 100.0, i)
        inputs.accept_velocity(rng.normal(size=6), i, 'odom')
        one, other = gone.tick(inputs, i), off.tick(inputs, i)
        for name in ('limits', 'thrusts', 'achieved', 'unallocated'):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
        assert gone.wrench_limits(one).tobytes() == off.wrench_limits(other).tobytes()
