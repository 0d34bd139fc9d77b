"""Measured thrust and the fitted law over speed, by angle."""

from pathlib import Path

from matplotlib.lines import Line2D
import numpy as np
from thrust_allocator.fit.measurements import SENSES
from thrust_allocator.fit.solution import Solution
from thrust_allocator.study import style

_MOST = 7  # angles with a colour of their own


def draw(solution: Solution, title: str, path: Path) -> None:
    """
    Draw each sense: rows as marks, the law at the largest command of each angle as a line.

    A mark is scaled to that command by what either gives at rest.
    """
    problem, rows = solution.problem, solution.problem.rows
    still = problem.curves.thrust(rows, solution.x)
    model = problem.law.thruster(problem.curves.limits(solution.x), solution.coefficients)
    degrees = np.round(np.degrees(rows.angle)).astype(int)
    angles = np.unique(degrees[~rows.at_rest])
    if len(angles) > _MOST:  # those that spread best; the others take the colour of the nearest
        angles = angles[np.linspace(0, len(angles) - 1, _MOST).round().astype(int)]
    nearest = np.abs(degrees[:, None] - angles).argmin(axis=1)
    sides = np.unique(rows.side).tolist()
    with style.look():
        figure, axes = style.panels(
            1, len(sides), 3.6, title,
            [Line2D([], [], marker='o', label=f'{angle} deg', **style.line(i))
             for i, angle in enumerate(angles)])
        speeds = np.linspace(0.0, 1.05 * rows.top_speed, 100)
        for one, side in zip(axes.ravel(), sides):
            style.over_speed(one, speeds, SENSES[side], 'share of the thrust at rest')
            for i, angle in enumerate(np.radians(angles)):
                mine = (rows.side == side) & ~rows.at_rest & (nearest == i)
                if not mine.any():
                    continue
                drive = still[mine].max()
                along, across = np.cos(angle) * speeds, np.sin(angle) * speeds
                law = [abs(model.thrust_in_flow(drive if side else -drive, *flow)) / drive
                       for flow in zip(along, across)]
                one.plot(speeds, law, **style.line(i))
                one.plot(rows.speed[mine], (rows.thrust / np.maximum(still, 1e-9))[mine], 'o',
                         color=style.line(i)['color'], ms=4)
        style.finish(axes, len(sides), 'speed through the water [m/s]')
        style.save(figure, path)
