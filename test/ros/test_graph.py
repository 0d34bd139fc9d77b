"""The documents name the topics and services that the running node has, and no others."""

from collections import defaultdict
import re
import xml.etree.ElementTree as ElementTree

import pytest
from support.paths import MT2012, ROOT
from support.peer import ros_context
from thrust_allocator.ros.node import ThrustAllocator

NODE = '/thrust_allocator'
README = (ROOT / 'README.md').read_text('utf-8')
SAFETY = (ROOT / 'doc/safety.md').read_text('utf-8')
OF_EVERY_NODE = {'/rosout', '/parameter_events', '/clock'}
VARIANTS = (  # of the parameters, which together make the node use all that it may ever use
    ('use_sim_time:=true', 'publish_individual:=true', 'nominal_voltage:=16.0'),
    ('stamped_wrench:=true', 'velocity_type:=twist'), ('velocity_type:=twist_with_covariance',))


@pytest.fixture(scope='module')
def graph():
    """Return (types of published topics, of subscribed ones, of services), each by full name."""
    found = ({}, {}, {})
    for rules in VARIANTS:
        arguments = [word for rule in rules for word in ('-p', rule)]
        with ros_context('--params-file', str(MT2012), *arguments) as context:
            node = ThrustAllocator(context=context)
            for names, read in zip(found, (node.get_publisher_names_and_types_by_node,
                                           node.get_subscriber_names_and_types_by_node,
                                           node.get_service_names_and_types_by_node)):
                for name, types in read(node.get_name(), node.get_namespace()):
                    name = re.sub('^/thrusters/[^/]+/', '/thrusters/NAME/', name)
                    names.setdefault(name, set()).update(types)
            node.destroy_node()
    return found


def full(name):
    """Return the full name of a documented topic or service, of a node in the root namespace."""
    name = name.replace('<name>', 'NAME')
    return name.replace('~', NODE, 1) if name[0] == '~' else f'/{name.lstrip("/")}'


def test_readme_has_every_topic(graph):
    """The table has each topic of the node with its types and its direction, and no other."""
    published, subscribed, _ = graph
    documented = defaultdict(dict)
    for name, types, meaning in re.findall(r'^\| `(\S+)` \| (\w+/.*?) \| (.*) \|$', README, re.M):
        package, *names = re.findall(r'\w+(?=/)|[A-Z]\w+', types)
        documented[re.match('in|out', meaning)[0]][full(name)] = {
            f'{package}/msg/{one}' for one in names}
    for direction, names in (('out', published), ('in', subscribed)):
        assert documented[direction] == {
            name: types for name, types in names.items() if name not in OF_EVERY_NODE}


def test_readme_has_every_service(graph):
    """Those that ROS does not give every node are named, with their types."""
    own = {name: types for name, types in graph[2].items()
           if not re.search('parameter|type_description', name)}
    documented = {full(name): {f'{package}/srv/{kind}'} for name, package, kind
                  in re.findall(r'`(~/\w+)` \((\w+)/(\w+)\)', README)}
    assert own and documented == own


def test_policy_allows_what_the_node_uses(graph):
    """The SROS 2 policy permits just the topics and services that the node has."""
    policy = ElementTree.fromstring(re.search('<policy.*</policy>', SAFETY, re.S)[0])
    for names, entries in zip(graph, (policy.findall('.//topics[@publish="ALLOW"]/topic'),
                                      policy.findall('.//topics[@subscribe="ALLOW"]/topic'),
                                      policy.findall('.//services[@reply="ALLOW"]/service'))):
        assert sorted(full(entry.text) for entry in entries) == sorted(names)


def test_permissions_are_those_of_the_policy(graph):
    """The names that DDS uses: rt/ for a topic, rq/ and rr/ for a service's two topics."""
    published, subscribed, services = graph
    rule = ElementTree.fromstring(re.search('<allow_rule>.*</allow_rule>', SAFETY, re.S)[0])
    for direction, topics, service in (('publish', published, 'rr{}Reply'),
                                       ('subscribe', subscribed, 'rq{}Request')):
        assert sorted(one.text for one in rule.findall(f'{direction}/topics/topic')) == sorted([
            *(f'rt{name}' for name in topics), *map(service.format, services),
            'ros_discovery_info'])


def test_commands_use_what_there_is(graph):
    """Each `ros2 topic` and `ros2 service` in the documents is of a name and type that exist."""
    published, subscribed, services = graph
    text = README + ''.join(file.read_text('utf-8') for file in (ROOT / 'doc').glob('*.md'))
    sent = re.findall(r'ros2 topic pub .*?(/\w+) (\S+)', text)
    called = re.findall(r'ros2 service call (\S+) (\S+)', text)
    assert sent and called
    assert all(kind in subscribed[name] for name, kind in sent)
    assert all(kind in services[name] for name, kind in called)
    assert set(re.findall(r'ros2 topic echo .*?(/\w+)', text)) <= set(published)
