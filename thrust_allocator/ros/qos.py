"""The quality of service of the node's topics, and what a user may override of it."""

from collections.abc import Mapping
from typing import Any

from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from thrust_allocator.parameters.types import ParameterError

# Best effort and depth 1 meet any publisher, and only the newest message counts
INPUT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
OUTPUT = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)

ALLOWED = {
    'history': ('keep_last', 'keep_all', 'system_default'), 'depth': None,
    'reliability': ('reliable', 'best_effort', 'system_default'),
    'durability': ('volatile', 'transient_local', 'system_default')}
OVERRIDABLE = QoSOverridingOptions([QoSPolicyKind[policy.upper()] for policy in ALLOWED])
PREFIX = 'qos_overrides.'
OF_EVERY_NODE = ('/rosout', '/parameter_events', '/clock')  # topics that rclpy itself opens


def check_overrides(values: Mapping[str, Any]) -> None:
    """
    Refuse overrides that rclpy would not understand.

    :param values: of all parameters by name; others are passed over.
    :raises ParameterError: for a value that is not allowed.
    """
    for name, value in values.items():
        policy = name.rpartition('.')[2]
        if not name.startswith(PREFIX) or policy not in ALLOWED:
            continue
        if policy == 'depth':
            if isinstance(value, bool) or not isinstance(value, int) or value < 0:
                raise ParameterError.wrong(name, value, 'a whole number, 0 or more')
        elif value not in ALLOWED[policy]:
            raise ParameterError.wrong(name, value, f'one of {", ".join(ALLOWED[policy])}')


def unused_overrides(node: Node) -> list[str]:
    """Return the names of overrides that are given but are for none of the node's topics."""
    known = {f'{PREFIX}{one.topic_name}.{kind}.{policy}'
             for kind, ends in (('publisher', node.publishers),
                                ('subscription', node.subscriptions))
             for one in ends for policy in ALLOWED}
    with node.handle:  # what rcl has read, declared or not
        given = node.handle.get_parameters(Parameter)
    return sorted(name for name in given
                  if name.startswith(PREFIX) and name not in known
                  and not name.startswith(tuple(f'{PREFIX}{topic}.' for topic in OF_EVERY_NODE)))
