"""The ROS 2 node: takes messages in, asks for a tick, and sends it out."""

from collections.abc import Callable, Iterator
from copy import copy
import time
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from std_srvs.srv import SetBool
from thrust_allocator.inputs import Inputs
from thrust_allocator.parameters.file import NODE_NAME
from thrust_allocator.parameters.types import ParameterError, shown
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.ros.markers import thruster_markers
from thrust_allocator.ros.outputs import Outputs
from thrust_allocator.ros.parameters import changes_of, coerced, declare, Start, take_overrides
from thrust_allocator.ros.qos import OVERRIDABLE, unused_overrides
from thrust_allocator.ros.reporter import Reporter
from thrust_allocator.ros.subscriptions import Subscriptions
from thrust_allocator.ros.ticker import Ticker
from thrust_allocator.ros.topics import check_topics
from thrust_allocator.ros.wrench_limits import WrenchLimits
from thrust_allocator.tick import Allocator, Tick
from visualization_msgs.msg import MarkerArray

LINGER = 0.1  # [s] for subscribers that acknowledge nothing to receive the last zeros
SHOW_PERIOD = 0.2  # [s] between pictures, and between wrench limits, if anybody looks
REPORT_PERIOD = 10**9  # [ns] between diagnostics, or until the tick after


class ThrustAllocator(Node):
    """Turns `cmd_wrench` and `odom` into `thruster_setpoints`, once per tick."""

    def __init__(self, start: Start = Start(), **options) -> None:
        """
        Start a node for the vehicle that its parameters describe.

        :param start: what the process has read of the command line.
        :param options: passed on to `rclpy.node.Node`, e.g. `context` and `cli_args`.
        :raises ParameterError: if the parameters describe no vehicle, or two topics are one.
        """
        super().__init__(NODE_NAME, parameter_overrides=start.overrides, **options)
        self._description = take_overrides(self, start)
        declare(self, self._description.parameters)
        values = self._description.parameters.values
        check_topics(self, values['velocity_type'])
        self._allocator = Allocator.of(self._description)
        self._outputs = Outputs(self, values['thruster_names'], values['setpoint_unit'])
        self._outputs.publish_individually(values['publish_individual'])
        for remark in self._description.remarks:
            self.get_logger().info(remark)
        for warning in self._description.warnings:
            self.get_logger().warning(warning)

        # The steady clock, so that setting the system clock changes nothing
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._simulated = self.get_parameter('use_sim_time').value
        clock = self.get_clock() if self._simulated else steady
        self._inputs = Inputs()
        self._enabled = values['start_enabled']
        self._last_tick: Tick | None = None
        self.reporter = Reporter(self, self._inputs, self.vehicle, {
            'cmd_wrench': f'stamped_wrench is {str(values["stamped_wrench"]).lower()}',
            'twist': f'velocity_type is {values["velocity_type"]}'})
        self.interrupted = False  # whether OSQP has caught a SIGINT

        self._wrench_limits = WrenchLimits(self)
        self._marker_publisher = self.create_publisher(
            MarkerArray, 'thruster_markers', 1, qos_overriding_options=OVERRIDABLE)
        self._ticker = Ticker(
            self, clock, values, self._tick, lambda: self._ears.fetch_wrench())
        self._ears = Subscriptions(
            self, self._inputs, self._ticker.now, values['stamped_wrench'],
            values['velocity_type'], self._ticker.wrench_accepted,
            lambda: self._allocator.settings.rating)
        self._ears.listen_to_battery(bool(values['nominal_voltage']))
        for name in unused_overrides(self):
            self.get_logger().warning(f'{name}: is for no topic of this node; it is ignored')
        self.create_service(SetBool, '~/enable', self._on_enable)
        self._checked = self._description  # what the newest check of a change has built
        self.add_pre_set_parameters_callback(
            lambda changes: coerced(changes, self._description.parameters))
        self.add_on_set_parameters_callback(self._check_change)
        self.add_post_set_parameters_callback(self._apply)
        self.report_due = time.monotonic_ns() + REPORT_PERIOD
        self._reporting: Iterator[None] = iter(())
        self.create_timer(SHOW_PERIOD, self._show, clock=steady)
        if self._simulated:
            self._jump_handle = clock.create_jump_callback(
                JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1)),
                post_callback=lambda jump: self._forget())

    @property
    def vehicle(self) -> Vehicle:
        """Return the vehicle as it is at present."""
        return self._allocator.vehicle

    # Each event that rclpy watches unless told otherwise costs time at every wait; the reporter
    # looks once a second for what they would tell. And rclpy writes what a user overrides into the
    # profile that it is given, which others share

    def create_publisher(self, kind: type, topic: str, qos: QoSProfile | int,
                         **options: Any) -> Publisher:
        """Create a publisher without rclpy's default events, with a profile of its own."""
        return super().create_publisher(kind, topic, copy(qos), **{
            'event_callbacks': PublisherEventCallbacks(use_default_callbacks=False), **options})

    def create_subscription(self, kind: type, topic: str, callback: Callable[[Any], None],
                            qos: QoSProfile | int, **options: Any) -> Subscription:
        """Create a subscription without rclpy's default events, with a profile of its own."""
        return super().create_subscription(kind, topic, callback, copy(qos), **{
            'event_callbacks': SubscriptionEventCallbacks(use_default_callbacks=False), **options})

    # Parameters

    def _check_change(self, changes: list[Parameter]) -> SetParametersResult:
        if any(change.name == 'use_sim_time' for change in changes):
            return SetParametersResult(
                successful=False, reason='use_sim_time: is read-only, must be set at start')
        try:
            self._checked = self._description.changed(
                changes_of(changes, self._description.parameters))
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply(self, changes: list[Parameter]) -> None:
        """Put what the check has built in force from the next tick on, and log it."""
        before = self._description.parameters.values
        self._description = self._checked
        self._allocator = Allocator.of(self._description, before=self._allocator)
        values = self._description.parameters.values
        for name, value in values.items():
            if value != before[name]:
                self.get_logger().info(f'{name}: {shown(before[name])} -> {shown(value)}')
        self._outputs.publish_individually(values['publish_individual'])
        self._ticker.change(values)
        if bool(values['nominal_voltage']) != bool(before['nominal_voltage']):
            self._ears.listen_to_battery(
                bool(values['nominal_voltage']))  # declares overrides, so this is called again

    # Ticks

    def _on_enable(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if request.data and not self._enabled:
            self._inputs.wrench = None  # only a command given since counts
            self._ticker.wrench_forgotten()
        stops = self._enabled and not request.data
        self._enabled = request.data
        if stops:
            self._ticker.stopped()
        response.success, response.message = True, 'enabled' if request.data else 'disabled'
        return response

    def _forget(self) -> None:
        """Let nothing count that came before the clock went back."""
        self._ears.fetch_state()
        self._inputs.forget()
        self._ticker.clock_went_back()

    def _tick(self, now: int, late: bool) -> None:
        start = time.perf_counter()
        self._ears.fetch_state()
        tick = self._allocator.tick(self._inputs, now, self._enabled)
        self._send(tick)
        if tick.allocation is not None and tick.allocation.status == 'interrupted':
            self.interrupted = True  # OSQP swallows a SIGINT that comes while it works
        self.reporter.tick(tick, now, time.perf_counter() - start, late)
        self._go_on_reporting()  # while the next wrench is far away

    def _send(self, tick: Tick) -> None:
        self._last_tick = tick
        self._outputs.publish(tick)

    def stop(self) -> None:
        """Publish zero setpoints for the last time and wait until they have been delivered."""
        self._ticker.cancel()
        self._inputs.wrench = None
        try:
            self._send(self._allocator.tick(self._inputs, self._ticker.now()))
        except Exception:  # what has ended the node may lie in there: zeros all the same
            self._outputs.publish_zero_setpoints()
        self._outputs.wait_until_delivered()
        time.sleep(LINGER)

    # Reports

    def report(self) -> None:
        """Publish diagnostics at once."""
        self._begin_report()
        for _ in self._reporting:
            pass

    def _begin_report(self) -> None:
        self.report_due = time.monotonic_ns() + REPORT_PERIOD
        self._ears.fetch_state()
        self._reporting = self.reporter.report(self.vehicle, self._ticker.now(), self._simulated)

    def _go_on_reporting(self) -> None:
        """Do the next step of a report, if one has been begun or is due."""
        if time.monotonic_ns() >= self.report_due:
            self._begin_report()
        next(self._reporting, None)

    def _show(self) -> None:
        """Publish a picture of the last tick, and what could still be asked, if anybody looks."""
        self._go_on_reporting()  # though no tick may have come
        if self._last_tick is None:
            return
        self.reporter.note('wrench limits', self._wrench_limits.publish(
            self._allocator, self._last_tick), self._ticker.now())
        if self._marker_publisher.get_subscription_count():
            self._marker_publisher.publish(thruster_markers(
                self.vehicle.thrusters, self._last_tick.thrusts, self._last_tick.limits,
                self._allocator.signs[:3],
                self._description.parameters.values['marker_frame'],
                self.get_clock().now().to_msg()))
