"""The demo: its table, that nobody else hears it, and that it does not hang."""

import os
import subprocess
import sys

import numpy as np
import pytest
from support.paths import ROOT
from support.peer import Peer, ros_context, TYPES_IN, TYPES_OUT
from support.vehicles import PAPER_TEST
from thrust_allocator import demo
from thrust_allocator.ros.node import ThrustAllocator

DOMAIN = 1 + os.getpid() % 100
NAMESPACE = '/thrust_allocator_demo'
TIMEOUT = 20.0  # [s]
DEMO = ('-m', 'thrust_allocator.demo')
# Participants that miss each other's first announcements meet at the next ones, after 3 s
LONG_DEMO = ('-c', 'from thrust_allocator import demo; demo.SPEEDS *= 15; demo.main(["demo"])')
OUTSIDE = {**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
           'ROS_DOMAIN_ID': str(DOMAIN)}


def start(*arguments, **environment):
    """Start Python as a process that others on this machine could hear."""
    return subprocess.Popen(
        [sys.executable, *arguments], cwd=ROOT, env={**OUTSIDE, **environment}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def end(process):
    """Kill a process if it still runs; return its output."""
    process.kill()
    return process.communicate()


def test_table():
    """Each row is the one of the recomputed table of the paper's test, from a running node."""
    process = start(*DEMO)
    try:
        stdout, stderr = process.communicate(timeout=TIMEOUT)
    finally:
        end(process)
    assert process.returncode == 0, stderr
    assert 'ERROR' not in stderr and 'Traceback' not in stderr
    heading, units, *rows = stdout.splitlines()
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
    process = start(*DEMO, '--ros-args', '--params-file', 'my_vehicle.yaml')
    try:
        stdout, stderr = process.communicate(timeout=TIMEOUT)
    finally:
        end(process)
    assert process.returncode == 2 and stdout == ''
    assert 'usage: demo' in stderr and '--params-file' in stderr


@pytest.fixture
def eavesdropper(monkeypatch):
    """Return a peer in the demo's namespace and domain that other processes can be heard by."""
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    with ros_context('-r', f'__ns:={NAMESPACE}', domain_id=DOMAIN) as context:
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
def test_nobody_hears_the_demo(eavesdropper, command, rows, environment):
    """From its start to its end no other process sees a topic of the demo or hears a message."""
    process = start(*command, **environment)
    found = set()

    def ended():
        found.update(overheard(eavesdropper))
        return found or process.poll() is not None

    try:
        eavesdropper.wait_until(ended, 'the end of the demo', 2 * TIMEOUT)
    finally:
        stdout, stderr = end(process)
    assert (found, eavesdropper.received) == (set(), [])
    assert process.returncode == 0, stderr
    assert len(stdout.splitlines()) == 2 + rows


def test_the_eavesdropper_is_not_deaf(eavesdropper):
    """The same observer sees and hears a node in the demo's place that does not hide."""
    process = start('-m', 'thrust_allocator', '--ros-args', '-r', f'__ns:={NAMESPACE}')
    wanted = {f'{NAMESPACE}/{topic}' for topic in (*TYPES_IN, *TYPES_OUT)}
    try:
        eavesdropper.wait_until(lambda: overheard(eavesdropper) >= wanted, 'all its topics')
        eavesdropper.wait_until(lambda: eavesdropper.ticks, 'a message on each')
        assert process.poll() is None
    finally:
        end(process)


def test_no_answer(monkeypatch, capsys):
    """If the allocator does not answer, the demo gives up with status 1 and says so."""
    monkeypatch.setattr(demo, 'PATIENCE', 0.2)
    monkeypatch.setattr(ThrustAllocator, '_tick', lambda self: None)
    assert demo.main(['demo']) == 1
    captured = capsys.readouterr()
    assert 'did not answer' in captured.err
    assert len(captured.out.splitlines()) == 2
