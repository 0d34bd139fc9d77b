"""Least squares through the package's own model: the fit of a law to measurements."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import least_squares
from thrust_allocator.fit.bollard import BollardCurves
from thrust_allocator.fit.law import Law
from thrust_allocator.fit.measurements import Measurements

_STEP = 1e-5  # of a number, relative, to differentiate by
_ROBUST = 2.5  # standard deviations beyond which a row counts less


@dataclass(frozen=True)
class Problem:
    """Rows, the law to fit to them, and the curves of what a command gives at rest."""

    rows: Measurements
    law: Law
    curves: BollardCurves

    @cached_property
    def target(self) -> np.ndarray:
        """
        Thrust to be met (n,): in a flow between 0 and that at rest, which no law leaves [N].

        But for noise: three sigmas beyond either end stay, or what noise there is would pull the
        coefficients to one side.
        """
        most = self.curves.thrust(self.rows, self.curves.start)
        noise = 3.0 * self.rows.sigma
        return np.where(self.rows.at_rest, self.rows.thrust,
                        np.clip(self.rows.thrust, -noise, most + noise))

    @cached_property
    def _flow(self) -> tuple[list[float], list[float]]:
        """Speed along and across the thrust axis [m/s]."""
        speed, angle = self.rows.speed, self.rows.angle
        return (speed * np.cos(angle)).tolist(), (speed * np.sin(angle)).tolist()

    @cached_property
    def _slopes(self) -> np.ndarray:
        """
        Derivatives of the thrusts at rest by the heights, (n, count), near the measured ones.

        They change by a percent or so over a fit, which costs it nothing but a step.
        """
        return self.curves.slopes(self.rows, self.curves.start)

    @cached_property
    def _sign(self) -> np.ndarray:
        return np.where(self.rows.side == 1, 1.0, -1.0)

    def of(self, rows: Measurements) -> 'Problem':
        """Return the problem of other rows, with the same curves and law."""
        return Problem(rows, self.law, self.curves)

    @property
    def start(self) -> np.ndarray:
        """Where to begin: heights as measured, coefficients as guessed."""
        return np.array([*self.curves.start, *(one.start for one in self.law.coefficients)])

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """The range of each unknown."""
        high = [np.inf] * self.curves.count + [one.high for one in self.law.coefficients]
        return np.zeros(len(high)), np.array(high)

    def delivered(self, x: np.ndarray) -> np.ndarray:
        """Return what the law says of each row, along its sense (n,) [N]."""
        return self._thrusts(self.curves.limits(x), x[self.curves.count:],
                             self.curves.thrust(self.rows, x))

    def _thrusts(self, limits: tuple[float, float], coefficients: np.ndarray,
                 equivalents: np.ndarray) -> np.ndarray:
        thrust = self.law.thruster(limits, coefficients).thrust_in_flow
        return self._sign * [thrust(e, *flow) for e, *flow in
                             zip((self._sign * equivalents).tolist(), *self._flow)]

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """
        Return the derivatives of `delivered`, (n, unknowns).

        Rows know only the coefficients of their own sense: both senses' are moved at once.
        """
        count, curves = self.curves.count, self.curves
        limits, coefficients = np.array(curves.limits(x)), x[count:]
        equivalents = curves.thrust(self.rows, x)
        here = self._thrusts(tuple(limits), coefficients, equivalents)
        scale = float(np.abs(limits).max())
        found = np.zeros((len(self.rows), len(x)))
        step = _STEP * scale
        found[:, :count] = self._slopes * (
            (self._thrusts(tuple(limits), coefficients, equivalents + step) - here)
            / step)[:, None]
        wider = tuple(limits * (1.0 + _STEP))
        by_limit = (self._thrusts(wider, coefficients, equivalents) - here) / _STEP
        for side, place in enumerate(curves.top):
            if place is not None and limits[side]:
                mine = self.rows.side == side
                found[mine, place] += by_limit[mine] / abs(limits[side])
        for name in self.law.names:
            places = [i for i, one in enumerate(self.law.coefficients) if one.name == name]
            moved = coefficients.copy()
            steps = {i: _STEP * max(coefficients[i], 1e-3 * self.law.coefficients[i].start)
                     for i in places}
            for i, step in steps.items():
                moved[i] += step
            change = self._thrusts(tuple(limits), moved, equivalents) - here
            for i, step in steps.items():
                side = self.law.coefficients[i].side
                mine = slice(None) if side is None else self.rows.side == side
                found[mine, count + i] = change[mine] / step
        return found


@dataclass(frozen=True)
class Solution:
    """A fit."""

    problem: Problem
    x: np.ndarray  # heights of the curves [N], then the coefficients
    robust: float  # beyond which a residual counts less, in standard deviations given

    @cached_property
    def error(self) -> np.ndarray:
        """What the law says less what was measured, (n,); positive is optimistic [N]."""
        return self.problem.delivered(self.x) - self.problem.rows.thrust

    @property
    def coefficients(self) -> np.ndarray:
        """The law's unknowns alone."""
        return self.x[self.problem.curves.count:]

    @cached_property
    def covariance(self) -> np.ndarray | None:
        """
        Covariance of x from the Jacobian; None where no row is to spare.

        Of an M-estimator (Huber 1981): sum psi^2 / (n - p) / (mean psi')^2 (J^T J)^-1. Standard
        deviations that were given are believed unless the rows contradict them.
        """
        rows = self.problem.rows
        ratio = 1.0 + (self._residual / self.robust)**2
        j = self.problem.jacobian(self.x) / rows.sigma[:, None]
        if self.spare > 0:
            variance = float((self._residual**2 / ratio).sum() / self.spare
                             / (ratio[~rows.at_rest]**-1.5).mean()**2)
            variance = max(variance, 1.0) if rows.sigma_given else variance
        elif rows.sigma_given:
            variance = 1.0
        else:
            return None
        return variance * np.linalg.pinv(j.T @ j, rcond=1e-14, hermitian=True)

    @cached_property
    def _residual(self) -> np.ndarray:
        """What the law says less the target, in standard deviations given (n,) [-]."""
        return (self.problem.delivered(self.x) - self.problem.target) / self.problem.rows.sigma

    @property
    def drawable(self) -> tuple[np.ndarray, np.ndarray]:
        """Return Jacobian and residuals by sigma, rows that count less in the fit made smaller."""
        root = (1.0 + (self._residual / self.robust)**2)**-0.25
        jacobian = self.problem.jacobian(self.x) / self.problem.rows.sigma[:, None]
        return root[:, None] * jacobian, root * self._residual

    @property
    def spare(self) -> int:
        """How many rows there are more than unknowns."""
        return len(self.problem.rows) - len(self.x)

    @property
    def noise(self) -> float:
        """Standard deviation of a row, as found, in those given [-]."""
        return float(np.sqrt((self._residual**2).sum() / max(self.spare, 1)))

    def again(self, rows: Measurements) -> 'Solution':
        """Return the fit to other rows, found from this one."""
        return replace(self, problem=self.problem.of(rows),
                       x=_least_squares(self.problem.of(rows), self.x, self.robust, 1e-4))


def solve(problem: Problem) -> Solution:
    """Fit the law, twice: the first time to see the noise, then with outliers counting less."""
    x = _least_squares(problem, problem.start, np.inf)
    residual = (problem.delivered(x) - problem.target) / problem.rows.sigma
    flow = np.abs(residual[~problem.rows.at_rest])
    robust = _ROBUST * max(1.4826 * float(np.median(flow)), 0.01)
    if problem.rows.sigma_given:
        robust = max(robust, _ROBUST)
    return Solution(problem, _least_squares(problem, x, robust), robust)


def _least_squares(problem: Problem, start: np.ndarray, robust: float,
                   tolerance: float = 1e-7) -> np.ndarray:
    sigma = problem.rows.sigma
    low, high = problem.bounds
    loss = {} if robust == np.inf else {'loss': 'soft_l1', 'f_scale': robust}
    inside = np.clip(start, low + 1e-9 * (1.0 + low), np.where(
        np.isfinite(high), high * (1.0 - 1e-9), np.inf))
    return least_squares(
        lambda x: (problem.delivered(x) - problem.target) / sigma, inside,
        lambda x: problem.jacobian(x) / sigma[:, None], bounds=(low, high), x_scale='jac',
        xtol=tolerance, ftol=1e-2 * tolerance, gtol=1e-9, **loss).x
