"""What a vehicle was asked for and did not give: by DOF, how much, how often, and why."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.authority import authority, TOGETHER
from thrust_allocator.solve.problem import Allocation

SHARE = 0.01  # of the command, and of what the vehicle can give, that may be missing without a word
OFTEN = 0.1  # share of the ticks from which on what is missing is told
MOSTLY = 0.5  # share of those ticks in which a cause is there, for it to be named
LIGHT = 0.1  # share of another DOF's worth below which a weight is one that gives way
ROUNDING = 1e-9  # relative to the largest element of B
UNITS = ('N', 'N', 'N', 'N*m', 'N*m', 'N*m')


class Allocated(NamedTuple):
    """One tick with a wrench, as far as it matters here."""

    wrench: np.ndarray  # as it came, (6,) in the axes of the messages [N, N*m]
    unallocated: np.ndarray  # (6,), likewise
    allocation: Allocation
    speed_limits: np.ndarray  # (2, p) [N]


class Yardstick:
    """What is worth a word in each DOF of a vehicle, whatever its size."""

    def __init__(self, vehicle: Vehicle) -> None:
        """Measure what the vehicle, all thrusters enabled, can give at rest, or fins at 1 m/s."""
        matrix, limits = vehicle.configuration_matrix, vehicle.reference_limits
        self.of = _essence(vehicle)
        reach = authority(matrix, limits, np.array(vehicle.wrench_weights) > 0.0)
        together = np.abs(matrix) @ np.abs(limits).max(axis=0)
        largest = np.abs(limits).max()
        arm = max(float(np.linalg.norm(np.subtract(one.position, vehicle.wrench_origin)))
                  for one in vehicle.thrusters) or 1.0
        nothing = np.repeat([largest, largest * arm], 3)
        served = together > ROUNDING * together.max()
        reach = np.where(reach > 0.0, reach, np.where(served, TOGETHER * together, nothing))
        self.floor = SHARE * reach  # (6,) [N, N*m]

    def measures(self, vehicle: Vehicle) -> bool:
        """Tell whether it holds for a vehicle still."""
        return self.of == _essence(vehicle)


def shortfall(ticks: Sequence[Allocated], count: int, vehicle: Vehicle, floor: np.ndarray) -> str:
    """
    Say what was missing of the commands of a second, and why, as far as that is known.

    A component is missing where its unallocated part is more than 1 % of the command and more than
    `floor`, in more than a tenth of the ticks.

    :param ticks: those that had a wrench to allocate.
    :param count: of all ticks of that second.
    :param floor: (6,) [N, N*m].
    :return: one line, or '' if there is nothing to say.
    """
    if not ticks:
        return ''
    commands = np.array([tick.wrench for tick in ticks])
    unallocated = np.array([tick.unallocated for tick in ticks])
    weights = np.array(vehicle.wrench_weights)
    missing = np.abs(unallocated) > np.maximum(SHARE * np.abs(commands), floor)
    asked = np.abs(commands) > floor
    parts, causes = [], None
    for dof in range(6):
        if weights[dof]:
            short = missing[:, dof]
            if short.sum() > OFTEN * count:
                causes = causes or Causes(ticks, vehicle, floor)
                parts.append(_missing(dof, commands[short], unallocated[short], floor)
                             + f' in {short.sum() / count:.0%} of the ticks: '
                             + causes.of(dof, short))
        elif asked[:, dof].sum() > OFTEN * count:
            parts.append(f'{DOFS[dof]} is commanded but not controlled (wrench_weights.{DOFS[dof]} '
                         'is 0)')
    return '; '.join(parts)


def _missing(dof: int, commands: np.ndarray, unallocated: np.ndarray, floor: np.ndarray) -> str:
    """Say how much of a component is missing on average, and whether it has the other sign."""
    wanted, given = commands[:, dof], commands[:, dof] - unallocated[:, dof]
    middle, unit = np.mean(wanted), UNITS[dof]
    against = (wanted * given < 0.0) & (np.abs(wanted) > floor[dof]) & (np.abs(given) > floor[dof])
    if against.mean() > MOSTLY:
        return (f'{DOFS[dof]} comes out with the other sign: {_number(np.mean(given[against]))} '
                f'instead of {_number(np.mean(wanted[against]))} {unit}')
    off = np.mean(np.abs(unallocated[:, dof]))
    return f'{DOFS[dof]} is off by {_number(off)} {unit} (commanded {_number(middle)} {unit})'


def _number(value: float) -> str:
    return f'{value + 0.0:.3g}' if abs(value) < 1000.0 else f'{value:.0f}'


class Causes:
    """What stood in the way of the commands of a second, tick by tick."""

    def __init__(self, ticks: Sequence[Allocated], vehicle: Vehicle, floor: np.ndarray) -> None:
        """Gather it of n ticks with a wrench; `floor` is (6,) [N, N*m]."""
        allocations = [tick.allocation for tick in ticks]
        at_bound = np.array([one.at_bound for one in allocations])  # (n, p)
        by_more = (np.array([one.limits for one in allocations])  # (n, 2, p), nearer than by speed
                   != np.array([tick.speed_limits for tick in ticks]))
        enabled = np.array([one.enabled for one in vehicle.thrusters])
        self._held = (at_bound != 0) & enabled
        self._by_rate = np.where(at_bound > 0, by_more[:, 1], by_more[:, 0])
        self._by_power = np.array([one.power_scale < 1.0 for one in allocations])
        self._by_direction = np.array([one.direction_scale < 1.0 for one in allocations])
        self._off = ~enabled
        self._acting = np.abs(vehicle.configuration_matrix) > (
            ROUNDING * np.abs(vehicle.configuration_matrix).max())  # (6, p)
        # That of an equal share of each authority
        self._worth = np.array(vehicle.wrench_weights) * floor**2
        self._vehicle = vehicle

    def of(self, dof: int, short: np.ndarray) -> str:
        """Name the causes that are known of what was missing of a DOF in some ticks, (n,)."""
        causes, acting = [*_geometry(self._vehicle, dof)], self._acting[dof]
        names = [one.name for one in self._vehicle.thrusters]
        held, by_rate = self._held[short] & acting, self._by_rate[short]
        at_limit = (held & ~by_rate).mean(axis=0) > MOSTLY
        ramping = (held & by_rate).mean(axis=0) > MOSTLY
        if at_limit.any():
            causes.append(_list(names, at_limit) + (' at the limit' if at_limit.sum() > 1
                                                    else ' at its limit'))
        if ramping.any():
            causes.append(_list(names, ramping) + ' held back by max_rate')
        if (acting & self._off).any():
            causes.append(_list(names, acting & self._off) + ' off')
        if self._by_power[short].mean() > MOSTLY:
            causes.append('power_limit')
        if self._by_direction[short].mean() > MOSTLY:
            causes.append('scaled to keep the direction')
        dearer = self._worth * LIGHT > self._worth[dof]
        if not causes:
            causes.append(
                f'wrench_weights.{DOFS[dof]} is low against the weights of the thrusters')
        elif dearer.any():
            causes.append(f'its low weight gives way to {_list(DOFS, dearer)}')
        return ', '.join(causes)


def _geometry(vehicle: Vehicle, dof: int) -> list[str]:
    """Say whether a DOF cannot be served with the thrusters in use, or not without others."""
    enabled = np.array([float(one.enabled) for one in vehicle.thrusters])
    matrix = vehicle.configuration_matrix
    norms = np.linalg.norm(matrix, axis=1, keepdims=True)
    rows = np.divide(matrix, norms, out=np.zeros_like(matrix),
                     where=norms > ROUNDING * norms.max()) * enabled
    if not np.abs(rows[dof]).max() > ROUNDING:
        return ['no thruster can act on it' + ('' if enabled.all() else ' while some are off')]
    controlled = np.flatnonzero(vehicle.wrench_weights)
    left, singular, _ = np.linalg.svd(rows[controlled])
    rank = int((singular > 1e-6 * singular.max()).sum())
    lost = left[:, rank:] @ left[:, rank:].T  # onto what cannot be had
    place = int(np.flatnonzero(controlled == dof)[0])
    if lost[place, place] < 1e-6:
        return []
    with_it = [DOFS[d] for i, d in enumerate(controlled)
               if i != place and abs(lost[i, place]) > 1e-6]
    return [f'it comes only together with {", ".join(with_it)}']


def _list(names: Sequence[str], chosen: np.ndarray) -> str:
    return ', '.join(name for name, is_chosen in zip(names, chosen) if is_chosen)


def _essence(vehicle: Vehicle) -> tuple:
    """Return what the authority at rest depends on."""
    return (vehicle.configuration_matrix.tobytes(), vehicle.reference_limits.tobytes(),
            tuple(weight > 0.0 for weight in vehicle.wrench_weights))
