"""
The attainable set by linear programmes, and random vehicles to ask about.

A campaign of 3 x 5,000 of them: `PYTHONPATH=.:test python -m support.attainable 5000`.
"""

import sys

import numpy as np
from scipy.optimize import linprog
from thrust_allocator.solve.attainable import AttainableSet

TOLERANCES = {'primal_feasibility_tolerance': 1e-10, 'dual_feasibility_tolerance': 1e-10}
KINDS = ('any', 'degenerate', 'vanishing')


def random_case(rng, kind):
    """
    Return a matrix B, weights R, which thrusters are enabled, limits, and a wrench.

    'degenerate': thrusters along axes, in planes and in pairs, one-sided ones, some disabled;
    'vanishing': some limits are zero or nearly so.
    """
    p = int(rng.integers(1, 10))
    directions, positions = rng.normal(size=(p, 3)), rng.uniform(-2.0, 2.0, (p, 3))
    if kind == 'degenerate':
        axial = rng.random(p) < 0.6
        directions[axial] = np.eye(3)[rng.integers(3, size=axial.sum())]
        positions[:, rng.random(3) < 0.4] = 0.0
        if p > 2:
            directions[1], positions[1] = directions[0], positions[0]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    matrix = np.vstack([directions.T, np.cross(positions, directions).T])
    weights = 10.0**rng.uniform(1.0, 6.0, 6) * (rng.random(6) < 0.7)
    if not weights.any():
        weights[0] = 1.0
    limits = np.array([-rng.uniform(10.0, 150.0, p), rng.uniform(10.0, 150.0, p)])
    enabled = np.ones(p)
    if kind == 'degenerate':
        limits[rng.integers(2), rng.random(p) < 0.4] = 0.0
        enabled = (rng.random(p) < 0.8).astype(float)
        limits *= enabled
    elif kind == 'vanishing':
        limits *= rng.choice([0.0, 1e-3, 1.0], (2, p))
    within = matrix @ rng.uniform(*limits)
    wrench = (within * rng.uniform(0.1, 5.0) if rng.random() < 0.6
              else within + rng.normal(size=6) * 100.0)
    return matrix, weights, enabled, limits, wrench


def largest_along(rows, point, direction, limits, largest=None):
    """Return the largest t, up to `largest`, for which rows tau = point + t direction."""
    unit = np.abs(limits).max() or 1.0  # thrusts near 1, rows of norm 1
    norms = np.linalg.norm(rows, axis=1)
    norms = np.where(norms > 1e-12, norms, 1.0)
    way = direction / norms / unit
    stretch = np.abs(way).max()
    found = linprog(
        np.append(np.zeros(rows.shape[1]), -1.0),
        A_eq=np.hstack([rows / norms[:, np.newaxis], -way[:, np.newaxis] / stretch]),
        b_eq=point / norms / unit,
        bounds=[*(limits.T / unit), (0.0, None if largest is None else largest * stretch)],
        method='highs', options=TOLERANCES)
    return found.x[-1] / stretch if found.status == 0 else np.nan


def in_range(rows, weights, wrench):
    """Return the nearest wrench, in the metric of the weights, that thrusts without limits give."""
    root = np.sqrt(weights)[:, np.newaxis]
    thrusts = np.linalg.lstsq(root * rows, root[:, 0] * wrench, rcond=1e-9)[0]
    return rows @ thrusts


def check(rng, kind):
    """Return the errors of the module against HiGHS of one case: of the scale, and of the room."""
    matrix, weights, enabled, limits, wrench = random_case(rng, kind)
    attainable = AttainableSet(matrix, weights, enabled)
    dofs = np.flatnonzero(weights)
    rows = matrix[dofs] * enabled
    wanted = in_range(rows, weights[dofs], wrench[dofs])
    if np.abs(wanted).max() > 1e-9 * np.abs(wrench[dofs]).max():
        scale = largest_along(rows, np.zeros(len(dofs)), wanted, limits, 1.0)
    else:
        scale = 1.0  # nothing of it can be given by any thrust
    errors = [abs(attainable.scale(wrench, limits) - scale)]

    point = (matrix * enabled) @ rng.uniform(*limits)
    directions = rng.normal(size=(2, 6)) * (weights > 0.0)
    directions[0] = np.eye(6)[rng.choice(dofs)]
    for direction, found in zip(directions, attainable.room(point, directions, limits)):
        along = direction[dofs]
        if np.abs(in_range(rows, weights[dofs], along) - along).max() > 1e-6:
            expected = [0.0, 0.0]
        else:
            expected = [-largest_along(rows, point[dofs], -along, limits),
                        largest_along(rows, point[dofs], along, limits)]
        whole = np.abs(rows) @ np.abs(limits).max(axis=0)
        way = max(np.min(whole[along != 0.0] / np.abs(along[along != 0.0])), 1e-9)
        errors += list(np.abs(found - expected) / way)
    return errors


def campaign(cases):
    """Print the errors of many cases of each kind."""
    for kind in KINDS:
        errors = np.array([check(np.random.default_rng([KINDS.index(kind), seed]), kind)
                           for seed in range(cases)])
        for name, some in (('scale', errors[:, :1]), ('room', errors[:, 1:])):
            print(f'{kind:10} {name}: {cases} cases, p99.9 {np.nanquantile(some, 0.999):.1e}, '
                  f'worst {np.nanmax(some):.1e}, without an answer of HiGHS '
                  f'{np.isnan(some).sum()}')


if __name__ == '__main__':
    campaign(int(sys.argv[1]))
