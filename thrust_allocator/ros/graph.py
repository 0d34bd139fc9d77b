"""Who else is on the node's topics: other types, policies that do not meet, and rivals."""

from collections.abc import Iterable, Mapping, Sequence

from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.topic_endpoint_info import TopicEndpointInfo
from thrust_allocator.ros.qos import OF_EVERY_NODE

UNKNOWN = '_NODE_NAME_UNKNOWN_'  # what rmw calls whom the graph does not know


def publishers(node: Node, topic: str) -> list[str]:
    """Return the full names of the nodes that publish on a topic, one for each publisher."""
    return [_name(one) for one in node.get_publishers_info_by_topic(node.resolve_topic_name(topic))]


def mismatches(node: Node, hints: Mapping[str, str]) -> dict[str, str]:
    """
    Return who cannot be heard by the node, or cannot hear it, by topic; one line each.

    :param hints: by full topic name, what to do about another type.
    """
    # Where as many are matched as there are, all hear each other: there is nothing to look for,
    # which takes a hundred times as long
    ends = {(one.topic_name, True) for one in node.publishers
            if one.get_subscription_count() != node.count_subscribers(one.topic_name)} | {
        (one.topic_name, False) for one in node.subscriptions
        if one.get_publisher_count() != node.count_publishers(one.topic_name)}
    found = {}
    for topic, sends in sorted(ends):
        if topic in OF_EVERY_NODE:
            continue
        both = [look(topic) for look in (node.get_publishers_info_by_topic,
                                         node.get_subscriptions_info_by_topic)]
        ours, others = both if sends else both[::-1]
        texts = _mismatches(_of(node, ours), others, sends, hints.get(topic, ''))
        if texts:
            found[topic] = f'{topic}: ' + '; '.join(dict.fromkeys(texts))
    return found


def _mismatches(ours: TopicEndpointInfo | None, others: Iterable[TopicEndpointInfo], sends: bool,
                hint: str) -> list[str]:
    if ours is None:  # the graph does not have it yet
        return []
    texts = []
    for other in others:
        if other.topic_type != ours.topic_type:
            does, we = ('expects', 'sends') if sends else ('sends', 'expects')
            texts.append(f'{_name(other)} {does} {other.topic_type}, this node {we} '
                         f'{ours.topic_type}{hint and f" ({hint})"}')
            continue
        publisher, subscription = (ours, other) if sends else (other, ours)
        compatible, reason = qos_check_compatible(publisher.qos_profile, subscription.qos_profile)
        if compatible == QoSCompatibility.ERROR:
            texts.append(f'the QoS of {_name(other)} does not meet that of this node: '
                         + ', '.join(_errors(reason)))
    return texts


def _of(node: Node, ends: Sequence[TopicEndpointInfo]) -> TopicEndpointInfo | None:
    own = node.get_fully_qualified_name()
    return next((one for one in ends if _name(one) == own), None)


def _name(end: TopicEndpointInfo) -> str:
    if end.node_name.startswith(UNKNOWN):
        return 'one that is no node of ROS, or not known yet'
    return f'{end.node_namespace.rstrip("/")}/{end.node_name}'


def _errors(reason: str) -> list[str]:
    """Return the parts of the middleware's reason, in its own words."""
    return [part.replace('ERROR:', '').strip() for part in reason.split(';') if 'ERROR:' in part]
