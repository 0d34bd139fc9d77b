"""The vehicle: its thrusters, its configuration matrix B, and the weights of the allocation."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.models import Limits, ThrusterModel


@dataclass(frozen=True)
class Thruster:
    """One thruster; vectors are in frd axes, from the body origin."""

    name: str
    position: tuple[float, float, float]  # r [m]
    direction: tuple[float, float, float]  # d, unit vector along which positive thrust pushes [-]
    model: ThrusterModel  # what it can give, and how it loses that in a flow
    weight: float = 1.0  # Q [-]
    torque_ratio: float = 0.0  # k, reaction torque about d per newton of thrust [m]
    max_rate: float = 0.0  # greatest change, 0: unlimited [N/s; of a fin's deflection: rad/s]
    cutoff: float = 0.0  # kappa, share of Bollard thrust below which a limit is not worth using
    enabled: bool = True
    bollard_power: tuple[float, float] = (0.0, 0.0)  # at the Bollard limits (reverse, forward) [W]

    @property
    def bollard_thrust(self) -> Limits:
        """The limits of thrust at rest, (reverse <= 0, forward >= 0) [N]."""
        return self.model.bollard_thrust

    @property
    def in_use(self) -> bool:
        """Whether it may be used and has anything left."""
        return self.enabled and self.model.strength > 0.0

    def column(self, origin: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
        """
        Return the wrench of 1 N of thrust: (6,), [d; r x d + k d] (physics of eq. 2.6).

        :param origin: the point that r is counted from, where the wrench acts [m].
        """
        d, arm = np.array(self.direction), np.subtract(self.position, origin)
        return np.concatenate([d, np.cross(arm, d) + self.torque_ratio * d])


@dataclass(frozen=True)
class Vehicle:
    """A vehicle, immutable and in frd axes, as the mathematics of this package needs it."""

    thrusters: tuple[Thruster, ...]
    wrench_weights: tuple[float, ...]  # R of surge ... yaw; 0: not controlled
    wrench_origin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # where wrenches act [m]

    @cached_property
    def configuration_matrix(self) -> np.ndarray:
        """B of eq. 2.6, (6, p): column i is the wrench of 1 N of thrust i [N/N, N*m/N]."""
        return _frozen(np.stack([one.column(self.wrench_origin) for one in self.thrusters], axis=1))

    @cached_property
    def bollard_thrust(self) -> np.ndarray:
        """The limits of thrust at rest, (2, p): row 0 lower (<= 0), row 1 upper (>= 0) [N]."""
        return _frozen(np.array([thruster.bollard_thrust for thruster in self.thrusters]).T.copy())

    @cached_property
    def reference_limits(self) -> np.ndarray:
        """The limits at rest, but of a fin those at 1 m/s: what to scale by, (2, p) [N]."""
        return _frozen(np.array([one.model.reference_limits for one in self.thrusters]).T.copy())

    def warnings(self) -> list[str]:
        """
        Say which controlled DOFs the thrusters cannot act on, or not independently.

        :return: one sentence per finding, for the log; empty if B has full rank over the
            controlled DOFs.
        """
        matrix = self.configuration_matrix
        controlled = [i for i in range(6) if self.wrench_weights[i] > 0.0]
        dead = [i for i in controlled if np.abs(matrix[i]).max() < 1e-9 * np.abs(matrix).max()]
        found = [f'no thruster can act on {DOFS[i]}: set wrench_weights.{DOFS[i]} to 0, '
                 'or its command is never met' for i in dead]
        alive = [i for i in controlled if i not in dead]
        if alive:
            rows = matrix[alive] / np.linalg.norm(matrix[alive], axis=1, keepdims=True)
            rank = np.linalg.matrix_rank(rows, tol=1e-9)
            if rank < len(alive):
                found.append(
                    f'the thrusters act on {", ".join(DOFS[i] for i in alive)} in only {rank} '
                    f'independent ways: not every wrench can be met; set the wrench_weights of '
                    'what need not be controlled to 0')
        return found


def _frozen(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array
