"""Velocity, current and broken messages on the running node: what counts, and for how long."""

from itertools import cycle

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from support.rotations import quaternion, rotation
from support.stepped_peer import SECOND

WRENCH = [60.0, 0.0, 10.0, 0.0, 20.0, -15.0]
TWIST = [1.0, 0.3, -0.2, 0.05, 0.1, -0.1]
FLU = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
CURRENT = np.array([0.7, -1.1, 0.4])  # [m/s], in the odometry's parent frame
ANGLES = (2.5, -0.6, 0.3)  # yaw, pitch, roll [rad]


def drift(angles=ANGLES):
    """Return the twist of a vehicle that the current carries along."""
    return [*(rotation(*angles).T @ CURRENT), 0.0, 0.0, 0.0]


def limits(tick):
    """Return the limits of a tick, (10,)."""
    return tick['thrust_limits']


def test_no_odometry_ever(stepped):
    """Before the first odometry the limits are those at fallback_velocity: WARN."""
    peer = stepped('message_frame:=flu', 'fallback_velocity:=[0.8, 0.2, -0.1]')
    expected = peer.limits_at(0.8, -0.2, 0.1)
    for tick in peer.steps(3, WRENCH):
        assert_array_equal(limits(tick), expected)
    level, message, figures = peer.report()
    assert level == 'WARN' and 'no odometry yet: using fallback_velocity' in message
    assert figures['age of odometry [s]'] == 'none'
    assert_array_equal(limits(peer.step(WRENCH, FLU * TWIST)), peer.limits_at(*TWIST))
    assert 'odometry' not in peer.report_later()[1]


def test_stale_odometry(stepped):
    """After odometry_timeout the tighter of last and fallback velocity counts per limit: WARN."""
    peer = stepped('odometry_timeout:=0.2', 'fallback_velocity:=[0.15, 0.0, 0.0]')
    moving, fallback = peer.limits_at(0.0, 0.5), peer.limits_at(0.15)
    tighter = np.where(np.abs(moving) < np.abs(fallback), moving, fallback)
    assert (tighter != moving).any() and (tighter != fallback).any()
    peer.steps(20, WRENCH, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0])
    peer.silence('twist')
    ticks = peer.steps(25)
    stale = [(limits(tick) == tighter).all() for tick in ticks]
    assert 18 <= stale.index(True) <= 21 and stale == sorted(stale)
    assert all((limits(tick) == moving).all() for tick in ticks[:8])
    level, message, figures = peer.report()
    assert level == 'WARN' and 'no odometry for 0.5 s: using fallback_velocity' in message
    assert figures['age of odometry [s]'] == '0.5'
    back = peer.steps(11, None, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0])
    assert (limits(back[-1]) == moving).all() and (limits(back[0]) != moving).any()
    assert 'odometry' not in peer.report_later()[1]
    peer.steps(500)
    peer.report()
    peer.wait_until(lambda: peer.logged('no longer: no odometry for'), 'word of the recovery')
    assert [line.split(':')[0] for line in peer.logged('no odometry for')] == ['WARN', 'INFO']


def test_no_odometry_expected(stepped):
    """With odometry_timeout 0 the lack of odometry is no finding."""
    peer = stepped('odometry_timeout:=0.0')
    peer.steps(3, WRENCH)
    peer.step(period=10 * SECOND)
    assert 'odometry' not in peer.report()[1]
    assert not peer.logged('odometry')


@pytest.mark.parametrize('frame', ['frd', 'flu'])
def test_moving_through_the_current(stepped, frame):
    """The bounds are those at the velocity less the current, turned into the body by a matrix."""
    peer = stepped(f'message_frame:={frame}')
    peer.current, peer.orientation = CURRENT, quaternion(*ANGLES)
    through_water = np.array(TWIST) * (FLU if frame == 'flu' else 1.0)
    tick = peer.step(WRENCH, drift() + through_water)
    assert_allclose(limits(tick), peer.limits_at(*TWIST), atol=1e-9)
    assert 'current' not in peer.report()[1]


def assert_ignored(peer, tick, why):
    """Check that the current does not count, and that the diagnostics say why."""
    assert_array_equal(limits(tick), peer.limits_at(*drift()))
    level, message, _ = peer.report()
    assert level == 'WARN' and 'current ignored' in message and why in message


def test_a_stale_current(stepped):
    """Older than current_timeout, a current is ignored: WARN; the next one counts again."""
    peer = stepped('current_timeout:=0.2')
    peer.current, peer.orientation = CURRENT, quaternion(*ANGLES)
    bollard = limits(peer.step(WRENCH, drift()))
    peer.current = None
    ticks = peer.steps(15)
    counts = [(limits(tick) == bollard).all() for tick in ticks]
    assert 8 <= counts.index(False) <= 11 and not any(counts[counts.index(False):])
    assert_ignored(peer, ticks[-1], 'none came for too long')
    peer.current = CURRENT
    assert_array_equal(limits(peer.step()), bollard)
    peer.steps(500)
    peer.report()
    peer.wait_until(lambda: peer.logged('no longer: current'), 'word of the recovery')
    assert [line.split(':')[0] for line in peer.logged('current ignored')] == ['WARN', 'INFO']


def test_a_current_from_another_frame(stepped):
    """A current from another frame than the odometry's parent is ignored: WARN."""
    peer = stepped()
    peer.orientation = quaternion(*ANGLES)
    peer.send_current(CURRENT, frame='map')
    assert_ignored(peer, peer.step(WRENCH, drift()), "'map'")


@pytest.mark.parametrize('topic, cause, value', [
    ('cmd_wrench', 'beyond 1e+09', 1.0001e9), ('odom', 'not finite', np.nan),
    ('current', 'beyond 50', -50.001)])
def test_nonsense(stepped, topic, cause, value):
    """A message with one broken component is dropped whole and counted, and refreshes nothing."""
    timeout = {'cmd_wrench': 'wrench', 'odom': 'odometry', 'current': 'current'}[topic]
    peer = stepped(f'{timeout}_timeout:=0.2')
    peer.current = [0.1, 0.2, 0.3]
    peer.steps(3, WRENCH, TWIST)
    before = peer.steps(3)[-1]
    name, send, size = {'cmd_wrench': ('wrench', peer.send_wrench, 6),
                        'odom': ('twist', peer.send_twist, 6),
                        'current': ('current', peer.send_current, 3)}[topic]
    peer.silence(name)
    broken = cycle(np.where(np.eye(size, dtype=bool), value, 2.0))
    peer.report()
    for _ in range(8):
        send(next(broken))
        after = peer.step()
        for key, values in before.items():
            assert_array_equal(after[key], values)
    level, message, figures = peer.report()
    assert level == 'WARN' and f'messages dropped: {topic} {cause}' in message
    assert figures[f'dropped: {topic} {cause}'] == '8'
    for _ in range(4):
        send(next(broken))
        peer.step()
    _, message, figures = peer.report()
    assert {'cmd_wrench': 'no wrench', 'odom': 'no odometry for', 'current': 'current ignored'}[
        topic] in message
    assert figures[f'dropped: {topic} {cause}'] == '12'
    assert 'messages dropped' not in peer.report_later()[1]
