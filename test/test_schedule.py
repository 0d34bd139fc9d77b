"""When ticks come, without ROS: by wrenches, the heartbeat, an expiry, or a timer; what is late."""

from hypothesis import given, strategies as st
import pytest
from thrust_allocator.schedule import Schedule

MS = 10**6  # [ns]
PERIOD = 20 * MS
VALUES = {'rate': 50.0, 'tick_on_wrench': True, 'wrench_timeout': 0.1}
TIMER = {**VALUES, 'tick_on_wrench': False}


def ticks_until(schedule, time):
    """Make every tick on time that is due before a time, and return when [ns]."""
    times = []
    while schedule.due < time:
        times.append(schedule.due)
        assert not schedule.tick(schedule.due)
    return times


def test_without_tick_on_wrench_only_the_period_counts():
    """A tick each period, whatever comes."""
    schedule = Schedule(TIMER, 0)
    schedule.wrench_accepted(10 * MS)
    assert ticks_until(schedule, 61 * MS) == [20 * MS, 40 * MS, 60 * MS]


def test_a_wrench_makes_a_tick_at_once():
    """The first at once; the next half a period later, for all that came; then the heartbeat."""
    schedule = Schedule(VALUES, 0)
    assert not ticks_until(schedule, 10 * MS)
    schedule.wrench_accepted(10 * MS)
    assert ticks_until(schedule, 12 * MS) == [10 * MS]
    schedule.wrench_accepted(12 * MS)
    schedule.wrench_accepted(13 * MS)
    assert ticks_until(schedule, 75 * MS) == [20 * MS, 50 * MS]


def test_a_wrench_just_after_a_heartbeat_does_not_wait():
    """Heartbeats do not keep a wrench away, only ticks that a wrench made do."""
    schedule = Schedule(VALUES, 0)
    assert ticks_until(schedule, 31 * MS) == [30 * MS]
    schedule.wrench_accepted(31 * MS)
    assert ticks_until(schedule, 32 * MS) == [31 * MS]


def test_the_expiry_of_the_newest_wrench_makes_a_tick():
    """One, as soon as the wrench is too old; none for a wrench that counts no more."""
    schedule = Schedule(VALUES, 0)
    schedule.wrench_accepted(0)
    schedule.wrench_accepted(13 * MS)
    assert ticks_until(schedule, 150 * MS) == [
        0, 30 * MS, 60 * MS, 90 * MS, 113 * MS + 1, 143 * MS + 1]
    schedule.wrench_accepted(150 * MS)
    schedule.tick(150 * MS)
    schedule.forget_wrench()
    assert ticks_until(schedule, 300 * MS) == [150 * MS + 30 * MS * n for n in range(1, 5)]


def test_a_shorter_time_out_expires_the_wrench_at_once():
    """A change that makes the wrench too old makes the tick now, not in the past."""
    schedule = Schedule({**VALUES, 'wrench_timeout': 60.0}, 0)
    schedule.wrench_accepted(0)
    assert ticks_until(schedule, 200 * MS)[-1] == 180 * MS
    schedule.change(VALUES)
    assert ticks_until(schedule, 220 * MS) == [180 * MS, 210 * MS]


def test_after_the_clock_has_gone_back_the_last_tick_is_forgotten():
    """A wrench is answered at once, the heartbeat counts from the jump, and nothing is late."""
    for mode in (VALUES, TIMER):
        schedule = Schedule(mode, 1000 * MS)
        schedule.wrench_accepted(1000 * MS)
        ticks_until(schedule, 1100 * MS)
        schedule.forget(500 * MS)
        assert schedule.due == 500 * MS + (30 if schedule.on_wrench else 20) * MS
        assert not schedule.is_late(900 * MS)
    schedule = Schedule(VALUES, 1000 * MS)
    schedule.wrench_accepted(1000 * MS)
    schedule.tick(1000 * MS)
    schedule.forget(1000 * MS - 1)
    schedule.wrench_accepted(1000 * MS - 1)
    assert schedule.due == 1000 * MS - 1


@pytest.mark.parametrize('mode, wrench, due', [
    (TIMER, None, 20), (TIMER, 5, 20), (VALUES, None, 30), (VALUES, 5, 10), (VALUES, 14, 14)])
def test_late_is_more_than_half_a_period_after_it_was_due(mode, wrench, due):
    """For a heartbeat, a timer, and a wrench that came late or early after the last tick."""
    for after, late in ((0, False), (10 * MS, False), (10 * MS + 1, True)):
        schedule = Schedule(mode, 0)
        schedule.wrench_accepted(0)
        schedule.tick(0)
        if wrench is not None:
            schedule.wrench_accepted(wrench * MS)
        assert schedule.due == due * MS
        assert schedule.tick(due * MS + after) is late
        assert not schedule.is_late(due * MS + after), 'one tick makes up for all that were missed'


def test_a_wrench_that_lay_about_is_late_though_it_is_answered_at_once():
    """It counts when it arrived, and the oldest of them, not when it was taken."""
    schedule = Schedule(VALUES, 0)
    schedule.wrench_accepted(0)
    schedule.tick(0)
    schedule.wrench_accepted(25 * MS, arrived=12 * MS)
    schedule.wrench_accepted(26 * MS, arrived=26 * MS)
    assert schedule.tick(26 * MS)


@pytest.mark.parametrize('changed', [{'rate': 49.0}, {'tick_on_wrench': False}])
def test_a_change_that_moves_the_next_tick_makes_none_late(changed):
    """After a change of rate or mode the next tick is not late, the one after it may be."""
    schedule = Schedule(VALUES, 0)
    schedule.tick(0)
    schedule.change({**VALUES, 'wrench_timeout': 1.0})
    assert schedule.is_late(1000 * MS)
    schedule.change({**VALUES, **changed})
    assert not schedule.tick(1000 * MS) and schedule.tick(2000 * MS)


@given(gaps=st.lists(st.integers(0, 3 * PERIOD), min_size=1, max_size=60),
       rate=st.floats(1.0, 1000.0))
def test_ticks_by_wrenches_keep_half_a_period_apart(gaps, rate):
    """However they come: each is answered, none too soon or too late, and never a pause."""
    period = round(1e9 / rate)
    schedule = Schedule({**VALUES, 'rate': rate, 'wrench_timeout': 1e3}, 0)
    now, ticks, by_wrench, waiting = 0, [0], [], None
    for gap in (*gaps, 4 * period):
        now += gap
        while schedule.due <= now:
            time = schedule.due
            schedule.tick(time)
            assert 0 <= time - ticks[-1] <= 1.5 * period
            if waiting is not None:
                assert time - waiting <= period / 2 + 1
                by_wrench.append(time)
                waiting = None
            ticks.append(time)
        schedule.wrench_accepted(now)
        waiting = now if waiting is None else waiting
    assert all(2 * (b - a) >= period for a, b in zip(by_wrench, by_wrench[1:]))
