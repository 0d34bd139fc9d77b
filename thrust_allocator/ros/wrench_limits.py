"""The topic `wrench_limits`: what a controller or planner could still ask for."""

from array import array

from rclpy.node import Node
from std_msgs.msg import Float64MultiArray
from thrust_allocator.ros.messages import array_message
from thrust_allocator.ros.outputs import OUTPUT
from thrust_allocator.ros.qos import OVERRIDABLE
from thrust_allocator.tick import Allocator, Tick


class WrenchLimits:
    """A publisher that computes nothing while nobody listens."""

    def __init__(self, node: Node) -> None:
        """Create the publisher."""
        self._message = array_message([('limits', 2), ('components', 6)])
        self._publisher = node.create_publisher(
            Float64MultiArray, 'wrench_limits', OUTPUT, qos_overriding_options=OVERRIDABLE)

    def publish(self, allocator: Allocator, tick: Tick) -> str:
        """Publish those of a tick, if anybody listens; return why not, or ''."""
        if self._publisher.get_subscription_count():
            limits = allocator.wrench_limits(tick)
            if limits is None:
                return 'no wrench_limits: this vehicle\'s attainable set has too many faces'
            self._message.data = array('d', limits.tobytes())
            self._publisher.publish(self._message)
        return ''
