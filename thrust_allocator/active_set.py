"""A primal active-set method that hands OSQP the optimum to start from."""

from functools import lru_cache

import numpy as np

CACHED_SETS = 256  # a vehicle meets a few dozen; bounded, because p thrusters have 3^p
ROUNDING = 1e-10  # a bound hinders a thruster by more than this share of the largest thrust


class ActiveSet:
    """
    The box-constrained problem of eq. 2.6 with the slack eliminated, solved from the last optimum.

    minimise 1/2 (x^T Q x + (B x - f)^T R (B x - f))  subject to  lower <= x <= upper

    Hold some thrusters at a bound. What each thruster would give if its own bound did not count is
    then linear in f and in the bounds of those held, by matrices that are computed once per set.
    If those held would go beyond their bound and the others would not, the set is the optimum's.
    From one tick to the next it rarely changes, and then confirming it is all.

    Where it changes, the method steps from a feasible point towards the optimum of the present
    set, holds the first thruster that meets a bound on the way, and once none does, frees the one
    whose bound hinders most (Nocedal and Wright, Numerical Optimization, 2006, section 16.5). The
    cost falls at every step, so it ends.
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
        self._per_multiplier = matrix / thrust_weights
        self._compliance = np.diag(1.0 / wrench_weights)
        self._response = lru_cache(maxsize=CACHED_SETS)(self._compute_response)
        self._sides = bytes(len(thrust_weights))  # of an int8 array: -1 lower, 0 free, +1 upper

    def solve(self, wrench: np.ndarray, limits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """
        Return what each thruster would give at the optimum if its own bound did not count.

        :param wrench: f over the controlled DOFs, (m,).
        :param limits: (2, p), row 0 lower, row 1 upper, not below it.
        :return: the unbounded thrusts (p,), which cut to the limits are the optimum, and which
            bound holds each thruster: -1 lower, 0 none, 1 upper, (p,) int8. In the rare case that
            rounding keeps the method from ending in 20 + 10 p steps, it is only near the optimum.
        """
        wanted = self._wanted(wrench, limits, self._sides)
        sides = sides_of(wanted, limits)
        if (key := sides.tobytes()) != self._sides:
            wanted = self._search(wrench, limits, wanted, sides)
            sides = sides_of(wanted, limits)
            key = sides.tobytes()
        self._sides = key
        return wanted, sides

    def _search(self, wrench: np.ndarray, limits: np.ndarray, wanted: np.ndarray,
                sides: np.ndarray) -> np.ndarray:
        """Return what `solve` does, starting from the feasible point next to `wanted`."""
        lower, upper = limits
        thrusts = np.clip(wanted, lower, upper)
        fixed = lower >= upper
        sides = np.where(fixed, np.int8(1), sides)
        for _ in range(20 + 10 * len(thrusts)):
            wanted = self._wanted(wrench, limits, sides.tobytes())
            step = np.where(sides == 0, wanted - thrusts, 0.0)
            first, share = _first_blocked(thrusts, step, lower, upper)
            if share < 1.0:
                sides[first] = 1 if step[first] > 0.0 else -1
                thrusts += share * step
                thrusts[first] = upper[first] if step[first] > 0.0 else lower[first]
                continue
            thrusts += step
            hindered = np.where(fixed, 0.0, sides * (thrusts - wanted))
            most = hindered.argmax()
            if hindered[most] <= ROUNDING * np.abs(thrusts).max():
                break
            sides[most] = 0
        return wanted

    def _wanted(self, wrench: np.ndarray, limits: np.ndarray, sides: bytes) -> np.ndarray:
        held, to_wrench, to_bounds = self._response(sides)
        return to_wrench @ wrench - to_bounds @ limits.take(held)

    def _compute_response(self, sides: bytes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """
        Return how the unbounded thrusts respond while some thrusters are held at a bound.

        Each free thruster gives b_i^T lambda / q_i, where the multiplier lambda = R (f - B x) of
        the wrench solves (R^-1 + B_F Q_F^-1 B_F^T) lambda = f - B_H x_H over the free thrusters F
        and those held H: six equations at most, however many thrusters there are.

        :param sides: bytes of the (p,) array of -1, 0 and 1.
        :return: indices (h,) of the bounds that hold into the flat limits, the response (p, m) to
            f, and (p, h) to those bounds, to be taken off.
        """
        sides = np.frombuffer(sides, dtype=np.int8)
        free, held = np.flatnonzero(sides == 0), np.flatnonzero(sides)
        system = self._compliance + self._per_multiplier[:, free] @ self._matrix[:, free].T
        to_wrench = np.linalg.solve(system, self._per_multiplier).T.copy()
        in_limits = held + len(sides) * (sides[held] > 0)
        return in_limits, to_wrench, to_wrench @ self._matrix[:, held]


def sides_of(wanted: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Return for each thruster which limit `wanted` lies beyond: -1, 0 or 1, (p,) int8."""
    lower, upper = limits
    return (wanted > upper).view(np.int8) - (wanted < lower).view(np.int8)


def _first_blocked(thrusts: np.ndarray, step: np.ndarray, lower: np.ndarray,
                   upper: np.ndarray) -> tuple[int, float]:
    """Return which thruster meets a bound first along `step`, and at what share of it."""
    room = np.where(step > 0.0, upper - thrusts, thrusts - lower)
    share = np.divide(room, np.abs(step), out=np.ones_like(step), where=np.abs(step) > room)
    first = int(share.argmin())
    return first, share[first]
