"""Which weights double precision can serve, and the nearest ones where it cannot."""

from collections.abc import Callable
from decimal import Context, ROUND_CEILING, ROUND_FLOOR
import math

import numpy as np

WORST_CONDITION = 1e13  # of the Hessian; beyond it double precision has nothing left to give


class IllConditioned(ValueError):
    """Weights and geometry that leave double precision nothing to give."""


def scaled(thrust_weights: np.ndarray, wrench_weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return Q and R by the factor, which changes no optimum, that makes the smallest Q 1."""
    smallest = thrust_weights.min()
    with np.errstate(over='ignore'):  # refused by require_precision
        return thrust_weights / smallest, wrench_weights / smallest


def root(matrix: np.ndarray, thrust_weights: np.ndarray, wrench_weights: np.ndarray) -> np.ndarray:
    """Return the (p + m, p) matrix whose square is the Hessian: root^T root = Q + B^T R B."""
    return np.vstack([np.diag(np.sqrt(thrust_weights)),
                      np.sqrt(wrench_weights)[:, np.newaxis] * matrix])


def require_precision(matrix: np.ndarray, thrust_weights: np.ndarray,
                      wrench_weights: np.ndarray) -> None:
    """
    Check that double precision can solve the problem whichever thrusters are at a bound.

    :param matrix: B over the controlled DOFs, (m, p).
    :param thrust_weights: diagonal of Q, (p,), > 0.
    :param wrench_weights: diagonal of R, (m,), > 0.
    :raises IllConditioned: if it cannot; with the weights that would do.
    """
    def serves(thrust_weight: float = 0.0, wrench_weight: float = math.inf) -> bool:
        return _condition(matrix, *scaled(
            np.maximum(thrust_weights, thrust_weight),
            np.minimum(wrench_weights, wrench_weight))) <= WORST_CONDITION

    if serves():
        return
    smallest, largest = thrust_weights.min(), wrench_weights.max()
    enough = max(thrust_weights.max(), largest * np.linalg.norm(matrix)**2)  # Q uniform, P near it
    remedies = [f'every thruster must weigh at least '
                f'{_shown(_boundary(serves, enough, smallest), ROUND_CEILING)}']
    little = min(1e-3, largest)  # that far down it is worth while to look
    if serves(wrench_weight=little):
        last = _boundary(lambda weight: serves(wrench_weight=weight), little, largest)
        remedies.insert(0, f'must be at most {_shown(last, ROUND_FLOOR)}')
    raise IllConditioned(
        f'are up to {largest:g} while thrusters weigh down to {smallest:g}; with these positions '
        f'that is beyond double precision, {", or ".join(remedies)}')


def _condition(matrix: np.ndarray, thrust_weights: np.ndarray,
               wrench_weights: np.ndarray) -> float:
    """Return the largest condition number that any set of thrusters at a bound can bring."""
    with np.errstate(over='ignore', invalid='ignore', divide='ignore'):
        rows = root(matrix, thrust_weights, wrench_weights)
        # With most thrusters at a bound, the equations for the rest may be worse than the Hessian
        gain = rows[len(thrust_weights):] / np.sqrt(thrust_weights)
        if not np.isfinite(rows).all():
            return math.inf
        singular = np.linalg.svd(rows, compute_uv=False)
        return float(max(singular[0] / singular[-1], np.linalg.norm(gain, 2))**2)


def _boundary(serves: Callable[[float], bool], good: float, bad: float) -> float:
    """Return the last weight on the way from a good one to a bad one that serves."""
    for _ in range(60):
        middle = math.sqrt(good) * math.sqrt(bad)
        good, bad = (middle, bad) if serves(middle) else (good, middle)
    return good


def _shown(weight: float, rounding: str) -> str:
    """Return two digits of a weight, rounded to the side that serves."""
    return f'{float(Context(prec=2, rounding=rounding).create_decimal(float(weight))):g}'
