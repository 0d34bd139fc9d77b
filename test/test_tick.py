"""What a tick decides, without ROS: which command counts, which limits, how far a thrust moves."""

from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from support.optimum import daqp_optimum
from support.vehicles import mt2012
from thrust_allocator.inputs import Inputs, Timeouts
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.tick import Allocator, Settings, Tick

WRENCH = np.array([120.0, 0.0, 10.0, 0.0, 25.0, -15.0])  # frd axes, within reach
FAR = np.array([3000.0, 0.0, 500.0, 0.0, 300.0, 200.0])  # out of reach
TWIST = np.array([0.3, 0.1, -0.1, 0.02, 0.05, -0.02])
FLU = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
SECOND = 10**9  # [ns]
PERIOD = SECOND // 50  # of the default rate [ns]
TIMEOUTS = Timeouts(wrench=SECOND // 5, velocity=SECOND // 2, current=2 * SECOND)
SETTINGS = Settings(message_frame='frd', fallback_velocity=(0.0, -0.6, 0.0), timeouts=TIMEOUTS)
FALLBACK = np.array([0.0, -0.6, 0.0, 0.0, 0.0, 0.0])  # tighter for the tunnel alone
VEHICLE = mt2012()
bounds = ThrustBounds(VEHICLE)


def inputs(wrench=None, twist=None, now: int = 0) -> Inputs:
    """Return what was received at a time; None: nothing."""
    found = Inputs()
    if wrench is not None:
        found.accept_wrench(wrench, now)
    if twist is not None:
        found.accept_velocity(twist, now, 'odom', 'odom', np.array([0.0, 0.0, 0.0, 1.0]))
    return found


def assert_stopped(tick: Tick) -> None:
    """Check for exact zeros, and that no solver was asked."""
    assert not tick.thrusts.any() and not tick.achieved.any() and tick.allocation is None


def test_a_live_wrench_is_allocated():
    """Limits at the velocity, an independent solver's optimum inside them, and all adds up."""
    for wrench in (WRENCH, -WRENCH, FAR):
        tick = Allocator(VEHICLE, SETTINGS).tick(inputs(wrench, TWIST), 0)
        assert_array_equal(tick.limits, bounds(TWIST))
        assert_allclose(tick.thrusts, daqp_optimum(VEHICLE, wrench, bounds(TWIST)), atol=1e-4)
        assert (tick.limits[0] <= tick.thrusts).all() and (tick.thrusts <= tick.limits[1]).all()
        assert_allclose(tick.achieved, VEHICLE.configuration_matrix @ tick.thrusts, atol=1e-9)
        assert_allclose(tick.achieved + tick.unallocated, wrench, atol=1e-9)
        assert tick.flow == bounds.flow(TWIST) and tick.enabled and tick.allocation.solved


def test_the_frame_of_messages_changes_nothing_else():
    """In flu axes the same vehicle does the same: thrusts to the bit, wrenches turned."""
    frd = Allocator(VEHICLE, SETTINGS).tick(inputs(FAR, TWIST), 0)
    flu = Allocator(VEHICLE, replace(SETTINGS, message_frame='flu')).tick(
        inputs(FLU * FAR, FLU * TWIST), 0)
    assert_array_equal(flu.thrusts, frd.thrusts)
    assert_array_equal(flu.limits, frd.limits)
    assert_array_equal(flu.achieved, FLU * frd.achieved)
    assert_array_equal(flu.unallocated, FLU * frd.unallocated)
    assert np.abs(frd.unallocated[[0, 2, 4, 5]]).min() > 1.0


def test_the_fallback_velocity_is_in_the_axes_of_messages():
    """Before the first velocity the limits are those at fallback_velocity, in either frame."""
    for frame, signs in (('frd', np.ones(6)), ('flu', FLU)):
        settings = replace(SETTINGS, message_frame=frame, fallback_velocity=(0.8, 0.2, -0.1))
        tick = Allocator(VEHICLE, settings).tick(inputs(WRENCH), 0)
        velocity = signs * [0.8, 0.2, -0.1, 0.0, 0.0, 0.0]
        assert_array_equal(tick.limits, bounds(velocity))
        assert tick.flow == bounds.flow(velocity) and tick.motion.twist is None


def test_without_a_wrench_the_vehicle_is_stopped():
    """Exact zeros, nothing unallocated, and the limits go with the speed all the same."""
    tick = Allocator(VEHICLE, SETTINGS).tick(inputs(twist=TWIST), 0)
    assert_stopped(tick)
    assert tick.wrench is None and not tick.unallocated.any()
    assert_array_equal(tick.limits, bounds(TWIST))


@pytest.mark.parametrize('age, live', [
    (0, True), (TIMEOUTS.wrench, True), (TIMEOUTS.wrench + 1, False), (3600 * SECOND, False)])
def test_a_wrench_counts_until_its_time_out(age, live):
    """The time-out itself included; a nanosecond later all is as if no wrench had come."""
    allocator, received = Allocator(VEHICLE, SETTINGS), inputs(WRENCH, TWIST)
    tick = allocator.tick(received, age)
    assert (tick.allocation is not None) == live
    if live:
        assert_allclose(tick.achieved + tick.unallocated, WRENCH, atol=1e-9)
    else:
        assert_stopped(tick)
        assert not tick.unallocated.any()


@pytest.mark.parametrize('age, expected', [
    (0, bounds(TWIST)), (TIMEOUTS.velocity, bounds(TWIST)),
    (100 * TIMEOUTS.velocity, np.array([
        np.maximum(bounds(TWIST)[0], bounds(FALLBACK)[0]),
        np.minimum(bounds(TWIST)[1], bounds(FALLBACK)[1])]))])
def test_a_velocity_counts_until_its_time_out(age, expected):
    """The time-out included; long after it, of each limit the tighter one, though the flow last."""
    assert (bounds(TWIST) != expected).any() == (age > TIMEOUTS.velocity)
    assert (bounds(FALLBACK) != expected).any()
    received = inputs(twist=TWIST)
    received.accept_wrench(FAR, age)
    tick = Allocator(VEHICLE, SETTINGS).tick(received, age)
    assert_array_equal(tick.limits, expected)
    assert tick.flow == bounds.flow(TWIST)


def test_a_velocity_is_never_stale_if_none_is_expected():
    """With a time-out of 0 an old velocity is tightened still, but none is said to be missing."""
    settings = replace(SETTINGS, timeouts=TIMEOUTS._replace(velocity=0))
    motion = Allocator(VEHICLE, settings).tick(inputs(WRENCH, TWIST), 100 * SECOND).motion
    assert motion.missing == ''


def test_disabled():
    """Exact zeros, and the whole of a live wrench unallocated."""
    tick = Allocator(VEHICLE, SETTINGS).tick(inputs(WRENCH, TWIST), 0, enabled=False)
    assert_stopped(tick)
    assert_array_equal(tick.unallocated, WRENCH)
    assert_array_equal(tick.limits, bounds(TWIST))
    assert not tick.enabled
    silent = Allocator(VEHICLE, SETTINGS).tick(inputs(None, TWIST), 0, enabled=False)
    assert_stopped(silent)
    assert not silent.unallocated.any()


def test_the_rate_limit_goes_by_the_formula():
    """Tick for tick: within a step of the last thrust, and only the speed bound forces more."""
    rates = np.array([50.0, 400.0, 1e-3, 0.0, 100.0])  # [N/s]; 0: unlimited
    vehicle = replace(VEHICLE, thrusters=tuple(
        replace(one, max_rate=rate) for one, rate in zip(VEHICLE.thrusters, rates)))
    allocator = Allocator(vehicle, SETTINGS)
    step = np.where(rates > 0.0, rates / 50.0, np.inf)
    random, last, forced, limited = np.random.default_rng(4), np.zeros(5), 0, 0
    for i in range(300):
        if i % 20 == 0:
            wrench = random.uniform(-150.0, 150.0, 6)
        if i % 5 == 0:
            twist = random.uniform(-2.0, 2.0, 6)
        now = i * SECOND // 50
        tick = allocator.tick(inputs(wrench, twist, now), now)
        lower, upper = bounds(twist)
        assert_array_equal(tick.limits, [np.minimum(np.maximum(lower, last - step), upper),
                                         np.maximum(np.minimum(upper, last + step), lower)])
        assert_allclose(tick.thrusts, np.clip(tick.thrusts, *tick.limits), rtol=0.0, atol=0.0)
        change = np.abs(tick.thrusts - last)
        forced += (change > 1.001 * step).sum()
        limited += (np.abs(change - step) <= 1e-9).sum()
        last = tick.thrusts
    assert forced > 5 and limited > 50


@pytest.mark.parametrize('stop', [{'wrench': None}, {'enabled': False}], ids=['silent', 'disabled'])
def test_stopping_knows_no_rate_and_starting_ramps_from_zero(stop):
    """A stop is at once whatever max_rate; the start after it goes up step by step."""
    vehicle = replace(VEHICLE, thrusters=tuple(
        replace(one, max_rate=100.0) for one in VEHICLE.thrusters))
    allocator = Allocator(vehicle, SETTINGS)
    for i in range(40):
        tick = allocator.tick(inputs(WRENCH, now=i * PERIOD), i * PERIOD)
    assert np.abs(tick.thrusts).max() > 20.0
    now = 40 * PERIOD
    assert_stopped(allocator.tick(inputs(stop.get('wrench', WRENCH), now=now), now,
                                  stop.get('enabled', True)))
    times = [now + i * PERIOD for i in (1, 2, 3)]
    most = [np.abs(allocator.tick(inputs(WRENCH, now=now), now).thrusts).max() for now in times]
    assert_allclose(most, [2.0, 4.0, 6.0])


@pytest.mark.parametrize('gap, share', [
    (PERIOD, 1.0), (PERIOD // 4, 0.25), (2 * PERIOD, 2.0), (50 * PERIOD, 2.0), (-SECOND, 1.0)])
def test_a_rate_goes_by_the_true_time_since_the_last_tick(gap, share):
    """Two periods at most count; where the clock went back, one."""
    vehicle = replace(VEHICLE, thrusters=tuple(
        replace(one, max_rate=100.0) for one in VEHICLE.thrusters))
    allocator = Allocator(vehicle, SETTINGS)
    start = 10 * SECOND
    first = allocator.tick(inputs(FAR, now=start), start).thrusts
    second = allocator.tick(inputs(FAR, now=start + gap), start + gap).thrusts
    assert_allclose(np.abs(second - first).max(), share * 2.0)


def test_the_limits_fade_to_the_fallback_and_back():
    """From one time-out after the last velocity to two; back in the same time; never a step."""
    allocator, moving = Allocator(VEHICLE, SETTINGS), bounds(TWIST)
    tighter = np.array([np.maximum(moving[0], bounds(FALLBACK)[0]),
                        np.minimum(moving[1], bounds(FALLBACK)[1])])
    received, timeout, found = inputs(twist=TWIST), TIMEOUTS.velocity, []
    for now in range(0, 5 * timeout, PERIOD):
        if now >= 3 * timeout:
            received.accept_velocity(TWIST, now, 'odom')
        limits = allocator.tick(received, now).limits
        if now < 3 * timeout:
            expected = min(max(now / timeout - 1.0, 0.0), 1.0)
        else:
            expected = max(1.0 - (now - 3 * timeout + PERIOD) / timeout, 0.0)
        assert_allclose(limits, (1.0 - expected) * moving + expected * tighter, atol=1e-9)
        found.append(limits)
    steps = np.abs(np.diff(found, axis=0)).max(axis=(1, 2))
    assert steps.max() <= 1.001 * PERIOD / timeout * np.abs(moving - tighter).max()
    assert_array_equal(found[-1], moving)


def test_the_first_velocity_ever_counts_at_once():
    """Before it the fallback counts; from it on the limits are its own, without a fade."""
    allocator, received = Allocator(VEHICLE, SETTINGS), inputs(WRENCH)
    for now in range(0, SECOND, PERIOD):
        assert_array_equal(allocator.tick(received, now).limits, bounds(FALLBACK))
    received.accept_velocity(TWIST, SECOND, 'odom')
    assert_array_equal(allocator.tick(received, SECOND).limits, bounds(TWIST))


def test_a_filter_on_the_velocity():
    """After a step a share exp(-t / tau) is left to go; after a gap it begins anew."""
    settings = replace(SETTINGS, velocity_time_constant=0.1)
    allocator, received = Allocator(VEHICLE, settings), Inputs()
    allocator.tick(received, 0)
    received.accept_velocity(np.zeros(6), 0, 'odom')
    for i in range(1, 8):  # odometry of any rate, between ticks too
        received.accept_velocity(TWIST, i * SECOND // 70, 'odom')
    now = SECOND // 10
    assert_allclose(received.velocity.values, (1.0 - np.exp(-1.0)) * TWIST)
    assert_array_equal(allocator.tick(received, now).limits, bounds(received.velocity.values))
    received.accept_velocity(-TWIST, now + TIMEOUTS.velocity + 1, 'odom')
    assert_array_equal(received.velocity.values, -TWIST)


def test_a_change_of_parameters_goes_on_from_the_last_tick():
    """The allocator that follows another ramps from its setpoints, not from zero."""
    given = read_parameter_file(default_parameter_file()) | {
        f'thrusters.{one.name}.max_rate': 100.0 for one in VEHICLE.thrusters}
    description = describe(given)
    allocator = Allocator.of(description)
    for now in range(0, 5 * PERIOD, PERIOD):
        last = allocator.tick(inputs(WRENCH, now=now), now).thrusts
    changed = Allocator.of(description.changed({'thrusters.up.weight': 2.0}), allocator)
    following = changed.tick(inputs(WRENCH, now=5 * PERIOD), 5 * PERIOD).thrusts
    assert_allclose(np.abs(following - last).max(), 2.0)
    assert np.abs(following).max() > 10.0


def test_defaults_are_those_of_the_parameters():
    """An allocator without settings goes by what a parameter file need not say."""
    assert Settings() == Settings.from_values(
        describe(read_parameter_file(default_parameter_file())).parameters.values)


def test_a_thruster_that_is_off_does_nothing_and_the_others_take_over():
    """Its limits and its thrust are exactly 0, and the rest is the optimum without it."""
    vehicle = replace(VEHICLE, thrusters=tuple(
        replace(one, enabled=one.name != 'left') for one in VEHICLE.thrusters))
    tick = Allocator(vehicle, SETTINGS).tick(inputs(WRENCH, TWIST), 0)
    assert tick.limits[:, 1].tolist() == [0.0, 0.0] and tick.thrusts[1] == 0.0
    full = bounds(TWIST)
    assert_array_equal(np.delete(tick.limits, 1, axis=1), np.delete(full, 1, axis=1))
    full[:, 1] = [-1e-9, 1e-9]
    assert_allclose(tick.thrusts, daqp_optimum(vehicle, WRENCH, full), atol=1e-4)
