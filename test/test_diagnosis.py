"""What a pilot is told, without ROS: findings as they come and go, and the figures of a second."""

from dataclasses import replace

import numpy as np
import pytest
from support.vehicles import mt2012
from thrust_allocator.diagnosis import allocation_figures, Findings, Level, shortfall, Tally
from thrust_allocator.inputs import age_in_seconds, Inputs
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.solve.problem import Allocation, AllocationProblem
from thrust_allocator.tick import Allocator, Settings, Tick

VEHICLE = mt2012()
SECOND = 10**9  # [ns]
UNITS = dict(zip(DOFS, ('N', 'N', 'N', 'N*m', 'N*m', 'N*m')))


class Log:
    """A logger that keeps what it is given."""

    def __init__(self):
        self.lines = []

    def __getattr__(self, level):
        return lambda text: self.lines.append((level, text))


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


def test_findings_are_logged_once_each_way():
    """A finding is logged when it appears and when it is over, by its level; the worst leads."""
    log = Log()
    findings = Findings(log)
    assert findings.overall() == (Level.OK, 'allocating')
    for text in ('late', 'later', 'latest'):
        findings.note('time', text)
    findings.note('solver', 'broken', Level.ERROR)
    assert findings.overall() == (Level.ERROR, 'broken; latest')
    for _ in range(3):
        findings.note('time', '')
    assert findings.overall() == (Level.ERROR, 'broken')
    findings.note('time', 'late again')
    assert log.lines == [('warning', 'late'), ('error', 'broken'), ('info', 'no longer: latest'),
                         ('warning', 'late again')]


@pytest.mark.parametrize('changes, level, word', [
    ({}, Level.OK, 'allocating'), ({'wrench': None}, Level.WARN, 'no wrench'),
    ({'enabled': False}, Level.WARN, 'disabled'),
    ({'allocation': allocation(status='unsolved')}, Level.ERROR, 'unsolved')])
def test_what_a_tick_finds(changes, level, word):
    """A stop is a warning, a solver that does not vouch an error; both are over with the cause."""
    findings = Findings(Log())
    findings.note_tick(tick(**changes))
    assert findings.overall()[0] == level and word in findings.overall()[1]
    findings.note_tick(tick())
    assert findings.overall() == (Level.OK, 'allocating')


@pytest.mark.parametrize('motion, word', [
    ({'missing': 'yet', 'twist': None}, 'no odometry yet'),
    ({'missing': 'for 3.5 s'}, 'no odometry for 3.5 s'),
    ({'current_ignored': 'too bad'}, 'current ignored: too bad')])
def test_what_is_missing_of_the_motion(motion, word):
    """Lost odometry and an ignored current are warnings that say why."""
    findings = Findings(Log())
    plain = tick()
    findings.note_tick(replace(plain, motion=plain.motion._replace(**motion)))
    assert findings.overall()[0] == Level.WARN and word in findings.overall()[1]


@pytest.mark.parametrize('dof', DOFS)
def test_each_dof_is_named_in_its_unit(dof):
    """What is missed is told of each DOF that is controlled, and what is not controlled as such."""
    i = DOFS.index(dof)
    controlled = replace(VEHICLE, wrench_weights=(1e4,) * 6)
    text = shortfall(allocation(100.0 * np.eye(6)[i], at_bound=(0, 0, 0, 0, 1)), controlled)
    assert f'{dof} 100.0 {UNITS[dof]}' in text and 'tunnel' in text
    assert [name for name in DOFS if name in text] == [dof]
    free = replace(VEHICLE, wrench_weights=tuple(1e4 * (name != dof) for name in DOFS))
    text = shortfall(allocation(100.0 * np.eye(6)[i]), free)
    assert f'{dof} is commanded but not controlled' in text
    assert [name for name in DOFS if f'{name} is' in text] == [dof]


def test_nothing_is_said_of_a_command_that_is_met():
    """However large it is."""
    assert shortfall(allocation(achieved=(1e5, 0, 300, 0, 50, 20)), VEHICLE) == ''


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
    """Means and worst of iterations and times, and the newest failure though it is over."""
    tally = Tally()
    for iterations, status in ((1, 'solved'), (4, 'unsolved'), (1, 'solved')):
        tally.count(tick(allocation=allocation(status=status, iterations=iterations)), 0.002)
    tally.count(tick(None), 0.004)
    figures = tally.figures()
    assert (figures['iterations, mean'], figures['iterations, worst']) == ('2.00', '4')
    assert (figures['tick time, mean [ms]'], figures['tick time, worst [ms]']) == ('2.500', '4.000')
    assert (figures['ticks'], figures['ticks late']) == ('4', '0')
    assert 'unsolved' in tally.trouble and tally.newest.solved
    assert set(Tally().figures()) == set(figures)


def test_ages():
    """Seconds since the last message, 'none' before the first and after the clock went back."""
    inputs = Inputs()
    assert age_in_seconds(inputs.velocity, 0) == 'none'
    inputs.accept_velocity(np.zeros(6), SECOND, 'odom')
    assert age_in_seconds(inputs.velocity, 3 * SECOND + SECOND // 2) == '2.5'
    inputs.forget()
    assert age_in_seconds(inputs.velocity, 0) == 'none'


def test_a_real_shortfall():
    """Far out of reach all thrusters concerned are named, and what surge lacks."""
    found = AllocationProblem(VEHICLE).solve(
        np.array([3000.0, 0.0, 0.0, 0.0, 0.0, 0.0]), VEHICLE.bollard_thrust)
    text = shortfall(found, VEHICLE)
    assert text.startswith('down, left, up, right at the limit; surge 2556.2 N')
