"""Interleaved measurement: every contender once per tick, on the same ticks, in changing order."""

from collections.abc import Callable, Sequence
import gc
from time import perf_counter_ns

import numpy as np
from thrust_allocator.benchmark.rivals import Ours, Rival
from thrust_allocator.benchmark.ticks import Tick, Walk
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.vehicle import Vehicle

REPEATS = 3  # of a sequence; a tick counts with the median of its times


class Contender:
    """A kind of rival and what was measured of it, one entry per tick that it was given."""

    def __init__(self, kind: type[Rival], vehicle: Vehicle, every: int = 1) -> None:
        """Take every tick, or one in `every`."""
        self.name, self.every = kind.name, every
        self._make: Callable[[], Rival] = lambda: kind(vehicle)
        self._times: list[list[int]] = []  # of each repeat [ns]
        self.errors: list[float] = []  # greatest distance of a thrust from the optimum [N]
        self.unsolved = 0  # ticks of the last repeat

    def restart(self) -> None:
        """Begin another repeat with a rival that knows nothing of the one before."""
        self.rival, self.unsolved = self._make(), 0
        self._times.append([])

    def run(self, tick: Tick, optimum: np.ndarray | None) -> None:
        """Solve one tick, timed, and judge the answer, untimed."""
        solve, thrusts = self.rival.solve, None
        begin = perf_counter_ns()
        try:
            thrusts = solve(tick.wrench, tick.limits)
        except (ValueError, RuntimeError):  # how quadprog and others refuse a problem
            pass
        self._times[-1].append(perf_counter_ns() - begin)
        self._judge(thrusts, optimum)

    def _judge(self, thrusts: np.ndarray | None, optimum: np.ndarray | None) -> None:
        self.unsolved += thrusts is None or not self.rival.solved
        if thrusts is not None and optimum is not None:
            self.errors.append(float(np.abs(thrusts - optimum).max()))

    @property
    def times(self) -> np.ndarray:
        """Return the time of each tick [us]."""
        return np.median(self._times, axis=0) / 1e3


class WholeTick(Contender):
    """Our bounds and solve in a row, as the node runs them."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(Ours, vehicle)
        self.name = 'bounds + solve'
        self.iterations: list[int] = []  # OSQP's
        self._bounds = ThrustBounds(vehicle)
        self._bounds_times: list[list[int]] = []  # of each repeat [ns]

    def restart(self) -> None:
        """Begin another repeat."""
        super().restart()
        self._bounds_times.append([])

    def run(self, tick: Tick, optimum: np.ndarray | None) -> None:
        """Compute the bounds and solve, timed; judge the answer, untimed."""
        bounds, solve, velocity = self._bounds, self.rival.solve, tick.velocity
        begin = perf_counter_ns()
        bounds(velocity)
        middle = perf_counter_ns()
        thrusts = solve(tick.wrench, tick.limits)  # these are the bounds, and 0 where switched off
        end = perf_counter_ns()
        self._bounds_times[-1].append(middle - begin)
        self._times[-1].append(end - begin)
        self.iterations.append(self.rival.iterations)
        self._judge(thrusts, optimum)

    @property
    def bounds_times(self) -> np.ndarray:
        """Return the time that the bounds take of each tick [us]."""
        return np.median(self._bounds_times, axis=0) / 1e3

    @property
    def solve_times(self) -> np.ndarray:
        """Return the time that the solve takes of each tick [us]."""
        return np.median(np.subtract(self._times, self._bounds_times), axis=0) / 1e3


def interleave(runs: Sequence[tuple[Sequence[Contender], Sequence[Tick],
                                    Sequence[np.ndarray | None]]], repeats: int) -> None:
    """
    Run each group of contenders over its ticks, all groups side by side.

    Whatever slows the machine for a while slows all alike; and the order within a tick is drawn
    anew each time, so that nobody always follows the same neighbour.

    :param runs: contenders, their ticks, and the optima of these ticks (None: unknown).
    """
    rng = np.random.default_rng(0)
    for _ in range(repeats):
        for contenders, _, _ in runs:
            for contender in contenders:
                contender.restart()
        gc.collect()
        gc.freeze()  # the ticks themselves are no garbage of anybody's
        for i in range(max(len(ticks) for _, ticks, _ in runs)):
            turn = [(contender, ticks[i], optima[i]) for contenders, ticks, optima in runs
                    for contender in contenders if i < len(ticks) and i % contender.every == 0]
            for position in rng.permutation(len(turn)):
                contender, tick, optimum = turn[position]
                contender.run(tick, optimum)
        gc.unfreeze()


def is_installed(kind: type[Rival], walk: Walk) -> bool:
    """Tell whether what a kind of rival needs is there."""
    try:
        kind(walk.vehicle)
    except ImportError:
        return False
    return True
