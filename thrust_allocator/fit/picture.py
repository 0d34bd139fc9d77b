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
    Draw each sense: rows as dots, the law at the largest command of each angle as a line.

    The smaller a command, the more of its thrust a flow takes: a cross is what the law says at the
    command of a row.
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
            [*(Line2D([], [], label=f'{angle} deg', **style.line(i))
               for i, angle in enumerate(angles)),
             Line2D([], [], ls='', marker='o', color='black', label='measured'),
             Line2D([], [], ls='', marker='x', color='black', label='law at its command')])
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
                for thrust, mark in ((rows.thrust, 'o'), (problem.delivered(solution.x), 'x')):
                    one.plot(rows.speed[mine], (thrust / np.maximum(still, 1e-9))[mine], mark,
                             color=style.line(i)['color'], ms=4 if mark == 'o' else 7)
        style.finish(axes, len(sides), 'speed through the water [m/s]')
        style.save(figure, path)
