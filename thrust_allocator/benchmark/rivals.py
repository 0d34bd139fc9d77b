"""Allocators to compare with: each set up once, as its user would, and then asked tick by tick."""

from abc import ABC, abstractmethod
from importlib import import_module

import numpy as np
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import AllocationProblem

NARROW = 1e-9  # bounds closer than this count as equal, for solvers that want them apart [N]


class Rival(ABC):
    """An allocator: `solve` returns thrusts, whatever it needs for that is its own time."""

    name: str
    package: str | None = None  # what it needs beyond this package's own dependencies
    slow = False  # slow ones are measured on a part of the ticks

    def __init__(self, vehicle: Vehicle) -> None:
        """
        Build the problem with the slack eliminated: minimise 1/2 x^T H x + (g f)^T x.

        :raises ImportError: if `package` is not installed.
        """
        self.module = import_module(self.package) if self.package else None
        self.solved = True  # whether the allocator itself was content with the last tick
        self.controlled = np.flatnonzero(vehicle.wrench_weights)
        self.thrust_weights = np.array([thruster.weight for thruster in vehicle.thrusters])
        self.wrench_weights = np.array(vehicle.wrench_weights)[self.controlled]
        self.matrix = vehicle.configuration_matrix[self.controlled]  # B, (m, p)
        self.count = self.matrix.shape[1]  # p
        self.hessian = (np.diag(self.thrust_weights)
                        + (self.matrix.T * self.wrench_weights) @ self.matrix)
        self.gradient = -(self.matrix.T * self.wrench_weights)  # g, (p, m)

    @abstractmethod
    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        """
        Allocate one tick.

        :param wrench: f, (6,), frd axes [N, N*m].
        :param limits: (2, p), row 0 lower, row 1 upper [N].
        :return: thrusts, (p,) [N].
        """


class Ours(Rival):
    """This package: an active set found from the last one, certified by OSQP."""

    name = 'thrust_allocator'

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self._problem = AllocationProblem(vehicle)
        self.iterations = 0  # OSQP's, of the last tick

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        allocation = self._problem.solve(wrench, limits)
        self.solved, self.iterations = allocation.solved, allocation.iterations
        return allocation.thrusts


class PseudoInverse(Rival):
    """What most vehicles run: the weighted pseudo-inverse, its answer cut to the limits."""

    name = 'pseudo-inverse, clamped'

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        root = np.sqrt(self.thrust_weights)  # of Q
        self._inverse = np.linalg.pinv(self.matrix / root) / root[:, np.newaxis]

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        thrusts = self._inverse @ wrench[self.controlled]
        return np.minimum(np.maximum(thrusts, limits[0]), limits[1])


class BoundedLeastSquares(Rival):
    """SciPy's bounded-variable least squares, on [Q^1/2; R^1/2 B] x = [0; R^1/2 f]."""

    name = 'SciPy lsq_linear (BVLS)'
    package = 'scipy.optimize'
    slow = True

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self._weights = np.sqrt(self.wrench_weights)
        self._rows = np.vstack([np.diag(np.sqrt(self.thrust_weights)),
                                self._weights[:, np.newaxis] * self.matrix])

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        target = np.concatenate([np.zeros(self.count), self._weights * wrench[self.controlled]])
        free = limits[1] - limits[0] > NARROW  # it refuses equal bounds
        thrusts = limits[0].copy()
        if not free.all():
            target -= self._rows[:, ~free] @ thrusts[~free]
        result = self.module.lsq_linear(self._rows[:, free], target, limits[:, free],
                                        method='bvls')
        self.solved, thrusts[free] = result.success, result.x
        return thrusts


class SequentialLeastSquares(Rival):
    """SciPy's SLSQP with the exact gradient, started from the last thrusts."""

    name = 'SciPy SLSQP'
    package = 'scipy.optimize'
    slow = True

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self._thrusts = np.zeros(self.count)

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        linear = self.gradient @ wrench[self.controlled]

        def cost(thrusts: np.ndarray) -> tuple[float, np.ndarray]:
            push = self.hessian @ thrusts
            return thrusts @ (0.5 * push + linear), push + linear

        result = self.module.minimize(
            cost, np.clip(self._thrusts, *limits), jac=True, method='SLSQP', bounds=limits.T)
        self.solved, self._thrusts = result.success, result.x
        return result.x
