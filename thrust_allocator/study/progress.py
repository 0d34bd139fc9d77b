"""Progress of a long run, on stderr."""

import sys
import time

SILENCE = 2.0  # a run shorter than this says nothing [s]
INTERVAL = {True: 0.5, False: 10.0}  # between two notes, by whether stderr is a terminal [s]


class Progress:
    """Says now and then how many of something are done."""

    def __init__(self, program: str = 'study', things: str = 'points') -> None:
        """Begin; `program` stands in front of each note, which counts `things`."""
        self._program, self._things = program, things
        self._start = self._last = time.monotonic()
        self._terminal = sys.stderr.isatty()
        self._said = False

    def __call__(self, done: int, total: int) -> None:
        """Note that `done` of `total` are done; print it if it is time to."""
        now = time.monotonic()
        elapsed = now - self._start
        last = done >= total
        due = elapsed > SILENCE and now - self._last >= INTERVAL[self._terminal]
        if not (due or last and self._said):
            return
        self._said, self._last = True, now
        left = elapsed / done * (total - done)
        end = '\r' if self._terminal and not last else '\n'
        print(f'{self._program}: {done} of {total} {self._things}, {elapsed:.0f} s gone, '
              f'{left:.0f} s to go   ', end=end, file=sys.stderr, flush=True)
