"""What a vehicle can give in each DOF, and the weights of the allocation that follow from it."""

import numpy as np
from thrust_allocator.solve.attainable import AttainableSet, TooManyFaces

TOGETHER = 0.2  # share of what a DOF has while the others are free that it counts for at least
LARGEST = 1e7  # of a weight; the parameters allow no larger one
STRONGEST = (1e3, 1e5)  # of the weight of the DOF with the largest authority
NO_EFFECT = 1e-9  # of a thruster on a DOF, relative to the largest of any on any


def authority(matrix: np.ndarray, limits: np.ndarray, controlled: np.ndarray) -> np.ndarray:
    """
    Return what the vehicle can give in each DOF, in the sense in which it can give less.

    That is the largest value of the component while the other controlled ones are 0, but at least
    a fifth of the largest while they are free. A sense that is not served at all does not count.

    :param matrix: B, (6, p).
    :param limits: (2, p) at rest, all thrusters enabled, row 0 lower, row 1 upper [N].
    :param controlled: (6,) bool.
    :return: (6,), 0 where no thruster acts on a DOF, and where it is not controlled [N, N*m].
    """
    served = controlled & (np.abs(matrix).max(axis=1) > NO_EFFECT * np.abs(matrix).max())
    free = np.stack([np.maximum(side * matrix * limits[0], side * matrix * limits[1]).sum(axis=1)
                     for side in (-1.0, 1.0)], axis=1)
    largest = free.max(axis=1)
    served &= largest > 0.0
    scale = np.divide(1.0, largest, out=np.zeros(6), where=served)
    try:
        alone = np.abs(AttainableSet(matrix, scale**2).room(np.zeros(6), np.eye(6), limits))
    except TooManyFaces:
        alone = np.array([_alone(matrix * scale[:, np.newaxis], limits, served, dof) * largest[dof]
                          if served[dof] else np.zeros(2) for dof in range(6)])
    # Rounding leaves a little of a sense, or of a DOF that has nothing alone
    alone, free = (np.where(both > NO_EFFECT * largest[:, np.newaxis], both, 0.0)
                   for both in (alone, free))
    return np.where(served, np.maximum(_lesser(alone), TOGETHER * _lesser(free)), 0.0)


def authority_weights(reach: np.ndarray) -> np.ndarray:
    """
    Return the weights R that make equal shares of the authority in each DOF equally dear.

    :param reach: the authority in each DOF, (6,) [N, N*m].
    :return: (6,), r (largest / reach)^2, 1e7 at most, where r is 1e5 or less, down to 1e3, to keep
        the smallest reach below that; 0 where there is no authority.
    """
    some = reach[reach > 0.0]
    if not some.size:
        return np.zeros(6)
    strongest = np.clip(LARGEST * (some.min() / some.max())**2, *STRONGEST)
    weights = np.zeros(6)
    weights[reach > 0.0] = np.minimum(strongest * (some.max() / some)**2, LARGEST)
    return weights


def _lesser(both: np.ndarray) -> np.ndarray:
    """Return the smaller of two senses, (n, 2), or the other one where it is 0."""
    return np.where(both.min(axis=1) > 0.0, both.min(axis=1), both.max(axis=1))


def _alone(matrix: np.ndarray, limits: np.ndarray, held: np.ndarray,
           dof: int) -> np.ndarray:
    """Return the largest of a DOF in both senses while those held are 0, by linear programmes."""
    from scipy.optimize import linprog  # takes longer to import than to solve

    rows = matrix[[i for i in np.flatnonzero(held) if i != dof]]
    found = []
    for side in (1.0, -1.0):
        result = linprog(
            side * matrix[dof], bounds=limits.T, method='highs',
            **({'A_eq': rows, 'b_eq': np.zeros(len(rows))} if len(rows) else {}))
        found.append(max(-result.fun, 0.0) if result.status == 0 else 0.0)
    return np.array(found)
