"""One parameter as ROS 2's own parser takes it from YAML: a value, or a list of one type."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from thrust_allocator.parameters.scalars import is_surprisingly_octal, scalar
from thrust_allocator.parameters.types import ParameterError, shown
import yaml

_WORD = 'tag:yaml.org,2002:str'  # as in !!str 5
_KINDS = {bool: 'true or false', int: 'whole numbers', float: 'real numbers', str: 'words'}
# Of values of several kinds the first of these counts, whichever came last: (is a list, type)
_ORDER = [(is_list, kind) for is_list in (False, True) for kind in _KINDS]
# libyaml's parser, as ROS 2 uses it, where PyYAML has it
_LOADER = getattr(yaml, 'CBaseLoader', yaml.BaseLoader)


@dataclass
class Entry:
    """One parameter of a section; of values of several kinds the first of `_ORDER` counts."""

    name: str
    values: dict[tuple[bool, type], Any] = field(default_factory=dict)  # by (is a list, type)
    place: str = ''  # of the last value
    notes: list[str] = field(default_factory=list)

    @property
    def value(self) -> Any:
        """Return the value in force; [] if there is none, as of an empty list or map."""
        return next((self.values[kind] for kind in _ORDER if kind in self.values), [])


class Value:
    """Takes the scalars of one value after the other into an entry, alone or in a list."""

    def __init__(self, source: str) -> None:
        self._source = source
        self.in_list = False
        self._kind: type | None = None  # of the list's items
        self._texts: list[str] = []  # of the list
        self._mixed = False

    def begin_list(self) -> None:
        """Begin a list; within a list the inner one counts alone."""
        self.in_list, self._kind = True, None
        self._texts.clear()

    def end_list(self, entry: Entry) -> None:
        """End a list, and refuse one whose items are not of one kind."""
        self.in_list = False
        if self._mixed:
            raise ParameterError(
                f'{entry.name}: {_mixture(self._texts)} ({entry.place})')

    def take(self, entry: Entry, event: yaml.ScalarEvent) -> None:
        """Put a scalar into an entry."""
        line = event.start_mark.line + 1
        quoted = event.style in ('"', "'") or event.tag == _WORD
        if not (event.value or event.style in ('"', "'")):
            raise ParameterError(
                f'{entry.name}: has no value, must have one (line {line} of {self._source})')
        item = scalar(event.value, quoted)
        kind = type(item)
        if not quoted and is_surprisingly_octal(event.value):
            entry.notes.append(f'{entry.name}: {event.value} is {item} to ROS 2, which takes '
                               'numbers with a leading zero for octal')
        if not self.in_list:
            self._set(entry, (False, kind), item, line)
            return
        self._texts.append(repr(event.value) if quoted else event.value)
        if self._kind is None:
            self._kind = kind
            self._set(entry, (True, kind), [], line)
        if kind is self._kind:
            entry.values[True, kind].append(item)
        else:
            self._mixed = True

    def _set(self, entry: Entry, kind: tuple[bool, type], value: Any, line: int) -> None:
        place = f'line {line} of {self._source}'
        if entry.values.keys() - {kind}:
            entry.values[kind] = value
            entry.notes.append(
                f'{entry.name}: is given in {entry.place} and as another type in {place}; ROS 2 '
                f'keeps {_KINDS[next(one for one in _ORDER if one in entry.values)[1]]}, whichever '
                'comes last')
        elif entry.values and entry.place.endswith(f' of {self._source}'):
            entry.notes.append(f'{entry.name}: stands twice, in {entry.place} and in {place}; '
                               'the last one counts')
        entry.values[kind], entry.place = value, place


def _mixture(texts: list[str]) -> str:
    """Say what is wrong with a list whose items ROS 2 takes for different types."""
    kinds = {type(scalar(text)) for text in texts}
    listed = f'[{", ".join(texts)}]'
    listed = listed if len(listed) < 80 else f'{listed[:76]}...]'
    if kinds == {int, float}:
        return (f'is {listed}, mixes whole and real numbers, which ROS 2 does not allow: must be '
                'written with decimals throughout, as in 2.0')
    if kinds == {bool, str}:
        first = next(text for text in texts if isinstance(scalar(text), bool))
        return (f'is {listed}, where ROS 2 takes {first} for {str(scalar(first)).lower()}: must '
                f"be quoted, as in '{first}'")
    return (f'is {listed}, must not mix '
            + ' and '.join(_KINDS[kind] for kind in _KINDS if kind in kinds))


def parse_value(text: str, name: str) -> Any:
    """
    Return what `-p name:=text` sets.

    :raises ParameterError: for what is neither a value nor a list of values of one type.
    """
    value, entry = Value('the command line'), Entry(name)
    for event in yaml_events(text, name):
        if isinstance(event, yaml.SequenceStartEvent):
            value.begin_list()
        elif isinstance(event, yaml.SequenceEndEvent):
            value.end_list(entry)
        elif isinstance(event, yaml.ScalarEvent):
            value.take(entry, event)
        elif isinstance(event, (yaml.MappingStartEvent, yaml.AliasEvent)):
            raise ParameterError(f'{name}: is {shown(text)}, must be a value or a list of values')
    return entry.value


def yaml_events(text: str | bytes, source: str) -> Iterator[yaml.Event]:
    """Yield YAML's events; a mistake in the YAML itself is one line with its place."""
    try:
        yield from yaml.parse(text, _LOADER)
    except (yaml.YAMLError, ValueError) as error:
        mark = getattr(error, 'problem_mark', None)
        where = f' in line {mark.line + 1}' if mark else ''
        problem = getattr(error, 'problem', None) or getattr(error, 'reason', None) or str(error)
        raise ParameterError(f'{source}: is not valid YAML: {problem}{where}') from None
