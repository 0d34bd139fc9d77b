"""Read the parameters of one node from a ROS 2 parameter file, without ROS."""

from collections.abc import Iterator
from pathlib import Path
import re
import sysconfig
from typing import Any

from thrust_allocator.parameter_types import ParameterError
import yaml

NODE_NAME = 'thrust_allocator'


class _Loader(yaml.SafeLoader):
    """A safe loader that refuses a key given twice, where PyYAML would keep the last one."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict:
        """Build the mapping of `node`, unless one of its keys stands twice."""
        keys = [key for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        seen = set()
        for key in keys:
            if key.value in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f'the key {key.value!r} stands twice', key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def read_parameter_file(path: str | Path, node: str = f'/{NODE_NAME}') -> dict[str, Any]:
    """
    Return what a ROS 2 parameter file says for one node, by full dotted parameter name.

    Sections whose top key matches the node's name apply in the order of the file, a later one
    over an earlier one, as in ROS 2.

    :param path: the YAML file.
    :param node: the node's full name, e.g. '/my_auv/thrust_allocator'.
    :raises ParameterError: if the file cannot be read, is no parameter file, holds a value that
        ROS 2 cannot take, or has nothing for this node.
    """
    values: dict[str, Any] = {}
    sections = check_parameter_file(path)
    for pattern, section in sections:
        if _matches(pattern, node):
            values.update(section)
    if not values:
        keys = ', '.join(pattern for pattern, _ in sections) or 'none'
        raise ParameterError(f'{path}: has nothing for the node {node}; its top keys are {keys}, '
                             f'one must be the name of the node, or /** for every node')
    return values


def check_parameter_file(path: str | Path) -> list[tuple[str, dict[str, Any]]]:
    """
    Return the sections of a ROS 2 parameter file: (pattern of node names, values by name).

    :raises ParameterError: if the file cannot be read, is no parameter file, or holds a value
        that ROS 2 cannot take.
    """
    try:
        with open(path, encoding='utf-8') as file:
            document = yaml.load(file, _Loader)
        return list(_sections(document, '', str(path)))
    except OSError as error:
        raise ParameterError(f'{path}: cannot be read: {error.strerror}') from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(f'{path}: is not valid YAML: {_one_line(error)}') from None


def _one_line(error: Exception) -> str:
    mark = getattr(error, 'problem_mark', None)
    where = f' in line {mark.line + 1}' if mark else ''
    problem = getattr(error, 'problem', None) or str(error) or type(error).__name__
    return ' '.join(problem.split()) + where


def _sections(document: Any, prefix: str, path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    where = f'{path}: {prefix}' if prefix else path
    if not isinstance(document, dict):
        raise ParameterError(f'{where}: is no map, must lead from the name of a node to '
                             'ros__parameters')
    for key, content in document.items():
        if key == 'ros__parameters':
            if not isinstance(content, dict):
                raise ParameterError(f'{where}.ros__parameters: is no map, must hold parameters')
            yield prefix, dict(_flat(content, ''))
        else:
            yield from _sections(content, f'{prefix}/{str(key).strip("/")}', path)


def _flat(content: dict, prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in content.items():
        name = f'{prefix}{key}'
        if isinstance(value, dict):
            yield from _flat(value, f'{name}.')
        else:
            _check_value(name, value)
            yield name, value


def _check_value(name: str, value: Any) -> None:
    """Refuse what ROS 2's own parser refuses, but by name: null, dates, and lists not of a kind."""
    items = value if isinstance(value, list) else [value]
    kinds = {float if _is_real(item) else type(item) for item in items}
    if kinds == {int, float}:
        raise ParameterError(f'{name}: is {value}, mixes whole and real numbers, which ROS 2 does '
                             'not allow: must be written with decimals throughout, as in 2.0')
    if len(kinds) != 1 or not kinds <= {bool, int, float, str}:
        allowed = 'a value or a list of values of one type: numbers, words, or true and false'
        raise ParameterError.wrong(name, value, allowed)


def _is_real(item: Any) -> bool:
    # 1.0e4 is a number to ROS 2, but to PyYAML, for want of a sign, a string
    return isinstance(item, float) or isinstance(item, str) and bool(
        re.fullmatch(r'[-+]?[0-9]*\.?[0-9]*[eE][-+]?[0-9]+', item))


def _matches(pattern: str, node: str) -> bool:
    """Tell whether a top key such as '/**' or '/my_auv/*' stands for the node's full name."""
    regex = re.escape(pattern).replace(r'/\*\*', r'(/[^/]+)*').replace(r'\*', '[^/]+')
    return re.fullmatch(regex, node) is not None


def default_parameter_file() -> Path:
    """
    Return the path of MT-2012's parameter file, which comes with the package.

    Looked for where colcon, pip and a source tree have it, in this order.

    :raises ParameterError: if the package was installed without it.
    """
    places = [Path(sysconfig.get_path('data'), 'share', NODE_NAME),
              Path(__file__).resolve().parent.parent]
    try:
        from ament_index_python.packages import get_package_share_directory
        places.insert(0, Path(get_package_share_directory(NODE_NAME)))
    except (ImportError, LookupError, OSError):  # no ROS, or this package is not in a workspace
        pass
    for place in places:
        if (file := place / 'config' / 'mt2012.yaml').is_file():
            return file
    raise ParameterError(f'mt2012.yaml: is missing from {", ".join(map(str, places))}')
