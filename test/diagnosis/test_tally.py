"""What a pilot is told, without ROS: findings as they come and go, and the figures of a second."""

from dataclasses import replace

import numpy as np
import pytest
from support.log import Log
from support.vehicles import mt2012
from thrust_allocator.diagnosis.findings import Findings, Level
from thrust_allocator.diagnosis.tally import allocation_figures, note_tick, Tally, thrusters_off
from thrust_allocator.inputs import age_in_seconds, Inputs
from thrust_allocator.solve.problem import Allocation
from thrust_allocator.tick import Allocator, Settings, Tick

VEHICLE = mt2012()
SECOND = 10**9  # [ns]


def allocation(unallocated=(0.0,) * 6, achieved=(0.0,) * 6, at_bound=(0,) * 5,
               status='solved', iterations=1) -> Allocation:
    """Return an allocation of MT-2012 that came to this."""
    return Allocation(np.zeros(5), np.zeros((2, 5)), np.array(achieved, dtype=float),
                      np.array(unallocated, dtype=float), np.array(at_bound), status, iterations)


def tick(wrench=(100.0, 0.0, 0.0, 0.0, 0.0, 0.0), enabled=True, **changes) -> Tick:
    """Return a tick of MT-2012 at rest, for a wrench or None."""
    inputs = Inputs()
    inputs.accept_velocity(np.zeros(6), 0, 'odom')
    if wrench is not None:
        inputs.accept_wrench(np.array(wrench), 0)
    return replace(Allocator(VEHICLE, Settings()).tick(inputs, 0, enabled), **changes)


@pytest.mark.parametrize('changes, level, word', [
    ({}, Level.OK, 'allocating'),
    ({'enabled': False}, Level.WARN, 'disabled'),
    ({'allocation': allocation(status='unsolved')}, Level.ERROR, 'unsolved')])
def test_what_a_tick_finds(changes, level, word):
    """A stop is a warning, a solver that does not vouch an error; both are over with the cause."""
    findings = Findings(Log())
    note_tick(findings, tick(**changes), 0)
    assert findings.overall(0)[0] == level and word in findings.overall(0)[1]
    note_tick(findings, tick(), 0)
    assert findings.overall(3 * SECOND) == (Level.OK, 'allocating')


@pytest.mark.parametrize('motion, word', [
    ({'missing': 'yet', 'twist': None}, 'no odometry yet'),
    ({'missing': 'for 3.5 s'}, 'no odometry for 3.5 s'),
    ({'current_ignored': 'too bad'}, 'current ignored: too bad')])
def test_what_is_missing_of_the_motion(motion, word):
    """Lost odometry and an ignored current are warnings that say why."""
    findings = Findings(Log())
    plain = tick()
    note_tick(findings, replace(plain, motion=plain.motion._replace(**motion)), 0)
    level, message = findings.overall(0)
    assert level == Level.WARN and word in message


def test_figures_of_an_allocation():
    """Force and moment are norms of three components each; thrusters are named."""
    vehicle = replace(VEHICLE, thrusters=tuple(
        replace(one, enabled=one.name != 'left') for one in VEHICLE.thrusters))
    figures = allocation_figures(
        allocation((3.0, 0.0, 4.0, 5.0, 0.0, 12.0), at_bound=(0, 1, -1, 0, 1)), vehicle)
    assert figures['unallocated force [N]'] == '5.00'
    assert figures['unallocated moment [N*m]'] == '13.00'
    assert figures['thrusters at a bound'] == 'up, tunnel' and figures['thrusters off'] == 'left'
    assert figures['solver status'] == 'solved'
    assert set(allocation_figures(None, vehicle)) == set(figures)


def test_a_tally_counts_what_the_ticks_came_to():
    """Means and worst of iterations and times, and what the newest allocation came to."""
    tally = Tally()
    for iterations, status in ((1, 'solved'), (4, 'unsolved'), (1, 'solved')):
        tally.count(tick(allocation=allocation(status=status, iterations=iterations)), 0.002)
    tally.count(tick(None), 0.004)
    figures = tally.figures(VEHICLE)
    assert (figures['iterations, mean'], figures['iterations, worst']) == ('2.00', '4')
    assert (figures['tick time, mean [ms]'], figures['tick time, worst [ms]']) == ('2.500', '4.000')
    assert (figures['ticks'], figures['ticks late']) == ('4', '0')
    assert figures['solver status'] == 'solved'
    assert set(Tally().figures(VEHICLE)) == set(figures)


def test_thrusters_off_are_named():
    """Those that are disabled, and nobody else."""
    assert thrusters_off(VEHICLE) == ''
    vehicle = replace(VEHICLE, thrusters=tuple(
        replace(one, enabled=one.name not in ('left', 'up')) for one in VEHICLE.thrusters))
    assert thrusters_off(vehicle) == 'left, up off: enabled is false'


def test_ages():
    """Seconds since the last message, 'none' before the first and after the clock went back."""
    inputs = Inputs()
    assert age_in_seconds(inputs.velocity, 0) == 'none'
    inputs.accept_velocity(np.zeros(6), SECOND, 'odom')
    assert age_in_seconds(inputs.velocity, 3 * SECOND + SECOND // 2) == '2.5'
    inputs.forget()
    assert age_in_seconds(inputs.velocity, 0) == 'none'
