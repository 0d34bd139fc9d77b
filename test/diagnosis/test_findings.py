"""Findings: when one begins, when it is over, and how often it is logged."""

from support.log import Log
from thrust_allocator.diagnosis.findings import Findings, Level

SECOND = 10**9  # [ns]


def run(noted, seconds=60, step=SECOND // 10):
    """Return log and reports (time in s, message) where `noted` gives a finding's text by time."""
    log, reports = Log(), []
    findings = Findings(log)
    for now in range(0, seconds * SECOND, step):
        findings.note('kind', noted(now / SECOND), now)
        if now % SECOND == 0:
            reports.append((now // SECOND, findings.overall(now)[1]))
    return log.lines, reports


def test_it_begins_at_once_and_is_over_after_two_seconds():
    """A finding from 5 s to 20 s is reported until 22 s, and logged at both ends."""
    lines, reports = run(lambda time: 'bad' if 5.0 <= time < 20.0 else '')
    assert [time for time, message in reports if message == 'bad'] == list(range(5, 22))
    assert lines == [('warning', 'bad'), ('info', 'no longer: bad')]


def test_the_worst_leads():
    """All that is wrong stands in one line; an error comes before warnings, at its own level."""
    log = Log()
    findings = Findings(log)
    assert findings.overall(0) == (Level.OK, 'allocating')
    findings.note('time', 'late', 0)
    assert findings.overall(0) == (Level.WARN, 'late')
    findings.note('solver', 'broken', 0, Level.ERROR)
    assert findings.overall(0) == (Level.ERROR, 'broken; late')
    assert log.lines == [('warning', 'late'), ('error', 'broken')]


def test_a_flapping_finding_fills_no_log():
    """A DVL at 1.8 Hz with a time-out of 0.5 s: one finding all the time, and a single line."""
    lines, reports = run(lambda time: 'no odometry' if time % (1 / 1.8) > 0.5 else '', step=10**7)
    assert lines == [('warning', 'no odometry')]
    assert all(message == 'no odometry' for time, message in reports if time >= 1)


def test_what_comes_and_goes_slowly_is_one_line_in_ten_seconds():
    """On for 1 s in every 5: its end is seen each time, but there is one line in 10 s at most."""
    lines, reports = run(lambda time: 'bad' if time % 5.0 < 1.0 else '', seconds=100)
    assert len(lines) <= 100 / 10 + 1
    assert {message for _, message in reports} == {'bad', 'allocating'}


def test_the_log_is_right_in_the_end():
    """An end that fell into the quiet time is logged once that has passed."""
    lines, _ = run(lambda time: 'bad' if time < 1.0 else '', seconds=12)
    assert lines == [('warning', 'bad'), ('info', 'no longer: bad')]
    lines, _ = run(lambda time: 'bad' if time < 1.0 or time > 5.0 else '', seconds=30)
    assert lines == [('warning', 'bad')]


def test_new_words_for_the_same_finding_are_no_new_line():
    """The text may change all the time: the newest is reported, the first one logged."""
    lines, reports = run(lambda time: f'since {time:.1f} s')
    assert lines == [('warning', 'since 0.0 s')]
    assert reports[7] == (7, 'since 7.0 s')


def test_each_kind_for_itself():
    """One finding does not silence another."""
    log = Log()
    findings = Findings(log)
    for kind in ('one', 'two', 'three'):
        findings.note(kind, kind, 0)
    assert [text for _, text in log.lines] == ['one', 'two', 'three']
    findings.note('two', '', SECOND)
    assert findings.present('one') == 'one' and findings.present('two') == ''
    assert findings.overall(4 * SECOND) == (Level.WARN, 'one; three')


def test_a_clock_that_jumps_backwards():
    """What had gone before the jump is over 2 s after it, and is logged 10 s after it at most."""
    log = Log()
    findings = Findings(log)
    findings.note('kind', 'bad', 1000 * SECOND)
    findings.note('kind', '', 1001 * SECOND)
    assert findings.overall(SECOND) == (Level.WARN, 'bad')
    assert findings.overall(3 * SECOND) == (Level.OK, 'allocating')
    findings.overall(20 * SECOND)
    assert log.lines == [('warning', 'bad'), ('info', 'no longer: bad')]
