"""The ROS 2 node: everything of ROS that the allocator needs, and no mathematics."""

from array import array
from collections.abc import Sequence
import math
import signal
import sys
import time

from geometry_msgs.msg import Twist, Wrench
from nav_msgs.msg import Odometry
import numpy as np
from rcl_interfaces.msg import ParameterDescriptor
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray, MultiArrayDimension
from thrust_allocator.allocation import Allocation, AllocationProblem
from thrust_allocator.bounds import ThrustBounds
from thrust_allocator.frames import frd_signs
from thrust_allocator.parameter_file import (
    check_parameter_file, command_line_values, default_parameter_file, NODE_NAME)
from thrust_allocator.parameter_types import ParameterError
from thrust_allocator.parameters import Parameters, read_parameters
from thrust_allocator.vehicle import Vehicle

# Best effort and depth 1 meet any publisher, and only the newest message counts
INPUT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
OUTPUT = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)

LARGEST_WRENCH = np.full(6, 1e6)  # [N, N*m]; beyond these a message is taken for broken
LARGEST_TWIST = np.full(6, 50.0)  # [m/s, rad/s]
ACKNOWLEDGE = Duration(seconds=0.2)  # the longest wait for the last zeros to be acknowledged
LINGER = 0.1  # [s] more, for subscribers that acknowledge nothing


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
        values = parameters.values
        self.vehicle = Vehicle.from_parameters(parameters)
        self._bounds = ThrustBounds(self.vehicle)
        self._problem = AllocationProblem(self.vehicle)
        for warning in [*parameters.warnings, *self.vehicle.warnings()]:
            self.get_logger().warning(warning)

        self._signs = frd_signs(values['message_frame'])
        self._velocity = np.zeros(6)  # of the body origin, frd axes
        self._wrench = np.zeros(6)  # newest command, frd axes
        self._wrench_time: int | None = None  # when it came [ns], or None
        self._wrench_timeout = round(values['wrench_timeout'] * 1e9)  # [ns]
        self._allocating = True  # so that the first tick says so if it is not
        self._last_status = 'solved'

        p = len(self.vehicle.thrusters)
        self._limits_message = _array_message([('limits', 2), ('thrusters', p)])
        self._setpoints_message = _array_message([('thrusters', p)])
        self._limits_publisher = self.create_publisher(Float64MultiArray, 'thrust_limits', OUTPUT)
        self._setpoints_publisher = self.create_publisher(
            Float64MultiArray, 'thruster_setpoints', OUTPUT)
        self._achieved_publisher = self.create_publisher(Wrench, 'achieved_wrench', OUTPUT)
        self._unallocated_publisher = self.create_publisher(Wrench, 'unallocated_wrench', OUTPUT)
        self.create_subscription(Wrench, 'cmd_wrench', self._on_wrench, INPUT)
        self.create_subscription(Odometry, 'odom', self._on_odometry, INPUT)

        # The steady clock, so that setting the system clock changes nothing
        simulated = self.get_parameter('use_sim_time').value
        self._tick_clock = self.get_clock() if simulated else Clock(
            clock_type=ClockType.STEADY_TIME)
        try:
            self._timer = self.create_timer(
                1.0 / values['rate'], self._tick, clock=self._tick_clock)
        except OverflowError:
            raise ParameterError.wrong(
                'rate', values['rate'], 'large enough for its period to fit a clock') from None

    def _declare_vehicle(self) -> Parameters:
        """Take the overrides, check them, and declare every parameter with its value in effect."""
        own = {
            name: parameter.value for name, parameter in self.get_parameters_by_prefix('').items()
            if name not in ('use_sim_time', 'start_type_description_service')
            and not name.startswith('qos_overrides.')}
        for name in own:
            self.undeclare_parameter(name)
        if 'thruster_names' not in own:
            raise ParameterError(
                'thruster_names: is missing, must be a list of names; does the top key of the '
                f"parameter file match the node's name, {self.get_fully_qualified_name()}?")
        parameters = read_parameters({
            name: list(value) if isinstance(value, array) else value
            for name, value in own.items()})
        for name, value in parameters.values.items():
            if value is not None:
                definition = parameters.definitions[name]
                self.declare_parameter(name, value, ParameterDescriptor(
                    description=' '.join(filter(None, (
                        definition.meaning, definition.unit and f'[{definition.unit}]'))),
                    additional_constraints=str(definition.type), read_only=True),
                    ignore_override=True)
        return parameters

    def _on_wrench(self, message: Wrench) -> None:
        wrench = wrench_components(message)
        if self._is_sane('cmd_wrench', wrench, LARGEST_WRENCH):
            self._wrench = self._signs * wrench
            self._wrench_time = self._tick_clock.now().nanoseconds

    def _on_odometry(self, message: Odometry) -> None:
        velocity = twist_components(message.twist.twist)
        if self._is_sane('odom', velocity, LARGEST_TWIST):
            self._velocity = self._signs * velocity

    def _is_sane(self, topic: str, values: np.ndarray, largest: np.ndarray) -> bool:
        sane = bool((np.abs(values) <= largest).all())  # false for NaN too
        if not sane:
            self.get_logger().warning(
                f'dropped a message on {topic}: {values.tolist()} is not finite or beyond '
                f'{largest[0]:g}', throttle_duration_sec=1.0)
        return sane

    def _tick(self) -> None:
        limits = self._bounds(self._velocity)
        live = self._wrench_is_live()
        self._report_whether_allocating(live)
        if not live:
            self._publish(limits, np.zeros(limits.shape[1]), np.zeros(6), np.zeros(6))
            return
        allocation = self._problem.solve(self._wrench, limits)
        self._report_status(allocation)
        self._publish(limits, allocation.thrusts, allocation.achieved, allocation.unallocated)
        if allocation.status == 'interrupted':  # OSQP swallows a SIGINT that comes while it works
            raise KeyboardInterrupt

    def _wrench_is_live(self) -> bool:
        if self._wrench_time is None:
            return False
        return self._tick_clock.now().nanoseconds - self._wrench_time <= self._wrench_timeout

    def _publish(self, limits: np.ndarray, thrusts: np.ndarray, achieved: np.ndarray,
                 unallocated: np.ndarray) -> None:
        self._limits_message.data = array('d', limits.tobytes())
        self._setpoints_message.data = array('d', thrusts.tobytes())
        self._limits_publisher.publish(self._limits_message)
        self._setpoints_publisher.publish(self._setpoints_message)
        self._achieved_publisher.publish(_wrench_message(self._signs * achieved))
        self._unallocated_publisher.publish(_wrench_message(self._signs * unallocated))

    def _report_whether_allocating(self, live: bool) -> None:
        if live != self._allocating:
            self._allocating = live
            if live:
                self.get_logger().info('allocating')
            else:
                self.get_logger().warning(
                    f'no wrench on {self.resolve_topic_name("cmd_wrench")}: zero setpoints')

    def _report_status(self, allocation: Allocation) -> None:
        if allocation.status != self._last_status:
            self._last_status = allocation.status
            if allocation.solved:
                self.get_logger().info('OSQP reports solved again')
            else:
                self.get_logger().error(f'OSQP reports {allocation.status}: the setpoints are '
                                        'inside the limits, but may not be the best')

    def stop(self) -> None:
        """Publish zero setpoints for the last time and wait until they have been delivered."""
        self._timer.cancel()
        zeros = np.zeros(len(self.vehicle.thrusters))
        self._publish(self._bounds(self._velocity), zeros, np.zeros(6), np.zeros(6))
        self._setpoints_publisher.wait_for_all_acked(ACKNOWLEDGE)
        time.sleep(LINGER)


def wrench_components(message: Wrench) -> np.ndarray:
    """Return force and torque as they stand in the message, (6,) [N, N*m]."""
    force, torque = message.force, message.torque
    return np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])


def twist_components(message: Twist) -> np.ndarray:
    """Return linear and angular velocity as they stand in the message, (6,) [m/s, rad/s]."""
    linear, angular = message.linear, message.angular
    return np.array([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z])


def _wrench_message(wrench: np.ndarray) -> Wrench:
    message = Wrench()
    force, torque = message.force, message.torque
    force.x, force.y, force.z, torque.x, torque.y, torque.z = wrench.tolist()
    return message


def _array_message(dimensions: list[tuple[str, int]]) -> Float64MultiArray:
    message = Float64MultiArray()
    sizes = [size for _, size in dimensions]
    message.layout.dim = [
        MultiArrayDimension(label=label, size=size, stride=math.prod(sizes[i:]))
        for i, (label, size) in enumerate(dimensions)]
    return message


def main(args: Sequence[str] | None = None) -> int:
    """
    Run the node until SIGINT or SIGTERM.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0 after a signal, 1 for a mistake in the parameters.
    """
    args = list(sys.argv if args is None else args)
    stopping: list[int] = []  # signals received
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: stopping.append(number))
    try:
        files = [file for option, file in zip(args, args[1:]) if option == '--params-file']
        for file in files:
            check_parameter_file(file)
        if not files:
            default = str(default_parameter_file())
            args[1:1] = ['--ros-args', '--params-file', default, '--']
        # What rcl logs of a mistake in the arguments stands in its exception too
        rclpy.logging.set_logger_level('rcl', rclpy.logging.LoggingSeverity.FATAL)
        # rclpy's own handlers would end the context before the last zeros are out
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        rclpy.logging.set_logger_level('rcl', rclpy.logging.LoggingSeverity.UNSET)
        # rcl drops a value from the command line if a file gives one of another type
        node = ThrustAllocator(parameter_overrides=[
            Parameter(name, value=value) for name, value in command_line_values(args).items()])
    except (ParameterError, ParameterException, RuntimeError) as error:
        print(f'{NODE_NAME}: {" ".join(str(error).split())}', file=sys.stderr)
        rclpy.try_shutdown()
        return 1
    if not files:
        node.get_logger().warning(f'no parameter file given: running MT-2012 from {default}')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        while not stopping:
            executor.spin_once(timeout_sec=0.1)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if rclpy.ok():
            node.stop()
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main())
