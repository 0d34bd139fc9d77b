"""The ROS 2 node: everything of ROS that the allocator needs, and no mathematics."""

import time

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import (
    Twist, TwistStamped, TwistWithCovarianceStamped, Vector3Stamped, Wrench, WrenchStamped)
from nav_msgs.msg import Odometry
import numpy as np
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Header
from std_srvs.srv import SetBool
from thrust_allocator.solve.problem import AllocationProblem
from thrust_allocator.physics.bounds import rate_limited, ThrustBounds
from thrust_allocator.diagnosis import allocation_figures, Findings, Level, Period, shortfall
from thrust_allocator.physics.frames import frd_signs
from thrust_allocator.inputs import Inputs, NEVER, Received
from thrust_allocator.ros.markers import thruster_markers
from thrust_allocator.ros.messages import (
    quaternion_components, status_message, twist_components, vector_components, wrench_components)
from thrust_allocator.ros.outputs import Outputs
from thrust_allocator.parameters.file import NODE_NAME
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.parameters.table import Parameters
from thrust_allocator.ros.parameters import changed, coerced, declare, take_overrides
from thrust_allocator.physics.vehicle import Vehicle
from visualization_msgs.msg import MarkerArray

# Best effort and depth 1 meet any publisher, and only the newest message counts
INPUT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)

LINGER = 0.1  # [s] for subscribers that acknowledge nothing to receive the last zeros
REPORT_PERIOD = 1.0  # [s] between diagnostics
MARKER_PERIOD = 0.2  # [s] between pictures, if anybody looks
LATE = 1.5  # periods after the tick before, from which on a tick is late


class ThrustAllocator(Node):
    """Turns `cmd_wrench` and `odom` into `thruster_setpoints`, once per tick."""

    def __init__(self, **options) -> None:
        """
        Start a node for the vehicle that its parameters describe.

        :param options: passed on to `rclpy.node.Node`, e.g. `context` and `cli_args`.
        :raises ParameterError: if the parameters describe no vehicle.
        """
        super().__init__(
            NODE_NAME, automatically_declare_parameters_from_overrides=True, **options)
        parameters = take_overrides(self)
        declare(self, parameters)
        values = parameters.values
        self._outputs = Outputs(self, values['thruster_names'], values['setpoint_unit'])
        self._problem: AllocationProblem | None = None
        self._timer = None
        self._apply(parameters)
        for warning in [*parameters.warnings, *self.vehicle.warnings()]:
            self.get_logger().warning(warning)

        # The steady clock, so that setting the system clock changes nothing
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._simulated = self.get_parameter('use_sim_time').value
        self._tick_clock = self.get_clock() if self._simulated else steady
        self._inputs = Inputs()
        self._enabled = values['start_enabled']
        p = len(self.vehicle.thrusters)
        self._setpoints, self._limits_now = np.zeros(p), np.zeros((2, p))  # last published [N]
        self._velocity = np.zeros(6)  # that the limits were computed for, frd axes
        self._last_tick: int | None = None  # when it began, on the node's clock [ns]
        self._findings = Findings(self.get_logger())
        self._period = Period()
        self._last_report: int | None = None  # [ns]
        self._known_dropped = self._inputs.dropped.copy()
        self.interrupted = False  # whether OSQP has caught a SIGINT

        self._diagnostics_publisher = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self._marker_publisher = self.create_publisher(MarkerArray, 'thruster_markers', 1)
        self._subscribe(values['stamped_wrench'], values['velocity_type'])
        self.create_service(SetBool, '~/enable', self._on_enable)
        self.add_pre_set_parameters_callback(lambda changes: coerced(changes, self._described))
        self.add_on_set_parameters_callback(self._check_change)
        self.add_post_set_parameters_callback(
            lambda changes: self._apply(changed(changes, self._described)))
        self._after_messages = self.create_guard_condition(self._tick)
        self.create_timer(REPORT_PERIOD, self._report, clock=steady)
        self.create_timer(MARKER_PERIOD, self._draw, clock=steady)
        self._timer = self.create_timer(
            self._tick_period * 1e-9, self._on_timer, clock=self._tick_clock)
        if self._simulated:
            self._jump_handle = self._tick_clock.create_jump_callback(
                JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1)),
                post_callback=lambda jump: self._inputs.forget())

    def _subscribe(self, stamped_wrench: bool, velocity_type: str) -> None:
        if stamped_wrench:
            self.create_subscription(
                WrenchStamped, 'cmd_wrench', self._on_stamped_wrench, INPUT)
        else:
            self.create_subscription(Wrench, 'cmd_wrench', self._on_wrench, INPUT)
        if velocity_type == 'odometry':
            self.create_subscription(Odometry, 'odom', self._on_odometry, INPUT)
            self.create_subscription(Vector3Stamped, 'current', self._on_current, INPUT)
        elif velocity_type == 'twist':
            self.create_subscription(
                TwistStamped, 'twist', lambda message: self._on_twist(message.twist), INPUT)
        else:
            self.create_subscription(
                TwistWithCovarianceStamped, 'twist',
                lambda message: self._on_twist(message.twist.twist), INPUT)

    # Parameters

    def _check_change(self, changes: list[Parameter]) -> SetParametersResult:
        if any(change.name == 'use_sim_time' for change in changes):
            return SetParametersResult(
                successful=False, reason='use_sim_time: is read-only, must be set at start')
        try:
            parameters = changed(changes, self._described)
            self._problem.for_vehicle(Vehicle.from_parameters(parameters))
            _period(parameters.values['rate'])
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply(self, parameters: Parameters) -> None:
        """Put checked parameters in force from the next tick on."""
        values = parameters.values
        self._described = parameters
        self.vehicle = Vehicle.from_parameters(parameters)
        self._problem = (self._problem.for_vehicle(self.vehicle) if self._problem
                         else AllocationProblem(self.vehicle))
        self._bounds = ThrustBounds(self.vehicle)
        self._signs = frd_signs(values['message_frame'])
        max_rates = np.array([thruster.max_rate for thruster in self.vehicle.thrusters])
        self._step = np.where(max_rates > 0.0, max_rates / values['rate'], np.inf)  # [N]
        self._fallback_velocity = self._signs * (*values['fallback_velocity'], 0.0, 0.0, 0.0)
        self._fallback_limits = self._bounds(self._fallback_velocity)
        self._wrench_timeout, self._velocity_timeout, self._current_timeout = (
            round(values.get(f'{name}_timeout', 0.0) * 1e9)
            for name in ('wrench', 'odometry', 'current'))
        self._outputs.publish_individually(values['publish_individual'])
        self._tick_period = _period(values['rate'])
        if self._timer is not None and self._timer.timer_period_ns != self._tick_period:
            self._timer.timer_period_ns = self._tick_period
            self._last_tick = None  # the tick that comes cannot be late
            if self._timer.time_until_next_call() > self._tick_period:
                self._timer.reset()

    # Inputs

    def _on_wrench(self, message: Wrench) -> None:
        self._inputs.accept_wrench(wrench_components(message), self._now())

    def _on_stamped_wrench(self, message: WrenchStamped) -> None:
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        old = self.get_clock().now().nanoseconds - stamp if stamp else 0
        self._inputs.accept_wrench(wrench_components(message.wrench), self._now(), old)

    def _on_odometry(self, message: Odometry) -> None:
        self._inputs.accept_velocity(
            twist_components(message.twist.twist), self._now(), 'odom', message.header.frame_id,
            quaternion_components(message.pose.pose.orientation))

    def _on_twist(self, message: Twist) -> None:
        self._inputs.accept_velocity(twist_components(message), self._now(), 'twist')

    def _on_current(self, message: Vector3Stamped) -> None:
        self._inputs.accept_current(
            vector_components(message.vector), message.header.frame_id, self._now())

    def _on_enable(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if request.data and not self._enabled:
            self._inputs.wrench = None  # only a command given since counts
        self._enabled = request.data
        response.success, response.message = True, 'enabled' if request.data else 'disabled'
        return response

    def _now(self) -> int:
        return self._tick_clock.now().nanoseconds

    # Ticks

    def _on_timer(self) -> None:
        now = self._now()
        late = self._last_tick is not None and now - self._last_tick > LATE * self._tick_period
        self._last_tick = now
        if late:
            self._period.late += 1
            self._after_messages.trigger()  # so that what has come meanwhile is taken first
        else:
            self._tick()

    def _tick(self) -> None:
        start = time.perf_counter()
        now = self._now()
        limits = self._limits(now)
        wrench = self._live_wrench(now)
        if wrench is not None and self._enabled:
            self._allocate(wrench, rate_limited(limits, self._setpoints, self._step))
        else:
            self._findings.note('solver', '')
            self._publish(limits, np.zeros_like(self._setpoints), np.zeros(6),
                          np.zeros(6) if wrench is None else wrench)
        self._period.times.append(time.perf_counter() - start)

    def _limits(self, now: int) -> np.ndarray:
        """Return the limits at the present velocity, and note what is wrong with it."""
        received, timeout = self._inputs.velocity, self._velocity_timeout
        through_water, ignored = self._inputs.velocity_through_water(now, self._current_timeout)
        self._findings.note('current', f'current ignored: {ignored}' if ignored else '')
        if received is None:
            self._findings.note(
                'odometry', 'no odometry yet: using fallback_velocity' if timeout else '')
            self._velocity = self._fallback_velocity
            return self._fallback_limits.copy()
        self._velocity = self._signs * through_water
        limits = self._bounds(self._velocity)
        stale = received.age(now) > timeout
        text = ''
        if stale and timeout:
            since = ('since the clock went back' if received.time == NEVER
                     else f'for {_age(received, now)} s')
            text = f'no odometry {since}: using fallback_velocity where it is tighter'
        self._findings.note('odometry', text)
        if stale:
            limits[0] = np.maximum(limits[0], self._fallback_limits[0])
            limits[1] = np.minimum(limits[1], self._fallback_limits[1])
        return limits

    def _live_wrench(self, now: int) -> np.ndarray | None:
        """Return the command in frd axes, or None if none counts, and note a stop."""
        received = self._inputs.wrench
        live = received is not None and received.age(now) <= self._wrench_timeout
        self._findings.note('wrench', '' if live else 'no wrench: zero setpoints')
        self._findings.note('enable', '' if self._enabled else 'disabled: zero setpoints')
        return self._signs * received.values if live else None

    def _allocate(self, wrench: np.ndarray, limits: np.ndarray) -> None:
        allocation = self._problem.solve(wrench, limits)
        self._publish(limits, allocation.thrusts, allocation.achieved, allocation.unallocated)
        self._period.iterations.append(allocation.iterations)
        self._period.newest = allocation
        trouble = '' if allocation.solved else (
            f'OSQP reports {allocation.status}: setpoints inside the limits, but perhaps not the '
            'best')
        self._findings.note('solver', trouble, Level.ERROR)
        self._period.trouble = trouble or self._period.trouble
        if allocation.status == 'interrupted':  # OSQP swallows a SIGINT that comes while it works
            self.interrupted = True

    def _publish(self, limits: np.ndarray, thrusts: np.ndarray, achieved: np.ndarray,
                 unallocated: np.ndarray) -> None:
        """Publish one tick; wrenches are in frd axes."""
        self._limits_now, self._setpoints = limits, thrusts
        self._outputs.publish(
            limits, thrusts, self._signs * achieved, self._signs * unallocated,
            self.vehicle.thrusters, lambda: self._bounds.flow(self._velocity))

    def stop(self) -> None:
        """Publish zero setpoints for the last time and wait until they have been delivered."""
        self._timer.cancel()
        zeros = np.zeros_like(self._setpoints)
        try:
            self._publish(self._limits(self._now()), zeros, np.zeros(6), np.zeros(6))
        except Exception:  # what has ended the node may lie in there: zeros all the same
            self._outputs.publish_zero_setpoints()
        self._outputs.wait_until_delivered()
        time.sleep(LINGER)

    # Reports

    def _report(self) -> None:
        """Look for what no tick can see, and publish the diagnostics of the last period."""
        period, self._period = self._period, Period()
        now, inputs = self._now(), self._inputs
        vehicle, allocation = self.vehicle, period.newest
        for topic in ('cmd_wrench', 'thruster_setpoints'):
            count = self.count_publishers(self.resolve_topic_name(topic))
            self._findings.note(
                f'publishers of {topic}', f'{count} publishers on {topic}' if count > 1 else '')
        stands = self._simulated and now == self._last_report
        self._findings.note('clock', 'the clock stands: no ticks' if stands else '')
        self._last_report = now
        fresh = inputs.dropped - self._known_dropped
        self._known_dropped = inputs.dropped.copy()
        self._findings.note(
            'dropped', f'messages dropped: {", ".join(sorted(fresh))}' if fresh else '')
        self._findings.note('shortfall', shortfall(allocation, vehicle) if allocation else '')

        level, text = self._findings.overall()
        if period.trouble and level < Level.ERROR:
            level, text = Level.ERROR, f'{period.trouble}; {text}'
        self._diagnostics_publisher.publish(DiagnosticArray(
            header=Header(stamp=self.get_clock().now().to_msg()),
            status=[status_message(f'{self.get_name()}: allocation', level, text, {
                'age of wrench [s]': _age(inputs.wrench, now),
                'age of odometry [s]': _age(inputs.velocity, now),
                **allocation_figures(allocation, vehicle), **period.figures(),
                **{f'dropped: {cause}': str(n) for cause, n in sorted(inputs.dropped.items())},
            })]))

    def _draw(self) -> None:
        """Publish a picture of the last tick, if anybody looks."""
        if self._marker_publisher.get_subscription_count():
            self._marker_publisher.publish(thruster_markers(
                self.vehicle.thrusters, self._setpoints, self._limits_now, self._signs[:3],
                self._described.values['marker_frame'], self.get_clock().now().to_msg()))


def _period(rate: float) -> int:
    """Return the period of a rate [Hz] in ns."""
    if 1e9 / rate >= 2.0**63:
        raise ParameterError.wrong('rate', rate, 'large enough for its period to fit a clock')
    return round(1e9 / rate)


def _age(received: Received | None, now: int) -> str:
    return 'none' if received is None or received.time == NEVER else (
        f'{received.age(now) * 1e-9:.1f}')
