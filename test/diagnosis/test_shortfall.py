"""What was asked for and not given, in words: which DOF, how much, how often, and why."""

from dataclasses import replace

import numpy as np
import pytest
from support.vehicles import described, mt2012, random_vehicle, thruster
from thrust_allocator.diagnosis.causes import Allocated
from thrust_allocator.diagnosis.shortfall import shortfall, Yardstick
from thrust_allocator.inputs import Inputs
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.models import Constant
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.tick import Allocator, Settings

BLUEROV = described('bluerov2_heavy')
FRD = Settings(message_frame='frd')
PERIOD = 20 * 10**6  # [ns]


def allocate(vehicle, wrenches, twist=(0.0,) * 6):
    """Return a second's ticks of a vehicle for a wrench each, frd axes; None: no wrench."""
    allocator, ticks = Allocator(vehicle, FRD), []
    for i, wrench in enumerate(wrenches):
        inputs = Inputs()
        inputs.accept_velocity(np.array(twist), i * PERIOD, 'odom')
        if wrench is not None:
            inputs.accept_wrench(np.array(wrench, dtype=float), i * PERIOD)
        ticks.append(allocator.tick(inputs, i * PERIOD))
    return ticks


def said(vehicle, wrenches, twist=(0.0,) * 6):
    """Return what is said of a second's ticks with these wrenches."""
    return words(vehicle, allocate(vehicle, wrenches, twist), Yardstick(vehicle).floor)


def words(vehicle, ticks, floor):
    """Return what is said of a second's ticks."""
    return shortfall([Allocated(tick.wrench, tick.unallocated, tick.allocation, tick.speed_limits)
                      for tick in ticks if tick.allocation is not None],
                     len(ticks), vehicle, floor)


def without(vehicle, *names):
    """Return the vehicle with some thrusters off."""
    return replace(vehicle, thrusters=tuple(
        replace(one, enabled=one.enabled and one.name not in names) for one in vehicle.thrusters))


def surge_only(limit=50.0, **changes):
    """Return a vehicle with a single thruster ahead."""
    return Vehicle((replace(thruster('stern', model=Constant((-limit, limit))), **changes),),
                   (1e4, 0.0, 0.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize('scale', [1e-3, 1.0, 1e4], ids=['0.05 N', '50 N', '5e5 N'])
def test_a_limit(scale):
    """A thruster at its limit is named, with what is missing, in a vehicle of any size."""
    vehicle = surge_only(50.0 * scale)
    vehicle = replace(vehicle, wrench_weights=(1e7,) + (0.0,) * 5)
    text = said(vehicle, [[90.0 * scale] + [0.0] * 5] * 50)
    assert 'surge is off by' in text and 'in 100% of the ticks: stern at its limit' in text
    assert said(vehicle, [[49.0 * scale] + [0.0] * 5] * 50) == ''


def test_most_of_a_second_counts_and_not_its_last_tick():
    """90 N asked of 50 in 80 % of the ticks, and none in those at the end."""
    wrenches = [[90.0] + [0.0] * 5] * 40 + [[20.0] + [0.0] * 5] * 10
    assert said(surge_only(), wrenches) == (
        'surge is off by 40 N (commanded 90 N) in 80% of the ticks: stern at its limit')
    assert said(surge_only(), wrenches[36:] + [[0.0] * 6] * 36) == ''  # a tenth is not too much


def test_what_is_missing_is_one_percent_of_the_command_and_of_the_authority():
    """Below either there is nothing to say."""
    assert said(surge_only(), [[50.4] + [0.0] * 5] * 50) == ''
    vehicle = replace(BLUEROV, wrench_weights=(1e4,) * 6)
    beyond = np.zeros(6)
    beyond[0] = 1.02 * 129.1  # all that it can give in surge is 129.1 N
    assert said(vehicle, [beyond] * 50).startswith('surge')
    beyond[0] = 1.005 * 129.1
    assert said(vehicle, [beyond] * 50) == ''


def test_a_thruster_that_is_off():
    """What it would have given is missing, and it is named."""
    text = said(without(BLUEROV, 'rear_left'), [[100.0, 0, 0, 0, 0, 0]] * 50)
    assert 'surge' in text and 'rear_left off' in text


def test_a_dof_that_nothing_can_serve():
    """MT-2012 has no roll; a vehicle that lost what served it says that too."""
    rolling = replace(mt2012(), wrench_weights=(1e4, 0.0, 1e2, 1e4, 1e4, 1e4))
    text = said(rolling, [[0.0, 0, 0, 20.0, 0, 0]] * 50)
    assert text == ('roll is off by 20 N*m (commanded 20 N*m) in 100% of the ticks: '
                    'no thruster can act on it')
    lost = without(surge_only(), 'stern')
    text = said(lost, [[20.0] + [0.0] * 5] * 50)
    assert 'no thruster can act on it while some are off, stern off' in text


def test_a_dof_that_is_tied_to_another():
    """MT-2012's sway comes with yaw: with weights on both neither is given, and both are named."""
    tied = replace(mt2012(), wrench_weights=(1e4, 1e4, 1e2, 0.0, 1e4, 1e4))
    text = said(tied, [[0.0, 50.0, 0, 0, 0, 0]] * 50)
    assert 'sway' in text and 'it comes only together with yaw' in text


def test_the_other_sign():
    """Equal weights and one thruster lost: yaw comes out against its command, said in that word."""
    vehicle = without(replace(mt2012(), wrench_weights=(1e4, 1e4, 1e4, 1e4, 1e4, 1e4)), 'left')
    wrench = np.array([0.0, 60.0, 0, 0, 0, 20.0])
    tick, = allocate(vehicle, [wrench])
    assert (tick.wrench * tick.achieved)[[1, 5]].min() < 0.0
    text = said(vehicle, [wrench] * 50)
    assert 'comes out with the other sign: ' in text


def test_a_rate():
    """A ramp is not called a limit."""
    vehicle = surge_only(max_rate=1.0)
    text = said(vehicle, [[30.0] + [0.0] * 5] * 50)
    assert text.endswith('in 100% of the ticks: stern held back by max_rate')


def test_a_low_weight():
    """Nothing at a limit: the weight is too low for the thrusters'; or it gives way to others."""
    weak = replace(surge_only(), wrench_weights=(1e-2,) + (0.0,) * 5)
    assert said(weak, [[30.0] + [0.0] * 5] * 50).endswith(
        'wrench_weights.surge is low against the weights of the thrusters')
    text = said(mt2012(), [[32.4, 0, 0, 0, 50.0, 0]] * 50, (0.9, 0, 0, 0, 0, 0))
    assert text == ('heave is off by 29.6 N (commanded 0 N) in 100% of the ticks: tunnel at its '
                    'limit, its low weight gives way to surge, pitch, yaw')


@pytest.mark.parametrize('cause, changes', [
    ('power_limit', {'power_scale': 0.5}),
    ('scaled to keep the direction', {'direction_scale': 0.5})])
def test_scales(cause, changes):
    """A command that was scaled down says for what."""
    tick = allocate(surge_only(), [[90.0] + [0.0] * 5])[0]
    one = Allocated(tick.wrench, tick.unallocated, tick.allocation._replace(**changes),
                    tick.speed_limits)
    assert cause in shortfall([one] * 50, 50, surge_only(), Yardstick(surge_only()).floor)


def test_a_command_without_weight():
    """A DOF of weight 0 that is commanded is named, by the same thresholds."""
    assert said(mt2012(), [[0.0, 30.0, 0, 0, 0, 0]] * 50) == (
        'sway is commanded but not controlled (wrench_weights.sway is 0)')
    assert said(mt2012(), [[0.0, 0.01, 0, 0, 0, 0]] * 50) == ''
    assert said(mt2012(), [[0.0, 30.0, 0, 0, 0, 0]] * 5 + [[0.0] * 6] * 45) == ''


def test_random_states():
    """
    Nothing more than 1 % of command and authority is missing without a word, nor a word too much.

    Vehicles from 0.1 N to 1e6 N, thrusters off, weights 0, wrenches of every size.
    """
    random, silent, told = np.random.default_rng(7), 0, 0
    for _ in range(200):
        vehicle = random_vehicle(random, int(random.integers(3, 8)))
        scale = 10.0**random.uniform(-3.0, 3.0)
        vehicle = replace(vehicle, thrusters=tuple(
            replace(one, enabled=random.random() < 0.9, weight=1.0, model=Constant(tuple(
                scale * limit for limit in one.bollard_thrust))) for one in vehicle.thrusters))
        floor, weights = Yardstick(vehicle).floor, np.array(vehicle.wrench_weights)
        wrench = 100.0 * floor * random.normal(size=6) * 10.0**random.uniform(-3.0, 1.0)
        wrench *= (random.random(6) < 0.7) & (np.abs(wrench) < 1e6)
        tick, = allocate(vehicle, [wrench])
        missing = np.abs(tick.unallocated) > np.maximum(0.01 * np.abs(wrench), floor)
        missing[weights == 0.0] = (np.abs(wrench) > floor)[weights == 0.0]
        text = words(vehicle, [tick] * 3, floor)
        assert [dof for dof, one in zip(DOFS, missing) if one] == [
            dof for dof in DOFS if any(part.startswith(dof) for part in text.split('; '))]
        silent, told = silent + (text == ''), told + (text != '')
    assert silent > 20 and told > 20
