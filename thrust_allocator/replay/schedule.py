"""When the node ticks, for recordings that do not hold its setpoints."""

from collections.abc import Iterator, Mapping
from math import inf
from typing import Any

SILENCE = 60 * 10**9  # [ns]


class Schedule:
    """
    The times of the ticks: on each accepted wrench, and by the heartbeat where none comes.

    Without `tick_on_wrench` they come at `rate`, whatever is received.
    """

    def __init__(self, values: Mapping[str, Any], start: int) -> None:
        """Begin at a time [ns], with checked parameters by name."""
        self._last: float = start  # tick [ns]
        self._heard = start  # of a message [ns]
        self._last_by_wrench, self._due, self._expiry = -inf, inf, inf  # [ns]
        self.change(values)

    def change(self, values: Mapping[str, Any]) -> None:
        """Go by other parameters from now on."""
        self._period = round(1e9 / values['rate'])
        self._on_wrench = values.get('tick_on_wrench', False)
        self._timeout = round(values['wrench_timeout'] * 1e9)

    def wrench_accepted(self, now: int) -> None:
        """Note that a wrench came: it makes a tick, half a period after the last one that did."""
        self._expiry = now + self._timeout + 1
        if self._on_wrench:
            self._due = min(self._due, max(now, self._last_by_wrench + self._period // 2))

    def until(self, time: int) -> Iterator[int]:
        """
        Yield the times of the ticks that come before a time [ns], when the next message does.

        In a long silence all are alike: after a minute of it none are made.
        """
        silent, self._heard = self._heard + SILENCE, time
        while (moment := self._next()) < time:
            if moment > silent:
                self._last = time
                return
            if moment == self._due:
                self._last_by_wrench, self._due = moment, inf
            if moment >= self._expiry:
                self._expiry = inf
            self._last = moment
            yield int(moment)

    def _next(self) -> float:
        if not self._on_wrench:
            return self._last + self._period
        return min(self._last + self._period * 3 // 2, self._due, self._expiry)
