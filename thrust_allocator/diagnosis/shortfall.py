"""What a vehicle was asked for and did not give: by DOF, how much, how often, and why."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.diagnosis.causes import Allocated, Causes, MOSTLY, ROUNDING
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.authority import authority, TOGETHER

SHARE = 0.01  # of the command, and of what the vehicle can give, that may be missing without a word
OFTEN = 0.1  # share of the ticks from which on what is missing is told
UNITS = ('N', 'N', 'N', 'N*m', 'N*m', 'N*m')


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
    commands = np.array([tick.wrench for tick in ticks])  # (n, 6)
    unallocated = np.array([tick.unallocated for tick in ticks])
    asked = np.abs(commands) > floor
    missing = np.abs(unallocated) > np.maximum(SHARE * np.abs(commands), floor)
    asked_for, missed = asked.sum(axis=0), missing.sum(axis=0)  # in how many ticks, (6,)
    parts, causes = [], None
    for dof, weight in enumerate(vehicle.wrench_weights):
        if weight and missed[dof] > OFTEN * count:
            causes = causes or Causes(ticks, vehicle, floor)
            short = missing[:, dof]
            parts.append(
                _missing(dof, commands[short, dof], unallocated[short, dof], floor[dof])
                + f' in {missed[dof] / count:.0%} of the ticks: {", ".join(causes.of(dof, short))}')
        elif not weight and asked_for[dof] > OFTEN * count:
            parts.append(f'{DOFS[dof]} is commanded but not controlled (wrench_weights.{DOFS[dof]} '
                         'is 0)')
    return '; '.join(parts)


def _missing(dof: int, wanted: np.ndarray, unallocated: np.ndarray, floor: float) -> str:
    """Say how much of a component is missing on average, and whether it has the other sign."""
    given, unit = wanted - unallocated, UNITS[dof]
    against = (wanted * given < 0.0) & (np.abs(wanted) > floor) & (np.abs(given) > floor)
    if against.sum() > MOSTLY * len(wanted):
        return (f'{DOFS[dof]} comes out with the other sign: {_number(given[against].mean())} '
                f'instead of {_number(wanted[against].mean())} {unit}')
    return (f'{DOFS[dof]} is off by {_number(np.abs(unallocated).mean())} {unit} '
            f'(commanded {_number(wanted.mean())} {unit})')


def _number(value: float) -> str:
    return f'{value + 0.0:.3g}' if abs(value) < 1000.0 else f'{value:.0f}'


def _essence(vehicle: Vehicle) -> tuple:
    """Return what the authority at rest depends on."""
    return (vehicle.configuration_matrix.tobytes(), vehicle.reference_limits.tobytes(),
            tuple(weight > 0.0 for weight in vehicle.wrench_weights))
