"""Ticks that wrenches make, and heartbeats where none come, on the clock of the test."""

import numpy as np
from numpy.testing import assert_array_equal
import pytest
from rclpy.parameter import Parameter
from support.peer import TYPES_OUT
from support.stepped_peer import inside_limits, is_stopped, PERIOD, rest_of, SECOND
from support.vehicles import NAMES

WRENCH = np.array([60.0, 0.0, 10.0, 0.0, 20.0, -15.0])
TWIST = [0.3, 0.1, -0.1, 0.02, 0.05, -0.02]
MS = 10**6  # [ns]


@pytest.fixture
def by_wrench(stepped):
    """Return a function that starts the node with ticks on wrenches."""
    def begin(*rules):
        peer = stepped('tick_on_wrench:=true', *rules)
        pulse(peer)  # the first time on /clock may make a tick
        return peer
    return begin


def run(peer, time, step=5 * MS):
    """Let so much time pass, step by step, and return (time, tick) of each tick [ns]."""
    found, end = [], peer.time + time
    while peer.time < end:
        peer.time += step
        found += pulse(peer)
    return found


def pulse(peer, *send):
    """Tell the present time, call what is given, and return (time, tick) of the ticks made."""
    peer.received.clear()
    before = peer.ticks_seen
    peer.pulse()
    for call in send:
        call()
    for _ in range(12):
        peer.spinner.spin_once(timeout_sec=0.0)
    if peer.ticks_seen > before:
        peer.wait_until(lambda: len(peer.received) == 4 * (peer.ticks_seen - before), 'the rest')
    return [(peer.time, {item.topic: item.values for item in peer.received[i:i + 4]})
            for i in range(0, len(peer.received), len(TYPES_OUT))]


def answer(peer, wrench=None, twist=None, period=PERIOD):
    """Let a period pass, send a wrench, and return the tick that it makes at once."""
    peer.wrench = peer.wrench if wrench is None else wrench
    peer.twist = peer.twist if twist is None else twist
    peer.time += period
    peer.received.clear()
    before = peer.ticks_seen
    peer.pulse()
    peer.send()
    peer.wait_until(lambda: peer.ticks_seen > before, 'a tick')
    assert peer.ticks_seen == before + 1
    return {item.topic: item.values for item in peer.received}


def test_both_modes_decide_the_same_at_the_same_times(stepped, by_wrench):
    """Ticks on wrenches and on the timer are equal to the bit, whatever the vehicle does."""
    rules = [f'thrusters.{name}.max_rate:=300.0' for name in NAMES]
    peers = stepped(*rules), by_wrench(*rules)
    random = np.random.default_rng(3)
    for number in range(80):
        wrench, twist = random.uniform(-150.0, 150.0, 6), random.uniform(-1.0, 1.0, 6)
        if number % 40 == 20:
            for peer in peers:
                assert peer.switch(left=number > 40)[0].successful
        one, other = peers[0].step(wrench, twist), answer(peers[1], wrench, twist)
        for topic in TYPES_OUT:
            assert one[topic].tobytes() == other[topic].tobytes(), (number, topic)
        assert inside_limits(one)


def test_a_tick_sees_the_velocity_that_came_with_its_wrench(by_wrench):
    """Whichever of the two was sent first, and though both wait to be taken."""
    peer = by_wrench()
    for speed in (0.4, 0.8, 1.2):
        assert_array_equal(answer(peer, WRENCH, [speed] + [0.0] * 5)['thrust_limits'],
                           peer.limits_at(speed))
    peer.time += PERIOD
    (_, tick), = pulse(peer, lambda: peer.send_wrench(WRENCH),
                       lambda: peer.send_twist([0.2] + [0.0] * 5))
    assert_array_equal(tick['thrust_limits'], peer.limits_at(0.2))


def test_heartbeats_and_wrenches_between_them(by_wrench):
    """1.5 periods after the last tick of any kind; a wrench just after a heartbeat is answered."""
    peer = by_wrench('wrench_timeout:=60.0')
    answer(peer, WRENCH, TWIST)
    begun = peer.time
    assert [time - begun for time, _ in run(peer, 70 * MS)] == [30 * MS, 60 * MS]
    assert rest_of(2 * WRENCH, answer(peer, 2 * WRENCH, period=MS)) < 1e-9
    begun = peer.time
    assert [time - begun for time, _ in run(peer, 35 * MS)] == [30 * MS]


def test_wrenches_that_come_too_fast(by_wrench):
    """A wrench each second millisecond makes a tick each half period, for the newest of them."""
    peer = by_wrench()
    answer(peer, WRENCH)
    begun, ticks = peer.time, []
    for number in range(22):
        peer.time += 2 * MS
        peer.wrench = WRENCH * (1.0 + 0.01 * number)
        ticks += pulse(peer, peer.send)
    assert [time - begun for time, _ in ticks] == [10 * MS, 20 * MS, 30 * MS, 40 * MS]
    for time, tick in ticks:  # that of the same moment counts already
        newest = (time - begun) // (2 * MS) - 1
        assert rest_of(WRENCH * (1.0 + 0.01 * newest), tick) < 1e-9
    (_, last), = run(peer, 6 * MS, 6 * MS)
    assert rest_of(peer.wrench, last) < 1e-9, 'what comes last is not lost'


def test_stopping_makes_a_tick_at_once(by_wrench):
    """~/enable false publishes zeros before any time has passed; true waits for a wrench."""
    peer = by_wrench()
    assert not is_stopped(answer(peer, WRENCH, TWIST))
    peer.silence('wrench')
    (_, tick), = pulse(peer, lambda: peer.enable(False))
    assert is_stopped(tick)
    assert_array_equal(tick['unallocated_wrench'], WRENCH)
    assert not pulse(peer, lambda: peer.enable(False)), 'it stands already'
    assert not pulse(peer, lambda: peer.enable(True))
    assert is_stopped(run(peer, 30 * MS)[0][1])
    assert not is_stopped(answer(peer, WRENCH))


def test_an_expired_wrench_makes_a_tick_at_once(by_wrench):
    """Zeros as soon as the wrench is too old, and not when the heartbeat comes."""
    peer = by_wrench('wrench_timeout:=0.1')
    answer(peer, WRENCH, TWIST)
    begun = peer.time
    peer.silence('wrench', 'twist')
    stopped = {time - begun: is_stopped(tick) for time, tick in [
        *run(peer, 100 * MS, 10 * MS), *run(peer, 2 * MS, MS), *run(peer, 30 * MS, 10 * MS)]}
    assert stopped == {30 * MS: False, 60 * MS: False, 90 * MS: False, 101 * MS: True,
                       132 * MS: True}
    assert 'no wrench' in peer.report()[1]


def test_the_clock_goes_back(by_wrench):
    """A wrench is answered at once though the last tick lies ahead, and heartbeats count anew."""
    peer = by_wrench('wrench_timeout:=60.0')
    answer(peer, WRENCH, TWIST)
    before = answer(peer)
    peer.silence('wrench', 'twist')
    peer.time -= 500 * SECOND
    assert not pulse(peer)
    begun = peer.time
    (time, tick), = run(peer, 30 * MS)
    assert time - begun == 30 * MS and is_stopped(tick)
    again = answer(peer, WRENCH, TWIST, period=MS)
    assert_array_equal(again['thruster_setpoints'], before['thruster_setpoints'])
    assert peer.report()[2]['ticks late'] == '0'


@pytest.mark.parametrize('periods, late', [(2.0, '0'), (2.05, '1')])
def test_from_when_a_heartbeat_is_late(by_wrench, periods, late):
    """From half a period after it was due on; one tick makes up for all that were missed."""
    peer = by_wrench()
    answer(peer, WRENCH, TWIST)
    peer.report()
    peer.time += round(periods * PERIOD)
    assert len(pulse(peer, peer.send)) == 1, 'for the wrench, in place of the heartbeat'
    assert peer.report()[2]['ticks late'] == late


def test_a_standing_clock_makes_no_heartbeats(by_wrench):
    """A wrench is answered once where the clock stands, and no more until it moves."""
    peer = by_wrench()
    answer(peer, WRENCH, TWIST)
    peer.report()
    assert sum(len(pulse(peer, peer.send)) for _ in range(20)) == 0
    level, message, figures = peer.report()
    assert level == 'WARN' and 'the clock stands: no ticks' in message
    assert figures['ticks'] == '0'
    assert not is_stopped(answer(peer))


def test_no_tick_before_the_clock_has_come(start):
    """With use_sim_time a wrench makes none either until /clock tells a time."""
    _, peer = start('use_sim_time:=true')
    publisher = peer._inputs['cmd_wrench']
    peer.wait_until(publisher.get_subscription_count, 'the node')
    for _ in range(20):
        peer.send_wrench(WRENCH)
        peer.spinner.spin_once(timeout_sec=0.02)
    assert not peer.received


def test_the_mode_is_changed_while_running(by_wrench):
    """Off: a tick each period and none by a wrench; on again: by wrenches."""
    peer = by_wrench('wrench_timeout:=60.0')
    answer(peer, WRENCH, TWIST)
    for on, gap in ((False, 20 * MS), (True, 30 * MS)):
        assert peer.set_parameters_of_node([Parameter('tick_on_wrench', value=on)])[0].successful
        run(peer, 30 * MS, 10 * MS)
        times = [time for time, _ in run(peer, 100 * MS, 10 * MS)]
        assert set(np.diff(times)) == {gap}
        peer.time += MS
        assert len(pulse(peer, peer.send)) == on
