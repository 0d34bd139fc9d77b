"""A peer that moves the node's clock tick by tick, and sees and does all that a pilot can."""

from collections.abc import Sequence
import math
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped
from nav_msgs.msg import Odometry
import numpy as np
from rcl_interfaces.msg import Log, SetParametersResult
import rclpy
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock as ClockMessage
from std_srvs.srv import SetBool
from support.optimum import daqp_optimum
from support.peer import Peer, TYPES_OUT
from thrust_allocator.diagnosis.findings import AFTERWARDS
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.ros.node import ThrustAllocator

PERIOD = 20 * 10**6  # of the default rate [ns]
SECOND = 10**9  # [ns]
LEVELS = {b'\x00': 'OK', b'\x01': 'WARN', b'\x02': 'ERROR'}
Tick = dict[str, np.ndarray]  # values by topic


class SteppedPeer(Peer):
    """
    Steps the node through simulated time: each step sends the inputs and lasts one tick.

    The node must have been started with use_sim_time. Reports come when they are asked for.
    """

    def __init__(self, context: rclpy.Context, *, beside: ThrustAllocator) -> None:
        """Start the clock, and have the node report only when it is asked."""
        super().__init__(context, beside=beside, name='stepped_peer')
        self.node = beside
        self.bounds = ThrustBounds(beside.vehicle)  # of frd velocities
        self.time = 1000 * SECOND  # [ns]
        self.orientation = [0.0, 0.0, 0.0, 1.0]  # sent in the odometry
        self.frame = 'odom'  # sent in the odometry and the current
        self.current: Sequence[float] | None = None  # sent at every step; None: not sent
        self.statuses: list[Any] = []  # of /diagnostics
        self.logs: list[tuple[int, str]] = []  # (level, text) of what the node logs
        self.ticks_seen = 0
        self.on_tick = self._count
        best_effort = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._clock_publisher = self.create_publisher(ClockMessage, '/clock', 1)
        self._current_publisher = self.create_publisher(Vector3Stamped, 'current', best_effort)
        self.create_subscription(
            DiagnosticArray, '/diagnostics', lambda message: self.statuses.extend(message.status),
            100)
        self.create_subscription(Log, '/rosout', self._on_log, 1000)
        self._enable = self.create_client(SetBool, f'{beside.get_name()}/enable')
        self._parameters = AsyncParameterClient(self, beside.get_name())
        beside.report_due = math.inf
        ends = [*self._inputs.values(), self._current_publisher, self._clock_publisher]
        self.wait_until(lambda: all(end.get_subscription_count() for end in ends)
                        and self._enable.service_is_ready()
                        and self._parameters.services_are_ready(), 'the node on the graph')

    def _count(self) -> None:
        self.ticks_seen += 1

    def _on_log(self, message: Log) -> None:
        if message.name == self.node.get_name():
            self.logs.append((message.level, message.msg))

    def logged(self, text: str) -> list[str]:
        """Return what the node has logged with `text` in it, as 'WARN: ...'."""
        names = {20: 'INFO', 30: 'WARN', 40: 'ERROR'}
        return [f'{names[level]}: {line}' for level, line in self.logs if text in line]

    # Inputs

    def send_twist(self, twist: Sequence[float]) -> None:
        """Send one odometry message with the present orientation and frame, message axes."""
        message = Odometry()
        message.header.frame_id = self.frame
        linear, angular = message.twist.twist.linear, message.twist.twist.angular
        turn = message.pose.pose.orientation
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z = map(float, twist)
        turn.x, turn.y, turn.z, turn.w = map(float, self.orientation)
        self._inputs['odom'].publish(message)

    def send_current(self, velocity: Sequence[float], frame: str | None = None) -> None:
        """Send one current, in the axes of a frame, the odometry's if it is not given."""
        message = Vector3Stamped()
        message.header.frame_id = self.frame if frame is None else frame
        message.vector.x, message.vector.y, message.vector.z = map(float, velocity)
        self._current_publisher.publish(message)

    def send(self) -> None:
        """Send the present current, twist and wrench, those that are not None."""
        if self.current is not None:
            self.send_current(self.current)
        super().send()

    def enable(self, on: bool) -> SetBool.Response:
        """Call ~/enable; no time passes."""
        return self._result(self._enable.call_async(SetBool.Request(data=on)))

    def switch(self, **thrusters: bool) -> list[SetParametersResult]:
        """Set `enabled` of thrusters over the parameter service; no time passes."""
        return self.set_parameters_of_node(
            [Parameter(f'thrusters.{name}.enabled', value=on) for name, on in thrusters.items()])

    def set_parameters_of_node(self, parameters: list[Parameter],
                               atomically: bool = False) -> list[SetParametersResult]:
        """Set parameters over the node's service; no time passes."""
        if atomically:
            return [self._result(self._parameters.set_parameters_atomically(parameters)).result]
        return self._result(self._parameters.set_parameters(parameters)).results

    def _result(self, future: Any) -> Any:
        self.wait_until(future.done, 'the answer of a service')
        return future.result()

    # Time

    def pulse(self) -> None:
        """Publish the present time, and spin until the node has read it."""
        message = ClockMessage()
        message.clock.sec, message.clock.nanosec = divmod(self.time, SECOND)
        self._clock_publisher.publish(message)
        self.wait_until(lambda: self.node.get_clock().now().nanoseconds == self.time,
                        'the node to take the time')

    def step(self, wrench: Sequence[float] | None = None, twist: Sequence[float] | None = None,
             period: int = PERIOD) -> Tick:
        """Send the inputs, those given here from now on, and return the next tick."""
        self.wrench = self.wrench if wrench is None else wrench
        self.twist = self.twist if twist is None else twist
        self.received.clear()
        before = self.ticks_seen
        self.send()
        self.time += period
        self.pulse()
        self.wait_until(lambda: self.ticks_seen > before, 'a tick')
        assert self.ticks_seen == before + 1
        assert [item.topic for item in self.received] == list(TYPES_OUT)
        return {item.topic: item.values for item in self.received}

    def steps(self, count: int, *inputs: Sequence[float]) -> list[Tick]:
        """Return the next `count` ticks."""
        return [self.step(*inputs) for _ in range(count)]

    def silence(self, *inputs: str) -> None:
        """Stop to send these inputs: 'wrench', 'twist', 'current'."""
        for name in inputs:
            setattr(self, name, None)

    # Reports

    def report(self) -> tuple[str, str, dict[str, str]]:
        """Have the node report, and return its level, its message and its figures."""
        known = len(self.statuses)
        self.node.report()
        self.node.report_due = math.inf
        self.wait_until(lambda: len(self.statuses) > known, 'diagnostics')
        status = self.statuses[-1]
        return (LEVELS[status.level], status.message,
                {pair.key: pair.value for pair in status.values})

    def report_later(self) -> tuple[str, str, dict[str, str]]:
        """Have the node report once what was wrong before is over: 2 s later, inputs going on."""
        self.steps(AFTERWARDS // PERIOD + 1)
        self.report()  # by which what the ticks until now were short of is gone
        self.steps(AFTERWARDS // PERIOD + 1)
        return self.report()

    def limits_at(self, *velocity: float) -> np.ndarray:
        """Return the limits (10,) at a velocity through the water, in frd axes."""
        return self.bounds(np.array([*velocity, *[0.0] * (6 - len(velocity))])).ravel()


def is_stopped(tick: Tick) -> bool:
    """Tell whether setpoints and achieved wrench are exact zeros."""
    return not tick['thruster_setpoints'].any() and not tick['achieved_wrench'].any()


def inside_limits(tick: Tick) -> bool:
    """Tell whether all setpoints are finite and inside the limits of the tick."""
    lower, upper = tick['thrust_limits'].reshape(2, -1)
    thrusts = tick['thruster_setpoints']
    return bool(np.isfinite(thrusts).all() and (lower <= thrusts).all()
                and (thrusts <= upper).all())


def rest_of(wrench: Sequence[float], tick: Tick) -> float:
    """Return the greatest part of a wrench that is neither achieved nor told as unallocated."""
    return np.abs(tick['achieved_wrench'] + tick['unallocated_wrench'] - wrench).max()


def assert_optimal(vehicle: Vehicle, tick: Tick, wrench: Sequence[float]) -> None:
    """Compare the setpoints with daqp's optimum for the limits published with them, frd axes."""
    limits = tick['thrust_limits'].reshape(2, -1).copy()
    used = limits[0] < limits[1]
    assert not tick['thruster_setpoints'][~used].any()
    limits[:, ~used] = [[-1e-9], [1e-9]]  # daqp likes no equal bounds
    np.testing.assert_allclose(tick['thruster_setpoints'],
                               daqp_optimum(vehicle, np.array(wrench), limits), atol=1e-4)
