"""A primal active-set method that hands OSQP the optimum to start from."""

from functools import lru_cache

import numpy as np


class ActiveSet:
    """
    The box-constrained problem of eq. 2.6 with the slack eliminated, solved from the last optimum.

    minimise 1/2 (x^T Q x + (B x - f)^T R (B x - f))  subject to  lower <= x <= upper

    For a given set of thrusters held at a bound the rest follows from the wrench multiplier
    lambda = R (f - B x): each free thruster gives x_i = b_i^T lambda / q_i, and lambda solves a
    system of no more than 6 equations however many thrusters there are.

    The method steps from a feasible point towards the optimum of the current set, holds the first
    thruster that meets a bound on the way, and once none does, frees the one whose bound hinders
    most (Nocedal and Wright, Numerical Optimization, 2006, section 16.5). The cost falls at every
    step, so it ends; from one tick to the next the set rarely changes, and then one step is all.
    """

    def __init__(self, matrix: np.ndarray, thrust_weights: np.ndarray,
                 wrench_weights: np.ndarray) -> None:
        """
        Remember the problem.

        :param matrix: B over the controlled DOFs, (m, p).
        :param thrust_weights: diagonal of Q, (p,), > 0.
        :param wrench_weights: diagonal of R, (m,), > 0.
        """
        self._matrix = matrix
        self._thrust_weights = thrust_weights
        self._compliance = 1.0 / wrench_weights
        self._per_multiplier = matrix / thrust_weights  # thrust wanted per unit of lambda, (m, p)
        self._sides = np.zeros(len(thrust_weights), dtype=np.int8)  # -1 lower, 0 free, +1 upper
        self._thrusts = np.zeros(len(thrust_weights))
        self._response = lru_cache(maxsize=256)(self._compute_response)

    def solve(self, wrench: np.ndarray, lower: np.ndarray,
              upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """
        Return the optimal thrusts and the multipliers of their bounds.

        :param wrench: f over the controlled DOFs, (m,).
        :param lower: (p,) bounds, in the unit of the result.
        :param upper: (p,) bounds, not below `lower`.
        :return: thrusts (p,), inside the bounds exactly, and multipliers (p,): > 0 at the upper,
            < 0 at the lower bound, 0 between. Feasible but not optimal in the rare case that
            rounding keeps the method from ending within 20 + 10 p steps.
        """
        fixed = lower >= upper
        sides = np.where(fixed, np.int8(-1), self._sides)
        thrusts = np.where(sides > 0, upper, np.where(sides < 0, lower, self._thrusts))
        thrusts = np.minimum(np.maximum(thrusts, lower), upper)
        for _ in range(20 + 10 * len(thrusts)):
            wanted = self._wanted(wrench, thrusts, sides)
            free = sides == 0
            step = np.where(free, wanted - thrusts, 0.0)
            first, share = _first_blocked(thrusts, step, lower, upper)
            if share < 1.0:
                sides[first] = 1 if step[first] > 0.0 else -1
                thrusts = thrusts + share * step
                thrusts[first] = upper[first] if step[first] > 0.0 else lower[first]
                continue
            thrusts = np.where(free, wanted, thrusts)
            hindered = np.where(fixed, 0.0, sides * (thrusts - wanted))
            most = hindered.argmax()
            if hindered[most] <= 1e-10 * (1.0 + np.abs(thrusts).max()):
                break
            sides[most] = 0
        thrusts = np.minimum(np.maximum(thrusts, lower), upper)
        self._sides, self._thrusts = sides, thrusts
        return thrusts, np.where(sides == 0, 0.0, self._thrust_weights * (wanted - thrusts))

    def _wanted(self, wrench: np.ndarray, thrusts: np.ndarray, sides: np.ndarray) -> np.ndarray:
        """Return what each thruster would give without its bound, the others' sides held: (p,)."""
        free = sides == 0
        response = self._response(free.tobytes())
        rest = wrench - self._matrix @ np.where(free, 0.0, thrusts)
        multiplier = response @ rest
        # One step of iterative refinement makes up for using an inverse
        given = np.where(free, multiplier @ self._per_multiplier, 0.0)
        multiplier += response @ (rest - self._compliance * multiplier - self._matrix @ given)
        return multiplier @ self._per_multiplier

    def _compute_response(self, free: bytes) -> np.ndarray:
        """Return the (m, m) inverse of R^-1 + B_F Q_F^-1 B_F^T for a set F of free thrusters."""
        free = np.frombuffer(free, dtype=bool)
        stiffness = self._per_multiplier[:, free] @ self._matrix[:, free].T
        return np.linalg.inv(np.diag(self._compliance) + stiffness)


def _first_blocked(thrusts: np.ndarray, step: np.ndarray, lower: np.ndarray,
                   upper: np.ndarray) -> tuple[int, float]:
    """Return which thruster meets a bound first along `step`, and at what share of it."""
    room = np.where(step > 0.0, upper - thrusts, thrusts - lower)
    share = np.divide(room, np.abs(step), out=np.ones_like(step), where=np.abs(step) > room)
    first = int(share.argmin())
    return first, share[first]
