"""The process whose cost is measured: our node, or a bare relay with the same wiring."""

from collections.abc import Callable, Sequence
import json
import sys
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped, Wrench
from nav_msgs.msg import Odometry
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import SetBool
from thrust_allocator.parameters.file import NODE_NAME
from thrust_allocator.ros import process
from thrust_allocator.ros.messages import array_message
from thrust_allocator.ros.node import ThrustAllocator
from thrust_allocator.ros.parameters import Start
from thrust_allocator.ros.qos import INPUT, OUTPUT
from visualization_msgs.msg import MarkerArray

THRUSTERS = 5  # of MT-2012
EXECUTORS = {'SingleThreadedExecutor': SingleThreadedExecutor, 'EventsExecutor': EventsExecutor}


class Relay(Node):
    """The least that a node with our node's topics can do: publish what came last."""

    def __init__(self, start: Start, **options: Any) -> None:
        super().__init__(NODE_NAME, automatically_declare_parameters_from_overrides=True,
                         parameter_overrides=start.overrides, **options)
        self.interrupted = False
        self._command = Wrench()
        self._velocity = Odometry()
        self._limits = array_message([('limits', 2), ('thrusters', THRUSTERS)])
        self._setpoints = array_message([('thrusters', THRUSTERS)])
        self._limits.data, self._setpoints.data = 2 * THRUSTERS * [0.0], THRUSTERS * [0.0]
        self._nothing, self._diagnostics = Wrench(), DiagnosticArray()
        self._publishers_of_a_tick = [
            self.create_publisher(kind, topic, OUTPUT) for kind, topic in (
                (Float64MultiArray, 'thrust_limits'), (Float64MultiArray, 'thruster_setpoints'),
                (Wrench, 'achieved_wrench'), (Wrench, 'unallocated_wrench'))]
        publisher = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        states = self.create_publisher(JointState, 'thruster_states', OUTPUT)
        markers = self.create_publisher(MarkerArray, 'thruster_markers', 1)
        self.create_subscription(Wrench, 'cmd_wrench', self._on_wrench, INPUT)
        self.create_subscription(Odometry, 'odom', self._on_odometry, INPUT)
        self.create_subscription(Vector3Stamped, 'current', lambda message: None, INPUT)
        self.create_service(SetBool, '~/enable', lambda request, response: response)
        self.create_guard_condition(lambda: None)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(1.0, lambda: publisher.publish(self._diagnostics), clock=steady)
        self.create_timer(
            0.2, lambda: (states.get_subscription_count(), markers.get_subscription_count()),
            clock=steady)
        self._timer = self.create_timer(
            1.0 / self.get_parameter('rate').value, self._tick, clock=steady)

    def _on_wrench(self, message: Wrench) -> None:
        self._command = message

    def _on_odometry(self, message: Odometry) -> None:
        self._velocity = message

    def _tick(self) -> None:
        for publisher, message in zip(self._publishers_of_a_tick, (
                self._limits, self._setpoints, self._command, self._nothing)):
            publisher.publish(message)

    def stop(self) -> None:
        """Do nothing: a relay has nothing to bring to rest."""


NODES = {'thrust_allocator': ThrustAllocator, 'relay': Relay}


class DirectCall:
    """Stands for a guard condition where there can be none: triggering calls at once."""

    def __init__(self, callback: Callable[[], None]) -> None:
        self.trigger = callback


def timed(kind: type[Node], times: dict[float, list[int]], guards: bool) -> type[Node]:
    """
    Return a kind of node that notes how long each call of a timer takes, by period [s, ns].

    :param guards: whether the executor takes guard conditions; EventsExecutor does not (7.1.6).
    """
    class Timed(kind):
        def create_guard_condition(self, callback: Callable[[], None], *arguments: Any) -> Any:
            if guards:
                return super().create_guard_condition(callback, *arguments)
            return DirectCall(callback)

        def create_timer(self, timer_period_sec: float, callback: Callable[[], None],
                         *arguments: Any, **options: Any) -> Any:
            noted = times.setdefault(timer_period_sec, [])

            def call() -> None:
                begin = time.perf_counter_ns()
                callback()
                noted.append(time.perf_counter_ns() - begin)

            return super().create_timer(timer_period_sec, call, *arguments, **options)

        def __init__(self, **options: Any) -> None:
            super().__init__(**options)
            print(json.dumps(wiring(self)), flush=True)

    return Timed


def wiring(node: Node) -> list[str]:
    """Return what the executor has to watch, and what is published."""
    within = node.get_namespace()
    names = [f'{kind} {name.removeprefix(within)}' for kind, found in (
        ('publisher', [one.topic_name for one in node.publishers]),
        ('subscription', [one.topic_name for one in node.subscriptions]),
        ('service', [one.service_name for one in node.services])) for name in found]
    timers = [f'timer of {one.timer_period_ns} ns' for one in node.timers]
    return sorted([*names, *timers, f'{len(list(node.guards))} guard conditions'])


def main(args: Sequence[str]) -> int:
    """Run the node's own process with another node or executor in it; say at its end how long."""
    kind, executor, *ros_arguments = args[1:]
    times: dict[float, list[int]] = {}
    process.ThrustAllocator = timed(NODES[kind], times, executor != 'EventsExecutor')
    for name in EXECUTORS:
        if hasattr(process, name):
            setattr(process, name, EXECUTORS[executor])
    status = process.main([args[0], *ros_arguments])
    print(json.dumps(times[min(times)]), flush=True)
    return status


if __name__ == '__main__':
    sys.exit(main(sys.argv))
