"""The signals that end the node, after it has published its last zeros."""

from collections.abc import Iterator
from contextlib import contextmanager
import signal


@contextmanager
def ending_signals() -> Iterator[list[int]]:
    """
    Note SIGINT, SIGTERM, SIGHUP and SIGQUIT instead of dying of them; yield those that have come.

    A SIGHUP that was ignored when the process started, by nohup, stays ignored. A second SIGQUIT
    does what it does by default. Afterwards all are ignored: Python, on its way out, would let them
    kill the process.
    """
    received: list[int] = []
    numbers = [signal.SIGINT, signal.SIGTERM, signal.SIGQUIT]
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        numbers.append(signal.SIGHUP)

    def note(number: int, frame: object) -> None:
        received.append(number)
        if number == signal.SIGQUIT:
            signal.signal(number, signal.SIG_DFL)

    for number in numbers:
        signal.signal(number, note)
    try:
        yield received
    finally:
        for number in numbers:
            signal.signal(number, signal.SIG_IGN)
