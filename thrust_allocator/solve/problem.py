"""The allocation problem, eq. 2.6 of Kostenko and Tolstonogov (2017), on OSQP."""

from math import isfinite
from typing import NamedTuple

import numpy as np
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.active_set import ActiveSet
from thrust_allocator.solve.conditioning import require_precision, root, scaled
from thrust_allocator.solve.osqp_solver import Solver, UNDECIDED

TOLERANCE = 1e-9  # of OSQP's residuals, relative to the largest thrust or lift
ROUNDING = 4.0 * np.finfo(float).eps  # of a sum, times its terms: one per thruster
MAX_ITERATIONS = 4000  # OSQP's default; from the optimum it needs one


class Allocation(NamedTuple):
    """What one tick decided; p thrusters, wrenches in frd axes at the body origin."""

    thrusts: np.ndarray  # tau, (p,), inside `limits` exactly [N]
    limits: np.ndarray  # (2, p), row 0 lower, row 1 upper [N]
    achieved: np.ndarray  # B tau, (6,) [N, N*m]
    unallocated: np.ndarray  # commanded minus achieved, (6,) [N, N*m]
    at_bound: np.ndarray  # (p,), -1: held at the lower limit, +1: at the upper one, 0: between
    status: str  # OSQP's own word, 'solved' unless something is wrong
    iterations: int  # OSQP's; 1, unless it had to find the optimum
    reach: float = 1.0  # alpha, the share of the command that is attainable in its direction
    direction_scale: float = 1.0  # of the command, to keep its direction
    power_scale: float = 1.0  # of what that left, to keep within the power limit
    power: float | None = None  # predicted, where it is limited [W]

    @property
    def solved(self) -> bool:
        """Tell whether the thrusts are vouched for as the optimum."""
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

    OSQP has one iteration to find that the active set's thrusts are the optimum. Where R / Q is
    large and f far out of reach, rounding is more than its tolerance: then the thrusts are refined,
    and the conditions of an optimum decide. Only where they fail too, OSQP solves the problem.
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
        given = (np.array([thruster.weight for thruster in vehicle.thrusters]),
                 np.array(vehicle.wrench_weights)[self._controlled])
        require_precision(matrix, *given)
        thrust_weights, wrench_weights = scaled(*given)
        self._thrust_weights = thrust_weights

        # L^T by QR, which does not square the condition number as factorising P itself would
        self._factor = np.ascontiguousarray(
            np.linalg.qr(root(matrix, thrust_weights, wrench_weights), mode='r'))  # L^T, (p, p)
        singular = np.linalg.svd(self._factor, compute_uv=False)
        self._active_set = ActiveSet(matrix, thrust_weights, wrench_weights)
        self._unwhiten = np.linalg.inv(self._factor)  # L^-T: tau = L^-T w
        # q = gradient @ f
        self._gradient = np.ascontiguousarray(-self._unwhiten.T @ (matrix.T * wrench_weights))

        self._rounding = ROUNDING * len(thrust_weights)
        self._settings = {
            'verbose': False, 'scaling': 0, 'polishing': False, 'check_termination': 1,
            'check_dualgap': False,
            'eps_abs': TOLERANCE * np.abs(vehicle.reference_limits).max(),
            # A wrench far out of reach makes a gradient so large that its rounding matters
            'eps_rel': self._rounding * singular[0] / singular[-1],
            'rho': float(np.clip(singular[0] * singular[-1], 1e-6, 1e6))}
        self._judge = self._new_judge()

    def _new_judge(self) -> Solver:
        """Return an OSQP that only tells whether its start is the optimum."""
        return Solver(self._unwhiten, max_iter=1, adaptive_rho=0, **self._settings)

    def for_vehicle(self, vehicle: Vehicle) -> 'AllocationProblem':
        """Return the problem of the same vehicle after a change: this one if it serves still."""
        return self if _essence(vehicle) == self._essence else AllocationProblem(vehicle)

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> Allocation:
        """
        Allocate a wrench.

        :param wrench: f, (6,), frd axes [N, N*m]; components of zero weight are not controlled.
        :param limits: (2, p), row 0 lower, row 1 upper [N].
        :return: the optimum; or, if its status is not solved, the best point known, which is
            inside the limits all the same.
        """
        lower, upper = limits
        command = wrench[self._controlled]
        wanted, thrusts, at_bound = self._active_set.solve(command, limits)
        if not isfinite(wanted.dot(wanted)):  # OSQP would call NaN solved
            wanted = thrusts = np.clip(0.0, lower, upper)
        question = (self._gradient.dot(command), lower, upper, self._factor.dot(thrusts),
                    self._thrust_weights * (wanted - thrusts))
        status, iterations = self._judge.solve(*question)
        if status in UNDECIDED:
            thrusts, at_bound, status, iterations = self._settle(
                command, limits, thrusts, at_bound, question)
        elif status != 'solved':
            self._judge = self._new_judge()  # nothing may linger in it
        achieved = self._matrix.dot(thrusts)
        return Allocation(
            thrusts, limits, achieved, wrench - achieved, at_bound, status, iterations)

    def _settle(self, command: np.ndarray, limits: np.ndarray, thrusts: np.ndarray,
                at_bound: np.ndarray, question: tuple) -> tuple[np.ndarray, np.ndarray, str, int]:
        """Return thrusts, bounds, status and iterations where OSQP cannot vouch for its start."""
        refined, held, certain = self._active_set.refine(
            command, limits, thrusts, at_bound, self._rounding)
        if certain:
            return refined, held, 'solved', 1
        # rho adapts by iterations and never by the clock, so that a run repeats bit for bit
        solver = Solver(
            self._unwhiten, max_iter=MAX_ITERATIONS, adaptive_rho=1, **self._settings)
        status, iterations = solver.solve(*question)
        if status == 'solved':
            whitened, multipliers = solver.optimum
            wanted = self._unwhiten @ whitened + multipliers / self._thrust_weights
            thrusts = np.clip(wanted, *limits)
            at_bound = (wanted > limits[1]).view(np.int8) - (wanted < limits[0]).view(np.int8)
        return thrusts, at_bound, status, iterations


def _essence(vehicle: Vehicle) -> tuple:
    """Return what the problem depends on, apart from what changes from tick to tick."""
    return (vehicle.wrench_weights, vehicle.configuration_matrix.tobytes(),
            tuple(thruster.weight for thruster in vehicle.thrusters),
            np.abs(vehicle.reference_limits).max())
