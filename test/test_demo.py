"""The demo: its table, that nobody else hears it, and that it does not hang."""


import numpy as np
import pytest
from support.peer import Peer, TYPES_IN, TYPES_OUT
from support.processes import context_among_processes, NODE, run, TIMEOUT
from support.vehicles import PAPER_TEST
from thrust_allocator import demo
from thrust_allocator.ros.node import ThrustAllocator

NAMESPACE = '/thrust_allocator_demo'
DEMO = ('-m', 'thrust_allocator.demo')
# Participants that miss each other's first announcements meet at the next ones, after 3 s
LONG_DEMO = ('-c', 'from thrust_allocator import demo; demo.SPEEDS *= 15; demo.main(["demo"])')


def test_table():
    """Each row is the one of the recomputed table of the paper's test, from a running node."""
    done = run(*DEMO)
    assert done.returncode == 0, done.stderr
    assert 'ERROR' not in done.stderr and 'Traceback' not in done.stderr
    heading, units, *rows = done.stdout.splitlines()
    assert heading.split() == ['v', 'down', 'left', 'up', 'right', 'tunnel', 'limit', 'of',
                               'pitch']
    assert units.split() == ['m/s', 'N', 'N', 'N', 'N', 'N', 'tunnel', 'N', 'N*m']
    found = np.array([row.split() for row in rows], dtype=float)
    speeds = np.array([row[0] for row in PAPER_TEST[1:]])
    np.testing.assert_array_equal(found[:, 0], speeds)
    np.testing.assert_allclose(found[:, 1:6], [row[1] for row in PAPER_TEST[1:]], atol=0.02)
    tunnel = 122.1 * np.exp(-7.0 * 1025.0 * 0.0707 / 122.1 * speeds**2)  # eq. 3.12, 3.13
    np.testing.assert_allclose(found[:, 6], tunnel, atol=0.02)
    np.testing.assert_allclose(found[:, 7], [row[4] for row in PAPER_TEST[1:]], atol=0.02)


def test_arguments_are_refused():
    """An argument, such as a parameter file, ends the demo with usage and status 2."""
    done = run(*DEMO, '--ros-args', '--params-file', 'my_vehicle.yaml')
    assert done.returncode == 2 and done.stdout == ''
    assert 'usage: demo' in done.stderr and '--params-file' in done.stderr


@pytest.fixture
def eavesdropper():
    """Return a peer in the demo's namespace and domain that other processes can be heard by."""
    with context_among_processes('-r', f'__ns:={NAMESPACE}') as context:
        peer = Peer(context, name='eavesdropper')
        peer.wrench, peer.twist = np.ones(6), np.ones(6)
        peer.create_timer(0.02, peer.send)
        yield peer
        peer.close()


def overheard(peer):
    """Return the topics in the demo's namespace that another node has an end of."""
    return {
        topic for topic, _ in peer.get_topic_names_and_types()
        if topic.startswith(f'{NAMESPACE}/') and any(
            end.node_name != peer.get_name() for end in (
                *peer.get_publishers_info_by_topic(topic),
                *peer.get_subscriptions_info_by_topic(topic)))}


@pytest.mark.parametrize('command, rows, environment', [
    (DEMO, 7, {}), (LONG_DEMO, 15 * 7, {'ROS_LOCALHOST_ONLY': '1'})])
def test_nobody_hears_the_demo(launch, eavesdropper, command, rows, environment):
    """From its start to its end no other process sees a topic of the demo or hears a message."""
    process = launch(*command, **environment)
    found = set()

    def ended():
        found.update(overheard(eavesdropper))
        return found or process.poll() is not None

    eavesdropper.wait_until(ended, 'the end of the demo', 2 * TIMEOUT)
    process.kill()
    stdout, stderr = process.communicate()
    assert (found, eavesdropper.received) == (set(), [])
    assert process.returncode == 0, stderr
    assert len(stdout.splitlines()) == 2 + rows


def test_the_eavesdropper_is_not_deaf(launch, eavesdropper):
    """The same observer sees and hears a node in the demo's place that does not hide."""
    process = launch(*NODE, '--ros-args', '-r', f'__ns:={NAMESPACE}')
    wanted = {f'{NAMESPACE}/{topic}' for topic in (*TYPES_IN, *TYPES_OUT)}
    eavesdropper.wait_until(lambda: overheard(eavesdropper) >= wanted, 'all its topics')
    eavesdropper.wait_until(lambda: eavesdropper.ticks, 'a message on each')
    assert process.poll() is None


def test_no_answer(monkeypatch, capsys):
    """If the allocator does not answer, the demo gives up with status 1 and says so."""
    monkeypatch.setattr(demo, 'PATIENCE', 0.2)
    monkeypatch.setattr(ThrustAllocator, '_tick', lambda *arguments: None)
    assert demo.main(['demo']) == 1
    captured = capsys.readouterr()
    assert 'did not answer' in captured.err
    assert len(captured.out.splitlines()) == 2
