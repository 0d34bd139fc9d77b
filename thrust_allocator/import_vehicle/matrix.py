"""Allocation matrices in YAML: nested, flat, or in named rows."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from thrust_allocator.import_vehicle.configuration import Mount, mount_of_column, SourceError
from thrust_allocator.import_vehicle.document import (
    are_numbers, Group, groups, limits_by_name, limits_in, MATRIX_NAME, names_in, OF_THRUSTERS)

ROWS = ('x', 'y', 'z', 'rx', 'ry', 'rz')


class Matrix(NamedTuple):
    """An allocation matrix, where it stands, and what stands beside it."""

    group: Group
    key: str
    values: np.ndarray  # (6, n)


def matrices(document: Any) -> list[Matrix]:
    """Return the allocation matrices of a document: named ones, or else any of six rows."""
    found = list(_candidates(document))
    return [one for one in found if MATRIX_NAME.fullmatch(one.key)] or found


def _candidates(document: Any) -> Iterator[Matrix]:
    for group in groups(document):
        for key, value in group.items.items():
            path, named = group.at(key), MATRIX_NAME.fullmatch(key)
            if isinstance(value, dict) and set(ROWS) <= {str(row) for row in value}:
                rows = [value[row] for row in ROWS]
                if named or all(map(are_numbers, rows)):
                    yield Matrix(group, key, _array(rows, path))
            elif isinstance(value, list) and any(isinstance(row, list) for row in value):
                if named and all(isinstance(row, list) for row in value) \
                        or len(value) == 6 and all(map(are_numbers, value)) \
                        and not OF_THRUSTERS.search(key):
                    yield Matrix(group, key, _array(value, path))
            elif named and isinstance(value, list) and len(value) >= 6:
                if not are_numbers(value) or len(value) % 6:
                    raise SourceError(f'{path}: has {len(value)} entries, must be 6 x n numbers, '
                                      'row by row')
                yield Matrix(group, key, np.array(value, dtype=float).reshape(6, -1))


def _array(rows: list[Any], path: str) -> np.ndarray:
    if len(rows) != 6:
        turned = ' (a row for each thruster? transpose it)' * all(
            are_numbers(row, 6) for row in rows)
        raise SourceError(f'{path}: has {len(rows)} rows{turned}, must be 6 x n: surge, sway, '
                          'heave, roll, pitch, yaw')
    lengths = {len(row) if are_numbers(row) else 0 for row in rows}
    if len(lengths) > 1 or 0 in lengths:
        raise SourceError(f'{path}: its rows are not of the same length, or hold what is no '
                          'number')
    return np.array(rows, dtype=float)


def mounts_of_matrix(matrix: Matrix, document: Any) -> tuple[Mount, ...]:
    """
    Return the thrusters that the columns of a matrix stand for.

    :raises SourceError: for a column that is not of newtons, or of no thruster.
    """
    count = matrix.values.shape[1]
    by_name = limits_by_name(document)
    return tuple(
        mount_of_column(name, matrix.values[:, i],
                        limits=by_name.get(name) or limits_in(matrix.group, i),
                        notes=(f'column {i} of {matrix.group.at(matrix.key)}',))
        for i, name in enumerate(names_in(matrix.group, count)))
