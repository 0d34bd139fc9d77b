"""Which topic of a bag is what: the node's names, found under a namespace or given by hand."""

from collections.abc import Mapping

from thrust_allocator.replay.errors import ReplayError

# What each name of the node's contract may carry
TYPES = {
    'cmd_wrench': ('geometry_msgs/msg/Wrench', 'geometry_msgs/msg/WrenchStamped'),
    'odom': ('nav_msgs/msg/Odometry',),
    'twist': ('geometry_msgs/msg/TwistStamped', 'geometry_msgs/msg/TwistWithCovarianceStamped'),
    'current': ('geometry_msgs/msg/Vector3Stamped',),
    'battery': ('sensor_msgs/msg/BatteryState',),
    'thruster_setpoints': ('std_msgs/msg/Float64MultiArray',),
}
PARAMETER_EVENTS = '/parameter_events'


def find_topics(recorded: Mapping[str, str], given: Mapping[str, str],
                namespace: str) -> dict[str, str]:
    """
    Return which name of the node each topic of a bag stands for, by topic.

    A name is looked for where it was given, then in the node's namespace, then anywhere, if only
    one topic ends in it.

    :param recorded: types by topic.
    :param given: topics by name of the node, from the command line.
    :param namespace: of the node, with no slash at its end.
    :raises ReplayError: if there is no wrench, or a topic that was given is missing or of another
        type.
    """
    found = {}
    for name, types in TYPES.items():
        if name in given:
            _check_given(name, given[name], recorded)
            found[given[name]] = name
            continue
        here = f'{namespace}/{name}'
        matches = [topic for topic, kind in recorded.items()
                   if topic.endswith(f'/{name}') and kind in types]
        if here in matches:
            matches = [here]
        if len(matches) > 1:
            raise ReplayError(f'{name} is recorded on {" and ".join(sorted(matches))}: say which '
                              f'one with --topic {name}:=TOPIC, or which node with --node')
        found.update({topic: name for topic in matches})
    if 'cmd_wrench' not in found.values():
        wrenches = [topic for topic, kind in recorded.items() if kind in TYPES['cmd_wrench']]
        raise ReplayError(
            'has no cmd_wrench: say with --topic cmd_wrench:=TOPIC where the wrench is; '
            + (f'topics of a wrench are {", ".join(sorted(wrenches))}' if wrenches else
               'there is no topic of a wrench, but ' + _listed(recorded)))
    return found


def _check_given(name: str, topic: str, recorded: Mapping[str, str]) -> None:
    if topic not in recorded:
        raise ReplayError(f'has no topic {topic} (--topic {name}:={topic}), but '
                          + _listed(recorded))
    if recorded[topic] not in TYPES[name]:
        raise ReplayError(f'{topic} is a {recorded[topic]}, must be a {" or ".join(TYPES[name])} '
                          f'to be {name}')


def _listed(recorded: Mapping[str, str]) -> str:
    return ', '.join(f'{topic} ({kind})' for topic, kind in sorted(recorded.items())) or 'none'
