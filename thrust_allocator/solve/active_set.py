"""A parametric active-set method that hands OSQP the optimum to start from."""

from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

CACHED_SETS = 256  # a vehicle meets a few dozen; bounded, because p thrusters have 3^p


class Response(NamedTuple):
    """What follows from which thrusters are held at which bound."""

    matrix: np.ndarray  # (p, m): what each thruster gives per unit of the wrench that is left
    columns: np.ndarray  # (m, h): B of those held
    held: np.ndarray  # (h,) thrusters that are held
    bounds: np.ndarray  # (h,) places of their bounds in the flat limits
    at_bound: np.ndarray  # (p,) int8: -1 at the lower, 1 at the upper bound, 0 free


class ActiveSet:
    """
    The box-constrained problem of eq. 2.6 with the slack eliminated, solved from the last optimum.

    minimise 1/2 (x^T Q x + (B x - f)^T R (B x - f))  subject to  lower <= x <= upper

    Hold some thrusters at a bound. What each thruster would give if its own bound did not count is
    then linear in f and in the bounds of those held, by matrices that are computed once per set.
    If exactly those held would go beyond their bound, the set is the optimum's. From one tick to
    the next it rarely changes, and then confirming it is all.

    Where it changes, f and the limits are moved in a straight line from those of the last tick to
    the new ones, and the optimum is followed: along the line the thrusts that would be given are
    linear, until one meets a bound, where it is held, or comes back from one, where it is let go
    (Best, 1996; Ferreau, Bock and Diehl, 2008). Each step is one such change, mostly the only one.

    A set is written as 2 p bytes, 0 or 1: whether each thruster would give more than its lower
    limit, then whether more than its upper one. Held at the lower bound is 0, 0, at the upper 1, 1.
    """

    def __init__(self, matrix: np.ndarray, thrust_weights: np.ndarray,
                 wrench_weights: np.ndarray) -> None:
        """
        Remember the problem.

        :param matrix: B over the controlled DOFs, (m, p).
        :param thrust_weights: diagonal of Q, (p,), > 0.
        :param wrench_weights: diagonal of R, (m,), > 0.
        """
        self._matrix = np.ascontiguousarray(matrix)
        self._thrust_weights, self._wrench_weights = thrust_weights, wrench_weights
        # Of a function that knows nothing of self: a cycle would keep a replaced problem alive
        self._response = lru_cache(maxsize=CACHED_SETS)(partial(
            _response, self._matrix, matrix / thrust_weights, np.diag(1.0 / wrench_weights)))
        self._start(matrix.shape[1])

    def _start(self, p: int) -> None:
        """Take the optimum of p thrusters for f = 0 and limits around 0 for that of last tick."""
        self._beyond = bytes(p * [1] + p * [0])
        self._wanted, self._limits = np.zeros(p), np.repeat([[-1.0], [1.0]], p, axis=1)

    def solve(self, wrench: np.ndarray,
              limits: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """
        Return the optimum.

        :param wrench: f over the controlled DOFs, (m,).
        :param limits: (2, p), row 0 lower, row 1 upper, not below it.
        :return: what each thruster would give if its own bound did not count, (p,); the optimum,
            which is that cut to the limits, (p,); and which bound holds each thruster: -1 lower,
            0 none, 1 upper, (p,) int8. In the rare case that rounding keeps the method from ending
            in 20 + 10 p steps, it is only near the optimum, and the next tick starts from f = 0.
        """
        beyond = self._beyond
        response = self._response(beyond)
        bounds = limits.take(response.bounds)
        wanted = response.matrix.dot(wrench - response.columns.dot(bounds))
        now = (wanted > limits).tobytes()
        if now == beyond:
            thrusts = wanted.copy()
            thrusts[response.held] = bounds
        else:
            wanted, beyond = self._follow(wrench, limits, wanted, now)
            thrusts = np.minimum(np.maximum(wanted, limits[0]), limits[1])
            response = self._response(beyond)
        self._beyond, self._wanted, self._limits = beyond, wanted, limits
        if now != beyond and (wanted > limits).tobytes() != beyond:
            self._start(len(wanted))
        return wanted, thrusts, response.at_bound

    def refine(self, wrench: np.ndarray, limits: np.ndarray, thrusts: np.ndarray,
               at_bound: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray, bool]:
        """
        Return the optimum to the last digits that rounding leaves, and whether it is certain.

        Where R / Q is large and the wrench far out of reach, the rounding of the responses shows in
        the thrusts, and where thrusters are alike, in which of them are held. Here the gradient of
        the cost, g = Q x - B^T R (f - B x), is computed from its definition at each step: Newton
        steps of the free thrusters, cut at the first bound that is met; then, of the held ones that
        would leave their bound, the first is let go (Nocedal and Wright, 2006, section 16.5).

        The optimum is certain if the thrusts meet its conditions (g zero for a free thruster and
        pressing a held one against its bound: Karush, 1939; Kuhn and Tucker, 1951) to within what
        rounding can make of g. They are then the exact optimum for Q, R, B and f that differ by
        no more than rounding from those given (after Oettli and Prager, 1964).

        :param wrench: f over the controlled DOFs, (m,).
        :param limits: (2, p), row 0 lower, row 1 upper.
        :param thrusts: where to start, (p,), inside the limits.
        :param at_bound: which bound holds each thruster there, (p,) int8, as `solve` returns it.
        :param tolerance: what rounding can make of g, relative to the sum of its terms' sizes.
        :return: thrusts and bounds as `solve` returns them, and whether they are certain.
        """
        lower, upper = limits
        thrusts, at_bound, size = thrusts.copy(), at_bound.copy(), np.abs(self._matrix)
        for _ in range(20 + 10 * len(thrusts)):
            gradient = self._thrust_weights * thrusts - self._matrix.T @ (
                self._wrench_weights * (wrench - self._matrix @ thrusts))
            rounding = tolerance * (self._thrust_weights * np.abs(thrusts) + size.T @ (
                self._wrench_weights * (np.abs(wrench) + size @ np.abs(thrusts))))
            free = at_bound == 0
            wrong = np.where(free, np.abs(gradient), at_bound * gradient) - rounding
            wrong[lower == upper] = 0.0
            if (wrong <= 0.0).all():
                return thrusts, at_bound, True
            if (wrong[free] <= 0.0).all():
                at_bound[wrong.argmax()] = 0
                continue
            response = self._response(np.concatenate((at_bound >= 0, at_bound > 0)).tobytes())
            step = -gradient * free / self._thrust_weights
            step -= free * (response.matrix @ (self._matrix @ step))
            bound = np.where(step < 0.0, lower, upper)
            room = bound - thrusts
            share = np.divide(
                room, step, out=np.ones_like(step), where=np.abs(step) > np.abs(room))
            first = share.argmin()
            thrusts += share[first] * step
            if share[first] < 1.0:
                thrusts[first], at_bound[first] = bound[first], np.sign(step[first])
        return thrusts, at_bound, False

    def _follow(self, wrench: np.ndarray, limits: np.ndarray, wanted: np.ndarray,
                goal: bytes) -> tuple[np.ndarray, bytes]:
        """Return the thrusts wanted at the optimum, and its set; `wanted` is of the last set."""
        changes = _differences(self._beyond, goal)
        if len(changes) > 1:  # all at once is it more often than not, if there are many thrusters
            gap = self._gap(wrench, limits, goal)
            if (gap > 0.0).tobytes() == goal:
                return gap[0] + limits[0], goal
        here, end = self._wanted - self._limits, wanted - limits
        present = bytearray(self._beyond)
        for _ in range(20 + 10 * len(wanted)):
            first = changes[0] if len(changes) == 1 else min(
                changes, key=lambda place: _share(here, end, place))
            present[first] ^= 1
            gap = self._gap(wrench, limits, bytes(present))
            goal = (gap > 0.0).tobytes()
            if goal == present:
                break
            here, end = here + _share(here, end, first) * (end - here), gap
            changes = _differences(present, goal)
        return gap[0] + limits[0], bytes(present)

    def _gap(self, wrench: np.ndarray, limits: np.ndarray, beyond: bytes) -> np.ndarray:
        """Return how far each thruster would go beyond its lower and upper limit, (2, p) [N]."""
        response = self._response(beyond)
        return response.matrix.dot(
            wrench - response.columns.dot(limits.take(response.bounds))) - limits


def _response(matrix: np.ndarray, per_multiplier: np.ndarray, compliance: np.ndarray,
              beyond: bytes) -> Response:
    """
    Return how the unbounded thrusts respond while some thrusters are held at a bound.

    Each free thruster gives b_i^T lambda / q_i, where the multiplier lambda = R (f - B x) of the
    wrench solves (R^-1 + B_F Q_F^-1 B_F^T) lambda = f - B_H x_H over the free thrusters F and those
    held H: six equations at most, however many thrusters there are.
    """
    above_lower, above_upper = np.frombuffer(beyond, dtype=np.bool_).reshape(2, -1)
    free = above_lower > above_upper
    held = np.flatnonzero(~free)
    system = compliance + (per_multiplier * free) @ matrix.T
    at_bound = above_lower.view(np.int8) + above_upper.view(np.int8) - np.int8(1)
    at_bound.flags.writeable = False  # shared by all ticks that end in this set
    return Response(
        np.linalg.solve(system, per_multiplier).T.copy(), matrix.take(held, axis=1),
        held, held + len(free) * above_upper.take(held), at_bound)


def _differences(one: bytes, other: bytes) -> list[int]:
    return [place for place, (a, b) in enumerate(zip(one, other)) if a != b]


def _share(here: np.ndarray, end: np.ndarray, place: int) -> float:
    """Return at what share of the way from `here` to `end` the gap at `place` changes its sign."""
    start = here.item(place)
    way = start - end.item(place)
    return max(start / way, 0.0) if way else 0.0
