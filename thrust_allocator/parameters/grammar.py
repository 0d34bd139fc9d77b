"""
What ROS 2's own parser makes of parameter files, without ROS.

It follows rcl_yaml_param_parser event by event, so that it reads the same even where nobody should
write so: a list in a list, one name twice, a map that is empty. A test holds both together. What
that parser refuses is said here in words that name the parameter or the place.
"""

import re
from typing import NoReturn

from thrust_allocator.parameters.entry import Entry, Value, yaml_events
from thrust_allocator.parameters.types import ParameterError, shown
import yaml

_SECTION = 'ros__parameters'
_NO_SECTION = f'is no map, must lead from the name of a node to {_SECTION}'
_TOKEN = re.compile(r'\*\*?|[A-Za-z_][A-Za-z0-9_]*')


class Grammar:
    """
    The sections of parameter files, in the order in which they apply.

    `sections` holds the entries by pattern of node names, as it stands in the file. `files` holds
    the patterns of each file that was added.
    """

    def __init__(self) -> None:
        self.sections: dict[str, list[Entry]] = {}
        self.files: dict[str, list[str]] = {}

    def add(self, content: str | bytes, source: str) -> None:
        """
        Read one file after the others, as ROS 2 merges them.

        :param source: the name of the file, for messages.
        :raises ParameterError: if ROS 2 would not read it.
        """
        _File(self, source).read(content)


class _File:
    """The state of ROS 2's parser within one file; the names are those of what it means."""

    def __init__(self, grammar: Grammar, source: str) -> None:
        self._sections = grammar.sections
        self._patterns = grammar.files.setdefault(source, [])
        self._source = source
        self._value = Value(source)
        self._at_key = True
        self._in_section = False
        self._depth = 0
        self._new_map = False
        self._node, self._node_depth = '', 0  # name so far, and how many keys it took
        self._group, self._group_depth = '', 0
        self._section: list[Entry] | None = next(iter(self._sections.values()), None)
        self._index = 0  # of the entry that the last key stands for
        self._emptied = ''  # a name with an empty map, at which ROS 2 leaves the section too early

    def read(self, content: str | bytes) -> None:
        handlers = {
            yaml.ScalarEvent: self._scalar, yaml.AliasEvent: self._alias,
            yaml.SequenceStartEvent: self._begin_list, yaml.SequenceEndEvent: self._end_list,
            yaml.MappingStartEvent: self._begin_map, yaml.MappingEndEvent: self._end_map}
        for event in yaml_events(content, self._source):
            if handler := handlers.get(type(event)):
                handler(event)

    def _scalar(self, event: yaml.ScalarEvent) -> None:
        if not self._at_key:
            if not (self._in_section and self._section):
                self._refuse_value()
            self._value.take(self._entry(), event)
            self._at_key = not self._value.in_list
            return
        if not event.value:
            raise ParameterError(f'{self._source}: has an empty name in line '
                                 f'{event.start_mark.line + 1}')
        name = event.value.partition('\0')[0]
        if self._in_section:
            self._parameter_name(name)
        elif name.startswith(_SECTION):
            self._enter_section()
        else:
            slash = '' if not self._node_depth or self._node.endswith('/') else '/'
            self._node, self._node_depth = f'{self._node}{slash}{name}', self._node_depth + 1
        self._at_key = False

    def _alias(self, event: yaml.AliasEvent) -> None:
        raise ParameterError(
            f'{self._source}: is not valid YAML: ROS 2 has no aliases such as *{event.anchor} '
            f'in line {event.start_mark.line + 1}')

    def _begin_list(self, event: yaml.SequenceStartEvent) -> None:
        if self._at_key and self._depth:
            raise ParameterError(f'{self._source}: has a list where a name must stand, in line '
                                 f'{event.start_mark.line + 1}')
        if self._at_key or not self._in_section:
            self._refuse_value()
        self._value.begin_list()

    def _end_list(self, event: yaml.SequenceEndEvent) -> None:
        self._value.end_list(self._entry())
        self._at_key = True

    def _begin_map(self, event: yaml.MappingStartEvent) -> None:
        self._depth += 1
        self._at_key = self._new_map = True
        if self._in_section and self._depth == self._node_depth + 3:
            self._new_map = False  # the section itself, which is no group

    def _end_map(self, event: yaml.MappingEndEvent) -> None:
        if self._in_section and self._group_depth:
            self._group_depth -= 1
            self._group = self._group.rpartition('.')[0] if self._group_depth else ''
        elif self._in_section:
            self._in_section = False
            if self._new_map and self._section:
                self._emptied = self._entry().name
        elif self._depth == self._node_depth + 1:
            self._node_depth = max(self._node_depth - 1, 0)
            self._node = self._node.rpartition('/')[0] if self._node_depth else ''
        self._depth -= 1

    def _enter_section(self) -> None:
        if not self._node_depth:
            raise ParameterError(
                f'{self._source}: {_SECTION} must stand under the name of a node, and once there')
        *namespace, name = self._node.removeprefix('/').split('/')
        if not all(_TOKEN.fullmatch(token) for token in (*namespace, name)) or len(name) > 255:
            raise ParameterError(
                f'{self._source}: {shown(self._node)} is no name of a node, must consist of '
                'letters, digits, _ and slashes, or * and ** for any')
        self._section = self._sections.setdefault(self._node, [])
        self._patterns.append(self._node)
        self._node_depth -= 1
        self._node = self._node.rpartition('/')[0] if self._node_depth else ''
        self._in_section = True

    def _parameter_name(self, name: str) -> None:
        if self._new_map:  # then the key before is a group
            if not self._entry().name:
                raise ParameterError(
                    f'{self._source}: {self._patterns[-1]}: stands beside {_SECTION}, must stand '
                    'in it, or be the name of a node of its own')
            self._group = self._entry().name
            self._group_depth += 1
            self._new_map = False
        sought = self._group if self._group_depth else name
        self._index = next((i for i, entry in enumerate(self._section) if entry.name == sought),
                           len(self._section))
        if self._index == len(self._section):
            self._section.append(Entry(sought))
        if self._group_depth:
            self._section[self._index].name = f'{self._group}.{name}'

    def _entry(self) -> Entry:
        """Return the entry of the last key; in another section that is none, as in ROS 2."""
        return self._section[self._index] if self._index < len(self._section) else Entry('')

    def _refuse_value(self) -> NoReturn:
        if self._emptied:
            raise ParameterError(f'{self._emptied}: is an empty map, must hold parameters')
        if self._in_section:
            raise ParameterError(f'{self._source}: {self._patterns[-1]}.{_SECTION}: is no map, '
                                 'must hold parameters')
        where = f': /{self._node.removeprefix("/")}' if self._node_depth else ''
        raise ParameterError(f'{self._source}{where}: {_NO_SECTION}')
