"""A YAML document of somebody else's: its groups of keys, and the names and limits in them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
import math
import re
from typing import Any

from thrust_allocator.import_vehicle.configuration import SourceError
import yaml

Limits = tuple[float | None, float | None]  # reverse, forward; None: not said [N]

# Flat lists of numbers are matrices, and lists of six numbers thrusters, by their key alone
MATRIX_NAME = re.compile(r'tam|tcm|b|b_matrix|.*alloc\w*|.*config\w*_matrix|.*mix\w*'
                         r'|.*thrust\w*_matrix|.*effectiveness\w*', re.I)
OF_THRUSTERS = re.compile(r'thruster|propuls|motor|actuator|layout', re.I)

_PAIRS = (('min_thrust', 'max_thrust'), ('min_force', 'max_force'), ('thrust_min', 'thrust_max'),
          ('force_min', 'force_max'), ('min', 'max'))
_LISTS = ('limits', 'bounds', 'thrust_limits', 'force_limits', 'bollard_thrust')
_GROUPS = ('constraints', 'limits')
_NAMES = ('thrusters', 'thruster_names', 'names')


@dataclass(frozen=True)
class Group:
    """One mapping of a document, and the dotted path that leads to it."""

    path: str
    items: Mapping[str, Any]

    def at(self, key: str) -> str:
        """Return the dotted path of one of its keys."""
        return f'{self.path}.{key}' if self.path else key


def load(text: str) -> Any:
    """Return a YAML document; a list at its top counts as the value of the key 'thrusters'."""
    try:
        document = yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError, TypeError, ValueError) as error:
        raise SourceError(f'is no YAML: {error}') from None
    if isinstance(document, list):
        document = {'thrusters': document}
    if not isinstance(document, dict):
        raise SourceError('holds no keys, must be a matrix or a layout in YAML, a URDF '
                          'or an SDF')
    return document


def groups(document: Any, path: str = '') -> Iterator[Group]:
    """Yield every mapping of a document, outer ones first; ROS's own levels leave no trace."""
    if not isinstance(document, dict):
        return
    items = {str(key): value for key, value in document.items()}
    group = Group(path, items)
    yield group
    for key, value in items.items():
        yield from groups(value, path if key in ('/**', 'ros__parameters') else group.at(key))


def is_number(value: Any) -> bool:
    """Tell a finite number."""
    return (isinstance(value, (int, float)) and not isinstance(value, bool)
            and math.isfinite(value))


def are_numbers(value: Any, count: int | None = None) -> bool:
    """Tell a list of finite numbers, of a length if one is given."""
    return (isinstance(value, list) and bool(value) and all(map(is_number, value))
            and count in (None, len(value)))


def frame_of(document: Any) -> str | None:
    """Return the axes that a document says its vectors are in, or None."""
    said = {str(group.items[key]).lower() for group in groups(document)
            for key in ('vehicle_frame', 'body_frame', 'frame', 'axes') if key in group.items}
    said &= {'flu', 'frd'}
    return said.pop() if len(said) == 1 else None


def names_in(group: Group, count: int) -> list[str]:
    """Return the names of the thrusters, if the group has that many; else their numbers from 0."""
    for key in _NAMES:
        value = group.items.get(key)
        if isinstance(value, list) and len(value) == count \
                and all(isinstance(name, (str, bool, int)) for name in value):
            return [str(name) for name in value]
    return [f'thruster_{i}' for i in range(count)]


def limits_in(group: Group, index: int | None = None) -> Limits:
    """
    Return the limits of thrust that stand in a group, or in its constraints.

    :param index: of the thruster, where limits may be lists with one entry for each.
    """
    for key in _LISTS:
        if are_numbers(group.items.get(key), 2):
            return _ordered(*group.items[key])
    for low, high in _PAIRS:
        found = [_entry(group.items.get(key), index) for key in (low, high)]
        if found != [None, None]:
            return _ordered(*found)
    for key in _GROUPS:
        if isinstance(group.items.get(key), dict):
            return limits_in(Group(group.at(key), group.items[key]), index)
    return None, None


def limits_by_name(document: Any) -> dict[str, Limits]:
    """Return the limits of groups that say whose they are: `thruster: NAME`."""
    return {str(group.items['thruster']): limits_in(group) for group in groups(document)
            if isinstance(group.items.get('thruster'), str)}


def _entry(value: Any, index: int | None) -> float | None:
    if index is not None and are_numbers(value) and index < len(value):
        value = value[index]
    return float(value) if is_number(value) else None


def _ordered(low: float | None, high: float | None) -> Limits:
    """Return limits with the signs that they must have; what is none says nothing."""
    low = float(low) if low is not None and low <= 0.0 else None
    high = float(high) if high is not None and high >= 0.0 else None
    return (None, None) if low == high == 0.0 else (low, high)
