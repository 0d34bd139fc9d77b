"""What goes out beside the arrays: names, units for motor drivers, topics per thruster."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from support.peer import cruise
from support.stepped_peer import is_stopped
from support.vehicles import NAMES

WRENCH, TWIST = cruise(0.9, side=1.0)
UNITS = ('newton', 'bollard_newton', 'bollard_fraction')


def listen(one, kind, topic):
    """Return the list that messages of a topic are put in, once the node knows of the listener."""
    heard = []
    one.create_subscription(kind, topic, heard.append, 10)
    one.wait_until(lambda: one.count_publishers(topic) and one.count_subscribers(topic),
                   f'{topic} on the graph')
    publisher = next(end for end in one.node.publishers if end.topic_name == f'/{topic}')
    one.wait_until(publisher.get_subscription_count, f'a match on {topic}')
    return heard


def answer(one, heard):
    """Step, and return the tick and the one message that it brought to each list."""
    for messages in heard:
        messages.clear()
    tick = one.step(WRENCH, TWIST)
    one.wait_until(lambda: all(heard), 'a message of each')
    assert [len(messages) for messages in heard] == [1] * len(heard)
    return tick, [messages[0] for messages in heard]


@pytest.mark.parametrize('unit', UNITS)
def test_thruster_states(stepped, unit):
    """A joint state names each thrust, in N in the flow whatever the unit of the setpoints."""
    plain = stepped().step(WRENCH, TWIST)['thruster_setpoints']
    one = stepped(f'setpoint_unit:={unit}')
    tick, (state,) = answer(one, [listen(one, JointState, 'thruster_states')])
    assert state.name == NAMES
    assert_allclose(state.effort, plain, atol=1e-9)
    assert list(state.position) == [0.0] * 5 and len(state.velocity) == 0
    assert state.header.stamp.sec * 10**9 + state.header.stamp.nanosec == one.time
    if unit == 'newton':
        assert_array_equal(state.effort, tick['thruster_setpoints'])


def told_to_newtons(one, told, unit):
    """Return the thrust in the flow that a driver with a Bollard curve delivers [N]."""
    vehicle = one.node.vehicle
    if unit == 'bollard_fraction':
        assert np.abs(told).max() <= 1.0
        told = [share * abs(thruster.bollard_thrust[int(share > 0.0)])
                for share, thruster in zip(told, vehicle.thrusters)]
    return np.array([
        thruster.model.thrust_in_flow(e, *flow)
        for e, thruster, flow in zip(told, vehicle.thrusters, one.bounds.flow(TWIST))])


@pytest.mark.parametrize('unit', UNITS[1:])
@pytest.mark.parametrize('factor', [1.0, -1.0, 20.0, -20.0])
def test_units_for_drivers_calibrated_at_rest(stepped, unit, factor):
    """Sent through a Bollard curve and the models, the setpoints give the thrust in the flow."""
    expected = stepped().step(factor * WRENCH, TWIST)
    one = stepped(f'setpoint_unit:={unit}')
    tick = one.step(factor * WRENCH, TWIST)
    assert_allclose(told_to_newtons(one, tick['thruster_setpoints'], unit),
                    expected['thruster_setpoints'], atol=1e-6)
    assert np.abs(tick['thruster_setpoints'] - expected['thruster_setpoints']).max() > 1.0
    for topic in ('thrust_limits', 'achieved_wrench', 'unallocated_wrench'):
        assert_allclose(tick[topic], expected[topic], atol=1e-9, err_msg=topic)


def test_shares_at_the_limit_and_stopped(stepped):
    """What is at its limit is told -1 or 1, what is off or stopped an exact 0."""
    one = stepped('setpoint_unit:=bollard_fraction')
    for side in (1.0, -1.0):
        tick = one.step([side * 1e5, 0.0, 0.0, 0.0, 0.0, 0.0], TWIST)
        assert_allclose(tick['thruster_setpoints'][:4], side, atol=1e-9)
    one.switch(up=False)
    assert one.step()['thruster_setpoints'][2] == 0.0
    one.enable(False)
    assert is_stopped(one.step())


def test_the_last_velocity_counts_while_odometry_is_stale(stepped):
    """Without odometry the flow is the last one known, and that of fallback_velocity before."""
    one = stepped('setpoint_unit:=bollard_newton', 'odometry_timeout:=0.03',
                  'wrench_timeout:=10.0', f'fallback_velocity:={TWIST[:3].tolist()}')
    without = one.step(WRENCH)['thruster_setpoints']
    known = one.step(WRENCH, TWIST)['thruster_setpoints']
    one.silence('twist')
    assert_allclose(one.steps(3)[-1]['thruster_setpoints'], known, atol=1e-6)
    assert_allclose(without, known, atol=1e-6)


@pytest.mark.parametrize('unit', UNITS)
def test_a_topic_per_thruster(stepped, unit):
    """Each thrust in N goes out on a topic of its own at every tick, zeros when stopped too."""
    one = stepped('publish_individual:=true', f'setpoint_unit:={unit}')
    heard = [listen(one, Float64, f'thrusters/{name}/thrust') for name in NAMES]
    tick, messages = answer(one, heard)
    thrusts = np.array([message.data for message in messages])
    assert_allclose(one.node.vehicle.configuration_matrix @ thrusts, tick['achieved_wrench'],
                    atol=1e-9)
    one.enable(False)
    assert [message.data for message in answer(one, heard)[1]] == [0.0] * 5


def test_topics_per_thruster_come_and_go(stepped):
    """They are off by default; switched on they are there, switched off they end with zeros."""
    one = stepped()
    one.step(WRENCH, TWIST)
    assert not [end for end in one.node.publishers if end.topic_name.startswith('/thrusters')]
    for _ in range(2):
        assert one.set_parameters_of_node([Parameter('publish_individual', value=True)])[
            0].successful
        heard = [listen(one, Float64, f'thrusters/{name}/thrust') for name in NAMES]
        assert any(message.data for message in answer(one, heard)[1])
        for messages in heard:
            messages.clear()
        one.set_parameters_of_node([Parameter('publish_individual', value=False)])
        one.wait_until(lambda: all(heard), 'zeros')
        one.steps(2)
        assert [[message.data for message in messages] for messages in heard] == [[0.0]] * 5


def test_a_live_change_sends_nothing_by_itself(stepped):
    """Whether on or off again, a change of something else brings no message of its own."""
    one = stepped('publish_individual:=true')
    heard = [listen(one, Float64, f'thrusters/{name}/thrust') for name in NAMES]
    for on, count in ((True, 1), (False, 0)):
        one.set_parameters_of_node([Parameter('publish_individual', value=on)])
        one.step(WRENCH, TWIST)
        one.wait_until(lambda: all(heard), 'a message of each')
        for messages in heard:
            messages.clear()
        one.set_parameters_of_node([Parameter('thrusters.up.weight', value=2.0 + on)])
        one.step()
        one.report()  # sent after all that came before
        assert [len(messages) for messages in heard] == [count] * 5
        assert all(message.data for messages in heard for message in messages)


@pytest.fixture
def stopping(start, monkeypatch):
    """Return a running node, and what it leaves behind: last values, and waits by topic."""
    node, peer = start('publish_individual:=true', 'message_frame:=frd')
    last, acknowledged = {}, {}
    for name in NAMES:
        peer.create_subscription(Float64, f'thrusters/{name}/thrust',
                                 lambda message, name=name: last.update({name: message.data}), 10)
    peer.settle(20.0 * WRENCH, TWIST)
    peer.wait_until(lambda: len(last) == 5 and all(last.values()), 'thrust on each topic')
    peer.on_tick = lambda: None
    wait = Publisher.wait_for_all_acked
    monkeypatch.setattr(Publisher, 'wait_for_all_acked', lambda self, timeout: (
        acknowledged.update({self.topic: timeout.nanoseconds}), wait(self, timeout))[1])
    return node, peer, last, acknowledged


SETPOINTS = {'thruster_setpoints', *(f'thrusters/{name}/thrust' for name in NAMES)}


def test_zeros_come_last_on_every_topic(stopping):
    """Stopping publishes zeros on the array, both wrenches and per thruster, and waits for each."""
    node, peer, last, acknowledged = stopping
    assert peer.ticks[-1]['unallocated_wrench'].any()
    known = len(peer.ticks)
    node.stop()
    peer.wait_until(lambda: not any(last.values()) and len(peer.ticks) > known, 'zeros')
    tick = peer.ticks[-1]
    assert is_stopped(tick) and not tick['unallocated_wrench'].any()
    assert set(acknowledged) >= SETPOINTS
    peer.send()
    node._ticker.tick()
    for _ in range(10):
        peer.spinner.spin_once(timeout_sec=0.01)
    assert len(peer.ticks) == known + 1, 'none may come after the last one'
    assert max(acknowledged.values()) <= 200_000_000, 'so long a subscriber that is stuck may take'


def test_zeros_come_last_though_ticks_fail(stopping, monkeypatch):
    """When no tick can be had any more, zeros go out on the array and per thruster all the same."""
    node, peer, last, acknowledged = stopping
    monkeypatch.setattr(node._allocator, 'tick', None)
    node.stop()
    peer.wait_until(lambda: not any(last.values()) and not peer.setpoints().any(), 'zeros')
    assert set(acknowledged) >= SETPOINTS


def test_no_joint_states_while_nobody_listens(stepped):
    """They are neither filled in nor sent without a subscriber."""
    one = stepped()
    one.steps(3, WRENCH, TWIST)
    assert len(one.node._outputs._states.effort) == 0


def test_no_wrench_carries_a_negative_zero(stepped):
    """What turning the axes makes of 0 goes out as 0.0, which reads as a stop ought to."""
    tick = stepped('message_frame:=flu').step(np.zeros(6))
    for topic in ('achieved_wrench', 'unallocated_wrench'):
        assert not tick[topic].any() and not np.signbit(tick[topic]).any()
