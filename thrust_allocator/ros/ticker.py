"""The timer that makes the ticks which the schedule wants."""

from collections.abc import Callable, Mapping
import time
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from thrust_allocator.schedule import Schedule


class Ticker:
    """Calls for a tick whenever one is due."""

    def __init__(self, node: Node, clock: Clock, values: Mapping[str, Any],
                 tick: Callable[[int, bool], None], fetch_wrench: Callable[[], None]) -> None:
        """
        Start.

        :param clock: that times are told by.
        :param values: checked parameters by name.
        :param tick: makes a tick at a time [ns], and is told whether it is late.
        :param fetch_wrench: has a wrench accepted that has come and waits.
        """
        # The steady clock of ROS is the system's monotonic one, which Python tells faster
        self.now = (time.monotonic_ns if clock.clock_type == ClockType.STEADY_TIME
                    else lambda: clock.now().nanoseconds)  # [ns]
        self._make_tick, self._fetch_wrench = tick, fetch_wrench
        self._schedule = Schedule(values, self.now())
        self._cancelled = False
        self._period = round(1e9 / values['rate'])  # of the timer [ns]
        self._timer = node.create_timer(self._period * 1e-9, self._on_timer, clock=clock)

    def change(self, values: Mapping[str, Any]) -> None:
        """Go by other parameters from now on."""
        self._schedule.change(values)
        if self._schedule.on_wrench:
            self._wait_for_the_next(self.now())
            return
        self._period = self._timer.timer_period_ns = round(1e9 / values['rate'])
        if self._timer.time_until_next_call() > self._period:
            self._timer.reset()

    def wrench_accepted(self, now: int, waited: int) -> None:
        """Make the tick that a wrench makes, or have it made as soon as it may be [ns]."""
        self._schedule.wrench_accepted(now, now - waited)
        if self._schedule.on_wrench and now:  # 0: /clock has not come yet
            if self._schedule.due <= now:
                self.tick()
            else:
                self._wait_for_the_next(now)

    def wrench_forgotten(self) -> None:
        """Expect no expiry of a wrench that counts no more."""
        self._schedule.forget_wrench()

    def stopped(self) -> None:
        """Make the tick that stops the vehicle, unless ticks come by the timer alone."""
        if self._schedule.on_wrench:
            self.tick()

    def clock_went_back(self) -> None:
        """Forget the last tick."""
        now = self.now()
        self._schedule.forget(now)
        if self._schedule.on_wrench:
            self._wait_for_the_next(now)

    def cancel(self) -> None:
        """Make no ticks any more, whatever comes."""
        self._cancelled = True
        self._timer.cancel()

    def tick(self) -> None:
        """Make a tick now."""
        if self._cancelled:
            return
        now = self.now()
        late = self._schedule.tick(now)
        if self._schedule.on_wrench:
            self._wait_for_the_next(now)
        self._make_tick(now, late)

    def _on_timer(self) -> None:
        self._fetch_wrench()
        if not self._schedule.on_wrench or self._schedule.due <= self.now():
            self.tick()  # else that wrench has made it

    def _wait_for_the_next(self, now: int) -> None:
        """Have the timer, which would go on at its period otherwise, call when a tick is due."""
        wait = max(self._schedule.due - now, 0)
        if wait != self._period:  # mostly it is 1.5 periods of ticks once more
            self._period = self._timer.timer_period_ns = wait
        self._timer.reset()
