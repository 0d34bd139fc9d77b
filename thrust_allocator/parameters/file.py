"""Read the parameters of one node from ROS 2 parameter files, without ROS."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
import os
from pathlib import Path
import re
import sysconfig
from typing import Any

from thrust_allocator.parameters.grammar import Grammar
from thrust_allocator.parameters.types import ParameterError

NODE_NAME = 'thrust_allocator'


def is_of_every_node(name: str) -> bool:
    """Tell a parameter that ROS 2 itself gives every node, as `ros2 param dump` writes it too."""
    return (name in ('use_sim_time', 'start_type_description_service')
            or name.startswith('qos_overrides.'))


@dataclass(frozen=True)
class Given:
    """What parameter files say for one node."""

    values: dict[str, Any]  # by full dotted name; [] for what has no value, such as {}
    own: frozenset[str]  # names given in a section that names the node: meant for no other
    notes: tuple[str, ...]  # what ROS 2 reads otherwise than its author may think


def read_files(paths: Iterable[str | Path], copies: Mapping[str, str] = {}) -> Grammar:
    """
    Read parameter files, one after the other as ROS 2 does.

    :param copies: where to read instead, by path, what can be read only once.
    :raises ParameterError: if one cannot be read, or ROS 2 would refuse it.
    """
    grammar = Grammar()
    for path in paths:
        try:
            content = Path(copies.get(path, path)).read_bytes()
        except OSError as error:
            raise ParameterError(f'{path}: cannot be read: {error.strerror}') from None
        grammar.add(content, str(path))
    return grammar


def given_for(node: str, files: Grammar) -> Given:
    """
    Return what files say for a node.

    Sections whose top key matches the node's name apply in the order of the files, a later one
    over an earlier one, as in ROS 2.

    :param node: the node's full name, e.g. '/my_auv/thrust_allocator'.
    :raises ParameterError: if one of the files has nothing for this node.
    """
    for path, patterns in files.files.items():
        if not any(_matches(pattern, node) for pattern in patterns):
            keys = ', '.join(f'/{pattern.removeprefix("/")}' for pattern in patterns) or 'none'
            raise ParameterError(f'{path}: has nothing for the node {node}; its top keys are '
                                 f'{keys}, one must be the name of the node, or /** for every '
                                 'node')
    values: dict[str, Any] = {}
    own: set[str] = set()
    notes: list[str] = []
    for pattern, entries in files.sections.items():
        if _matches(pattern, node):
            values.update((entry.name, entry.value) for entry in entries)
            notes += [note for entry in entries for note in entry.notes]
            if '*' not in pattern.rpartition('/')[2]:
                own.update(entry.name for entry in entries)
    for name in [name for name in values if is_of_every_node(name)]:
        del values[name]
    return Given(values, frozenset(own), tuple(notes))


def read_parameter_file(path: str | Path, node: str = f'/{NODE_NAME}') -> dict[str, Any]:
    """
    Return what one file says for one node, by full dotted parameter name.

    :raises ParameterError: if ROS 2 would refuse the file, or it has nothing for this node.
    """
    return given_for(node, read_files([path])).values


def _matches(pattern: str, node: str) -> bool:
    """Tell whether a top key such as '/**' or '/my_auv/*' stands for the node's full name."""
    regex = re.escape(f'/{pattern.removeprefix("/")}')
    regex = regex.replace(r'/\*\*', r'(/[^/]+)*').replace(r'/\*', '/[^/]+')
    return re.fullmatch(regex, node) is not None


def default_parameter_file() -> Path:
    """
    Return the path of MT-2012's parameter file, which comes with the package.

    Looked for where colcon, pip and a source tree have it, in this order.

    :raises ParameterError: if the package was installed without it.
    """
    workspaces = filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep))
    places = [*(Path(prefix, 'share', NODE_NAME)
                for prefix in (*workspaces, sysconfig.get_path('data'))),
              Path(__file__).resolve().parents[2]]
    for place in places:
        if (file := place / 'config' / 'mt2012.yaml').is_file():
            return file
    raise ParameterError(f'mt2012.yaml: is missing from {", ".join(map(str, places))}')
