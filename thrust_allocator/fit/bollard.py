"""What a command gives at rest: a curve through the Bollard table, whose heights are fitted too."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import PchipInterpolator
if TYPE_CHECKING:
    from thrust_allocator.fit.measurements import Measurements

_SAME = 0.02  # commands squared closer than this share of the largest are one knot


@dataclass(frozen=True)
class BollardCurves:
    """
    The curve of each sense: thrust over the command squared, monotone where its knots are.

    Taken as exact, a Bollard table would ruin every interval: all rows share its errors. So the
    heights of the knots are unknowns of the fit, in one vector, reverse before forward.
    """

    knots: tuple[np.ndarray, np.ndarray]  # commands squared, (reverse, forward); may be empty
    start: np.ndarray  # heights as measured [N]

    def heights(self, x: np.ndarray, side: int) -> np.ndarray:
        """Return the heights of one sense [N]."""
        count = len(self.knots[0])
        return x[:count] if side == 0 else x[count:count + len(self.knots[1])]

    @property
    def count(self) -> int:
        """How many heights there are."""
        return len(self.start)

    @property
    def top(self) -> tuple[int | None, int | None]:
        """Return the places of the greatest heights, the Bollard limits (reverse, forward)."""
        first, second = map(len, self.knots)
        return (first - 1 if first else None, first + second - 1 if second else None)

    def limits(self, x: np.ndarray) -> tuple[float, float]:
        """Return the Bollard limits (reverse <= 0, forward >= 0) [N]."""
        reverse, forward = (float(x[place]) if place is not None else 0.0 for place in self.top)
        return -reverse, forward

    def thrust(self, rows: 'Measurements', x: np.ndarray) -> np.ndarray:
        """Return what the command of each row gives at rest (n,), not negative [N]."""
        found = np.zeros(len(rows))
        for side, knots in enumerate(self.knots):
            if (mine := rows.side == side).any():
                curve = PchipInterpolator([0.0, *knots], [0.0, *self.heights(x, side)])
                found[mine] = curve(rows.drive[mine])
        return np.maximum(found, 0.0)

    def slopes(self, rows: 'Measurements', x: np.ndarray) -> np.ndarray:
        """Return the derivatives of `thrust` by the heights, (n, count) [-]."""
        found = np.empty((len(rows), self.count))
        step = 1e-6 * max(float(np.abs(x[:self.count]).max()), 1e-9)
        still = self.thrust(rows, x)
        for j in range(self.count):
            moved = x.copy()
            moved[j] += step
            found[:, j] = (self.thrust(rows, moved) - still) / step
        return found


def bollard_curves(rows: 'Measurements') -> BollardCurves:
    """Return the curves through the rows at rest, commands that are nearly the same as one."""
    knots, heights = [], []
    for side in (0, 1):
        mine = (rows.side == side) & rows.at_rest
        groups = _groups(rows.drive[mine]) if mine.any() else []
        places = [float(rows.drive[mine][group].mean()) for group in groups]
        if places:
            places[-1] = float(rows.drive[mine].max())
        knots.append(np.array(places))
        heights += [max(float(rows.thrust[mine][group].mean()), 0.0) for group in groups]
    return BollardCurves((knots[0], knots[1]), np.array(heights))


def _groups(drives: np.ndarray) -> Sequence[np.ndarray]:
    order = np.argsort(drives, kind='stable')
    gaps = np.flatnonzero(np.diff(drives[order]) > _SAME * drives.max()) + 1
    return np.split(order, gaps)
