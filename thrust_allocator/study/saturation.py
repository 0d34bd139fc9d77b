"""What gives way beyond reach: random commands, by allocator, at rest."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from thrust_allocator.markdown import table
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.attainable import TooManyFaces
from thrust_allocator.solve.authority import authority
from thrust_allocator.solve.compromise import Compromise
from thrust_allocator.solve.problem import AllocationProblem
from thrust_allocator.study.sweep import pseudo_inverse

KEEPING = (0.0, 0.5, 1.0)  # values of direction_keeping
ALLOCATORS = ('pseudo-inverse, clamped', 'pseudo-inverse, scaled down',
              *(f'direction_keeping {k:g}' for k in KEEPING))
TIMES_AUTHORITY = 3.0  # the largest command, in its own direction


class Saturation(NamedTuple):
    """What became of n commands, by allocator."""

    angles: dict[str, np.ndarray]  # between achieved and commanded wrench, (n,) [deg]
    lost: dict[str, np.ndarray]  # share of the command that is missing along it, (n,) [-]


def reach_of(vehicle: Vehicle) -> np.ndarray:
    """Return the authority of a vehicle in its controlled DOFs, at rest, (6,) [N, N*m]."""
    return authority(vehicle.configuration_matrix, _limits(vehicle),
                     np.array(vehicle.wrench_weights) > 0.0)


def _limits(vehicle: Vehicle) -> np.ndarray:
    """Return the limits at rest, (2, p), 0 where a thruster is out of use [N]."""
    return ThrustBounds(vehicle)(np.zeros(6))


def saturation(vehicle: Vehicle, reach: np.ndarray, count: int, seed: int = 0) -> Saturation:
    """
    Allocate commands that a pseudo-inverse cannot, each by every one of ALLOCATORS.

    A wrench is counted in units of the vehicle's authority, for newtons and newton metres cannot
    be compared: directions are uniform there, and lengths up to TIMES_AUTHORITY.

    :param reach: the authority, (6,); DOFs of 0 are not commanded [N, N*m].
    :param count: n.
    :return: without the direction that is kept, where the vehicle has too many faces for it.
    """
    matrix, limits = vehicle.configuration_matrix, _limits(vehicle)
    inverse = pseudo_inverse(vehicle)
    commands = _commands(inverse, limits, reach, count, np.random.default_rng(seed))
    wanted = commands @ inverse.T
    room = np.where(wanted > 0.0, limits[1], -limits[0])
    scales = np.min(np.divide(room, np.abs(wanted), out=np.ones_like(room),
                              where=np.abs(wanted) > room), axis=1, keepdims=True)
    thrusts = dict(zip(ALLOCATORS, (np.clip(wanted, *limits), scales * wanted)))
    for name, k in zip(ALLOCATORS[2:], KEEPING):
        try:
            rule = Compromise(vehicle, AllocationProblem(vehicle), k)
        except TooManyFaces:
            continue
        thrusts[name] = np.array([rule.solve(one, limits, limits).thrusts for one in commands])
    angles, lost = {}, {}
    for name, found in thrusts.items():
        angles[name], lost[name] = _compared(commands, found @ matrix.T, reach)
    return Saturation(angles, lost)


def _commands(inverse: np.ndarray, limits: np.ndarray, reach: np.ndarray, count: int,
              rng: np.random.Generator) -> np.ndarray:
    """Return commands (n, 6) that the pseudo-inverse (p, 6) does not keep inside the limits."""
    found = np.empty((0, 6))
    while len(found) < count:
        some = rng.normal(size=(count, 6)) * (reach > 0.0)
        some *= reach * rng.uniform(0.0, TIMES_AUTHORITY, (count, 1)) \
            / np.linalg.norm(some, axis=1, keepdims=True)
        wanted = some @ inverse.T
        beyond = ((wanted < limits[0]) | (wanted > limits[1])).any(axis=1)
        found = np.vstack([found, some[beyond]])
    return found[:count]


def _compared(commands: np.ndarray, achieved: np.ndarray,
              reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the angles (n,) [deg] and the lost shares (n,) of achieved wrenches (n, 6)."""
    unit = np.divide(1.0, reach, out=np.zeros(6), where=reach > 0.0)
    wanted, got = commands * unit, achieved * unit
    along = (wanted * got).sum(axis=1) / np.linalg.norm(wanted, axis=1)
    across = np.linalg.norm(got - wanted * (along / np.linalg.norm(wanted, axis=1))[:, np.newaxis],
                            axis=1)
    return np.degrees(np.arctan2(across, along)), 1.0 - along / np.linalg.norm(wanted, axis=1)


def saturation_table(found: Saturation, published: Sequence[Sequence[Any]] = ()) -> str:
    """
    Return a table of what gives way, by allocator.

    :param published: rows to stand first: a name, then mean, 95 % and worst angle [deg], and what
        is lost on average [%].
    """
    rows = [*published, *(
        (name, angles.mean(), np.quantile(angles, 0.95), angles.max(),
         100.0 * found.lost[name].mean()) for name, angles in found.angles.items())]
    return table(('allocator', 'direction error, mean, °', '95 %, °', 'worst, °', 'lost, mean, %'),
                 [(name, *(f'{figure:.2f}' for figure in figures)) for name, *figures in rows])
