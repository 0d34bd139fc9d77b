"""Quadratic programming solvers to compare with: dense active-set methods, and OSQP's first use."""

import numpy as np
import scipy.sparse
from thrust_allocator.benchmark.rivals import NARROW, Rival
from thrust_allocator.physics.vehicle import Vehicle


class Quadprog(Rival):
    """quadprog on the box problem; it wants one constraint per bound, and no equal bounds."""

    name = 'quadprog'
    package = 'quadprog'

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        identity = np.eye(self.count)
        self._constraints = np.hstack([identity, -identity])

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        lower, upper = limits
        linear = -(self.gradient @ wrench[self.controlled])
        free = upper - lower > NARROW
        if free.all():
            return self.module.solve_qp(self.hessian, linear, self._constraints,
                                        np.concatenate([lower, -upper]))[0]
        thrusts = lower.copy()
        if free.any():
            linear -= self.hessian[:, ~free] @ thrusts[~free]
            thrusts[free] = self.module.solve_qp(
                self.hessian[np.ix_(free, free)], linear[free],
                self._constraints[free][:, np.tile(free, 2)],
                np.concatenate([lower[free], -upper[free]]))[0]
        return thrusts


class Daqp(Rival):
    """daqp on the box problem, one workspace for all ticks."""

    name = 'daqp'
    package = 'daqp'

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        none = np.zeros((0, self.count))
        self._model = self.module.Model()
        self._model.setup(self.hessian, np.zeros(self.count), none, np.ones(self.count),
                          -np.ones(self.count), np.zeros(self.count, dtype=np.int32))

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        self._model.update(f=self.gradient @ wrench[self.controlled], bupper=limits[1],
                           blower=limits[0])
        thrusts, _, flag, _ = self._model.solve()
        self.solved = flag == 1
        return thrusts


class CasadiQrqp(Rival):
    """
    CasADi's qrqp with the slack as variables.

    Started cold: from the last tick's solution and multipliers it is no faster, and calls answers
    a success that are 64 N off (3.8.2, smooth walk).
    """

    name = 'CasADi qrqp, with slack'
    package = 'casadi'

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        weights = np.concatenate([self.thrust_weights, self.wrench_weights])
        slack = len(self.wrench_weights)
        self._hessian = self.module.DM(scipy.sparse.diags(weights, format='csc'))
        self._rows = self.module.DM(scipy.sparse.csc_matrix(
            np.hstack([self.matrix, -np.eye(slack)])))
        self._unbounded = np.full(slack, np.inf)
        self._solver = self.module.conic(
            'allocation', 'qrqp', {'h': self._hessian.sparsity(), 'a': self._rows.sparsity()},
            {'print_iter': False, 'print_header': False, 'print_info': False,
             'error_on_fail': False})

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        command = wrench[self.controlled]
        result = self._solver(
            h=self._hessian, a=self._rows, lba=command, uba=command,
            lbx=np.concatenate([limits[0], -self._unbounded]),
            ubx=np.concatenate([limits[1], self._unbounded]))
        self.solved = self._solver.stats()['success']
        return result['x'].full()[:self.count, 0]


class Osqp(Rival):
    """OSQP as it is written first: tau and s as variables, default settings, warm start."""

    name = 'OSQP, with slack, warm'
    package = 'osqp'

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        weights = np.concatenate([self.thrust_weights, self.wrench_weights])
        slack = len(self.wrench_weights)
        self._hessian = scipy.sparse.diags(weights, format='csc')
        self._rows = scipy.sparse.csc_matrix(np.block([
            [self.matrix, -np.eye(slack)], [np.eye(self.count), np.zeros((self.count, slack))]]))
        self._set_up(np.zeros(slack + self.count), np.zeros(slack + self.count))

    def _set_up(self, lower: np.ndarray, upper: np.ndarray) -> None:
        self._solver = self.module.OSQP()
        self._solver.setup(self._hessian, np.zeros(len(lower)), self._rows, lower, upper,
                           verbose=False)

    def _renew(self, lower: np.ndarray, upper: np.ndarray) -> None:
        self._solver.update(l=lower, u=upper)

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
        command = wrench[self.controlled]
        self._renew(np.concatenate([command, limits[0]]), np.concatenate([command, limits[1]]))
        result = self._solver.solve(raise_error=False)
        self.solved = result.info.status == 'solved'
        return result.x[:self.count]


class OsqpRebuilt(Osqp):
    """The same, but set up anew at every tick."""

    name = 'OSQP, with slack, rebuilt'
    slow = True

    def _renew(self, lower: np.ndarray, upper: np.ndarray) -> None:
        self._set_up(lower, upper)
