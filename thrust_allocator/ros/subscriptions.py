"""The topics that carry what is commanded and measured into the node."""

from collections.abc import Callable
from functools import partial
import time
from typing import Any

from geometry_msgs.msg import (
    TwistStamped, TwistWithCovarianceStamped, Vector3Stamped, Wrench, WrenchStamped)
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.subscription import Subscription
from sensor_msgs.msg import BatteryState
from thrust_allocator.inputs import Inputs
from thrust_allocator.ros.cdr import Content, Form, read_message
from thrust_allocator.ros.qos import INPUT, OVERRIDABLE
from thrust_allocator.supply import Rating

WRENCH = Form(Wrench, 0, 6)
WRENCH_STAMPED = Form(WrenchStamped, 1, 6)
CURRENT = Form(Vector3Stamped, 1, 3)
# Of an odometry: position 3, orientation 4, covariance 36, twist 6, covariance 36
VELOCITIES = {'odometry': Form(Odometry, 2, 85), 'twist': Form(TwistStamped, 1, 6),
              'twist_with_covariance': Form(TwistWithCovarianceStamped, 1, 6 + 36)}


class Subscriptions:
    """Puts what comes into the inputs, as bytes of which only the numbers wanted are read."""

    def __init__(self, node: Node, inputs: Inputs, now: Callable[[], int], stamped_wrench: bool,
                 velocity_type: str, on_wrench: Callable[[int, int], None],
                 rating: Callable[[], Rating]) -> None:
        """
        Subscribe.

        :param now: returns the time of the inputs' clock [ns].
        :param velocity_type: a key of VELOCITIES.
        :param on_wrench: called for each wrench that counts, with the time and for how long it
            has waited to be taken [ns].
        :param rating: returns what the voltage of a battery goes by.
        """
        self._node, self._inputs, self._now = node, inputs, now
        self._on_wrench, self._rating = on_wrench, rating
        self._simulated = node.get_parameter('use_sim_time').value
        # The executor takes them in this order: a wrench last, that its tick may see what came
        # with it
        if velocity_type == 'odometry':
            self._listen_to_numbers('odom', VELOCITIES[velocity_type], self._take_odometry)
            self._listen_to_numbers('current', CURRENT, self._take_current)
        else:
            self._listen_to_numbers('twist', VELOCITIES[velocity_type], self._take_twist)
        self._listen_to_numbers(
            'cmd_wrench', WRENCH_STAMPED if stamped_wrench else WRENCH, self._take_wrench)
        self._battery: Subscription | None = None

    def listen_to_battery(self, on: bool) -> None:
        """Listen to it only if its voltage counts."""
        if on and self._battery is None:
            self._battery = self._listen('battery', BatteryState, partial(
                read_message, kind=BatteryState), self._take_battery)
        elif not on and self._battery is not None:
            self._node.destroy_subscription(self._battery)
            self._battery = None

    def _listen_to_numbers(self, topic: str, form: Form,
                           take: Callable[[Content, int], None]) -> None:
        self._listen(topic, form.kind, form.read, take)

    def _listen(self, topic: str, kind: type, read: Callable[[bytes], Any],
                take: Callable[[Any, int], None]) -> Subscription:
        def receive(raw: bytes, info: dict) -> None:
            try:
                content = read(raw)
            except ValueError:
                self._inputs.dropped[f'{topic} malformed'] += 1
            else:
                take(content, info['received_timestamp'])

        return self._node.create_subscription(
            kind, topic, receive, INPUT, raw=True, qos_overriding_options=OVERRIDABLE)

    def _take_odometry(self, content: Content, received: int) -> None:
        self._inputs.accept_velocity(content.numbers[43:49], self._now(), 'odom',
                                     content.frames[0], content.numbers[3:7], content.frames[1])

    def _take_twist(self, content: Content, received: int) -> None:
        self._inputs.accept_velocity(content.numbers[:6], self._now(), 'twist')

    def _take_current(self, content: Content, received: int) -> None:
        self._inputs.accept_current(content.numbers, content.frames[0], self._now())

    def _take_battery(self, message: BatteryState, received: int) -> None:
        self._inputs.accept_voltage(message.voltage, self._now(), self._rating())

    def _take_wrench(self, content: Content, received: int) -> None:
        now, old = self._now(), 0
        if content.stamp:
            old = self._node.get_clock().now().nanoseconds - content.stamp
        if self._inputs.accept_wrench(content.numbers, now, old):
            # Not every middleware tells when it came, and what it tells is the system's time
            told = received and not self._simulated
            self._on_wrench(now, max(time.time_ns() - received, 0) if told else 0)
