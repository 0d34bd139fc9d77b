"""A peer of the node: stands for its controller, its odometry and its motor drivers."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import time
from typing import Any, NamedTuple

from geometry_msgs.msg import Vector3, Wrench
from nav_msgs.msg import Odometry
import numpy as np
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock as ClockMessage
from std_msgs.msg import Float64MultiArray

TYPES_IN = {'cmd_wrench': Wrench, 'odom': Odometry}
TYPES_OUT = {  # in the order of publication
    'thrust_limits': Float64MultiArray, 'thruster_setpoints': Float64MultiArray,
    'achieved_wrench': Wrench, 'unallocated_wrench': Wrench}


class Received(NamedTuple):
    """One message, as it came."""

    topic: str
    message: Any
    values: np.ndarray  # the array, or force and torque, in the message's own axes
    sent: int  # when it was published, by its publisher [ns]


@contextmanager
def ros_context(*arguments: str, domain_id: int | None = None) -> Iterator[rclpy.Context]:
    """Open a Context of its own with ROS arguments, and shut it down."""
    context = rclpy.Context()
    rclpy.init(args=['test', '--ros-args', *arguments], context=context, domain_id=domain_id)
    try:
        yield context
    finally:
        context.try_shutdown()


class Peer(Node):
    """Sends wrench and twist anew at every tick, and records all that the allocator says."""

    def __init__(self, context: rclpy.Context, *,
                 reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE,
                 beside: Node | None = None, name: str = 'peer') -> None:
        """
        Meet the allocator by the relative names of its topics.

        :param reliability: of the publishers and the subscriptions.
        :param beside: a node to spin together with this one; of a Peer, its executor is shared.
        """
        super().__init__(name, context=context)
        self.received: list[Received] = []
        self.wrench: np.ndarray | None = None  # sent at every tick, message axes; None: not sent
        self.twist: np.ndarray | None = None
        self.on_tick: Callable[[], None] = self.send
        qos = QoSProfile(depth=1000, reliability=reliability)
        self._inputs = {topic: self.create_publisher(kind, topic, qos)
                        for topic, kind in TYPES_IN.items()}
        for topic, kind in TYPES_OUT.items():
            self.create_subscription(kind, topic, self._recorder(topic), qos)
        self.spinner = beside.spinner if isinstance(beside, Peer) else SingleThreadedExecutor(
            context=context)
        for node in (self, beside):
            if node is not None:
                self.spinner.add_node(node)

    def _recorder(self, topic: str) -> Callable[[Any, dict], None]:
        def record(message: Any, info: dict) -> None:
            wrench = isinstance(message, Wrench)
            values = np.array(_components(message.force, message.torque) if wrench
                              else message.data)
            self.received.append(Received(topic, message, values, info['source_timestamp']))
            if topic == 'unallocated_wrench':
                self.on_tick()
        return record

    @property
    def ticks(self) -> list[dict[str, np.ndarray]]:
        """Return the complete ticks in order of publication, each with its values by topic."""
        ticks: list[dict[str, np.ndarray]] = []
        for item in sorted(self.received, key=lambda item: item.sent):
            if item.topic == 'thrust_limits' or not ticks:
                ticks.append({})
            ticks[-1][item.topic] = item.values
        return [tick for tick in ticks if len(tick) == len(TYPES_OUT)]

    def setpoints(self) -> np.ndarray | None:
        """Return the last setpoints that arrived, or None."""
        return next((item.values for item in reversed(self.received)
                     if item.topic == 'thruster_setpoints'), None)

    def send(self) -> None:
        """Send the present twist and wrench, those that are not None."""
        if self.twist is not None:
            self.send_twist(self.twist)
        if self.wrench is not None:
            self.send_wrench(self.wrench)

    def send_wrench(self, wrench: Sequence[float]) -> None:
        """Send one wrench, message axes."""
        message = Wrench()
        _fill(message.force, message.torque, wrench)
        self._inputs['cmd_wrench'].publish(message)

    def send_twist(self, twist: Sequence[float]) -> None:
        """Send one odometry message, message axes."""
        message = Odometry()
        _fill(message.twist.twist.linear, message.twist.twist.angular, twist)
        self._inputs['odom'].publish(message)

    def wait_until(self, condition: Callable[[], Any], what: str, timeout: float = 20.0) -> None:
        """Spin until `condition` holds; `what` is said if it does not within `timeout` s."""
        deadline = time.monotonic() + timeout
        while not condition():
            newest = self.ticks[-1] if self.ticks else 'none'
            assert time.monotonic() < deadline, (
                f'not within {timeout} s: {what}; newest tick: {newest}')
            self.spinner.spin_once(timeout_sec=0.02)

    def wait_for_ticks(self, count: int) -> list[dict[str, np.ndarray]]:
        """Spin for `count` ticks more than have arrived, and return them."""
        known = len(self.ticks)
        self.wait_until(lambda: len(self.ticks) >= known + count, f'{count} more ticks')
        return self.ticks[known:]

    def settle(self, wrench: Sequence[float] | None = None,
               twist: Sequence[float] | None = None) -> dict[str, np.ndarray]:
        """
        Keep sending a wrench and a twist until they are answered alike at two ticks in a row.

        :return: the values of the last tick by topic. It comes long enough after the first
            sending, by four ticks, that both inputs have been read.
        """
        self.wrench = None if wrench is None else np.array(wrench, dtype=float)
        self.twist = None if twist is None else np.array(twist, dtype=float)
        known = len(self.ticks)
        self.send()
        self.wait_until(lambda: len(self.ticks) >= known + 4 and self._answered(),
                        f'an answer to the wrench {wrench} at the twist {twist}')
        return self.ticks[-1]

    def _answered(self) -> bool:
        before, last = self.ticks[-2:]
        commanded = np.zeros(6) if self.wrench is None else self.wrench
        answered = last['achieved_wrench'] + last['unallocated_wrench']
        return np.allclose(answered, commanded, rtol=1e-12, atol=1e-6) and all(
            np.allclose(before[topic], last[topic], rtol=0.0, atol=1e-6) for topic in last)

    def close(self) -> None:
        """End the executor and this node."""
        self.spinner.shutdown()
        self.destroy_node()


def _components(linear: Vector3, angular: Vector3) -> list[float]:
    return [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]


def _fill(linear: Vector3, angular: Vector3, values: Sequence[float]) -> None:
    linear.x, linear.y, linear.z, angular.x, angular.y, angular.z = map(float, values)


class SimulatedClock:
    """Publishes /clock 100 times per second of real time, from a timer of a peer."""

    def __init__(self, peer: Peer) -> None:
        """Start to publish, 20 ms further each time."""
        self._peer = peer
        self._publisher = peer.create_publisher(ClockMessage, '/clock', 1)
        self._pulses = 0
        self.time = 1000 * 10**9  # [ns]
        self.step = 20 * 10**6  # [ns]
        peer.create_timer(0.01, self._pulse, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _pulse(self) -> None:
        self._pulses += 1
        self.time += self.step
        message = ClockMessage()
        message.clock.sec, message.clock.nanosec = divmod(self.time, 10**9)
        self._publisher.publish(message)

    def wait_for_pulses(self, count: int) -> None:
        """Spin until the time has been published `count` times more, whether it moves or not."""
        known = self._pulses
        self._peer.wait_until(lambda: self._pulses >= known + count, f'{count} times on /clock')


def cruise(speed: float, side: float) -> tuple[np.ndarray, np.ndarray]:
    """Return wrench and twist of the paper's test; `side` is +1 in frd axes, -1 in flu."""
    return (np.array([40.0 * speed**2, 0.0, 0.0, 0.0, side * 50.0, 0.0]),
            np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0]))
