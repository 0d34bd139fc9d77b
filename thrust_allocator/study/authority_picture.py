"""Authority against speed: a row for each DOF, with the failures that cost most there."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.study.authority import HELD
from thrust_allocator.study.findings import named
from thrust_allocator.study.grid import Case, Outcome
from thrust_allocator.study.manoeuvre import unit
from thrust_allocator.study.style import (
    BOUNDS, dotted, finish, line, look, over_speed, panels, save)

SPEED = 'speed through the water (m/s)'
NEAR = 1e-3  # curves closer than this share of the largest value look the same
MOST = 4  # failures in a row: more cannot be told apart


def telling(ranges: Sequence[np.ndarray]) -> list[list[int]]:
    """
    Return which failures to draw, those that cost most first, alike ones in one group.

    :param ranges: of one DOF, (n, 2, 2), as Authority returns them: intact, then by failure
        [N, N*m]. A failure that changes nothing is in no group.
    """
    near = NEAR * (np.nanmax(np.abs(ranges[0])) if np.isfinite(ranges[0]).any() else 1.0)

    def alike(i: int, other: int) -> bool:
        return np.allclose(ranges[i], ranges[other], 0.0, near, equal_nan=True)

    groups: list[list[int]] = []
    for i in range(1, len(ranges)):
        if alike(i, 0):
            continue
        same = next((group for group in groups if alike(i, group[0])), None)
        if same is None:
            groups.append([i])
        else:
            same.append(i)
    return sorted(groups, key=lambda group: np.nan_to_num(np.diff(ranges[group[0]])).sum())


def draw_authority(path: Path, setting: str, speeds: Sequence[float], cases: Sequence[Case],
                   outcomes: Sequence[Outcome]) -> None:
    """
    Draw the range of every controlled DOF, intact and for the failures that cost most of it.

    The columns are the kinds of holding; gaps stay gaps. Beside each row stands who is who.
    """
    dofs = np.flatnonzero(cases[0].vehicle.wrench_weights)
    names = [' and '.join(name for name in case.failed if name not in cases[0].failed)
             for case in cases]
    with look():
        figure, axes = panels(len(dofs), len(HELD), 1.9, 'Authority against speed', [], setting,
                              sharex=True, sharey='row')
        for row, dof in zip(axes, dofs):
            ranges = [outcome.authority[:, :, dof] for outcome in outcomes]
            groups = telling(ranges)
            for k, (one, held) in enumerate(zip(row, HELD.values())):
                one.fill_between(speeds, *ranges[0][:, k].T, color=BOUNDS, lw=0)
                for group in groups[:MOST]:
                    one.plot(speeds, ranges[group[0]][:, k], **line(group[0]))
                over_speed(one, speeds, held if dof == dofs[0] else '',
                           f'{DOFS[dof]} ({dotted(unit(dof))})' if k == 0 else '')
            others = 'others cost less' if len(groups) > MOST else 'others change nothing'
            left = len(cases) - 1 - sum(map(len, groups[:MOST]))
            _legend(row[-1], named(cases[0].failed), [
                (line(group[0]), [names[i] for i in group]) for group in groups[:MOST]],
                others if left else '')
        finish(axes, axes.size, SPEED)
        save(figure, path)


def _legend(axes: Axes, state: str, drawn: Sequence[tuple[dict, Sequence[str]]],
            others: str) -> None:
    """Say to the right of a row whose failure each line is, and what is with the others."""
    handles = [Patch(color=BOUNDS, label=state)]
    handles += [Line2D([], [], label='without ' + ',\nor '.join(who), **style)
                for style, who in drawn]
    handles += [Line2D([], [], lw=0, label=others)] if others else []
    axes.legend(handles=handles, loc='center left', bbox_to_anchor=(1.02, 0.5), frameon=False,
                fontsize=8, handlelength=3.0)
