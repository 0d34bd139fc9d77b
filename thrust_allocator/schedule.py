"""When a tick is due: by a wrench, by the heartbeat, or by a timer. No clock is read here."""

from collections.abc import Mapping
from typing import Any


class Schedule:
    """
    Says when the next tick is due, and whether the one that comes is late; times are in ns.

    With `tick_on_wrench` a wrench makes a tick at once, but not within half a period of the last
    one that a wrench made; the expiry of the last wrench makes one, and so does the heartbeat,
    1.5 periods after the last of any kind. Otherwise a tick is due one period after the last.
    """

    def __init__(self, values: Mapping[str, Any], now: int) -> None:
        """Begin with checked parameters by name."""
        self._last = now  # tick
        self._last_by_wrench: int | None = None  # tick that answered a new wrench
        self._arrived: int | None = None  # the oldest wrench that no tick has answered
        self._received: int | None = None  # the newest wrench, until it has expired
        self.on_wrench, self._period = False, 0
        self.change(values)

    def change(self, values: Mapping[str, Any]) -> None:
        """Go by other parameters from now on; if they move the next tick, it is not late."""
        before = self.on_wrench, self._period
        self.on_wrench, self._period = values['tick_on_wrench'], round(1e9 / values['rate'])
        self._timeout = round(values['wrench_timeout'] * 1e9)
        self._excused = before != (self.on_wrench, self._period)

    def wrench_accepted(self, now: int, arrived: int | None = None) -> None:
        """Note that a wrench counts from now on; it may have arrived earlier."""
        self._received = now
        if self._arrived is None:
            self._arrived = now if arrived is None else arrived

    def forget_wrench(self) -> None:
        """Expect no expiry any more: the wrench counts no longer."""
        self._received = self._arrived = None

    def forget(self, now: int) -> None:
        """Forget ticks and wrench: the clock has gone back."""
        self._last, self._last_by_wrench, self._excused = now, None, True
        self.forget_wrench()

    @property
    def due(self) -> int:
        """Return when the next tick is due, if nothing else comes before."""
        if not self.on_wrench:
            return self._last + self._period
        due = self._last + self._period * 3 // 2
        if self._received is not None:
            due = min(due, max(self._received + self._timeout + 1, self._last))
        if self._arrived is not None:
            due = min(due, self._due_by_wrench(self._arrived))
        return due

    def _due_by_wrench(self, arrived: int) -> int:
        if self._last_by_wrench is None:
            return arrived
        return max(arrived, self._last_by_wrench + (self._period + 1) // 2)

    def is_late(self, now: int) -> bool:
        """Tell whether a tick now comes more than half a period after it was due."""
        return not self._excused and 2 * (now - self.due) > self._period

    def tick(self, now: int) -> bool:
        """Note that a tick is made now, for the newest of all; return whether it is late."""
        late = self.is_late(now)
        if self._arrived is not None:
            self._arrived, self._last_by_wrench = None, now
        if self._received is not None and now > self._received + self._timeout:
            self._received = None
        self._last, self._excused = now, False
        return late
