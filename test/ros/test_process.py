"""The node as a process of its own: start, mistakes in its parameters, and how it stops."""

from pathlib import Path
import signal
import uuid

import numpy as np
import pytest
from rcl_interfaces.msg import ParameterType
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import ReliabilityPolicy
from support.peer import cruise, Peer
from support.processes import context_among_processes, NODE, TIMEOUT


@pytest.fixture
def namespace():
    """Return a namespace that nobody else uses."""
    return f'/test_{uuid.uuid4().hex}'


@pytest.fixture
def launch_node(launch, namespace):
    """Return a function that starts the node as a process in the namespace."""
    return lambda *arguments: launch(
        *NODE, '--ros-args', '-r', f'__ns:={namespace}', *arguments)


@pytest.fixture
def peer(namespace):
    """Return a peer of the process, in this process and heard on this machine only."""
    with context_among_processes('-r', f'__ns:={namespace}') as context:
        peer = Peer(context)
        yield peer
        peer.close()


def wait_until_allocating(peer, process, *others):
    """Send the paper's test at 0.9 m/s until all peers hear a sensible answer to it."""
    peer.wrench, peer.twist = cruise(0.9, side=-1.0)

    def allocating():
        assert process.poll() is None, process.communicate()
        return all(each.setpoints() is not None and np.abs(each.setpoints()).max() > 1.0
                   for each in (peer, *others))

    peer.wait_until(allocating, 'setpoints from the process', TIMEOUT)


def stop(process, number=signal.SIGTERM):
    """Send a signal, wait for the end and return what stood on stderr, by line."""
    process.send_signal(number)
    stdout, stderr = process.communicate(timeout=TIMEOUT)
    assert (process.returncode, stdout) == (0, '')
    return stderr.splitlines()


def test_without_a_parameter_file(launch_node, peer, mt2012):
    """MT-2012 runs from the package's own file, allocates, and one WARN line names that file."""
    process = launch_node()
    wait_until_allocating(peer, process)
    tick = peer.settle(*cruise(0.9, side=-1.0))
    np.testing.assert_allclose(tick['thruster_setpoints'], [-35.34, 8.77, 52.88, 8.77, -4.20],
                               atol=0.02)
    np.testing.assert_allclose(tick['achieved_wrench'] + tick['unallocated_wrench'],
                               peer.wrench, atol=1e-9)
    lines = stop(process)
    said, = [line for line in lines if 'MT-2012' in line or '.yaml' in line]
    assert said.startswith('[WARN]') and 'MT-2012' in said
    named = Path(said.split()[-1])
    assert named.name == 'mt2012.yaml' and named.read_text() == mt2012.read_text()
    assert all(line.startswith(('[WARN]', '[INFO]')) for line in lines)


def test_with_a_parameter_file(launch_node, peer, variant):
    """The given vehicle runs, nothing of MT-2012 is merged in, and no WARN speaks of it."""
    path = variant({'thruster_names': ['thrust'], 'thrusters': {'thrust': {
        'model': 'constant', 'position': [0.0, 0.0, 0.0], 'direction': [1.0, 0.0, 0.0],
        'bollard_thrust': [-10.0, 20.0]}}})
    process = launch_node('--params-file', path)
    wait_until_allocating(peer, process)
    tick = peer.settle((50.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert tick['thrust_limits'].tolist() == [-10.0, 20.0]
    assert tick['thruster_setpoints'].tolist() == [20.0]
    assert not [line for line in stop(process) if 'MT-2012' in line]


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGINT])
def test_zeros_come_last(launch_node, peer, number):
    """After a signal in full action each subscriber has zeros last, and the exit status is 0."""
    impatient = Peer(peer.context, reliability=ReliabilityPolicy.BEST_EFFORT, beside=peer,
                     name='impatient')
    process = launch_node('-p', 'wrench_timeout:=600.0')
    wait_until_allocating(peer, process, impatient)
    process.send_signal(number)
    peer.wait_until(lambda: process.poll() is not None, 'the end of the process', TIMEOUT)
    assert process.returncode == 0
    peer.wait_until(lambda: peer.count_publishers('thruster_setpoints') == 0,
                    'the end of its publishers', TIMEOUT)
    for each in (peer, impatient):
        peer.wait_until(lambda: (each.setpoints() == 0.0).all(),
                        f'zero setpoints as the last ones, for {each.get_name()}')
    stderr = process.communicate()[1]
    assert 'Traceback' not in stderr and '[ERROR]' not in stderr
    impatient.destroy_node()


def refused(launch_node, *arguments):
    """Return the only line on stderr of a process that ends with status 1 at once."""
    process = launch_node(*arguments)
    stdout, stderr = process.communicate(timeout=TIMEOUT)
    assert (process.returncode, stdout, stderr.count('\n')) == (1, '', 1), stderr
    return stderr


@pytest.mark.parametrize('changes, named', [
    ({'rate': -5.0}, 'rate: is -5.0, must be'),
    ({'thrusters.up.bollard_thrust': [68.2, 120.1]},
     'thrusters.up.bollard_thrust: is [68.2, 120.1], must be'),
    ({'thrusters.up.position': [-1, 0.5, 0]}, 'thrusters.up.position: is [-1, 0.5, 0], mixes'),
    ({'thrusters.up.wieght': 1.0}, 'thrusters.up.wieght: is no parameter here; did you mean '
                                   'thrusters.up.weight?'),
    ({'rate': None}, "rate: is 'null', must be")])
def test_mistakes_in_a_parameter_file(launch_node, variant, changes, named):
    """A mistake ends in one line that names the parameter, what it is and what it must be."""
    assert named in refused(launch_node, '--params-file', variant(changes))


def test_a_wrong_top_key(launch_node, variant, namespace):
    """A file for another node ends in one line that asks about its top key."""
    line = refused(launch_node, '--params-file', variant({}, top_key='/other'))
    assert f'has nothing for the node {namespace}/thrust_allocator; its top keys are /other' in line


@pytest.mark.parametrize('content, said', [
    (None, 'cannot be read'), ('{', 'is not valid YAML'), ('- 1\n', 'is no map')])
def test_no_parameter_file_at_all(launch_node, tmp_path, content, said):
    """A file that is missing or no parameter file ends in one line that names it."""
    path = tmp_path / 'broken.yaml'
    if content is not None:
        path.write_text(content, encoding='utf-8')
    line = refused(launch_node, '--params-file', path)
    assert str(path) in line and said in line


@pytest.mark.parametrize('value', ['abc', '-1', 'null', '2020-01-01', str(10**30)])
def test_a_wrong_value_on_the_command_line(launch_node, value):
    """A value that ROS itself would drop, for its type, ends in one line that names it."""
    assert 'rate: is ' in refused(launch_node, '-p', f'rate:={value}')


def test_a_whole_number_on_the_command_line(launch_node, peer):
    """A whole number where the default file has a real one is in effect, as a real one."""
    process = launch_node('-p', 'rate:=20')
    wait_until_allocating(peer, process)
    client = AsyncParameterClient(peer, 'thrust_allocator')
    peer.wait_until(client.services_are_ready, 'the services for parameters', TIMEOUT)
    answer = client.get_parameters(['rate'])
    peer.wait_until(answer.done, 'the value of rate', TIMEOUT)
    rate, = answer.result().values
    assert (rate.type, rate.double_value) == (ParameterType.PARAMETER_DOUBLE, 20.0)
    stop(process)
