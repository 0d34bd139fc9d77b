"""The rows of a table sorted out: which sense, which command from neutral, at rest or in a flow."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from thrust_allocator.fit.bollard import bollard_curves
from thrust_allocator.fit.errors import FitError
from thrust_allocator.fit.table import Row

SENSES = ('reverse', 'forward')
_UNLIKE_REST = 0.5  # share of the thrust at rest by which one in a flow may exceed it or oppose it


@dataclass(frozen=True)
class Measurements:
    """Columns of a table (n,), magnitudes by sense: 0 reverse, 1 forward."""

    line: np.ndarray
    side: np.ndarray  # 0 or 1
    drive: np.ndarray  # the command squared, from neutral
    speed: np.ndarray  # [m/s]
    angle: np.ndarray  # between positive thrust and motion [rad]
    thrust: np.ndarray  # along the sense of the command; negative: the other way [N]
    sigma: np.ndarray  # [N]
    sigma_given: bool
    run: np.ndarray  # number of the run, -1 at rest

    def __len__(self) -> int:
        return len(self.line)

    @cached_property
    def at_rest(self) -> np.ndarray:
        """Which rows make the Bollard table."""
        return self.speed == 0.0

    @cached_property
    def incoming(self) -> np.ndarray:
        """Angle of the flow that the sense of thrust sees, 0 straight into it [rad]."""
        return np.where(self.side == 1, self.angle, np.pi - self.angle)

    @property
    def top_speed(self) -> float:
        """The fastest flow of the table [m/s]."""
        return float(self.speed.max())

    @property
    def full(self) -> float:
        """The largest thrust at rest [N]."""
        return float(self.thrust[self.at_rest].max())

    def rows(self, chosen: np.ndarray) -> 'Measurements':
        """Return some of the rows, by a mask or by their numbers, which may repeat."""
        columns = ('line', 'side', 'drive', 'speed', 'angle', 'thrust', 'sigma', 'run')
        return replace(self, **{name: getattr(self, name)[chosen] for name in columns})


def sort_out(rows: Sequence[Row], path: Path, neutral: float | None) -> Measurements:
    """
    Find out the sense of each row from its command, and hold the rows against each other.

    :param neutral: the command without thrust; None: 0.
    :raises FitError: for a table that lacks rest or flow, and for rows that contradict it.
    """
    at_rest = [row for row in rows if row.speed == 0.0]
    if not at_rest:
        raise FitError(f'{path}: has no row at speed 0, must have a Bollard table: two commands '
                       'or more in each sense')
    if len(at_rest) == len(rows):
        raise FitError(f'{path}: has rows at speed 0 alone, must have at least one in a flow')
    signs = {row.thrust > 0.0 for row in at_rest if row.thrust}
    if neutral is None and len(signs) == 2 and not any(row.command < 0.0 for row in rows):
        raise FitError(f'{path}: has thrusts of both signs and commands of one, must be given '
                       '--neutral, the command without thrust, such as 1500')
    counted = [row.command - (neutral or 0.0) for row in rows]
    flip = _flip(rows, counted, path)
    runs: dict[str, int] = {}
    found = Measurements(
        line=np.array([row.line for row in rows]),
        side=np.array([int(one * flip > 0.0) for one in counted]),
        drive=np.array(counted)**2, speed=np.array([row.speed for row in rows]),
        angle=np.array([row.angle for row in rows]),
        thrust=np.array([row.thrust if one * flip > 0.0 else -row.thrust
                         for row, one in zip(rows, counted)]),
        sigma=np.array([row.sigma for row in rows]), sigma_given=any(row.sigma for row in rows),
        run=np.array([runs.setdefault(row.run or f'line {row.line}', len(runs))
                      if row.speed else -1 for row in rows]))
    # A command at neutral belongs to no sense; that it gives nothing is known
    found = found.rows(found.drive > 0.0)
    if not found.sigma_given:
        found = replace(found, sigma=np.full(len(found), 0.01 * found.full))
    _check_senses(found, path)
    _check_flow(found, path)
    return found


def _flip(rows: Sequence[Row], counted: Sequence[float], path: Path) -> float:
    """Return 1 where a positive command gives positive thrust at rest, else -1; all must agree."""
    largest = max(abs(row.thrust) for row in rows if row.speed == 0.0)
    weighty = [(one * row.thrust, row) for row, one in zip(rows, counted)
               if row.speed == 0.0 and abs(row.thrust) > 0.05 * largest]
    strongest = max(weighty, key=lambda one: abs(one[1].thrust))[0] if weighty else 1.0
    flip = 1.0 if strongest > 0.0 else -1.0
    for product, row in weighty:
        if product * flip <= 0.0:
            raise FitError(f'{path}, line {row.line}: thrust at rest is {row.thrust:.4g} N at '
                           f'command {row.command:g}, must have the sign that the other rows give '
                           'to that sense of the command (or is --neutral wrong?)')
    return flip


def _check_senses(found: Measurements, path: Path) -> None:
    """Refuse a sense without a Bollard table, and one whose thrust does not grow."""
    for side in np.unique(found.side):
        rest = found.rows((found.side == side) & found.at_rest)
        line = found.line[found.side == side][0]
        if len(np.unique(rest.drive)) < 2:
            raise FitError(f'{path}, line {line}: commands {SENSES[side]} have '
                           f'{len(np.unique(rest.drive))} row at speed 0, must have two commands '
                           'or more: a Bollard table')
        order = np.argsort(rest.drive, kind='stable')
        highest = np.maximum.accumulate(rest.thrust[order])
        fallen = highest - rest.thrust[order] > 0.1 * rest.thrust.max()
        if fallen.any():
            raise FitError(f'{path}, line {rest.line[order][fallen][0]}: thrust at rest is '
                           f'{rest.thrust[order][fallen][0]:.4g} N where a smaller command gives '
                           f'{highest[fallen][0]:.4g} N, must grow with the command')


def _check_flow(found: Measurements, path: Path) -> None:
    """Refuse a row in a flow that its Bollard table contradicts: commands, signs, units."""
    rest = bollard_curves(found)
    for side in np.unique(found.side):
        largest = found.drive[(found.side == side) & found.at_rest].max()
        beyond = (found.side == side) & (found.drive > 1.02 * largest)
        if beyond.any():
            raise FitError(f'{path}, line {found.line[beyond][0]}: its command is beyond the '
                           'largest one at speed 0, must be within the Bollard table')
    still = rest.thrust(found, rest.start)
    for unlike, what in ((found.thrust > (1.0 + _UNLIKE_REST) * still + 0.1 * found.full, 'at most '
                          'about that: are units and command right?'),
                         (found.thrust < -_UNLIKE_REST * still - 0.1 * found.full, 'of the same '
                          'sign: is the sign right?')):
        if (unlike & ~found.at_rest).any():
            i = int(np.flatnonzero(unlike & ~found.at_rest)[0])
            sign = 1.0 if found.side[i] else -1.0
            raise FitError(f'{path}, line {found.line[i]}: thrust in the flow is '
                           f'{sign * found.thrust[i]:.4g} N where the same command gives '
                           f'{sign * still[i]:.4g} N at rest, must be {what}')
