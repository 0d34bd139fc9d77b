"""The solve beside other solvers, and what a whole tick of ours takes."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.benchmark.qp_rivals import CasadiQrqp, Daqp, Osqp, OsqpRebuilt, Quadprog
from thrust_allocator.benchmark.rivals import (
    BoundedLeastSquares, Ours, Rival, PseudoInverse, SequentialLeastSquares)
from thrust_allocator.benchmark.ticks import mt2012, paper_sweep, smooth_walk, switching_walk, Walk
from thrust_allocator.benchmark.timing import (
    Contender, interleave, is_installed, REPEATS, WholeTick)
from thrust_allocator.markdown import table

RIVALS: tuple[type[Rival], ...] = (
    Ours, PseudoInverse, Daqp, Quadprog, Osqp, CasadiQrqp, BoundedLeastSquares, OsqpRebuilt,
    SequentialLeastSquares)
SLOW_EVERY = 10  # a slow rival gets one tick in so many


class Measured:
    """One walk, measured."""

    def __init__(self, walk: Walk, repeats: int) -> None:
        self.walk = walk
        self.reference, optima = exact_optima(walk)
        self.contenders = {
            kind: Contender(kind, walk.vehicle, SLOW_EVERY if kind.slow else 1)
            if is_installed(kind, walk) else None for kind in RIVALS}
        self.tick = WholeTick(walk.vehicle)
        interleave([([*filter(None, self.contenders.values()), self.tick], walk.ticks, optima)],
                   repeats)

    def table(self) -> str:
        """Return one row per allocator."""
        ours = np.median(self.contenders[Ours].times)
        return table(
            ('allocator', 'p50, µs', 'p99, µs', 'p50 / ours', 'worst error, N', 'unsolved',
             'ticks'),
            [(kind.name, 'missing', *5 * ('–',)) if one is None else
             (kind.name, *(f'{np.quantile(one.times, share):.1f}' for share in (0.5, 0.99)),
              f'{np.median(one.times) / ours:.2f}', self._worst_error(one), f'{one.unsolved}',
              f'{len(one.times)}')
             for kind, one in self.contenders.items()])

    def _worst_error(self, one: Contender) -> str:
        if one.name == self.reference:
            return 'reference'
        return f'{max(one.errors):.0e}' if one.errors else '–'

    def tick_row(self) -> tuple[str, ...]:
        """Return what a whole tick takes, as a row of the table of ticks."""
        tick, quadprog = self.tick, self.contenders[Quadprog]
        bounds, solve, both = map(np.median, (tick.bounds_times, tick.solve_times, tick.times))
        late = np.quantile(tick.times, 0.99)
        return (self.walk.name, f'{bounds:.1f}', f'{solve:.1f}', f'{both:.1f}', f'{late:.1f}',
                f'{late / both:.2f}',
                f'{bounds / np.median(quadprog.times):.2f}' if quadprog else '–',
                f'{np.mean(tick.iterations):.2f}', f'{max(tick.iterations)}', f'{tick.unsolved}')


def exact_optima(walk: Walk) -> tuple[str, list[np.ndarray | None]]:
    """Return the optimum of each tick by an independent solver, and its name; None: no solver."""
    for kind in (Daqp, Quadprog):
        if is_installed(kind, walk):
            rival = kind(walk.vehicle)
            optima: list[np.ndarray | None] = []
            for tick in walk.ticks:
                optimum = rival.solve(tick.wrench, tick.limits)
                optima.append(optimum if rival.solved else None)
            return kind.name, optima
    return 'nobody', [None] * len(walk.ticks)


def walks(count: int) -> Sequence[Walk]:
    """Return the three sequences of MT-2012, of `count` ticks but for the sweep, at most 1801."""
    vehicle = mt2012()
    return (paper_sweep(min(count, 1801)), smooth_walk(vehicle, count),
            switching_walk(vehicle, count))


def report(count: int = 10_000, repeats: int = REPEATS) -> None:
    """Measure, and print the tables."""
    print('## The solve, MT-2012\n')
    print('Each allocator solves each tick, in an order drawn anew at every tick; what it needs\n'
          'to turn wrench and limits into its own form is counted. Slow ones get one tick in '
          f'{SLOW_EVERY}. A tick counts with the median of its times in {repeats} runs, each from '
          'a cold start.')
    rows = []
    for walk in walks(count):
        measured = Measured(walk, repeats)
        rows.append(measured.tick_row())
        print(f'\n### {walk.name[0].upper()}{walk.name[1:]}, {len(walk.ticks)} ticks\n')
        print(measured.table())
        print(f'\nErrors are against {measured.reference}, asked beforehand.', flush=True)
    print('\n## A tick of ours, MT-2012\n')
    print(table(
        ('ticks', 'bounds p50, µs', 'solve p50, µs', 'both p50, µs', 'both p99, µs', 'p99 / p50',
         'bounds / quadprog', 'iterations mean', 'worst', 'unsolved'), rows), flush=True)
