"""Coefficients that promise too little rather than too much: through the worst point."""

from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares
from thrust_allocator.fit.solution import Solution

_WALLS = (10.0, 300.0, 10000.0)  # how steep it is beyond sigma, one after the other
_MARGIN = 1e-3  # of sigma, so that a wall which gives way a little is still within


def safe(solution: Solution) -> tuple[Solution, np.ndarray]:
    """
    Return the nearest fit that is optimistic by more than its sigma at no row.

    Sigma is that of the table, or else the noise that the fit has found. The Bollard limits may
    fall too: no loss in a flow makes good for a limit that is too large at rest. Below the limits
    a command gives at rest what was measured, as it will to whoever uses the coefficients.

    :return: the fit, and the lines of the rows that no coefficients bring within their sigma.
    """
    problem, rows, curves = solution.problem, solution.problem.rows, solution.problem.curves
    sigma = rows.sigma * (1.0 if rows.sigma_given else max(solution.noise, 1e-3))
    tops = [place for place in curves.top if place is not None]
    free = [*tops, *range(curves.count, len(solution.x))]
    held = np.setdiff1d(np.arange(len(solution.x)), free)
    low, high = (bound[free] for bound in problem.bounds)
    # Rows at rest below the limits make the curve, and no coefficient changes them
    largest = np.array([knots[-1] if len(knots) else 0.0 for knots in curves.knots])[rows.side]
    counted = ~rows.at_rest | (rows.drive > 0.98 * largest)

    def whole(y: np.ndarray) -> np.ndarray:
        x = solution.x.copy()
        x[held], x[free] = curves.start[held], y
        return x

    y = solution.x[free]
    for wall in _WALLS:
        def residual(y: np.ndarray, wall: float = wall) -> np.ndarray:
            delivered = problem.delivered(whole(y))
            above = (delivered - rows.thrust) / sigma - 1.0 + _MARGIN
            return np.concatenate([(delivered - problem.target) / sigma,
                                   wall * counted * np.maximum(above, 0.0)])

        def jacobian(y: np.ndarray, wall: float = wall) -> np.ndarray:
            x = whole(y)
            above = (problem.delivered(x) - rows.thrust) / sigma > 1.0 - _MARGIN
            plain = problem.jacobian(x)[:, free] / sigma[:, None]
            return np.concatenate([plain, wall * (counted & above)[:, None] * plain])

        y = least_squares(residual, np.clip(y, low + 1e-9, high * (1.0 - 1e-9)), jacobian,
                          bounds=(low, high), x_scale='jac', xtol=1e-8, ftol=1e-10).x
    found = replace(solution, x=whole(y))
    return found, rows.line[counted & (found.error > sigma * (1.0 + 1e-6))]
