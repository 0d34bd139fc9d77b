"""A console that never makes the node wait: who does not read costs lines, and no ticks."""

from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
import os
from threading import Condition, Thread
import time

MOST = 2000  # lines that wait for a terminal to read them
PATIENCE = 0.5  # longest wait for it at the end [s]


class Console:
    """
    Stands between a file descriptor and where it leads.

    What is written to the descriptor, by Python or by the libraries of ROS below it, goes into a
    pipe; one thread empties the pipe at once, another hands the lines on as fast as they are read.
    """

    def __init__(self, descriptor: int) -> None:
        """Take the place of a file descriptor, such as 2."""
        self.lost = 0  # lines
        self._descriptor, self._real = descriptor, os.dup(descriptor)
        self._lines: deque[bytes] = deque()
        self._change = Condition()
        self._ended = False  # whether no more lines will come
        out, into = os.pipe()
        os.set_blocking(into, False)
        os.dup2(into, descriptor)
        os.close(into)
        Thread(target=self._collect, args=(out,), daemon=True).start()
        Thread(target=self._hand_on, daemon=True).start()

    def close(self) -> None:
        """Give the descriptor back, once all has been handed on or after a short time."""
        os.dup2(self._real, self._descriptor)  # was the last end of the pipe to write to
        deadline = time.monotonic() + PATIENCE
        with self._change:
            while not self._ended or self._lines:
                if not self._change.wait(max(deadline - time.monotonic(), 0.0)):
                    break

    def _collect(self, out: int) -> None:
        rest = b''
        while text := os.read(out, 65536):
            *lines, rest = (rest + text).split(b'\n')
            self._keep([line + b'\n' for line in lines])
        os.close(out)
        self._keep([rest] if rest else [], ended=True)

    def _keep(self, lines: list[bytes], ended: bool = False) -> None:
        with self._change:
            for line in lines:
                if len(self._lines) < MOST:
                    self._lines.append(line)
                else:
                    self.lost += 1
            self._ended = ended
            self._change.notify_all()

    def _hand_on(self) -> None:
        while True:
            with self._change:
                while not self._lines:
                    if self._ended:
                        return
                    self._change.wait()
                line = self._lines[0]
            try:
                while line:
                    line = line[os.write(self._real, line):]
            except OSError:  # the terminal is gone
                with self._change:
                    self.lost += 1
            with self._change:
                self._lines.popleft()
                self._change.notify_all()


@contextmanager
def unblocked(descriptors: Iterable[int] = (1, 2)) -> Iterator[list[Console]]:
    """Have these file descriptors never block a writer for as long as the context lasts."""
    if os.isatty(2):  # which rcutils cannot see any more
        os.environ.setdefault('RCUTILS_COLORIZED_OUTPUT', '1')
    consoles = [Console(descriptor) for descriptor in descriptors]
    try:
        yield consoles
    finally:
        for console in consoles:
            console.close()
