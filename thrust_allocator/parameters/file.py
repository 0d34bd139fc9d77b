"""Read the parameters of one node from a ROS 2 parameter file, without ROS."""

from collections.abc import Iterator, Sequence
from pathlib import Path
import re
import sysconfig
from typing import Any

from thrust_allocator.parameters.types import is_exponent, ParameterError, shown
import yaml

NODE_NAME = 'thrust_allocator'


def is_of_every_node(name: str) -> bool:
    """Tell a parameter that ROS 2 itself gives every node, as `ros2 param dump` writes it too."""
    return (name in ('use_sim_time', 'start_type_description_service')
            or name.startswith('qos_overrides.'))


class _Loader(yaml.SafeLoader):
    """A safe loader that refuses what ROS 2 does, and a key given twice, which PyYAML drops."""

    def compose_node(self, parent: yaml.Node | None, index: object) -> yaml.Node | None:
        """Build the next node, unless it is an alias, which ROS 2 does not know."""
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()
            raise yaml.composer.ComposerError(
                None, None, f'ROS 2 has no aliases such as *{event.anchor}', event.start_mark)
        return super().compose_node(parent, index)

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
            values.update((name, value) for name, value in section.items()
                          if not is_of_every_node(name))
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
        text = Path(path).read_bytes()
    except OSError as error:
        raise ParameterError(f'{path}: cannot be read: {error.strerror}') from None
    return list(_sections(_load(text, str(path)), '', str(path)))


def command_line_values(args: Sequence[str]) -> dict[str, Any]:
    """
    Return what `-p name:=value` on the command line sets, by full dotted name.

    :param args: the command line; a rule for one node among several (`-p node:name:=value`) is
        passed over.
    :raises ParameterError: for a value that ROS 2 cannot take.
    """
    values = {}
    for option, rule in zip(args, args[1:]):
        name, separator, text = rule.partition(':=')
        if option in ('-p', '--param') and separator and ':' not in name:
            values[name] = _load(text, name)
            _check_value(name, values[name])
    return values


def _load(text: str | bytes, source: str) -> Any:
    try:
        return yaml.load(text, _Loader)
    except Exception as error:  # of nearly any type: PyYAML's constructors take much for granted
        mark = getattr(error, 'problem_mark', None)
        where = f' in line {mark.line + 1}' if mark else ''
        problem = getattr(error, 'problem', None) or str(error) or type(error).__name__
        raise ParameterError(f'{source}: is not valid YAML: {problem}{where}') from None


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
        if isinstance(value, dict) and value:
            yield from _flat(value, f'{name}.')
        else:
            _check_value(name, value)
            yield name, value


def _check_value(name: str, value: Any) -> None:
    """Refuse what ROS 2's own parser refuses, but by name: null, dates, and lists not of a kind."""
    items = value if isinstance(value, list) else [value]
    kinds = {float if is_exponent(item) else type(item) for item in items}
    if kinds == {int, float}:
        raise ParameterError(
            f'{name}: is {shown(value)}, mixes whole and real numbers, which ROS 2 does not allow: '
            'must be written with decimals throughout, as in 2.0')
    for item in items:
        if isinstance(item, int) and not -2**63 <= item < 2**63:
            raise ParameterError.wrong(name, item, 'a number of 64 bits')
    if len(kinds) != 1 or not kinds <= {bool, int, float, str}:
        allowed = 'a value or a list of values of one type: numbers, words, or true and false'
        raise ParameterError.wrong(name, value, allowed)


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
              Path(__file__).resolve().parents[2]]
    try:
        from ament_index_python.packages import get_package_share_directory
        places.insert(0, Path(get_package_share_directory(NODE_NAME)))
    except (ImportError, LookupError, OSError):  # no ROS, or this package is not in a workspace
        pass
    for place in places:
        if (file := place / 'config' / 'mt2012.yaml').is_file():
            return file
    raise ParameterError(f'mt2012.yaml: is missing from {", ".join(map(str, places))}')
