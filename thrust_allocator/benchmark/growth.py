"""How the cost of a tick grows with the number of thrusters."""

from pathlib import Path

import numpy as np
from thrust_allocator.benchmark.qp_rivals import Daqp, Osqp, Quadprog
from thrust_allocator.benchmark.rivals import Rival
from thrust_allocator.benchmark.ticks import random_vehicle, smooth_walk
from thrust_allocator.benchmark.timing import (
    Contender, interleave, is_installed, REPEATS, WholeTick)
from thrust_allocator.markdown import table

SIZES = (4, 5, 8, 16, 32, 64)  # thrusters
VEHICLES = 3  # of each size
RIVALS: tuple[type[Rival], ...] = (Daqp, Quadprog, Osqp)
PLOTTED = {  # Okabe and Ito's colours, told apart by colour-blind readers; marks survive print
    'ours: bounds + solve': ('black', 'o', '-'), 'ours: solve': ('#0072B2', 's', '-'),
    'ours: bounds': ('#009E73', '^', '-'), Daqp.name: ('#E69F00', 'D', '--'),
    Quadprog.name: ('#D55E00', 'v', '--'), Osqp.name: ('#CC79A7', 'P', '--')}


def measure(count: int, repeats: int) -> dict[str, list[float] | None]:
    """
    Measure every size on smooth walks of `count` ticks in all, all sizes side by side.

    :return: for each curve its medians in the order of SIZES [us]; None: not installed.
    """
    walks = [[smooth_walk(random_vehicle(size, seed), max(count // VEHICLES, 10), seed)
              for seed in range(VEHICLES)] for size in SIZES]
    there = [kind for kind in RIVALS if is_installed(kind, walks[0][0])]
    ours = [[WholeTick(walk.vehicle) for walk in group] for group in walks]
    others = {kind: [[Contender(kind, walk.vehicle) for walk in group] for group in walks]
              for kind in there}
    interleave([([ours[i][j], *(others[kind][i][j] for kind in there)], walk.ticks,
                 [None] * len(walk.ticks))
                for i, group in enumerate(walks) for j, walk in enumerate(group)], repeats)

    def curve(groups: list[list[Contender]], times: str = 'times',
              share: float = 0.5) -> list[float]:
        return [float(np.quantile(np.concatenate([getattr(one, times) for one in group]), share))
                for group in groups]

    return {
        'ours: bounds': curve(ours, 'bounds_times'), 'ours: solve': curve(ours, 'solve_times'),
        'ours: bounds + solve': curve(ours), 'p99': curve(ours, share=0.99),
        **{kind.name: curve(others[kind]) if kind in there else None for kind in RIVALS}}


def report(count: int = 3000, repeats: int = REPEATS, plot: Path | None = None) -> None:
    """Measure, print the table, and draw the picture if `plot` says where."""
    curves = measure(count, repeats)
    print(f'\n## Growth: random vehicles, {VEHICLES} of each size, smooth walks, p50 in µs\n')
    ticks = curves['ours: bounds + solve']
    five = ticks[SIZES.index(5)]
    print(table(
        ('thrusters', 'bounds', 'solve', 'both', 'both p99', 'both / five thrusters',
         *(kind.name for kind in RIVALS)),
        [(str(size), *(f'{curves[name][i]:.1f}' for name in (
            'ours: bounds', 'ours: solve', 'ours: bounds + solve', 'p99')),
          f'{ticks[i] / five:.2f}',
          *(f'{curves[kind.name][i]:.1f}' if curves[kind.name] else 'missing'
            for kind in RIVALS))
         for i, size in enumerate(SIZES)]), flush=True)
    if plot is not None:
        draw(curves, plot)
        print(f'\nDrawn: {plot}', flush=True)


def draw(curves: dict[str, list[float] | None], path: Path) -> None:
    """Draw the medians over the number of thrusters as SVG."""
    import matplotlib
    from matplotlib.figure import Figure

    matplotlib.rcParams.update({'svg.hashsalt': 'thrust_allocator', 'font.size': 11})
    figure = Figure(figsize=(8.0, 4.2), layout='constrained')
    axes = figure.add_subplot()
    for name, (colour, mark, dashes) in PLOTTED.items():
        if curves[name]:
            axes.plot(SIZES, curves[name], dashes, marker=mark, color=colour, lw=2, label=name)
    axes.set(xscale='log', yscale='log', xlabel='thrusters', ylabel='median time of one tick (µs)')
    axes.set_xticks(SIZES, [str(size) for size in SIZES])
    axes.set_xticks([], minor=True)
    ticks = [time for time in (2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000)
             if axes.get_ylim()[0] <= time <= axes.get_ylim()[1]]
    axes.set_yticks(ticks, [str(time) for time in ticks])
    axes.set_yticks([], minor=True)
    axes.grid(color='#DDDDDD', lw=0.6)
    axes.spines[['top', 'right']].set_visible(False)
    figure.legend(loc='outside right center', frameon=False, fontsize=9)
    figure.savefig(path, format='svg', metadata={'Date': None})
