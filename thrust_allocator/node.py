"""The ROS 2 node: everything of ROS that the allocator needs, and no mathematics."""

import time

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped, Wrench
from nav_msgs.msg import Odometry
import numpy as np
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.clock import Clock, ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64MultiArray, Header
from std_srvs.srv import SetBool
from thrust_allocator.allocation import AllocationProblem
from thrust_allocator.bounds import rate_limited, ThrustBounds
from thrust_allocator.diagnosis import allocation_figures, Findings, Level, Period, shortfall
from thrust_allocator.frames import frd_signs
from thrust_allocator.inputs import Inputs, NEVER, Received
from thrust_allocator.messages import (
    array_message, fill_wrench, float64s, plain, quaternion_components, status_message,
    twist_components, vector_components, wrench_components)
from thrust_allocator.parameter_file import NODE_NAME
from thrust_allocator.parameter_types import Flag, ParameterError
from thrust_allocator.parameters import Parameters, read_parameters
from thrust_allocator.vehicle import Vehicle

# Best effort and depth 1 meet any publisher, and only the newest message counts
INPUT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
OUTPUT = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)

ACKNOWLEDGE = Duration(seconds=0.2)  # the longest wait for the last zeros to be acknowledged
LINGER = 0.1  # [s] more, for subscribers that acknowledge nothing
REPORT_PERIOD = 1.0  # [s] between diagnostics
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
        parameters = self._declare_vehicle()
        self._apply(parameters)
        self._problem = AllocationProblem(self.vehicle)
        for warning in [*parameters.warnings, *self.vehicle.warnings()]:
            self.get_logger().warning(warning)

        # The steady clock, so that setting the system clock changes nothing
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._simulated = self.get_parameter('use_sim_time').value
        self._tick_clock = self.get_clock() if self._simulated else steady
        self._inputs = Inputs()
        self._enabled = parameters.values['start_enabled']
        self._setpoints = np.zeros(len(self.vehicle.thrusters))  # last published ones [N]
        self._last_tick: int | None = None  # when it began, on the node's clock [ns]
        self._findings = Findings(self.get_logger())
        self._period = Period()
        self._last_report: int | None = None  # [ns]
        self._known_dropped = self._inputs.dropped.copy()
        self.interrupted = False  # whether OSQP has caught a SIGINT

        p = len(self.vehicle.thrusters)
        self._limits_message = array_message([('limits', 2), ('thrusters', p)])
        self._setpoints_message = array_message([('thrusters', p)])
        self._achieved_message, self._unallocated_message = Wrench(), Wrench()
        self._limits_publisher = self.create_publisher(Float64MultiArray, 'thrust_limits', OUTPUT)
        self._setpoints_publisher = self.create_publisher(
            Float64MultiArray, 'thruster_setpoints', OUTPUT)
        self._achieved_publisher = self.create_publisher(Wrench, 'achieved_wrench', OUTPUT)
        self._unallocated_publisher = self.create_publisher(Wrench, 'unallocated_wrench', OUTPUT)
        self._diagnostics_publisher = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self.create_subscription(Wrench, 'cmd_wrench', self._on_wrench, INPUT)
        self.create_subscription(Odometry, 'odom', self._on_odometry, INPUT)
        self.create_subscription(Vector3Stamped, 'current', self._on_current, INPUT)
        self.create_service(SetBool, '~/enable', self._on_enable)
        self.add_on_set_parameters_callback(self._check_change)
        self.add_post_set_parameters_callback(self._on_change)
        self._after_messages = self.create_guard_condition(self._tick)
        self.create_timer(REPORT_PERIOD, self._report, clock=steady)
        try:
            self._timer = self.create_timer(
                1.0 / parameters.values['rate'], self._on_timer, clock=self._tick_clock)
        except (OverflowError, TypeError):  # beyond a float, beyond 64 bits
            raise ParameterError.wrong('rate', parameters.values['rate'],
                                       'large enough for its period to fit a clock') from None
        if self._simulated:
            self._jump_handle = self._tick_clock.create_jump_callback(
                JumpThreshold(min_forward=None, min_backward=Duration(nanoseconds=-1)),
                post_callback=lambda jump: self._inputs.forget())

    # Parameters

    def _declare_vehicle(self) -> Parameters:
        """Take the overrides, check them, and declare every parameter with its value in effect."""
        given = self.get_parameters_by_prefix('')
        Flag().read('use_sim_time', given['use_sim_time'].value)
        own = {
            name: parameter.value for name, parameter in given.items()
            if name not in ('use_sim_time', 'start_type_description_service')
            and not name.startswith('qos_overrides.')}
        for name in own:
            self.undeclare_parameter(name)
        if 'thruster_names' not in own:
            raise ParameterError(
                'thruster_names: is missing, must be a list of names; does the top key of the '
                f"parameter file match the node's name, {self.get_fully_qualified_name()}?")
        parameters = read_parameters({name: plain(value) for name, value in own.items()})
        for name, value in parameters.values.items():
            definition = parameters.definitions[name]
            self.declare_parameter(name, value, ParameterDescriptor(
                description=' '.join(filter(None, (
                    definition.meaning, definition.unit and f'[{definition.unit}]'))),
                additional_constraints=str(definition.type),
                read_only=definition.name != 'enabled'), ignore_override=True)
        return parameters

    def _check_change(self, changes: list[Parameter]) -> SetParametersResult:
        if any(change.name == 'use_sim_time' for change in changes):
            return SetParametersResult(
                successful=False, reason='use_sim_time: is read-only, must be set at start')
        try:
            Vehicle.from_parameters(self._changed(changes))
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _on_change(self, changes: list[Parameter]) -> None:
        self._apply(self._changed(changes))

    def _changed(self, changes: list[Parameter]) -> Parameters:
        given = dict(self._described.values)
        given.update((change.name, plain(change.value)) for change in changes
                     if change.name in given)
        return read_parameters(given)

    def _apply(self, parameters: Parameters) -> None:
        """Put checked parameters in force from the next tick on."""
        values = parameters.values
        self._described = parameters
        self.vehicle = Vehicle.from_parameters(parameters)
        self._bounds = ThrustBounds(self.vehicle)
        self._signs = frd_signs(values['message_frame'])
        self._tick_period = 1e9 / values['rate']  # [ns]
        max_rates = np.array([thruster.max_rate for thruster in self.vehicle.thrusters])
        self._step = np.where(max_rates > 0.0, max_rates / values['rate'], np.inf)  # [N]
        fallback = np.array([*values['fallback_velocity'], 0.0, 0.0, 0.0])
        self._fallback_limits = self._bounds(self._signs * fallback)
        self._wrench_timeout, self._odometry_timeout, self._current_timeout = (
            round(values[f'{name}_timeout'] * 1e9) for name in ('wrench', 'odometry', 'current'))

    # Inputs

    def _on_wrench(self, message: Wrench) -> None:
        self._inputs.accept_wrench(wrench_components(message), self._now())

    def _on_odometry(self, message: Odometry) -> None:
        self._inputs.accept_odometry(
            twist_components(message.twist.twist),
            quaternion_components(message.pose.pose.orientation),
            message.header.frame_id, self._now())

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
        odometry, timeout = self._inputs.odometry, self._odometry_timeout
        velocity, ignored = self._inputs.velocity_through_water(now, self._current_timeout)
        self._findings.note('current', f'current ignored: {ignored}' if ignored else '')
        if odometry is None:
            self._findings.note(
                'odometry', 'no odometry yet: using fallback_velocity' if timeout else '')
            return self._fallback_limits.copy()
        limits = self._bounds(self._signs * velocity)
        stale = now - odometry.time > timeout
        since = ('since the clock went back' if odometry.time == NEVER
                 else f'for {_age(odometry, now)} s')
        self._findings.note(
            'odometry', f'no odometry {since}: using fallback_velocity where it is tighter'
            if stale and timeout else '')
        if stale:
            limits[0] = np.maximum(limits[0], self._fallback_limits[0])
            limits[1] = np.minimum(limits[1], self._fallback_limits[1])
        return limits

    def _live_wrench(self, now: int) -> np.ndarray | None:
        """Return the command in frd axes, or None if none counts, and note a stop."""
        received = self._inputs.wrench
        live = received is not None and now - received.time <= self._wrench_timeout
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
        self._setpoints = thrusts
        self._limits_message.data = float64s(limits)
        self._setpoints_message.data = float64s(thrusts)
        fill_wrench(self._achieved_message, self._signs * achieved)
        fill_wrench(self._unallocated_message, self._signs * unallocated)
        self._limits_publisher.publish(self._limits_message)
        self._setpoints_publisher.publish(self._setpoints_message)
        self._achieved_publisher.publish(self._achieved_message)
        self._unallocated_publisher.publish(self._unallocated_message)

    def stop(self) -> None:
        """Publish zero setpoints for the last time and wait until they have been delivered."""
        self._timer.cancel()
        zeros = np.zeros_like(self._setpoints)
        try:
            self._publish(self._limits(self._now()), zeros, np.zeros(6), np.zeros(6))
        except Exception:  # what has ended the node may lie in there: zeros all the same
            self._setpoints_message.data = float64s(zeros)
            self._setpoints_publisher.publish(self._setpoints_message)
        self._setpoints_publisher.wait_for_all_acked(ACKNOWLEDGE)
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
                'age of odometry [s]': _age(inputs.odometry, now),
                **allocation_figures(allocation, vehicle), **period.figures(),
                **{f'dropped: {cause}': str(n) for cause, n in sorted(inputs.dropped.items())},
            })]))


def _age(received: Received | None, now: int) -> str:
    return 'none' if received is None or received.time == NEVER else (
        f'{(now - received.time) * 1e-9:.1f}')
