"""What is read of /proc, of a process whose doings are known, and which gaps are kept."""

import os
import time

from thrust_allocator.benchmark.stalls import Facts, Gaps, Watch

NONE = Facts(0.0, 0.0, 0, 0, 0, 0.0, 0.0, 0.0)


def test_a_process_that_works_and_touches_memory():
    """Its CPU time is what Python's own clock says, and each new page is a fault."""
    watch = Watch(os.getpid())
    clock, before = time.thread_time(), watch.read()
    pages = bytearray(4 * 2**20)  # 1,024 pages, or a few huge ones
    while time.thread_time() < clock + 0.05:
        pages[::4096] = bytes(len(pages[::4096]))
    found = watch.read().since(before)
    ran = 1e3 * (time.thread_time() - clock)
    assert 45.0 <= found.ran <= ran + 20.0
    assert found.faults > 0 and found.waited >= 0.0 and found.observer_waited >= 0.0
    watch.close()


def test_a_process_that_has_ended(launch):
    """There is nothing to read any more."""
    process = launch('-c', 'input()')
    watch = Watch(process.pid)
    assert watch.read() is not None
    process.kill()
    process.wait()
    assert watch.read() is None
    watch.close()


def test_the_longest_gaps_are_kept():
    """Five of them, the longest first, each with its facts."""
    gaps = Gaps()
    for length in (3.0, 9.0, 1.0, 7.0, 5.0, 8.0, 2.0):
        gaps.note(length, length / 10.0, NONE._replace(faults=int(length)))
    lines = gaps.lines()
    assert [line.split(':')[0] for line in lines] == [
        f'gap of {length}.0 ms at 0.{length}0 min' for length in (9, 8, 7, 5, 3)]
    assert '9 page faults and 0 from a disk' in lines[0]
