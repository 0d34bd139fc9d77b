"""The node's own topics, under the names that remapping gives them."""

from rclpy.node import Node
from thrust_allocator.parameters.types import ParameterError

OUTPUTS = ('thrust_limits', 'thruster_setpoints', 'achieved_wrench', 'unallocated_wrench',
           'thruster_states', 'thruster_markers', '/diagnostics')


def check_topics(node: Node, velocity_type: str) -> None:
    """
    Refuse remapping that makes two of the node's topics one: it would command itself.

    :raises ParameterError: with the names of both.
    """
    inputs = ('cmd_wrench', *(('odom', 'current') if velocity_type == 'odometry' else ('twist',)))
    known: dict[str, str] = {}
    for name in (*inputs, *OUTPUTS):
        topic = node.resolve_topic_name(name)
        if other := known.get(topic):
            raise ParameterError(f'{other} and {name}: are both {topic} after remapping, must be '
                                 'two topics')
        known[topic] = name
