"""The timer that makes the ticks which the schedule wants."""

from collections.abc import Callable, Mapping
from typing import Any

from rclpy.clock import Clock
from rclpy.node import Node
from thrust_allocator.schedule import Schedule


class Ticker:
    """Calls for a tick whenever one is due."""

    def __init__(self, node: Node, clock: Clock, values: Mapping[str, Any],
                 tick: Callable[[int, bool], None]) -> None:
        """
        Start.

        :param clock: that times are told by.
        :param values: checked parameters by name.
        :param tick: makes a tick at a time [ns], and is told whether it is late.
        """
        self._clock, self._make_tick = clock, tick
        self._schedule = Schedule(values, self.now())
        self._cancelled = False
        self._timer = node.create_timer(
            round(1e9 / values['rate']) * 1e-9, self._on_timer, clock=clock)
        self._after_messages = node.create_guard_condition(self._catch_up)

    def now(self) -> int:
        """Return the time [ns]."""
        return self._clock.now().nanoseconds

    def change(self, values: Mapping[str, Any]) -> None:
        """Go by other parameters from now on."""
        self._schedule.change(values)
        if self._schedule.on_wrench:
            self._wait_for_the_next()
            return
        period = round(1e9 / values['rate'])  # [ns]
        self._timer.timer_period_ns = period
        if self._timer.time_until_next_call() > period:
            self._timer.reset()

    def wrench_accepted(self, now: int, waited: int) -> None:
        """Make the tick that a wrench makes, or have it made as soon as it may be [ns]."""
        self._schedule.wrench_accepted(now, now - waited)
        if self._schedule.on_wrench and now:  # 0: /clock has not come yet
            if self._schedule.due <= now:
                self.tick()
            else:
                self._wait_for_the_next()

    def wrench_forgotten(self) -> None:
        """Expect no expiry of a wrench that counts no more."""
        self._schedule.forget_wrench()

    def stopped(self) -> None:
        """Make the tick that stops the vehicle, unless ticks come by the timer alone."""
        if self._schedule.on_wrench:
            self.tick()

    def clock_went_back(self) -> None:
        """Forget the last tick."""
        self._schedule.forget(self.now())
        if self._schedule.on_wrench:
            self._wait_for_the_next()

    def cancel(self) -> None:
        """Make no ticks any more, whatever comes."""
        self._cancelled = True
        self._timer.cancel()

    def tick(self) -> None:
        """Make a tick now."""
        if self._cancelled:
            return
        now = self.now()
        self._make_tick(now, self._schedule.tick(now))
        if self._schedule.on_wrench:
            self._wait_for_the_next()

    def _on_timer(self) -> None:
        if self._schedule.is_late(self.now()):
            self._after_messages.trigger()  # so that what has come meanwhile is taken first
        else:
            self.tick()

    def _catch_up(self) -> None:
        if self._schedule.due <= self.now():  # no wrench among the messages has made the tick
            self.tick()

    def _wait_for_the_next(self) -> None:
        """Have the timer, which would go on at its period otherwise, call when a tick is due."""
        self._timer.timer_period_ns = max(self._schedule.due - self.now(), 0)
        self._timer.reset()
