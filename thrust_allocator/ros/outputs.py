"""The topics that carry each tick's result, in the units and under the names that users want."""

from array import array
from collections.abc import Sequence
import math
import time

from geometry_msgs.msg import Vector3, Wrench
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, Float64MultiArray
from thrust_allocator.ros.cdr import Template
from thrust_allocator.ros.messages import array_message
from thrust_allocator.ros.qos import OUTPUT, OVERRIDABLE
from thrust_allocator.setpoints import SETPOINTS
from thrust_allocator.tick import Tick

ACKNOWLEDGE = 0.2  # the longest wait for the last setpoints to be acknowledged [s]
ZERO = array('d', [0.0]).tobytes()


class Outputs:
    """Publishers of limits, setpoints and wrenches, which send one tick at a time."""

    def __init__(self, node: Node, names: Sequence[str], setpoint_unit: str) -> None:
        """
        Create the publishers.

        :param names: of the p thrusters.
        :param setpoint_unit: of `thruster_setpoints`, a key of SETPOINTS.
        """
        p = len(names)
        self._node = node
        self._in_unit = SETPOINTS[setpoint_unit]
        self._limits = _array_template([('limits', 2), ('thrusters', p)])
        self._setpoints = _array_template([('thrusters', p)])
        self._wrench, self._thrust = _wrench_template(), _thrust_template()
        self._states = JointState(name=list(names))
        self._limits_publisher = self._create(Float64MultiArray, 'thrust_limits')
        self._setpoints_publisher = self._create(Float64MultiArray, 'thruster_setpoints')
        self._achieved_publisher = self._create(Wrench, 'achieved_wrench')
        self._unallocated_publisher = self._create(Wrench, 'unallocated_wrench')
        self._states_publisher = self._create(JointState, 'thruster_states')
        self._individual: list[Publisher] = []
        self._individually = False

    def _create(self, kind: type, topic: str) -> Publisher:
        return self._node.create_publisher(
            kind, topic, OUTPUT, qos_overriding_options=OVERRIDABLE)

    def publish_individually(self, on: bool) -> None:
        """Have each thrust on a topic `thrusters/<name>/thrust` too, or end with zeros there."""
        if on and not self._individual:
            self._individual = [
                self._create(Float64, f'thrusters/{name}/thrust')
                for name in self._states.name]
        elif self._individually and not on:
            for publisher in self._individual:
                publisher.publish(self._thrust.filled(ZERO))
        self._individually = on

    def publish(self, tick: Tick) -> None:
        """Publish one tick."""
        wanted = tick.thrusts.tolist()
        setpoints = array('d', self._in_unit(wanted, tick.models, tick.flow))
        self._limits_publisher.publish(self._limits.filled(tick.limits.tobytes()))
        self._setpoints_publisher.publish(self._setpoints.filled(setpoints.tobytes()))
        for publisher, wrench in ((self._achieved_publisher, tick.achieved),
                                  (self._unallocated_publisher, tick.unallocated)):
            publisher.publish(self._wrench.filled(
                (wrench + 0.0).tobytes()))  # + 0.0 turns -0.0 into 0.0
        if self._individually:
            for publisher, thrust in zip(self._individual, tick.thrusts):
                publisher.publish(self._thrust.filled(thrust.tobytes()))
        if self._states_publisher.get_subscription_count():
            self._states.header.stamp = self._node.get_clock().now().to_msg()
            self._states.effort = array('d', wanted)
            self._states.position = array('d', [
                model.deflection(thrust, *motion)
                for model, thrust, motion in zip(tick.models, wanted, tick.flow)])
            self._states_publisher.publish(self._states)

    def publish_zero_setpoints(self) -> None:
        """Publish zeros and nothing else, when the rest of the node has failed."""
        self._setpoints_publisher.publish(
            self._setpoints.filled(len(self._states.name) * ZERO))
        for publisher in self._individual:
            publisher.publish(self._thrust.filled(ZERO))

    def wait_until_delivered(self) -> None:
        """Wait, though not for long, until reliable subscribers have the last setpoints."""
        deadline = time.monotonic() + ACKNOWLEDGE
        for publisher in (self._setpoints_publisher, *self._individual):
            publisher.wait_for_all_acked(Duration(seconds=max(0.0, deadline - time.monotonic())))


def _marks(count: int) -> array:
    """Return numbers that stand nowhere else in a message."""
    return array('d', [i + 1 / 3 for i in range(count)])


def _array_template(dimensions: list[tuple[str, int]]) -> Template:
    message = array_message(dimensions)
    message.data = _marks(math.prod(size for _, size in dimensions))
    return Template(message, message.data.tobytes())


def _wrench_template() -> Template:
    marks = _marks(6)
    message = Wrench(force=Vector3(x=marks[0], y=marks[1], z=marks[2]),
                     torque=Vector3(x=marks[3], y=marks[4], z=marks[5]))
    return Template(message, marks.tobytes())


def _thrust_template() -> Template:
    mark, = marks = _marks(1)
    return Template(Float64(data=mark), marks.tobytes())
