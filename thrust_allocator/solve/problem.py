"""The allocation problem, eq. 2.6 of Kostenko and Tolstonogov (2017), on OSQP."""

from math import isfinite
from typing import NamedTuple

import numpy as np
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.active_set import ActiveSet
from thrust_allocator.solve.osqp_solver import Solver

TOLERANCE = 1e-9  # of OSQP's residuals, relative to the largest Bollard thrust
ROUNDING = 4.0 * np.finfo(float).eps  # of the whitened gradient, times thrusters and condition
MAX_ITERATIONS = 4000  # OSQP's default; from the optimum it needs one
WORST_CONDITION = 1e13  # of the Hessian; beyond it double precision has nothing left to give


class IllConditioned(ValueError):
    """Weights and geometry that leave double precision nothing to give."""


class Allocation(NamedTuple):
    """What one tick decided; p thrusters, wrenches in frd axes at the body origin."""

    thrusts: np.ndarray  # tau, (p,), inside `limits` exactly [N]
    limits: np.ndarray  # (2, p), row 0 lower, row 1 upper [N]
    achieved: np.ndarray  # B tau, (6,) [N, N*m]
    unallocated: np.ndarray  # commanded minus achieved, (6,) [N, N*m]
    at_bound: np.ndarray  # (p,), -1: held at the lower limit, +1: at the upper one, 0: between
    status: str  # OSQP's own word, 'solved' unless something is wrong
    iterations: int  # OSQP's
    reach: float = 1.0  # alpha, the share of the command that is attainable in its direction
    direction_scale: float = 1.0  # of the command, to keep its direction
    power_scale: float = 1.0  # of what that left, to keep within the power limit
    power: float | None = None  # predicted, where it is limited [W]

    @property
    def solved(self) -> bool:
        """Tell whether OSQP vouches for the thrusts being the optimum."""
        return self.status == 'solved'


class AllocationProblem:
    """
    The quadratic programme, set up once and solved at every tick for a new wrench and new bounds.

    minimise    1/2 (tau^T Q tau + s^T R s)
    subject to  B tau = f + s,  tau_min <= tau <= tau_max                    (eq. 2.6)

    The slack s is eliminated, leaving the Hessian P = Q + B^T R B = L L^T, and OSQP is given the
    problem in w = L^T tau, where its Hessian is the identity: then its dual residual bounds the
    error of the thrusts whatever the weights, so one tolerance does for every vehicle. Bounds and
    linear term are all that changes from tick to tick.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        """
        Set up the solver.

        :raises IllConditioned: if the weights and the geometry make the problem too
            ill-conditioned for double precision.
        """
        self._essence = _essence(vehicle)
        self._matrix = vehicle.configuration_matrix
        self._controlled = np.flatnonzero(vehicle.wrench_weights)
        matrix = self._matrix[self._controlled]
        # A common factor of Q and R changes nothing; this one makes the smallest weight in Q 1
        thrust_weights = np.array([thruster.weight for thruster in vehicle.thrusters])
        smallest = thrust_weights.min()
        with np.errstate(over='ignore', invalid='ignore'):  # refused below
            thrust_weights = thrust_weights / smallest
            wrench_weights = np.array(vehicle.wrench_weights)[self._controlled] / smallest
            root = np.vstack([np.diag(np.sqrt(thrust_weights)),
                              np.sqrt(wrench_weights)[:, np.newaxis] * matrix])
            gain = root[len(thrust_weights):] / np.sqrt(thrust_weights)

        # L^T by QR, which does not square the condition number as factorising P itself would
        self._factor = np.ascontiguousarray(np.linalg.qr(root, mode='r'))  # L^T, (p, p)
        finite = bool(np.isfinite(self._factor).all())
        singular = np.linalg.svd(self._factor, compute_uv=False) if finite else (np.inf, 0.0)
        # With most thrusters at a bound, the equations for the rest may be worse than the Hessian
        worst = np.sqrt(WORST_CONDITION)
        if singular[0] > worst * singular[-1] or np.linalg.norm(gain, 2) > worst:
            raise IllConditioned(
                f'are up to {max(vehicle.wrench_weights):g} while thrusters weigh '
                f'down to {smallest:g}; with these positions that is beyond double precision, must '
                'lie closer together')
        self._thrust_weights = thrust_weights
        self._active_set = ActiveSet(matrix, thrust_weights, wrench_weights)
        self._thrusts = np.linalg.inv(self._factor)  # L^-T: tau = L^-T w
        # q = gradient @ f
        self._gradient = np.ascontiguousarray(-self._thrusts.T @ (matrix.T * wrench_weights))

        self._settings = {
            'verbose': False, 'scaling': 0, 'polishing': False, 'max_iter': MAX_ITERATIONS,
            'check_termination': 1, 'check_dualgap': False,
            'eps_abs': TOLERANCE * np.abs(vehicle.bollard_thrust).max(),
            # A wrench far out of reach makes a gradient so large that its rounding matters
            'eps_rel': ROUNDING * len(singular) * singular[0] / singular[-1],
            # By iterations and never by the clock, so that a run repeats bit for bit
            'adaptive_rho': 1, 'rho': float(np.clip(singular[0] * singular[-1], 1e-6, 1e6))}
        self._solver = Solver(self._thrusts, **self._settings)

    def for_vehicle(self, vehicle: Vehicle) -> 'AllocationProblem':
        """Return the problem of the same vehicle after a change: this one if it serves still."""
        return self if _essence(vehicle) == self._essence else AllocationProblem(vehicle)

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> Allocation:
        """
        Allocate a wrench.

        :param wrench: f, (6,), frd axes [N, N*m]; components of zero weight are not controlled.
        :param limits: (2, p), row 0 lower, row 1 upper [N].
        :return: the optimum, as OSQP found it; or, if OSQP does not report it solved, the best
            point known, which is inside the limits all the same.
        """
        lower, upper = limits
        command = wrench[self._controlled]
        wanted, thrusts, at_bound = self._active_set.solve(command, limits)
        if not isfinite(wanted.sum()):  # OSQP would call NaN solved
            wanted = thrusts = np.clip(0.0, lower, upper)
        status, iterations = self._solver.solve(
            self._gradient.dot(command), lower, upper,
            self._factor.dot(thrusts), self._thrust_weights * (wanted - thrusts))
        if status == 'solved' and iterations > 1:  # the start was not the optimum
            whitened, multipliers = self._solver.optimum
            wanted = self._thrusts @ whitened + multipliers / self._thrust_weights
            thrusts = np.clip(wanted, lower, upper)
            at_bound = (wanted > upper).view(np.int8) - (wanted < lower).view(np.int8)
        elif status != 'solved':
            self._solver = Solver(self._thrusts, **self._settings)  # nothing may linger in it
        achieved = self._matrix.dot(thrusts)
        return Allocation(
            thrusts, limits, achieved, wrench - achieved, at_bound, status, iterations)


def _essence(vehicle: Vehicle) -> tuple:
    """Return what the problem depends on, apart from what changes from tick to tick."""
    return (vehicle.wrench_weights, vehicle.configuration_matrix.tobytes(),
            tuple(thruster.weight for thruster in vehicle.thrusters),
            np.abs(vehicle.bollard_thrust).max())
