"""What tells of the vehicle's state: it wakes nobody, is fetched, and counts from when it came."""

from contextlib import contextmanager
from copy import copy
import math
import time

from numpy.testing import assert_array_equal
import pytest
from rclpy.node import Node
from support.peer import Peer, ros_context
from thrust_allocator.inputs import Inputs
from thrust_allocator.ros import subscriptions
from thrust_allocator.supply import Rating

SECOND = 10**9  # [ns]
TWIST = [1.0, 0.3, -0.2, 0.05, 0.1, -0.1]


class Listener:
    """Subscriptions of a node that makes no ticks, on a clock that the test turns."""

    def __init__(self, context):
        """Listen, once a peer is there to be heard."""
        self.now, self.inputs, self.wrenches = 1000 * SECOND, Inputs(), []
        self.node = Node('listener', context=context)
        self.ears = subscriptions.Subscriptions(
            self.node, self.inputs, lambda: self.now, False, 'odometry',
            lambda *times: self.wrenches.append(times), Rating)
        self.peer = Peer(context, beside=self.node)
        self.peer.wait_until(lambda: all(
            one.get_publisher_count() for one in self.node.subscriptions
            if one.topic_name in ('/odom', '/cmd_wrench')), 'the peer')

    def send(self):
        """Have the peer send an odometry, and a wrench that comes after it."""
        self.peer.send_twist(TWIST)
        self.peer.send_wrench(TWIST)
        self.peer.wait_until(lambda: self.wrenches, 'the wrench')


@contextmanager
def listening(*arguments):
    """Start a Listener with a peer, with ROS arguments."""
    with ros_context(*arguments) as context, pytest.MonkeyPatch.context() as patch:
        # rclpy writes an override into the profile that it is given
        patch.setattr(subscriptions, 'INPUT', copy(subscriptions.INPUT))
        one = Listener(context)
        yield one
        one.peer.close()
        one.node.destroy_node()


@pytest.fixture
def listener():
    """Return a Listener with a peer."""
    with listening() as one:
        yield one


def test_only_a_command_wakes_the_node(listener):
    """The executor brings a wrench that comes after an odometry, which waits to be fetched."""
    listener.send()
    assert listener.inputs.velocity is None
    listener.ears.fetch_state()
    assert_array_equal(listener.inputs.velocity.values, TWIST)


def test_in_simulated_time_the_executor_brings_all(start):
    """Nobody could tell there for how long a message has waited, so that none does."""
    for rule, topics in (('false', {'/cmd_wrench'}),
                         ('true', {'/cmd_wrench', '/odom', '/current', '/battery', '/clock'})):
        node, peer = start(f'use_sim_time:={rule}', 'nominal_voltage:=48.0')
        assert {one.topic_name for one in node.subscriptions
                if peer.spinner.can_execute(one)} == topics


@pytest.mark.parametrize('depth, dropped', [(1, 0), (3, 2)])
def test_how_many_wait(depth, dropped):
    """The newest only, or as many as a user wants: two broken ones before a good one are seen."""
    with listening('-p', f'qos_overrides./odom.subscription.depth:={depth}') as listener:
        for _ in range(2):
            listener.peer.send_twist([math.inf] * 6)
        listener.send()
        listener.ears.fetch_state()
        assert listener.inputs.dropped['odom not finite'] == dropped
        assert_array_equal(listener.inputs.velocity.values, TWIST)


@pytest.mark.parametrize('leap, came', [
    (0.3, pytest.approx(1001.7, abs=0.2)),  # [s]; what the test itself takes is in the tolerance
    (3600.0, 1001.0), (-3600.0, 1002.0)])
def test_it_counts_from_when_it_came(listener, monkeypatch, leap, came):
    """An odometry that has waited is as old; a leap of the system's clock is bounded by fetches."""
    listener.now += SECOND
    listener.ears.fetch_state()  # at 1001 s
    listener.now += SECOND
    monkeypatch.setattr(subscriptions.time, 'time_ns',
                        lambda real=time.time_ns: real() + round(leap * SECOND))
    listener.send()
    listener.ears.fetch_state()
    assert listener.inputs.velocity.time / SECOND == came
