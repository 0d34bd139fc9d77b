"""What gives way: how a wrench is changed before it is allocated, by direction and by power."""

from collections.abc import Callable, Sequence

import numpy as np
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.attainable import AttainableSet, NO_SERVICE
from thrust_allocator.solve.cone import Cone
from thrust_allocator.solve.power_scale import within_power
from thrust_allocator.solve.problem import Allocation, AllocationProblem

FULLY_KEPT = 0.1  # scale of the wrench from which on its direction is kept as asked


class Compromise:
    """
    The wrench that is allocated, f - k (1 - alpha) f_D, in place of f, by one QP all the same.

    alpha f_D is the largest share of the wrench that is attainable in its direction. With k = 0
    the weights of the QP decide what gives way, with k = 1 the direction is kept. Where less than
    a tenth is left in its direction, k fades out in proportion: else one thruster that has died
    would take every other DOF down with it.
    """

    def __init__(self, vehicle: Vehicle, problem: AllocationProblem, keeping: float = 0.0,
                 dofs: Sequence[int] = range(6), power_limit: float = 0.0) -> None:
        """
        Set up for a vehicle.

        :param problem: of the same vehicle.
        :param keeping: k, how much of the direction to keep, in [0, 1].
        :param dofs: D, the DOFs that are scaled together; of these, those of weight > 0.
        :param power_limit: of all thrusters together; 0: none [W].
        :raises TooManyFaces: if k > 0 and the vehicle's attainable set has too many faces.
        """
        self._problem, self._keeping, self._power_limit = problem, keeping, power_limit
        root = np.sqrt(np.array(vehicle.wrench_weights))
        self._per_wrench = np.linalg.pinv(  # that a command would take if nothing limited them
            root[:, np.newaxis] * vehicle.configuration_matrix, rcond=NO_SERVICE) * root
        if keeping:
            weights = np.zeros(6)
            weights[list(dofs)] = np.array(vehicle.wrench_weights)[list(dofs)]
            enabled = np.array([float(thruster.in_use) for thruster in vehicle.thrusters])
            self._scaled = weights > 0.0
            self._attainable = AttainableSet(vehicle.configuration_matrix, weights, enabled)
            self._cone = Cone(vehicle.configuration_matrix, weights,
                              vehicle.reference_limits * enabled)

    def solve(self, wrench: np.ndarray, speed_limits: np.ndarray, limits: np.ndarray,
              power: Callable[[], Callable[[np.ndarray], float]] | None = None) -> Allocation:
        """
        Allocate a wrench.

        :param wrench: f, (6,), frd axes [N, N*m].
        :param speed_limits: (2, p) at the present velocity, row 0 lower, row 1 upper [N].
        :param limits: (2, p), the part of them within reach of the last setpoints [N].
        :param power: asked only where there is a limit for a function that predicts what thrusts
            (p,) take in the present flow [W].
        :return: the allocation; what is not allocated counts from the wrench as it came. Where
            even the setpoints nearest to 0 in `limits` take too much power, limits that exclude 0
            are moved towards it.
        """
        command, reach, scale = self._kept(wrench, speed_limits)
        allocation = self._problem.solve(command, limits)
        if self._power_limit and power is not None:
            allocation = within_power(
                self._problem, command, allocation, power(), self._power_limit,
                float(np.abs(self._per_wrench @ command).max() / np.abs(limits).max()))
        elif command is wrench:
            return allocation
        return allocation._replace(unallocated=wrench - allocation.achieved, reach=reach,
                                   direction_scale=scale)

    def _kept(self, wrench: np.ndarray,
              speed_limits: np.ndarray) -> tuple[np.ndarray, float, float]:
        """Return the wrench to allocate, alpha, and the factor that the wrench was scaled by."""
        if not self._keeping:
            return wrench, 1.0, 1.0
        reach, towards = self._attainable.scale(wrench, speed_limits), wrench
        if reach == 0.0 and self._cone.one_sided:
            nearest = self._cone.nearest(wrench)
            if nearest is not None:
                reach, towards = self._attainable.scale(nearest, speed_limits), nearest
        if reach == 1.0 and towards is wrench:
            return wrench, 1.0, 1.0
        keeping = self._keeping * min(1.0, reach / FULLY_KEPT)
        change = np.where(self._scaled, wrench - reach * towards, 0.0)
        return wrench - keeping * change, reach, 1.0 - keeping * (1.0 - reach)
