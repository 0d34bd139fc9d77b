"""The node's command line: what ROS 2 takes of it, and what to say of the rest."""

from collections.abc import Sequence
from dataclasses import dataclass, field
import difflib
from pathlib import Path
from typing import Any

from thrust_allocator.parameters.entry import parse_value
from thrust_allocator.parameters.types import ParameterError, shown

USAGE = """\
usage: ros2 run thrust_allocator node --ros-args --params-file my_vehicle.yaml [OPTION ...]

Turns a commanded wrench into setpoints for the thrusters of an AUV or ROV.
Without a --params-file the vehicle is MT-2012.

after --ros-args:
  --params-file FILE     the parameters of a vehicle; of several, the last one counts
  -p NAME:=VALUE         one parameter
  -r __ns:=/NAMESPACE    the namespace of the node
  -r NAME:=NEW_NAME      another name for a topic
  --log-level LEVEL      debug, info, warn, error or fatal
and every other option of ROS 2."""

_WITH_VALUE = ('-p', '--param', '--params-file', '-r', '--remap', '-e', '--enclave',
               '--log-level', '--log-config-file', '--log-file-name')
_ALONE = tuple(f'--{switch}-{what}-logs' for switch in ('enable', 'disable')
               for what in ('stdout', 'rosout', 'external-lib'))
_HELP = ('-h', '--help')
# A full name in ROS 2 has at most 247 characters; this is the longest below the namespace
_LONGEST_NAMESPACE = 247 - len('/thrust_allocator/set_parameters_atomically')


@dataclass
class CommandLine:
    """The parts of a command line that the node itself must know."""

    files: list[str] = field(default_factory=list)  # of --params-file
    values: dict[str, Any] = field(default_factory=dict)  # of `-p name:=value`, the last ones
    named: set[str] = field(default_factory=set)  # parameters of any -p, of one node's also
    unknown: list[str] = field(default_factory=list)  # after --ros-args, to this page
    help: bool = False


def read_command_line(args: Sequence[str]) -> CommandLine:
    """
    Read a command line, program name first, by the rules of ROS 2.

    :raises ParameterError: for an argument that ROS 2 would not take, with the right form; and for
        a parameter's value that it cannot read.
    """
    line = CommandLine()
    words = iter(args[1:])
    of_ros = False
    for word in words:
        _check_text(word)
        if word in _HELP:
            line.help = True
            return line
        if word == '--ros-args':
            of_ros = True
        elif not of_ros:
            raise ParameterError(_right_form(word, next(words, '...')))
        elif word == '--':
            of_ros = False
        elif word in _WITH_VALUE:
            value = next(words, None)
            if value is None:
                raise ParameterError(f'{word}: stands last, must be followed by its value')
            _check_text(value)
            _take(line, word, value)
        elif word not in _ALONE:
            line.unknown.append(word)
    return line


def unknown_option(word: str) -> ParameterError:
    """Return what to say of a word after --ros-args that ROS 2 does not take."""
    name = word.partition('=')[0]
    close = difflib.get_close_matches(name, (*_WITH_VALUE, *_ALONE), n=1)
    if name in _WITH_VALUE:
        return ParameterError(f'{word}: is no option of ROS 2, must be {name} and its value as a '
                              'word of its own')
    if word.endswith(('.yaml', '.yml')):
        return ParameterError(f'{word}: means nothing here, must be --params-file {word}')
    return ParameterError(f'{word}: is no option of ROS 2'
                          + (f'; did you mean {close[0]}?' if close else ''))


def _check_text(word: str) -> None:
    try:
        word.encode()
    except UnicodeEncodeError:
        raise ParameterError(f'{ascii(word)}: is no UTF-8, which ROS 2 needs') from None


def _take(line: CommandLine, option: str, value: str) -> None:
    namespace = value.partition('__ns:=')[2]
    if option in ('-r', '--remap') and len(namespace) > _LONGEST_NAMESPACE:
        raise ParameterError(f'__ns: has {len(namespace)} characters, must be a namespace of at '
                             f'most {_LONGEST_NAMESPACE}')
    if option == '--params-file':
        line.files.append(value)
    elif option in ('-p', '--param'):
        rule, separator, text = value.partition(':=')
        name = rule.rpartition(':')[2]
        if not separator:
            raise ParameterError(f'{option} {value}: is no rule, must be {option} NAME:=VALUE')
        if text.endswith(('.yaml', '.yml')) and 'file' in name:
            raise ParameterError(f'{name}: is no parameter here; a file is read by '
                                 f'--params-file {text}')
        line.named.add(name)
        if not text:
            raise ParameterError(f'{name}: has no value, must be {option} {name}:=VALUE')
        if name == rule:
            line.values[name] = parse_value(text, name)


def _right_form(word: str, following: str) -> str:
    """Say how a word before --ros-args, which the node does not take, may have been meant."""
    name, separator, value = word.partition(':=')
    if separator and name == '__params':
        right = f'--ros-args --params-file {value}'
    elif separator and name.startswith('__'):
        right = f'--ros-args -r {word}'
    elif separator:
        right = f'--ros-args -p {word} for a parameter, --ros-args -r {word} for a topic'
    elif word in _WITH_VALUE:
        right = f'--ros-args {word} {following}'
    elif word in _ALONE:
        right = f'--ros-args {word}'
    elif word.endswith(('.yaml', '.yml')) or Path(word).is_file():
        right = f'--ros-args --params-file {word}'
    elif close := difflib.get_close_matches(word, (*_WITH_VALUE, *_ALONE, '--ros-args'), n=1):
        return f'{word}: means nothing here; did you mean {close[0]}?'
    else:
        right = '--ros-args and options of ROS 2; see --help'
    return f'{shown(word)[1:-1]}: means nothing here, must be {right}'
