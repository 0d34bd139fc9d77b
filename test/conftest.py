"""Shared by all tests: an environment that nothing leaves, and variants of MT-2012's file."""

from contextlib import ExitStack
import copy
import os
import tempfile

import pytest
from support.paths import MT2012
import yaml

# Before any rclpy: in-process traffic stays inside its Context, logs go where they are deleted
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'OFF'
os.environ.pop('ROS_LOCALHOST_ONLY', None)  # would override it
_LOGS = tempfile.TemporaryDirectory(prefix='thrust_allocator_test_')
os.environ['ROS_LOG_DIR'] = _LOGS.name


@pytest.fixture
def mt2012():
    """Return the path of MT-2012's parameter file."""
    return MT2012


@pytest.fixture
def variant(tmp_path):
    """Return a function that writes MT-2012's file with changes and returns its path."""
    original = yaml.safe_load(MT2012.read_text(encoding='utf-8'))['/**']['ros__parameters']

    def write(changes, top_key='/**'):
        """Set what `changes` gives by dotted name, under the top key `top_key`."""
        parameters = copy.deepcopy(original)
        for name, value in changes.items():
            *groups, last = name.split('.')
            place = parameters
            for group in groups:
                place = place[group]
            place[last] = value
        path = tmp_path / 'vehicle.yaml'
        path.write_text(yaml.safe_dump({top_key: {'ros__parameters': parameters}}),
                        encoding='utf-8')
        return path

    return write


@pytest.fixture
def start(mt2012):
    """Return a function that starts the node and a peer in a Context of their own."""
    from support.peer import Peer, ros_context  # not before the environment above
    from thrust_allocator.ros.node import ThrustAllocator

    with ExitStack() as stack:
        def start_node(*rules, file=mt2012, remap='', kind=Peer, **options):
            """Return the node with parameter rules, and the peer: both spin with the latter."""
            arguments = [word for rule in rules for word in ('-p', rule)]
            arguments += ['-r', remap] if remap else []
            context = stack.enter_context(ros_context('--params-file', str(file), *arguments))
            node = ThrustAllocator(context=context)
            stack.callback(node.destroy_node)
            peer = kind(context, beside=node, **options)
            stack.callback(peer.close)
            return node, peer
        yield start_node


@pytest.fixture
def launch():
    """Return a function that starts Python as a process; what still runs at the end is killed."""
    from support import processes

    with ExitStack() as stack:
        def start_process(*arguments, **environment):
            process = processes.start(*arguments, **environment)
            stack.callback(processes.end, process)
            return process
        yield start_process


@pytest.fixture
def stepped(start):
    """Return a function that starts the node in simulated time and frd axes on a SteppedPeer."""
    from support.stepped_peer import SteppedPeer

    return lambda *rules, **options: start(
        'use_sim_time:=true', 'tick_on_wrench:=false', 'message_frame:=frd', *rules,
        kind=SteppedPeer, **options)[1]
