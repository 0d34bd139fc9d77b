"""The process whose cost is measured: our node, or a relay with the same wiring."""

from collections.abc import Callable, Sequence
from itertools import cycle
import json
import sys
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped, Wrench
from nav_msgs.msg import Odometry
import rclpy
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import SetBool
from thrust_allocator.parameters.file import NODE_NAME
from thrust_allocator.ros import process
from thrust_allocator.ros.messages import array_message
from thrust_allocator.ros.node import ThrustAllocator
from thrust_allocator.ros.qos import INPUT, OUTPUT
from thrust_allocator.ros.subscriptions import messages_waiting, Unattended
from visualization_msgs.msg import MarkerArray

THRUSTERS = 5  # of MT-2012


class Relay(Node):
    """The least that a node with our node's topics can do: publish what came last."""

    def __init__(self, tricks: bool) -> None:
        """
        Start.

        :param tricks: whether it does as our node does: bytes, a tick on each wrench, no events.
            Otherwise it is written as the rclpy tutorials would: messages, and a timer.
        """
        super().__init__(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        self._tricks = tricks
        messages = [array_message([('limits', 2), ('thrusters', THRUSTERS)]),
                    array_message([('thrusters', THRUSTERS)]), Wrench(), Wrench()]
        for message, count in zip(messages, (2 * THRUSTERS, THRUSTERS)):
            message.data = count * [0.0]
        self._messages = [serialize_message(one) for one in messages] if tricks else messages
        self._velocity = None
        self._publishers_of_a_tick = [self._out(kind, topic) for kind, topic in (
            (Float64MultiArray, 'thrust_limits'), (Float64MultiArray, 'thruster_setpoints'),
            (Wrench, 'achieved_wrench'), (Wrench, 'unallocated_wrench'))]
        asked = [self._out(kind, topic) for kind, topic in (
            (JointState, 'thruster_states'), (MarkerArray, 'thruster_markers'),
            (Float64MultiArray, 'wrench_limits'))]
        diagnostics, nothing = self._out(DiagnosticArray, '/diagnostics'), DiagnosticArray()
        group = Unattended() if tricks else None
        self._states = [self._in(Odometry, 'odom', self._on_odometry, group),
                        self._in(Vector3Stamped, 'current', lambda message: None, group)]
        self._in(Wrench, 'cmd_wrench', self._on_wrench)
        self.create_service(SetBool, '~/enable', lambda request, response: response)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        turns = cycle(range(5))

        def show() -> None:
            for one in asked:
                one.get_subscription_count()
            if next(turns) == 0:
                diagnostics.publish(nothing)

        self.create_timer(0.2, show, clock=steady)
        period = (1.5 if tricks else 1.0) / self.get_parameter('rate').value  # [s]
        self._timer = self.create_timer(period, self._tick, clock=steady)

    def _out(self, kind: type, topic: str) -> Publisher:
        events = PublisherEventCallbacks(use_default_callbacks=not self._tricks)
        return self.create_publisher(kind, topic, OUTPUT, event_callbacks=events)

    def _in(self, kind: type, topic: str, callback: Callable[[Any], None],
            group: CallbackGroup | None = None) -> Subscription:
        events = SubscriptionEventCallbacks(use_default_callbacks=not self._tricks)
        return self.create_subscription(kind, topic, callback, INPUT, raw=self._tricks,
                                        event_callbacks=events, callback_group=group)

    def _on_odometry(self, message: Odometry | bytes) -> None:
        self._velocity = message

    def _on_wrench(self, message: Wrench | bytes) -> None:
        self._messages[2] = message
        if self._tricks:
            self._tick()
            self._timer.reset()

    def _tick(self) -> None:
        for state in self._states if self._tricks else ():
            for raw, _ in messages_waiting(state):
                state.callback(raw)
        for publisher, message in zip(self._publishers_of_a_tick, self._messages):
            publisher.publish(message)


def wiring(node: Node) -> list[str]:
    """Return what the executor has to watch, and what is published; but for events."""
    within = node.get_namespace()
    names = [f'{kind} {name.removeprefix(within)}' for kind, found in (
        ('publisher', [one.topic_name for one in node.publishers]),
        ('subscription', [one.topic_name for one in node.subscriptions]),
        ('service', [one.service_name for one in node.services])) for name in found]
    return sorted([*names, f'{len(list(node.timers))} timers',
                   f'{len(list(node.guards))} guard conditions'])


class Allocator(ThrustAllocator):
    """Our node, which says what it is wired to."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        print(json.dumps(wiring(self)), flush=True)


def main(args: Sequence[str]) -> int:
    """Run our node's own process, or a relay, until it is killed."""
    kind, *ros_arguments = args[1:]
    if kind == 'thrust_allocator':
        process.ThrustAllocator = Allocator
        return process.main([args[0], *ros_arguments])
    rclpy.init(args=[args[0], *ros_arguments])
    relay = Relay(tricks=kind != 'relay')
    print(json.dumps(wiring(relay)), flush=True)
    rclpy.spin(relay)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
