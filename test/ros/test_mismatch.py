"""Those who cannot be heard or cannot hear, why no wrench counts, and frames that are mistaken."""

from contextlib import ExitStack
import time

from geometry_msgs.msg import Wrench, WrenchStamped
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64, Float64MultiArray
from support.processes import context_among_processes, TIMEOUT
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.ros.node import ThrustAllocator

NAMESPACE = '/mismatch'
BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def meeting(mt2012):
    """Return a function: parameter rules -> a node, and a stranger in a Context of its own."""
    with ExitStack() as stack:
        def meet(*rules):
            arguments = [word for rule in rules for word in ('-p', rule)]
            contexts = [stack.enter_context(context_among_processes(*more)) for more in (
                ('--params-file', str(mt2012), '-r', f'__ns:={NAMESPACE}', *arguments), ())]
            node = ThrustAllocator(context=contexts[0])
            stack.callback(node.destroy_node)
            stranger = Node('stranger', context=contexts[1], namespace=NAMESPACE)
            stack.callback(stranger.destroy_node)
            return node, stranger

        yield meet


def reported(node, kind):
    """Have the node report until a kind of finding is there, and return its words."""
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    deadline = time.monotonic() + TIMEOUT
    while True:
        node.report()
        text = node.reporter.present(kind)
        if text and 'not known yet' not in text:
            return text
        assert time.monotonic() < deadline, f'nothing of {kind}'
        executor.spin_once(timeout_sec=0.05)


@pytest.mark.parametrize('stamped, kind, said', [
    (False, WrenchStamped, 'sends geometry_msgs/msg/WrenchStamped, this node expects '
                           'geometry_msgs/msg/Wrench (stamped_wrench is false)'),
    (True, Wrench, 'sends geometry_msgs/msg/Wrench, this node expects '
                   'geometry_msgs/msg/WrenchStamped (stamped_wrench is true)')])
def test_a_command_of_another_type(meeting, stamped, kind, said):
    """It is named with node and both types, and is what a missing wrench is put down to."""
    node, stranger = meeting(f'stamped_wrench:={str(stamped).lower()}')
    stranger.create_publisher(kind, 'cmd_wrench', 1)
    topic = f'{NAMESPACE}/cmd_wrench'
    assert reported(node, f'ends of {topic}') == f'{topic}: {NAMESPACE}/stranger {said}'
    node._ticker.tick()
    node.report()
    assert 'those who publish cannot be heard' in node.reporter.present('wrench')


def test_a_listener_of_another_type(meeting):
    """Whoever takes the setpoints for one number hears nothing, and is named."""
    node, stranger = meeting()
    stranger.create_subscription(Float64, 'thruster_setpoints', print, 1)
    text = reported(node, f'ends of {NAMESPACE}/thruster_setpoints')
    assert text.endswith(f'{NAMESPACE}/stranger expects std_msgs/msg/Float64, this node sends '
                         'std_msgs/msg/Float64MultiArray')


def test_a_listener_that_wants_what_came_before_it(meeting):
    """A latched subscription is served by no volatile publisher; both policies are named."""
    node, stranger = meeting()
    stranger.create_subscription(Float64MultiArray, 'thrust_limits', print, LATCHED)
    text = reported(node, f'ends of {NAMESPACE}/thrust_limits').lower()
    assert f'{NAMESPACE}/stranger' in text and 'volatile' in text and 'transient local' in text


def test_overrides_of_a_policy_count(meeting):
    """A subscription made reliable no longer meets a best-effort sender; the others stay."""
    node, stranger = meeting(
        f'qos_overrides.{NAMESPACE}/cmd_wrench.subscription.reliability:=reliable')
    policies = {one.topic_name: one.qos_profile.reliability for one in node.subscriptions}
    assert policies[f'{NAMESPACE}/cmd_wrench'] == ReliabilityPolicy.RELIABLE
    assert policies[f'{NAMESPACE}/odom'] == ReliabilityPolicy.BEST_EFFORT
    stranger.create_publisher(Wrench, 'cmd_wrench', BEST_EFFORT)
    text = reported(node, f'ends of {NAMESPACE}/cmd_wrench').lower()
    assert 'best effort publisher and reliable subscription' in text


@pytest.mark.parametrize('policy, value, allowed', [
    ('reliability', 'maybe', 'one of reliable, best_effort, system_default'),
    ('depth', '-1', 'a whole number, 0 or more')])
def test_overrides_that_cannot_be(meeting, policy, value, allowed):
    """Each is refused by name, value and what is allowed."""
    name = f'qos_overrides.{NAMESPACE}/odom.subscription.{policy}'
    with pytest.raises(ParameterError, match=f'^{name}: is .*{value}.*, must be {allowed}$'):
        meeting(f'{name}:={value}')


def test_no_wrench_and_why(stepped):
    """Nobody publishes; one that came long ago; one that is broken; none since enabling."""
    peer = stepped()
    node = peer.node
    peer.steps(2, None, [0.0] * 6)
    assert 'none has come from /stepped_peer' in peer.report()[1]
    peer.destroy_publisher(peer._inputs.pop('cmd_wrench'))
    peer.wait_until(lambda: not node.count_publishers('/cmd_wrench'), 'its end')
    peer.steps(2)
    assert 'no wrench: zero setpoints: nobody publishes /cmd_wrench' in peer.report()[1]
    peer._inputs['cmd_wrench'] = peer.create_publisher(Wrench, 'cmd_wrench', 10)
    peer.wait_until(lambda: node.count_publishers('/cmd_wrench'), 'a new one')
    peer.wait_until(lambda: peer._inputs['cmd_wrench'].get_subscription_count(), 'its listener')
    peer.send_wrench([np.nan] * 6)
    peer.steps(2)
    assert 'dropped: cmd_wrench not finite' in peer.report()[1]
    peer.step([10.0] + [0.0] * 5)
    peer.silence('wrench')
    peer.steps(40)
    assert 'no wrench: zero setpoints: the last one came 0.8 s ago' in peer.report()[1]


def test_a_command_that_is_old_by_its_stamp(meeting):
    """The sender's clock is suspected."""
    node, _ = meeting('stamped_wrench:=true')
    node._inputs.accept_wrench(np.ones(6), node._ticker.now(), old=5 * 10**9)
    node._ticker.tick()
    node.report()
    assert 'by its stamp it was 5.0 s old when it came' in node.reporter.present('wrench')


@pytest.mark.parametrize('frame, child, told', [
    ('odom', 'odom', True), ('odom', 'base_link', False), ('', '', False)])
def test_a_twist_in_axes_of_the_world(start, frame, child, told):
    """An odometry whose two frames are one draws a WARN; one that names none does not."""
    node, peer = start()
    message = Odometry(child_frame_id=child)
    message.header.frame_id = frame

    def send():
        peer._inputs['odom'].publish(message)

    peer.on_tick = send
    peer.wait_until(lambda: node._inputs.velocity is not None, 'the odometry')
    node.report()
    assert bool(node.reporter.present('frames')) == told


def test_live_changes_are_logged(stepped):
    """With the name, the value before and the value after."""
    from support.live_parameters import change

    peer = stepped()
    assert change(peer, {'thrusters.up.weight': 2.5, 'rate': 50.0}) == [(True, '')] * 2
    peer.wait_until(lambda: peer.logged('thrusters.up.weight: 1.0 -> 2.5'), 'a line of the log')
    assert not peer.logged('rate:')
