"""The topics that carry what is commanded and measured into the node."""

from collections.abc import Callable, Iterator
from functools import partial
import time
from typing import Any

from geometry_msgs.msg import (
    TwistStamped, TwistWithCovarianceStamped, Vector3Stamped, Wrench, WrenchStamped)
from nav_msgs.msg import Odometry
from rclpy.callback_groups import CallbackGroup
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


class Unattended(CallbackGroup):
    """Of subscriptions that no executor waits for: what comes is there to be fetched."""

    def can_execute(self, entity: object) -> bool:
        """Let the executor pass it over."""
        return False

    def beginning_execution(self, entity: object) -> bool:
        """Never begin."""
        return False

    def ending_execution(self, entity: object) -> None:
        """Have nothing to end."""


def messages_waiting(subscription: Subscription) -> Iterator[tuple[bytes, dict]]:
    """Take what waits in a raw subscription: bytes, and when they were sent and received."""
    with subscription.handle:
        while (message := subscription.handle.take_message(subscription.msg_type, True)):
            yield message


class Subscriptions:
    """
    Puts what comes into the inputs, as bytes of which only the numbers wanted are read.

    Only a command wakes the node. What tells of the vehicle's state waits to be fetched by the next
    tick: to wake up for an odometry would cost much more. In simulated time the executor brings it,
    for then nobody knows for how long a message has waited.
    """

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
        self._unattended = Unattended()
        self._receivers: dict[Subscription, Callable[[bytes, dict], None]] = {}
        self._fetched = now()  # when the state was fetched last
        if velocity_type == 'odometry':
            self._listen_to_numbers('odom', VELOCITIES[velocity_type], self._take_odometry)
            self._listen_to_numbers('current', CURRENT, self._take_current)
        else:
            self._listen_to_numbers('twist', VELOCITIES[velocity_type], self._take_twist)
        self._wrench = self._listen_to_numbers(
            'cmd_wrench', WRENCH_STAMPED if stamped_wrench else WRENCH, self._take_wrench,
            wakes=True)
        self._battery: Subscription | None = None

    def listen_to_battery(self, on: bool) -> None:
        """Listen to it only if its voltage counts."""
        if on and self._battery is None:
            self._battery = self._listen('battery', BatteryState, partial(
                read_message, kind=BatteryState), self._take_battery)
        elif not on and self._battery is not None:
            del self._receivers[self._battery]
            self._node.destroy_subscription(self._battery)
            self._battery = None

    def fetch_state(self) -> None:
        """Take what has come of the vehicle's state, so that a tick sees all that was there."""
        for subscription in self._receivers:
            if subscription is not self._wrench:
                self._fetch(subscription)
        self._fetched = self._now()

    def fetch_wrench(self) -> None:
        """Take a wrench that has come, before the executor does; it may make a tick."""
        self._fetch(self._wrench)

    def _fetch(self, subscription: Subscription) -> None:
        for raw, info in messages_waiting(subscription):
            self._receivers[subscription](raw, info)

    def _listen_to_numbers(self, topic: str, form: Form,
                           take: Callable[[Content, int, int], None],
                           wakes: bool = False) -> Subscription:
        return self._listen(topic, form.kind, form.read, take, wakes)

    def _listen(self, topic: str, kind: type, read: Callable[[bytes], Any],
                take: Callable[[Any, int, int], None], wakes: bool = False) -> Subscription:
        def receive(raw: bytes, info: dict) -> None:
            try:
                content = read(raw)
            except ValueError:
                self._inputs.dropped[f'{topic} malformed'] += 1
            else:
                take(content, self._now(), self._waited(info['received_timestamp']))

        subscription = self._node.create_subscription(
            kind, topic, receive, INPUT, raw=True, qos_overriding_options=OVERRIDABLE,
            callback_group=None if wakes or self._simulated else self._unattended)
        self._receivers[subscription] = receive
        return subscription

    def _waited(self, received: int) -> int:
        """Return for how long a message has waited that was received at a system time [ns]."""
        if not received or self._simulated:  # not every middleware tells it
            return 0
        return max(time.time_ns() - received, 0)

    def _came(self, now: int, waited: int) -> int:
        """Return when what was fetched has come, whatever has become of the system's time [ns]."""
        return max(now - waited, min(self._fetched, now))

    def _take_odometry(self, content: Content, now: int, waited: int) -> None:
        self._inputs.accept_velocity(content.numbers[43:49], self._came(now, waited), 'odom',
                                     content.frames[0], content.numbers[3:7], content.frames[1])

    def _take_twist(self, content: Content, now: int, waited: int) -> None:
        self._inputs.accept_velocity(content.numbers[:6], self._came(now, waited), 'twist')

    def _take_current(self, content: Content, now: int, waited: int) -> None:
        self._inputs.accept_current(
            content.numbers, content.frames[0], self._came(now, waited))

    def _take_battery(self, message: BatteryState, now: int, waited: int) -> None:
        self._inputs.accept_voltage(message.voltage, self._came(now, waited), self._rating())

    def _take_wrench(self, content: Content, now: int, waited: int) -> None:
        old = 0
        if content.stamp:
            old = self._node.get_clock().now().nanoseconds - content.stamp
        if self._inputs.accept_wrench(content.numbers, now, old):
            self._on_wrench(now, waited)
