"""A vehicle with fins on the running node: what goes out for them, and what may be changed."""

import math

from builtin_interfaces.msg import Time
import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
from sensor_msgs.msg import JointState
from support.live_parameters import change
from support.paths import CONFIG
from support.stepped_peer import inside_limits, is_stopped
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.ros.markers import LONGEST, thruster_markers

FILE = CONFIG / 'delphin2_fins.yaml'
FINS = slice(5, 9)
TOP = 'thrusters.fin_top.'
COMMAND = np.array([2.0, 0.0, 0.0, 0.0, 5.0, 4.0])  # frd axes
TWIST = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
PER_RADIAN = 9.285  # of a fin at 1 m/s, half of what the vehicle's software gives a pair [N/rad]


def told(stepped, unit):
    """Return the setpoints of a tick in a unit, those of the fins."""
    return stepped(f'setpoint_unit:={unit}', file=FILE).step(
        COMMAND, TWIST)['thruster_setpoints'][FINS]


def test_what_a_servo_is_told(stepped):
    """Newtons of lift; radians for bollard_newton, shares of 30 degrees for bollard_fraction."""
    one = stepped(file=FILE)
    states = []
    one.create_subscription(JointState, 'thruster_states', states.append, 10)
    publisher = next(end for end in one.node.publishers if end.topic_name == '/thruster_states')
    one.wait_until(publisher.get_subscription_count, 'a match on thruster_states')
    tick = one.step(COMMAND, TWIST)
    one.wait_until(lambda: states, 'a state')
    lift, deflection = tick['thruster_setpoints'][FINS], np.array(states[-1].position)
    assert np.abs(lift).min() > 0.5
    assert_allclose(deflection[FINS], lift / PER_RADIAN, rtol=1e-6)
    assert_array_equal(deflection[:5], 0.0)
    assert_array_equal(states[-1].effort, tick['thruster_setpoints'])
    assert_allclose(told(stepped, 'bollard_newton'), deflection[FINS], rtol=1e-9)
    assert_allclose(told(stepped, 'bollard_fraction'), deflection[FINS] / 0.5236, rtol=1e-9)
    assert_allclose(tick['achieved_wrench'],
                    one.node.vehicle.configuration_matrix @ tick['thruster_setpoints'], atol=1e-9)
    assert abs(tick['unallocated_wrench'][[4, 5]]).max() < 0.01


def test_rates_are_of_the_deflection(stepped):
    """rad/s, from where the fin stands: a change of speed alone does not turn it."""
    one = stepped(file=FILE)
    assert change(one, {TOP + 'max_rate': math.radians(30.0)}) == [(True, '')]
    one.step(np.zeros(6), TWIST)
    step = math.radians(30.0) / 50.0
    for n in range(1, 4):
        lift = one.step(COMMAND, TWIST)['thruster_setpoints'][5]
        assert_allclose(abs(lift), n * step * PER_RADIAN, rtol=1e-6)
    faster = one.step(COMMAND, 1.2 * TWIST)
    lower, upper = faster['thrust_limits'].reshape(2, 9)[:, 5]
    assert_allclose((upper + lower) / 2.0, np.sign(lift) * 3 * step * PER_RADIAN * 1.44, rtol=1e-6)
    assert_allclose(upper - lower, 2.0 * step * PER_RADIAN * 1.44, rtol=1e-6)
    one.enable(False)
    assert is_stopped(one.step())  # at once, whatever the rate
    one.enable(True)
    assert_allclose(abs(one.step(COMMAND, TWIST)['thruster_setpoints'][5]), step * PER_RADIAN,
                    rtol=1e-6)


def test_live(stepped):
    """A fin's coefficients are in force on the next tick; its chord, and what it lacks, are not."""
    one = stepped(file=FILE)
    limits = one.step(COMMAND, TWIST)['thrust_limits'].reshape(2, 9)[1]
    assert_allclose(limits[FINS], PER_RADIAN * 0.5236, rtol=1e-4)
    for changes, factor in (({'fin_area': 0.00619 / 2}, 0.5), ({'lift_slope': 6.0}, 1.0),
                            ({'max_deflection': 0.1309}, 0.25), ({'cut_in_speed': 4.0 / 3}, 0.125)):
        assert change(one, {TOP + name: value for name, value in changes.items()}) == [(True, '')]
        tick = one.step()
        assert inside_limits(tick)
        after = tick['thrust_limits'].reshape(2, 9)[1]
        assert_allclose(after[5], factor * limits[5], rtol=1e-9)
        assert_array_equal(np.delete(after, 5), np.delete(limits, 5))
    for name, value, why in (('chord', [0.0, 0.0, 1.0], 'read-only'),
                             ('bollard_thrust', [-1.0, 1.0], 'undeclared')):
        (successful, reason), = change(one, {TOP + name: value})
        assert not successful and why in reason
    assert change(one, {TOP + 'enabled': False}) == [(True, '')]
    tick = one.step()
    assert tick['thruster_setpoints'][5] == 0.0 and not tick['thrust_limits'][[5, 14]].any()


def test_markers_of_fins_alone():
    """With nothing that has Bollard thrust, arrows are scaled by the lift at 1 m/s."""
    fins = load_vehicle(FILE).thrusters[FINS]
    lift = np.array([2.0, -2.0, 1.0, 0.0])
    message = thruster_markers(fins, lift, np.tile([[-3.0], [3.0]], 4), np.ones(3), 'hull', Time())
    arrows = [marker for marker in message.markers if marker.ns == 'thrust']
    span = 0.34 * math.sqrt(2.0)
    for marker, one, thrust in zip(arrows, fins, lift):
        if thrust:
            tail, head = ([point.x, point.y, point.z] for point in marker.points)
            assert_allclose(np.subtract(head, tail), thrust * LONGEST * span / (
                PER_RADIAN * 0.5236) * np.array(one.direction), rtol=1e-4, atol=1e-12)
    assert not arrows[3].points
