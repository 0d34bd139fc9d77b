"""Simulated time that stands, jumps and races, and a node that falls behind."""

import time

from diagnostic_msgs.msg import DiagnosticArray
import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from rclpy.parameter import Parameter
from support.stepped_peer import inside_limits, is_stopped, PERIOD, SECOND

WRENCH = np.array([60.0, 0.0, 10.0, 0.0, 20.0, -15.0])
OTHER = np.array([-30.0, 0.0, 5.0, 0.0, -10.0, 20.0])
TWIST = [0.3, 0.1, -0.1, 0.02, 0.05, -0.02]
STALL = 0.2  # [s], ten periods


def diagnostics(receive):
    """Return the arguments of a subscription that hands each status to a function."""
    return (DiagnosticArray, '/diagnostics',
            lambda array: [receive(status) for status in array.status], 10)


def is_answer(tick, wrench):
    """Tell whether a tick answers a wrench."""
    return np.allclose(tick['achieved_wrench'] + tick['unallocated_wrench'], wrench)


def test_the_clock_stands(stepped):
    """While /clock stands there are no ticks, and WARN; when it moves, all is as before."""
    peer = stepped()
    before = peer.steps(3, WRENCH, TWIST)[-1]
    peer.report()
    peer.received.clear()
    for _ in range(20):
        peer.send()
        peer.pulse()
    assert not peer.received
    level, message, figures = peer.report()
    assert level == 'WARN' and 'the clock stands: no ticks' in message
    assert figures['ticks'] == '0'
    assert_array_equal(peer.step()['thruster_setpoints'], before['thruster_setpoints'])
    assert 'clock' not in peer.report_later()[1]


def test_the_clock_never_came(start):
    """With use_sim_time but without /clock there are no ticks, and the node says so by itself."""
    _, peer = start('use_sim_time:=true')
    reports = []
    peer.create_subscription(*diagnostics(lambda status: reports.append(status.message)))
    peer.wait_until(lambda: any('the clock stands' in text for text in reports), 'a warning')
    assert not peer.received


def test_a_jump_forward(stepped):
    """Beyond its time-out, a jump forward expires wrench and odometry; new ones count."""
    peer = stepped('fallback_velocity:=[0.5, 0.0, 0.0]')
    before = peer.steps(3, WRENCH, TWIST)[-1]
    peer.silence('wrench', 'twist')
    jumped = peer.step(period=3600 * SECOND)
    assert is_stopped(jumped) and (jumped['thrust_limits'] != before['thrust_limits']).any()
    message = peer.report()[1]
    assert 'no wrench' in message and 'no odometry for 3600' in message
    assert_array_equal(peer.step(WRENCH, TWIST)['thruster_setpoints'],
                       before['thruster_setpoints'])


@pytest.mark.parametrize('seconds', [1e-9, 0.1, 900.0])
def test_a_jump_backward(stepped, seconds):
    """Any jump backward expires the wrench, and the odometry; new ones are answered at once."""
    peer = stepped('wrench_timeout:=60.0', 'odometry_timeout:=60.0', 'current_timeout:=60.0')
    peer.current = [0.1, 0.0, 0.0]
    before = peer.steps(3, WRENCH, TWIST)[-1]
    peer.silence('wrench', 'twist', 'current')
    peer.time -= round(seconds * SECOND)
    peer.pulse()
    for tick in peer.steps(3):
        assert is_stopped(tick) and not tick['unallocated_wrench'].any()
    level, message, _ = peer.report()
    assert level == 'WARN' and all(
        text in message for text in ('no wrench', 'no odometry', 'current ignored'))
    peer.current = [0.1, 0.0, 0.0]
    assert_array_equal(peer.step(WRENCH, TWIST)['thruster_setpoints'],
                       before['thruster_setpoints'])
    message = peer.report_later()[1]
    assert not any(text in message for text in ('no wrench', 'no odometry', 'current ignored'))


def test_ticks_go_on_after_a_jump_backward(stepped):
    """After a jump backward the next tick comes a period later, not when the old time is back."""
    peer = stepped()
    peer.steps(3, WRENCH, TWIST)
    peer.time -= 500 * SECOND
    peer.pulse()
    assert all(inside_limits(tick) and is_answer(tick, WRENCH) for tick in peer.steps(5))


def test_a_fast_clock(stepped):
    """A clock that moves by several periods at a time gives one tick for each of its steps."""
    peer = stepped()
    for number in range(20):
        wrench = WRENCH if number % 2 else OTHER
        assert is_answer(peer.step(wrench, TWIST, period=9 * PERIOD), wrench)
    peer.silence('wrench')
    ticks = [peer.step(period=9 * PERIOD) for _ in range(4)]  # 0.72 s
    assert [is_stopped(tick) for tick in ticks] == [False, False, True, True]


def test_late_ticks_in_simulated_time(stepped):
    """Of the ticks that a jump of the clock left out one is made up for, and counted as late."""
    peer = stepped()
    peer.steps(3, WRENCH, TWIST)
    assert peer.report()[2]['ticks late'] == '0'
    assert is_answer(peer.step(OTHER, period=7 * PERIOD), OTHER)
    peer.received.clear()
    for _ in range(10):
        peer.pulse()
    assert not peer.received
    assert peer.report()[2]['ticks late'] == '1'
    peer.steps(5)
    assert peer.report()[2]['ticks late'] == '0'


@pytest.mark.parametrize('periods, late', [(1.49, '0'), (1.51, '1')])
def test_from_when_a_tick_is_late(stepped, periods, late):
    """A tick is late from one and a half periods after the one before on, and answers all alike."""
    peer = stepped()
    peer.steps(3, WRENCH, TWIST)
    assert is_answer(peer.step(OTHER, period=round(periods * PERIOD)), OTHER)
    assert peer.report()[2]['ticks late'] == late


def test_a_stall(start):
    """After a stall one tick comes at once, for the newest command, and counts as late."""
    _, peer = start()
    late = []
    peer.create_subscription(*diagnostics(lambda status: late.extend(
        int(pair.value) for pair in status.values if pair.key == 'ticks late')))
    for _ in range(3):  # wherever in its round the executor happens to be
        peer.settle(WRENCH)
        peer.wrench = None
        peer.wait_for_ticks(1)
        peer.send_wrench(WRENCH)
        peer.send_wrench(OTHER)
        sent, start_of_stall = time.time_ns(), time.monotonic()
        while (since := time.monotonic() - start_of_stall) < STALL:
            pass
        peer.wait_until(lambda: len(answers_after(sent, peer)) >= 3, 'ticks after the stall')
        answers = answers_after(sent, peer)
        since = time.monotonic() - start_of_stall - since
        assert len(answers) <= 2 + since * 50.0  # those missed did not queue up
        assert_allclose(answers, [OTHER] * len(answers), atol=1e-9)
    peer.wait_until(lambda: sum(late) >= 3, 'the count of late ticks')


def answers_after(sent, peer):
    """Return achieved and unallocated wrench, summed, of each tick published after a time."""
    achieved, unallocated = ([item.values for item in peer.received
                              if item.topic == topic and item.sent > sent]
                             for topic in ('achieved_wrench', 'unallocated_wrench'))
    return [one + other for one, other in zip(achieved, unallocated)]


def test_the_clock_cannot_be_changed_while_running(start):
    """use_sim_time is refused while the node runs, and the ticks go on."""
    node, peer = start()
    before = peer.settle(WRENCH)
    result, = node.set_parameters([Parameter('use_sim_time', value=True)])
    assert not result.successful and 'use_sim_time' in result.reason
    assert_allclose(peer.wait_for_ticks(3)[-1]['thruster_setpoints'],
                    before['thruster_setpoints'], atol=1e-9)
