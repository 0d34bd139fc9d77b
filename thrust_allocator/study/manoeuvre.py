"""What the vehicle is asked to do at every speed: hold the speed, and a manoeuvre's wrench."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math

import numpy as np
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.study.authority import Authority
from thrust_allocator.study.errors import StudyError

DRAG = 40.0  # surge force that holds a speed, per speed squared: the paper's test [N*s^2/m^2]
PITCH = 50.0  # nose up: the paper's test [N*m]
# Where 50 N*m of pitch is beyond a vehicle: which DOF to manoeuvre in instead, best first
SUBSTITUTES = ('pitch', 'yaw', 'heave', 'sway', 'roll', 'surge')
SUBSTITUTE_SHARE = 0.5  # of what can be reached at rest


def unit(dof: int) -> str:
    """Return the unit of a component of a wrench."""
    return 'N' if dof < 3 else 'N*m'


@dataclass(frozen=True)
class Manoeuvre:
    """The command at every speed, in frd axes; its default is the paper's test case."""

    wrench: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, PITCH, 0.0)  # besides the drag [N, N*m]
    drag: tuple[float, float, float] = (DRAG, 0.0, 0.0)  # surge, sway, heave [N*s^2/m^2]

    def velocity(self, speed: float, heading: float) -> np.ndarray:
        """
        Return the velocity through the water of a vehicle that keeps a heading to the current.

        :param speed: through the water [m/s].
        :param heading: of the bow, to starboard from straight into the current [deg].
        :return: (6,) frd axes [m/s, rad/s]; level, without a turn rate.
        """
        angle = math.radians(heading)
        return np.array([speed * math.cos(angle), -speed * math.sin(angle), 0.0, 0.0, 0.0, 0.0])

    def cruise(self, velocity: np.ndarray) -> np.ndarray:
        """Return the wrench that holds a velocity against the drag, (6,), frd axes [N, N*m]."""
        along = velocity[:3]
        return np.concatenate([np.array(self.drag) * along * np.abs(along), np.zeros(3)])

    def command(self, velocity: np.ndarray) -> np.ndarray:
        """Return the cruise wrench and the manoeuvre's together, (6,), frd axes [N, N*m]."""
        return self.cruise(velocity) + self.wrench

    def __str__(self) -> str:
        wrench = [f'{value:g} {unit(i)} of {DOFS[i]}' for i, value in enumerate(self.wrench)
                  if value]
        drag = [f'{value:g} v^2 N of {DOFS[i]}' for i, value in enumerate(self.drag) if value]
        return ' and '.join(drag + wrench) or 'no wrench at all'


def paper_test(vehicles: Sequence[Vehicle], speed: float) -> Manoeuvre:
    """
    Return the paper's test case, or the nearest to it that the vehicles can follow.

    That is 50 N*m of pitch where every vehicle can reach it at rest; or else half of what every one
    can reach at rest in the first DOF of SUBSTITUTES in which that is not nothing. Likewise the
    drag is the paper's, or else takes half of the surge that is within reach at the largest speed.

    :param speed: the largest of the study [m/s].
    :raises StudyError: if there is no DOF in which all can push.
    """
    paper = Manoeuvre()
    at_speed = _largest(vehicles, speed)[0]
    if paper.drag[0] * speed**2 > at_speed:
        paper = replace(paper, drag=(_rounded(SUBSTITUTE_SHARE * at_speed / speed**2), 0.0, 0.0))
    at_rest = _largest(vehicles, 0.0)
    for dof in map(DOFS.index, SUBSTITUTES):
        if DOFS[dof] == 'pitch' and at_rest[dof] >= PITCH:
            return paper
        if at_rest[dof] > 0.0:
            amount = _rounded(SUBSTITUTE_SHARE * at_rest[dof])
            return replace(paper, wrench=tuple(amount if i == dof else 0.0 for i in range(6)))
    raise StudyError('--wrench: must be given, for there is no controlled DOF in which every '
                     'vehicle can push')


def _largest(vehicles: Sequence[Vehicle], speed: float) -> np.ndarray:
    """Return what every vehicle can reach straight ahead, no other wrench held: (6,) [N, N*m]."""
    velocity = np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0])
    return np.min([np.nan_to_num(Authority(vehicle)(ThrustBounds(vehicle)(velocity),
                                                    np.zeros(6))[0, :, 1])
                   for vehicle in vehicles], axis=0)


def _rounded(value: float) -> float:
    """Return a value >= 0 with two digits, not rounded up, lest it be more than there is."""
    step = 10.0**(math.floor(math.log10(value)) - 1) if value > 0.0 else 1.0
    return float(f'{math.floor(value / step) * step:.2g}')
