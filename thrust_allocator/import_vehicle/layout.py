"""Thruster layouts in YAML: rows of positions and directions, or one entry for each thruster."""

from collections.abc import Iterator, Mapping
import math
import re
from typing import Any, NamedTuple

import numpy as np
from thrust_allocator.import_vehicle.configuration import Mount, SourceError, unit
from thrust_allocator.import_vehicle.document import (
    are_numbers, Group, groups, is_number, limits_in, MATRIX_NAME, names_in, OF_THRUSTERS)
from thrust_allocator.import_vehicle.pose import pose

_POSITION = re.compile(r'pos|position|xyz|translation|location|origin', re.I)
_DIRECTION = re.compile(r'dir|direction|axis|(thrust|force)_direction', re.I)
_TURN = re.compile(r'rpy|rotation|orientation|quaternion|quat', re.I)
_ROWS_OF_POSITIONS = re.compile(r'.*position\w*', re.I)
_ROWS_OF_DIRECTIONS = re.compile(r'.*direction\w*', re.I)
_CENTRE = re.compile(r'cent(er|re)_of_(mass|gravity)|com|cog', re.I)
_SENSE = re.compile(r'flipped|inverted|invert|reversed|reverse|sign', re.I)


class Layout(NamedTuple):
    """A layout, where it stands, and the point that its moments are counted about."""

    path: str
    mounts: tuple[Mount, ...]


def layouts(document: Any) -> list[Layout]:
    """
    Return the thruster layouts of a document.

    :raises SourceError: for directions that are no unit vectors.
    """
    found = []
    degrees = _in_degrees(document)
    for group in groups(document):
        found += _of_rows(group)
        for key, value in group.items.items():
            entries = _entries(group, key, value) if not MATRIX_NAME.fullmatch(key) else []
            if entries:
                found.append(Layout(group.at(key), tuple(
                    _mount(name, Group(group.at(key), entry), degrees)
                    for name, entry in entries)))
    return found


def centre_of_mass(document: Any) -> list[float] | None:
    """Return the centre of mass that a document gives, in its own axes [m], or None."""
    found = [value for group in groups(document) for key, value in group.items.items()
             if _CENTRE.fullmatch(key) and are_numbers(value, 3)]
    return found[0] if found and all(one == found[0] for one in found) else None


def _of_rows(group: Group) -> Iterator[Layout]:
    """Yield the layout of two lists of 3 x n numbers, flat or nested."""
    rows = {pattern: [(key, array) for key, value in group.items.items()
                      if pattern.fullmatch(key) and (array := _three_rows(value)) is not None]
            for pattern in (_ROWS_OF_POSITIONS, _ROWS_OF_DIRECTIONS)}
    for key, positions in rows[_ROWS_OF_POSITIONS]:
        for other, directions in rows[_ROWS_OF_DIRECTIONS]:
            count = positions.shape[1]
            if directions.shape[1] != count:
                raise SourceError(f'{group.at(other)}: is of {directions.shape[1]} thrusters, '
                                  f'but {group.at(key)} of {count}')
            yield Layout(group.at(key), tuple(
                Mount(name, tuple(positions[:, i].tolist()),
                      tuple(unit(directions[:, i], name).tolist()), limits=limits_in(group, i),
                      notes=(f'column {i} of {group.at(key)}',))
                for i, name in enumerate(names_in(group, count))))


def _three_rows(value: Any) -> np.ndarray | None:
    if isinstance(value, list) and len(value) == 3 and all(map(are_numbers, value)) \
            and len({len(row) for row in value}) == 1:
        return np.array(value, dtype=float)
    # A single thruster's position has three numbers, too: that is an entry, no rows
    if are_numbers(value) and len(value) > 3 and len(value) % 3 == 0:
        return np.array(value, dtype=float).reshape(3, -1)
    return None


def _entries(group: Group, key: str, value: Any) -> list[tuple[str, dict[str, Any]]]:
    """Return the thrusters of a mapping by name, or of a list, as groups; [] if it is none."""
    if isinstance(value, dict):
        named = [(str(name), one) for name, one in value.items()]
    elif isinstance(value, list):
        names = names_in(Group('', {k: v for k, v in group.items.items() if k != key}), len(value))
        named = [(str(one.get('name', one.get('id', name))) if isinstance(one, dict) else name,
                  one) for name, one in zip(names, value)]
    else:
        return []
    entries = [(name, _entry(key, one)) for name, one in named]
    return entries if entries and all(one is not None for _, one in entries) else []


def _entry(key: str, value: Any) -> dict[str, Any] | None:
    """Return one thruster as a group with a pose, or a position and a direction or turn."""
    if are_numbers(value):
        if not OF_THRUSTERS.search(key) or len(value) not in (6, 7):
            return None
        if len(value) == 7 or 'pose' in key.lower():
            return {'pose': value}
        return {'position': value[:3], 'direction': value[3:]}
    if not isinstance(value, dict):
        return None
    entry = {str(k): _vector(v) for k, v in value.items()}
    for name, letters in (('position', ('x', 'y', 'z')), ('direction', ('dx', 'dy', 'dz')),
                          ('rpy', ('roll', 'pitch', 'yaw'))):
        if all(is_number(entry.get(letter)) for letter in letters):
            entry[name] = [entry[letter] for letter in letters]
    if are_numbers(entry.get('pose')) and len(entry['pose']) in (6, 7):
        return entry
    has_turn = _find(entry, _DIRECTION, 3) or _find(entry, _TURN, 3) or _find(entry, _TURN, 4)
    return entry if _find(entry, _POSITION, 3) and has_turn else None


def _vector(value: Any) -> Any:
    """Return x, y, z or roll, pitch, yaw of a mapping as a list."""
    if isinstance(value, dict):
        for letters in (('x', 'y', 'z', 'w'), ('x', 'y', 'z'), ('roll', 'pitch', 'yaw')):
            if set(letters) == set(map(str, value)):
                return [value[letter] for letter in letters]
    return value


def _find(entry: Mapping[str, Any], pattern: re.Pattern, count: int) -> list[float] | None:
    return next((value for key, value in entry.items()
                 if pattern.fullmatch(key) and are_numbers(value, count)), None)


def _mount(name: str, group: Group, degrees: bool) -> Mount:
    entry, notes = group.items, []
    direction = _find(entry, _DIRECTION, 3)
    if 'pose' in entry:
        values = entry['pose']
    else:
        values = _find(entry, _POSITION, 3)
        if not direction:
            values = values + (_find(entry, _TURN, 3) or _find(entry, _TURN, 4))
    if direction:
        direction = unit(direction, name)
    else:
        direction = pose(values, name, degrees and len(values) == 6).rotation.apply([1.0, 0.0, 0.0])
        notes.append('thrust along +x of its pose' + (', angles in degrees' if degrees else ''))
    notes += [f'the source says {key}: {value}, which is not used: a sense of rotation is the '
              "driver's" for key, value in entry.items() if _SENSE.fullmatch(key) and value]
    return Mount(name, tuple(map(float, values[:3])), tuple(np.asarray(direction).tolist()),
                 limits=limits_in(group), notes=tuple(notes))


def _in_degrees(document: Any) -> bool:
    """Tell whether the angles of a document are degrees: it says so, or they exceed a turn."""
    for group in groups(document):
        for key, value in group.items.items():
            if key == 'degrees' and value is True:
                return True
    return any(abs(angle) > 2.0 * math.pi for angle in _angles(document))


def _angles(node: Any, key: str = '') -> Iterator[float]:
    if isinstance(node, dict):
        for name, value in node.items():
            yield from _angles(_vector(value), str(name))
    elif are_numbers(node):
        if len(node) == 3 and _TURN.fullmatch(key):
            yield from node
        elif len(node) == 6 and 'pose' in key.lower():
            yield from node[3:]
    elif isinstance(node, list):
        for value in node:
            yield from _angles(value, key)
