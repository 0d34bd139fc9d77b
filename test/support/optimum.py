"""What an independent solver, and exact arithmetic, make of the allocation problem."""

from fractions import Fraction

import daqp
import numpy as np
from thrust_allocator.physics.vehicle import Vehicle


def daqp_optimum(vehicle: Vehicle, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Return the optimum that daqp finds for the problem with the slack eliminated."""
    matrix, weights = vehicle.configuration_matrix, np.array(vehicle.wrench_weights)
    hessian = np.diag([t.weight for t in vehicle.thrusters]) + (matrix.T * weights) @ matrix
    optimum, _, flag, _ = daqp.solve(
        hessian, -(matrix.T * weights) @ wrench, np.zeros((0, matrix.shape[1])),
        limits[1].copy(), limits[0].copy(), np.zeros(matrix.shape[1], dtype=np.int32))
    assert flag == 1
    return optimum


def exact_optimum(vehicle: Vehicle, wrench: np.ndarray, limits: np.ndarray,
                  at_bound: np.ndarray) -> np.ndarray:
    """
    Return the optimum, found in fractions, without any rounding, to the nearest doubles.

    The thrusters that are held are guessed: those who are wrong change sides, all at once, until
    none is. The guess has to be near; without end it would go on only if it is far off.
    """
    weights = np.array(vehicle.wrench_weights)
    used = np.flatnonzero(weights)
    columns = _fractions(vehicle.configuration_matrix[used].T)  # one per thruster
    wrench_weights, command = _fractions(weights[used]), _fractions(wrench[used])
    thrust_weights = _fractions([one.weight for one in vehicle.thrusters])
    lower, upper = _fractions(limits)
    sides = at_bound.tolist()
    for _ in range(20):
        held = [(low, None, high)[side + 1] for low, side, high in zip(lower, sides, upper)]
        left = [f - sum(x * b[k] for x, b in zip(held, columns) if x is not None)
                for k, f in enumerate(command)]
        system = [[sum(b[k] * b[j] / q for x, b, q in zip(held, columns, thrust_weights)
                       if x is None) + (1 / r if j == k else 0) for j in range(len(left))]
                  for k, r in enumerate(wrench_weights)]
        multiplier = _solution(system, left)
        wanted = [sum(map(Fraction.__mul__, b, multiplier)) / q
                  for b, q in zip(columns, thrust_weights)]
        before, sides = sides, [
            side if low == high else (x > high) - (x < low)
            for side, x, low, high in zip(sides, wanted, lower, upper)]
        if sides == before:
            return np.array([float(w if x is None else x) for w, x in zip(wanted, held)])
    raise AssertionError('the guess is far off')


def _fractions(numbers) -> list:
    return np.vectorize(Fraction, otypes=[object])(np.asarray(numbers, dtype=float)).tolist()


def _solution(system: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """Return the solution of a positive definite system, by elimination."""
    rows = [[*row, one] for row, one in zip(system, right)]
    for k, pivot in enumerate(rows):
        pivot[:] = [one / pivot[k] for one in pivot]
        for i, row in enumerate(rows):
            if i != k:
                row[:] = [a - row[k] * b for a, b in zip(row, pivot)]
    return [row[-1] for row in rows]
