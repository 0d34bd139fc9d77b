"""The input as people have it: stamped wrenches, and twists instead of odometry."""

from geometry_msgs.msg import TwistStamped, TwistWithCovarianceStamped, WrenchStamped
import numpy as np
from numpy.testing import assert_allclose
import pytest
from rclpy.qos import ReliabilityPolicy
from support.peer import Peer, ros_context, TYPES_IN
from support.stepped_peer import is_stopped, SECOND
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.ros.node import ThrustAllocator

WRENCH = np.array([60.0, 10.0, 20.0, 5.0, 30.0, -15.0])
TWIST = np.array([1.0, 0.3, -0.2, 0.05, 0.1, -0.1])
TENTH = SECOND // 10  # [ns]
TWISTS = {'twist': TwistStamped, 'twist_with_covariance': TwistWithCovarianceStamped}


@pytest.fixture
def stamped(stepped, monkeypatch):
    """Return a function that starts the node with a stepped peer that sends stamped wrenches."""
    monkeypatch.setitem(TYPES_IN, 'cmd_wrench', WrenchStamped)
    return lambda *rules: stepped('stamped_wrench:=true', *rules)


def send(one, stamp, wrench=WRENCH):
    """Send a wrench with a stamp [ns], 0 or a time on the node's clock, and see it arrive."""
    message = WrenchStamped()
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, SECOND)
    force, torque = message.wrench.force, message.wrench.torque
    force.x, force.y, force.z, torque.x, torque.y, torque.z = map(float, wrench)
    inputs = one.node._inputs
    before = inputs.wrench, inputs.dropped.total()
    one._inputs['cmd_wrench'].publish(message)
    one.wait_until(lambda: inputs.wrench is not before[0] or inputs.dropped.total() > before[1],
                   'the wrench')


def test_a_stamped_wrench_is_a_wrench(stepped, monkeypatch):
    """A fresh stamped wrench is answered as a plain one is."""
    expected = stepped().step(WRENCH, TWIST)
    monkeypatch.setitem(TYPES_IN, 'cmd_wrench', WrenchStamped)
    one = stepped('stamped_wrench:=true')
    one.step(twist=TWIST)
    send(one, one.time)
    tick = one.step()
    for topic, values in tick.items():
        assert_allclose(values, expected[topic], atol=1e-9, err_msg=topic)


@pytest.mark.parametrize('age, counts', [
    (SECOND // 2, True), (SECOND // 2 + 1, False), (-TENTH, True), (-TENTH - 1, False)])
def test_age_by_the_stamp(stamped, age, counts):
    """A wrench older than wrench_timeout, or more than 0.1 s ahead, is not answered."""
    one = stamped()
    one.step()
    send(one, one.time - age)
    assert is_stopped(one.step()) is not counts
    dropped = one.report()[2].get('dropped: cmd_wrench stamped in the future')
    assert dropped == (None if counts or age > 0 else '1')


@pytest.mark.parametrize('stamp', [0, -1, -2**31 * SECOND])
def test_odd_stamps(stamped, stamp):
    """A stamp of 0 means receipt, and one before the beginning of time is only very old."""
    one = stamped()
    one.step()
    send(one, stamp)
    assert is_stopped(one.step()) is (stamp != 0)


def test_the_larger_age_counts(stamped):
    """A wrench expires by the time since receipt, even if its stamp was fresh or a little ahead."""
    for ahead in (0, TENTH, -SECOND // 4):
        one = stamped('wrench_timeout:=0.5')
        one.step()
        send(one, one.time + ahead)
        for _ in range(25):  # of 20 ms each
            assert not is_stopped(one.step())
        assert is_stopped(one.step())


def test_the_age_in_the_diagnostics(stamped):
    """The reported age is the one that counts: by the stamp, where that is larger."""
    one = stamped()
    one.step()
    send(one, one.time - 3 * SECOND)
    one.step()
    assert one.report()[2]['age of wrench [s]'] == '3.0'


def test_a_wrench_from_the_future_refreshes_nothing(stamped):
    """What is dropped for its stamp leaves the last good wrench in force, until its time-out."""
    one = stamped()
    one.step()
    send(one, one.time)
    answer = one.step()['thruster_setpoints']
    for _ in range(24):
        send(one, one.time + SECOND, -WRENCH)
        assert_allclose(one.step()['thruster_setpoints'], answer, atol=1e-6)
    send(one, one.time + SECOND)
    assert is_stopped(one.steps(2)[-1])
    assert one.report()[2]['dropped: cmd_wrench stamped in the future'] == '25'


def test_a_broken_stamped_wrench(stamped):
    """It is dropped and counted as a plain one is."""
    one = stamped()
    one.step()
    send(one, one.time, np.full(6, np.nan))
    assert is_stopped(one.step())
    assert one.report()[2]['dropped: cmd_wrench not finite'] == '1'


class TwistPeer(Peer):
    """Sends its twist as the message that TYPES_IN says."""

    def send_twist(self, twist):
        """Send one twist, message axes."""
        message = TYPES_IN['twist']()
        body = message.twist.twist if hasattr(message.twist, 'covariance') else message.twist
        linear, angular = body.linear, body.angular
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z = map(float, twist)
        self._inputs['twist'].publish(message)


@pytest.fixture(params=TWISTS)
def twisted(request, start, monkeypatch):
    """Return a function that starts the node with a kind of twist, and a peer that sends it."""
    def start_node(*rules):
        with monkeypatch.context() as patch:
            patch.delitem(TYPES_IN, 'odom')
            patch.setitem(TYPES_IN, 'twist', TWISTS[request.param])
            started = start(f'velocity_type:={request.param}', *rules, kind=TwistPeer)
        monkeypatch.setitem(TYPES_IN, 'twist', TWISTS[request.param])
        return started
    return start_node


def test_a_twist_is_an_odometry(twisted, start):
    """Limits and setpoints are those for an odometry with the same velocity."""
    _, odometry = start()
    _, twist = twisted()
    expected, found = odometry.settle(WRENCH, TWIST), twist.settle(WRENCH, TWIST)
    assert np.abs(expected['thrust_limits'][:4] + 68.2).max() > 1.0
    for topic, values in found.items():
        assert_allclose(values, expected[topic], atol=1e-6, err_msg=topic)


def test_a_twist_that_is_broken_or_late(twisted):
    """It is dropped, counted, and does not keep fallback_velocity away."""
    node, peer = twisted('odometry_timeout:=0.05')
    still = peer.settle()['thrust_limits']
    moving = peer.settle(twist=TWIST)['thrust_limits']
    assert np.abs(moving - still).max() > 1.0
    peer.twist = np.full(6, np.nan)
    peer.wait_until(lambda: node._inputs.dropped['twist not finite'] > 3, 'broken twists')
    peer.wait_until(lambda: node.reporter.present('odometry'), 'the time-out')


def subscriptions(node):
    """Return the node's own subscriptions: (topic, message) of each, in order."""
    return sorted((end.topic_name, end.msg_type.__name__) for end in node.subscriptions
                  if end.topic_name not in ('/parameter_events', '/clock'))


@pytest.mark.parametrize('rules, expected', [
    ([], [('/cmd_wrench', 'Wrench'), ('/current', 'Vector3Stamped'), ('/odom', 'Odometry')]),
    (['stamped_wrench:=true'], [
        ('/cmd_wrench', 'WrenchStamped'), ('/current', 'Vector3Stamped'), ('/odom', 'Odometry')]),
    (['velocity_type:=twist'], [('/cmd_wrench', 'Wrench'), ('/twist', 'TwistStamped')]),
    (['velocity_type:=twist_with_covariance', 'stamped_wrench:=true'], [
        ('/cmd_wrench', 'WrenchStamped'), ('/twist', 'TwistWithCovarianceStamped')])])
def test_one_subscription_each(mt2012, rules, expected):
    """Each input has one subscription of the chosen type, best effort, and a twist no current."""
    words = [word for rule in rules for word in ('-p', rule)]
    with ros_context('--params-file', str(mt2012), *words) as context:
        node = ThrustAllocator(context=context)
        assert subscriptions(node) == expected
        assert {end.qos_profile.reliability for end in node.subscriptions
                if end.topic_name in dict(expected)} == {ReliabilityPolicy.BEST_EFFORT}
        node.destroy_node()


@pytest.mark.parametrize('velocity_type', TWISTS)
def test_a_twist_refuses_a_current(start, velocity_type):
    """A current_timeout together with a twist is refused at start, with the reason."""
    with pytest.raises(ParameterError, match='current_timeout: is given, .*no orientation'):
        start(f'velocity_type:={velocity_type}', 'current_timeout:=10.0')


@pytest.mark.parametrize('rule, allowed', [
    ('velocity_type:=pose', "velocity_type: is 'pose', must be one of odometry, twist"),
    ('stamped_wrench:=1', 'stamped_wrench: is 1, must be true or false'),
    ('setpoint_unit:=pwm', "setpoint_unit: is 'pwm', must be one of newton, bollard_newton"),
    ('publish_individual:=1.0', 'publish_individual: is 1.0, must be true or false'),
    ('marker_frame:=""', "marker_frame: is '', must be a word")])
def test_other_words_are_refused(start, rule, allowed):
    """A type or unit that does not exist is refused at start with those that do."""
    with pytest.raises(ParameterError, match=allowed):
        start(rule)
