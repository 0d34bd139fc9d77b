"""The console: whoever writes never waits, whoever reads gets all that can be kept."""

import os
import pty
import signal
import time

import pytest
from thrust_allocator.ros import console
from thrust_allocator.ros.console import Console, unblocked


@pytest.fixture
def pipe():
    """Return the two ends of a pipe, which a test may close."""
    ends = os.pipe()
    yield ends
    for end in ends:
        try:
            os.close(end)
        except OSError:
            pass


def everything(end):
    """Return all that can be read from a file descriptor."""
    os.set_blocking(end, False)
    found = b''
    try:
        while text := os.read(end, 65536):
            found += text
    except BlockingIOError:
        pass
    return found


def test_what_is_written_arrives_whole_and_in_order(pipe):
    """Lines, pieces of lines, and what has no end of line."""
    out, into = pipe
    with unblocked([into]):
        for text in (b'one\n', b'tw', b'o\nthree\n\n', b'four'):
            os.write(into, text)
    assert everything(out) == b'one\ntwo\nthree\n\nfour'
    os.write(into, b'five')  # as before
    assert everything(out) == b'five'


def test_nobody_reads(pipe, monkeypatch):
    """Far more than the pipe holds goes by without a wait, and every lost line is counted."""
    monkeypatch.setattr(console, 'PATIENCE', 0.0)
    out, into = pipe
    first = Console(into)
    line, count = b'x' * 99 + b'\n', 20_000  # 2 MB, where a pipe holds 64 kB
    deadline = time.monotonic() + 20.0
    for _ in range(count):
        while True:
            try:
                os.write(into, line)
                break
            except BlockingIOError:  # told at once, never made to wait
                assert time.monotonic() < deadline
    arrived = 65536 // len(line)
    while first.lost < count - console.MOST - arrived - 1:
        assert time.monotonic() < deadline
        time.sleep(0.001)
    assert first.lost <= count - console.MOST
    first.close()


def test_the_terminal_is_gone():
    """What can be written nowhere is counted as lost, and nothing is raised."""
    ours, theirs = pty.openpty()
    with unblocked([theirs]) as (one,):
        os.close(ours)
        os.write(theirs, b'to nobody\nnor this\n')
    assert one.lost == 2
    os.close(theirs)


def test_a_terminal_that_reads_late(pipe):
    """What had to wait comes when it is read."""
    out, into = pipe
    text = b''.join(b'%d\n' % i for i in range(1500))
    with unblocked([into]) as (one,):
        os.write(into, text)
        found = b''
        while len(found) < len(text):
            found += os.read(out, 100)
    assert found == text and one.lost == 0


def test_signals_are_noted_and_a_hangup_stays_ignored():
    """nohup's SIGHUP is let be; a second SIGQUIT is back to its default."""
    from thrust_allocator.ros.ending import ending_signals

    before = {number: signal.getsignal(number) for number in (
        signal.SIGINT, signal.SIGTERM, signal.SIGQUIT, signal.SIGHUP)}
    try:
        for ignored in (False, True):
            signal.signal(signal.SIGHUP, signal.SIG_IGN if ignored else signal.SIG_DFL)
            with ending_signals() as received:
                for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
                    signal.raise_signal(number)
                assert signal.getsignal(signal.SIGQUIT) == signal.SIG_DFL
            expected = [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT]
            assert received == [one for one in expected if not ignored or one != signal.SIGHUP]
            assert signal.getsignal(signal.SIGTERM) == signal.SIG_IGN
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
