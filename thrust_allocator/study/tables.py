"""The numbers behind every picture, as CSV, to the last bit."""

from collections.abc import Iterable, Sequence
import csv
from pathlib import Path

import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.study.authority import HELD
from thrust_allocator.study.directions import Directions
from thrust_allocator.study.grid import Case, Outcome
from thrust_allocator.study.manoeuvre import unit
from thrust_allocator.study.saturation import Saturation
from thrust_allocator.study.sweep import ALLOCATORS, DRIVERS, Sweep

Row = Sequence[object]


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Row]) -> None:
    """Write a table; floats in full, NaN as an empty cell."""
    with path.open('w', encoding='utf-8', newline='') as file:
        writer = csv.writer(file, lineterminator='\n')
        writer.writerow(header)
        writer.writerows([_cell(value) for value in row] for row in rows)


def _cell(value: object) -> object:
    if isinstance(value, (float, np.floating)):
        return '' if np.isnan(value) else repr(float(value))
    return value


def _wrench(prefix: str) -> list[str]:
    return [f'{prefix} {dof} [{unit(i)}]' for i, dof in enumerate(DOFS)]


def write_allocation(path: Path, vehicle: Vehicle, speeds: Sequence[float], allocation: Sweep,
                     shares: dict[int, dict[str, np.ndarray]]) -> None:
    """Write thrusts by moving bounds, the bounds, and the shares (n,) of DOFs' wrenches [%]."""
    names = [thruster.name for thruster in vehicle.thrusters]
    header = ['speed [m/s]'] + [f'{name} {what} [N]' for what in ('thrust', 'lower', 'upper')
                                for name in names]
    header += [f'{DOFS[dof]} share of {name} [%]' for dof, who in shares.items()
               for name in who]
    moving = allocation.thrusts[:, list(ALLOCATORS).index('moving bounds')]
    write_csv(path, header, (
        [speed, *thrusts, *limits.ravel(),
         *(share[i] for who in shares.values() for share in who.values())]
        for i, (speed, thrusts, limits) in enumerate(zip(speeds, moving, allocation.limits))))


def write_worth(path: Path, speeds: Sequence[float], allocation: Sweep) -> None:
    """Write commanded and delivered wrench by driver and allocator."""
    write_csv(path, ['driver', 'allocator', 'speed [m/s]', *_wrench('commanded'),
                     *_wrench('delivered')], (
        [driver, allocator, speed, *allocation.commands[i], *allocation.delivered[i, a, d]]
        for d, driver in enumerate(DRIVERS) for a, allocator in enumerate(ALLOCATORS)
        for i, speed in enumerate(speeds)))


def write_authority(path: Path, speeds: Sequence[float], cases: Sequence[Case],
                    outcomes: Sequence[Outcome]) -> None:
    """Write the range of every controlled DOF; empty where the cruise wrench cannot be held."""
    write_csv(path, ['failed', 'holding', 'speed [m/s]', *_wrench('smallest'),
                     *_wrench('largest')], (
        [' '.join(case.failed), kind, speed, *outcome.authority[i, k, :, 0],
         *outcome.authority[i, k, :, 1]]
        for case, outcome in zip(cases, outcomes) for k, kind in enumerate(HELD)
        for i, speed in enumerate(speeds)))


def write_directions(path: Path, found: Directions) -> None:
    """Write the limits of one thruster over its speed and angle of attack."""
    write_csv(path, ['speed [m/s]', 'angle of attack [deg]', 'lower [N]', 'upper [N]'], (
        [speed, angle, *found.limits[i, j]] for i, speed in enumerate(found.speeds)
        for j, angle in enumerate(found.angles)))


def write_giving_way(path: Path, found: Saturation) -> None:
    """Write direction error and lost share of every command, by allocator."""
    write_csv(path, ['allocator', 'direction error [deg]', 'lost [%]'], (
        [name, angle, 100.0 * lost] for name, angles in found.angles.items()
        for angle, lost in zip(angles, found.lost[name])))


def write_grid(path: Path, speeds: Sequence[float], cases: Sequence[Case],
               outcomes: Sequence[Outcome]) -> None:
    """Write one row for every point of the study: errors of the wrench, and authority."""
    header = ['layout', 'heading [deg]', 'failed', 'speed [m/s]', *_wrench('commanded')]
    for allocator in ALLOCATORS:
        for driver in DRIVERS:
            header += _wrench(f'{allocator}, {driver}: error of')
    for kind in HELD:
        header += _wrench(f'{kind} hold: smallest') + _wrench(f'{kind} hold: largest')
    write_csv(path, header, (
        [case.layout, case.heading, ' '.join(case.failed), speed,
         *outcome.allocation.commands[i], *outcome.allocation.errors[i].ravel(),
         *np.swapaxes(outcome.authority[i], 1, 2).ravel()]
        for case, outcome in zip(cases, outcomes) for i, speed in enumerate(speeds)))


def write_candidates(path: Path, speeds: Sequence[float],
                     series: dict[str, tuple[np.ndarray, np.ndarray]]) -> None:
    """Write what candidates.png shows: for each series (n, 6) intact and at the worst failure."""
    write_csv(path, ['series', 'case', 'speed [m/s]', *_wrench('both ways')], (
        [name, case, speed, *values[i]] for name, pair in series.items()
        for case, values in zip(('intact', 'worst single failure'), pair)
        for i, speed in enumerate(speeds)))
