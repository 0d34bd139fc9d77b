"""Why a vehicle did not give what it was asked for, as far as the ticks of a second tell."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import Allocation

MOSTLY = 0.5  # share of the ticks concerned in which a cause is there, for it to be named
LIGHT = 0.1  # share of another DOF's worth below which a weight is one that gives way
ROUNDING = 1e-9  # relative to the largest element of B
TIED = 1e-6  # likewise, of the singular values that DOFs have which come only together


class Allocated(NamedTuple):
    """One tick with a wrench, as far as it matters here."""

    wrench: np.ndarray  # as it came, (6,) in the axes of the messages [N, N*m]
    unallocated: np.ndarray  # (6,), likewise
    allocation: Allocation
    speed_limits: np.ndarray  # (2, p) [N]


class Causes:
    """What stood in the way of the commands of a second, tick by tick."""

    def __init__(self, ticks: Sequence[Allocated], vehicle: Vehicle, floor: np.ndarray) -> None:
        """
        Gather it.

        :param ticks: those that had a wrench, n.
        :param floor: a share of what the vehicle can give in each DOF, (6,) [N, N*m].
        """
        self._names = [one.name for one in vehicle.thrusters]
        self._enabled = np.array([one.enabled for one in vehicle.thrusters])
        matrix = vehicle.configuration_matrix
        self._acting = np.abs(matrix) > ROUNDING * np.abs(matrix).max()  # (6, p)

        allocations = [tick.allocation for tick in ticks]
        at_bound = np.array([one.at_bound for one in allocations])  # (n, p)
        nearer = (np.array([one.limits for one in allocations])  # than by the speed, (n, 2, p)
                  != np.array([tick.speed_limits for tick in ticks]))
        by_rate = np.where(at_bound > 0, nearer[:, 1], nearer[:, 0])
        held = (at_bound != 0) & self._enabled
        self._at_limit, self._ramping = held & ~by_rate, held & by_rate  # (n, p)
        self._scaled = np.array([  # by power, by direction, (n, 2)
            (one.power_scale < 1.0, one.direction_scale < 1.0) for one in allocations])

        self._served, self._tied = _geometry(vehicle, self._enabled)
        self._worth = np.array(vehicle.wrench_weights) * floor**2  # of an equal share of each

    def of(self, dof: int, short: np.ndarray) -> list[str]:
        """Name the causes that are known of what was missing of a DOF in some ticks, (n,)."""
        causes, most = [], MOSTLY * short.sum()
        at_limit, ramping, (by_power, by_direction) = (
            which[short].sum(axis=0) > most
            for which in (self._at_limit, self._ramping, self._scaled))
        at_limit, ramping = at_limit & self._acting[dof], ramping & self._acting[dof]
        if not self._served[dof]:
            causes.append('no thruster can act on it'
                          + ('' if self._enabled.all() else ' while some are off'))
        elif self._tied[dof].any():
            causes.append(f'it comes only together with {chosen(DOFS, self._tied[dof])}')
        if at_limit.any():
            causes.append(chosen(self._names, at_limit) + (
                ' at the limit' if at_limit.sum() > 1 else ' at its limit'))
        if ramping.any():
            causes.append(chosen(self._names, ramping) + ' held back by max_rate')
        off = self._acting[dof] & ~self._enabled
        if off.any():
            causes.append(chosen(self._names, off) + ' off')
        if by_power:
            causes.append('power_limit')
        if by_direction:
            causes.append('scaled to keep the direction')
        dearer = self._worth * LIGHT > self._worth[dof]
        if not causes:
            causes.append(
                f'wrench_weights.{DOFS[dof]} is low against the weights of the thrusters')
        elif dearer.any():
            causes.append(f'its low weight gives way to {chosen(DOFS, dearer)}')
        return causes


def _geometry(vehicle: Vehicle, enabled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which DOFs the thrusters in use serve, (6,), and which only with others, (6, 6)."""
    matrix = vehicle.configuration_matrix
    norms = np.linalg.norm(matrix, axis=1, keepdims=True)
    rows = np.divide(matrix, norms, out=np.zeros_like(matrix),
                     where=norms > ROUNDING * norms.max()) * enabled
    controlled = np.flatnonzero(vehicle.wrench_weights)
    left, singular, _ = np.linalg.svd(rows[controlled])
    rank = int((singular > TIED * singular.max()).sum())
    lost = left[:, rank:] @ left[:, rank:].T  # onto what cannot be had
    tied = np.zeros((6, 6), dtype=bool)
    tied[np.ix_(controlled, controlled)] = (np.abs(lost) > TIED) & (
        np.diag(lost) > TIED)[:, np.newaxis]
    np.fill_diagonal(tied, False)
    return np.abs(rows).max(axis=1) > ROUNDING, tied


def chosen(names: Sequence[str], which: np.ndarray) -> str:
    """Return those of the names that are chosen, in one line."""
    return ', '.join(name for name, is_chosen in zip(names, which) if is_chosen)
