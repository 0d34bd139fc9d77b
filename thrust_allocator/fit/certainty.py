"""How far a fit can be trusted: intervals, correlations, and runs that it has not seen."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student
from thrust_allocator.fit.solution import Solution

CORRELATED = 0.9
_REPLICATES = 200
_FEWEST_RUNS = 4  # for a bootstrap over them
_MOST_GROUPS = 40  # in which runs are left out


@dataclass(frozen=True)
class LeftOut:
    """What a run, or a group of them, comes out as that the fit has not seen."""

    lines: np.ndarray  # of the table
    error: np.ndarray  # law less measured of each; positive is optimistic [N]


@dataclass(frozen=True)
class Certainty:
    """Of the law's coefficients, in their order, and then of the Bollard limits."""

    interval: np.ndarray | None  # (k + 2, 2), 95 %; None: no row to spare
    bootstrap: bool  # whether runs were drawn
    correlated: tuple[tuple[int, int, float], ...]  # pairs above CORRELATED
    at_limit: tuple[int, ...]  # coefficients at an end of their range
    left_out: tuple[LeftOut, ...]
    only: tuple[int, ...]  # runs that cannot be left out: nothing else tells a coefficient


def certainty(solution: Solution, progress: Callable[[int, int], None]) -> Certainty:
    """
    Judge a fit.

    :param progress: told how many of how many fits without some of the runs are done.
    """
    interval, bootstrap = intervals(solution)
    names = solution.problem.law.coefficients
    at_limit = tuple(i for i, (one, value) in enumerate(zip(names, solution.coefficients))
                     if value < 1e-3 * one.start or value > 0.999 * one.high)
    left_out, only = _leave_out(solution, progress)
    return Certainty(interval, bootstrap, _correlated(solution), at_limit, left_out, only)


def intervals(solution: Solution) -> tuple[np.ndarray | None, bool]:
    """
    Return the 95 % intervals of the coefficients and Bollard limits, and whether runs were drawn.

    An interval is the wider one of two: from the Jacobian, which takes rows for independent, and
    from a bootstrap over runs, where there are four, which does not.
    """
    covariance = solution.covariance
    if covariance is None:
        return None, False
    places, rows = _places(solution), solution.problem.rows
    free = solution.spare if solution.spare > 0 else np.inf
    half = student.ppf(0.975, free) * np.sqrt(np.maximum(np.diag(covariance)[places], 0.0))
    runs = len(np.unique(rows.run[~rows.at_rest]))
    drawn = _bootstrap(solution, places) if runs >= _FEWEST_RUNS else None
    if drawn is not None:
        half = np.maximum(half, student.ppf(0.975, runs - 1) * drawn)
    value = solution.x[places]
    low, high = (bound[places, None] for bound in solution.problem.bounds)
    return np.clip(np.stack([value - half, value + half], axis=1), low, high), drawn is not None


def _places(solution: Solution) -> list[int]:
    """Return where in x the coefficients are, and the Bollard limits that there are."""
    curves = solution.problem.curves
    return [*range(curves.count, len(solution.x)), *(i for i in curves.top if i is not None)]


def _bootstrap(solution: Solution, places: list[int]) -> np.ndarray | None:
    """
    Return the spread over tables of runs drawn with replacement, each fitted by one Newton step.

    The rows at rest stay, because the curves need each of them, and get noise of the size found.
    None where most of such tables cannot tell all coefficients.
    """
    rows, count = solution.problem.rows, solution.problem.curves.count
    jacobian, residual = solution.drawable
    labels, run = np.unique(rows.run[~rows.at_rest], return_inverse=True)
    rng = np.random.default_rng(1)
    low, high = solution.problem.bounds
    found = []
    for _ in range(_REPLICATES):
        weight = np.ones(len(rows))
        weight[~rows.at_rest] = np.bincount(rng.integers(len(labels), size=len(labels)),
                                            minlength=len(labels))[run]
        if (np.abs(jacobian[weight > 0.0, count:]).max(axis=0) < 1e-9).any():
            continue
        drawn = residual + rows.at_rest * rng.normal(0.0, solution.noise, len(rows))
        weighted = weight[:, None] * jacobian
        step = np.linalg.pinv(jacobian.T @ weighted, rcond=1e-12, hermitian=True) @ (
            weighted.T @ drawn)
        found.append(np.clip(solution.x - step, low, high)[places])
    return np.std(found, axis=0, ddof=1) if len(found) > _REPLICATES / 2 else None


def _correlated(solution: Solution) -> tuple[tuple[int, int, float], ...]:
    if solution.covariance is None:
        return ()
    places = _places(solution)
    part = solution.covariance[np.ix_(places, places)]
    deviation = np.sqrt(np.maximum(np.diag(part), 1e-300))
    matrix = part / np.outer(deviation, deviation)
    return tuple((i, j, float(matrix[i, j])) for i in range(len(places)) for j in range(i)
                 if abs(matrix[i, j]) > CORRELATED)


def _leave_out(solution: Solution, progress: Callable[[int, int], None]) -> tuple[
        tuple[LeftOut, ...], tuple[int, ...]]:
    """Predict each run, in groups where there are many, from a fit to the others."""
    rows, count = solution.problem.rows, solution.problem.curves.count
    labels = np.unique(rows.run[~rows.at_rest])
    groups = np.array_split(np.random.default_rng(2).permutation(labels),
                            min(len(labels), _MOST_GROUPS))
    tells = np.abs(solution.problem.jacobian(solution.x)[:, count:])
    found, only = [], []
    for done, group in enumerate(groups):
        out = np.isin(rows.run, group)
        if (tells[~out].max(axis=0) < 1e-3 * tells.max(axis=0)).any():
            only += group.tolist()
        else:
            other = solution.again(rows.rows(~out))
            unseen = solution.problem.of(rows.rows(out))
            found.append(LeftOut(rows.line[out],
                                 unseen.delivered(other.x) - unseen.rows.thrust))
        progress(done + 1, len(groups))
    return tuple(found), tuple(only)
