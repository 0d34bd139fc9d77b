"""Parameter files read without ROS, and a corpus of small ones held against plain rclpy."""

from hypothesis import given, settings, strategies as st
import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from support.peer import ros_context
from thrust_allocator.parameters.entry import parse_value
from thrust_allocator.parameters.file import given_for, read_files
from thrust_allocator.parameters.types import ParameterError

HEAD = '/**:\n  ros__parameters:\n    '
NODE = '/ns/thrust_allocator'

# What may stand for a parameter `a`
VALUES = [
    '2024-02-03', '2024-02-03 10:11:12', '~', 'null', '', '[]', '{}', '!!binary aGk=', '!!str 5',
    '!!int "5"', '!!float 5', '99999999999999999999', '9223372036854775807', '9223372036854775808',
    '-9223372036854775808', '-9223372036854775809', '1e400', '1e-320', '-1e-400', '0x1p-1080',
    '=', '<<', '[y, yes]', '[-.5, 0.5]', '[n, e, s, w]', '[x, y, z]', '[n]', '[x, "y", z]', '010',
    '-017', '08', '00', '0', '-0', '+5', '0o10', '0x10', '0X1F', '-0x10', '0x', '1_000', '1:30',
    '.5', '-.5', '+.5', '1.', '.', '1e4', '1.0e4', '1E+4', '1e', '0x1p3', 'inf', '-Infinity',
    'nan', '.nan', '-.nan', '.inf', '-.inf', '+.INF', '[1, [2]]', '[[1.0]]', '[[1.0], [2.0]]',
    '[{b: 1}]', '[x, {b: 1}]', '[1, 2.0]', '[1, up]', '[1.0, true]', '[~]', '["x", ~]', '"5"',
    "''", '|\n      hi', '|-\n      5', '>-\n      5', '&x 5', '&x {b: 1}', '&x 5\n    b: *x',
    '1\n    a: 2', '1\n    a: 2.0', '2.0\n    a: 1', 'x\n    a: [1.0]', '{b: {c: 1, c: 2}}',
    '{b: 1}\n    a.b: 2.0', 'b: c', '? b', '1 2', '"1" # c', '{}\n    b: 1', '[]\n    b: 1',
    'True', 'tRUE', 'Off', 'é', '"\\0b"', '{b: [1, 2], c: {d: x}}\n    e: 1', '[1.0,\n', '{',
    '{b: {c: {d: {e: 1, f: 2}, g: 3}, h: 4}, i: 5}\n    j: 6', '{b.c: {d: 1, e: 2}, f: 3}',
    '1\n    a: {b: x}', '1\n    "": 2', '1\n    ? [b]\n    : 1', '1\n   b: 2', '1\n    <<: {b: 1}']

# Whole files
FILES = [
    '', '5', '- a', '~', '[]', '{}', 'x: {}\n' + HEAD + 'a: 1\n', '/**:\n', '/**: 5\n',
    'ns:\n  - node\n', '/**:\n  rate: 5.0\n', '/**:\n  ros__parameters:\n',
    '/**:\n  ros__parameters: [1]\n', '/**:\n  ros__parameters: {}\n', '/**: {ros__parameters: ~}',
    'ros__parameters: {a: 1}\n', '/**: {ros__parameters: {a: 1}, b: 1}\n',
    '/**: {ros__parameters: {a: 1}, x: {ros__parameters: {a: 2}}}\n',
    '/**: {ros__parameters: {a: 1}, ros__parameters: {b: 1}}\n', HEAD + 'a: 1\nother: 5\n',
    HEAD + 'a: 1\nother: {ros__parameters: {b: [n, e]}}\n',
    HEAD + 'a: 1\nother: {ros__parameters: {b: [], c: 2020-01-01, d: ~, e: 99999999999999999999, '
    'f: =, g: [y, yes], h: [-.5, 0.5]}}\n',
    HEAD + 'a: 1\n' + HEAD + 'b: 2\n', HEAD + 'a: 1\n' + HEAD + 'a: 2.0\n',
    HEAD + 'a: 1\n---\n' + HEAD + 'a: 2\n', HEAD + 'a: 1\n...\ntrash\n', '%YAML 1.1\n---\n/**: {}',
    '{/**: {ros__parameters: {a: 1}}}', '\ufeff' + HEAD + 'a: 1\n', '/**:\n\tros__parameters: {}\n',
    b'\xff\xfe', b'\x00', b'\x7fELF\x02\xff', HEAD.encode() + b'a: \xe9\n',
    '/**: {ros__parameters: {a: 1}}\n/**: {ros__parameters: 5}\n',
    '/**: {ros__parameters_of_mine: {a: 1}}', '/ns: {thrust_allocator: {ros__parameters: {a: 1}}}',
    'ns: {thrust_allocator: {ros__parameters: {a: 1}}, x: {ros__parameters: {a: 2}}}\n',
    '/ns/thrust_allocator: {ros__parameters: {a: x}}\n' + HEAD + 'a: 1\n',
    HEAD + 'a: 1\n/ns/thrust_allocator: {ros__parameters: {a: x, b: 2}}\n' + HEAD + 'a: 2.0\n',
    *[f'"{key}": {{ros__parameters: {{a: 1}}}}\n' for key in (
        '/*', '*', '**', '/**/thrust_allocator', '/*/thrust_allocator', '/ns/*', '/ns/**', '/**/*',
        '/ns/thrust_allocator/**', '/ns/thrust_allocator/*', 'thrust_allocator', 'ns/**',
        '/ns//thrust_allocator', '/ns/', '/', '', '/1a', '/thrust-allocator', '/~', '/n*',
        'a b', 'x' * 256, 'é')]]


def of_rclpy(*arguments):
    """Return what plain rclpy holds for the node, by name, or None if it does not start."""
    try:
        with ros_context('-r', '__ns:=/ns', *arguments) as context:
            node = Node('thrust_allocator', context=context)
            with node.handle:
                found = node.handle.get_parameters(Parameter)
            node.destroy_node()
    except RuntimeError:
        return None
    return {name: one.value if isinstance(one.value, (bool, int, float, str))
            else list(one.value or []) for name, one in found.items()}


def alike(ours, theirs):
    """Tell whether values agree in type and to the last bit; NaN equals NaN."""
    return repr(ours) == repr(theirs)


@pytest.mark.parametrize('content', [
    pytest.param(content, id=ascii(content[-40:])) for content in (
        *(f'{HEAD}a: {value}\n' for value in VALUES), *FILES)])
def test_ros_and_we_read_the_same(content, tmp_path):
    """A file gives each parameter the value that rcl gives it; what rcl refuses, in one line."""
    path = tmp_path / 'some.yaml'
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    theirs = of_rclpy('--params-file', str(path))
    try:
        files = read_files([path])
    except ParameterError as error:
        assert theirs is None, error
        assert '\n' not in str(error) and len(str(error)) < 300
        return
    try:
        ours = given_for(NODE, files).values
    except ParameterError as error:
        assert 'has nothing for the node /ns/thrust_allocator' in str(error)
        ours = {}
    assert theirs is not None and alike(ours, theirs)


@pytest.mark.parametrize('text', [value for value in VALUES if value and '\n' not in value])
def test_a_value_of_the_command_line(text):
    """`-p a:=VALUE` means what it means to rcl, and what rcl refuses is refused by name."""
    theirs = of_rclpy('-p', f'a:={text}')
    try:
        ours = {'a': parse_value(text, 'a')}
    except ParameterError as error:
        assert theirs is None and str(error).startswith('a: ')
    else:
        assert theirs is not None and alike(ours, theirs)


@given(st.text(st.sampled_from('0123456789abcdefxXpPeE.+-_~nNyYiInNfF '), max_size=12))
@settings(deadline=None, max_examples=200)
def test_random_words(text):
    """Random characters of numbers are the same value to both, alone and in a list."""
    for written in (text, f'[{text}, {text}]'):
        if not text.strip():
            continue
        theirs = of_rclpy('-p', f'a:={written}')
        try:
            ours = {'a': parse_value(written, 'a')}
        except ParameterError:
            assert theirs is None
        else:
            assert alike(ours, theirs)


def test_files_are_merged_as_in_ros(tmp_path):
    """Of two files the later one counts, but of two types in one section the first in order."""
    paths = [tmp_path / 'first.yaml', tmp_path / 'second.yaml']
    paths[0].write_text('/**: {ros__parameters: {a: 1, b: u, c: [1.0]}}\n'
                        '/ns/thrust_allocator: {ros__parameters: {d: 1}}\n')
    paths[1].write_text('/**: {ros__parameters: {a: 2.0, b: v, c: [true], d: 2}}\n')
    given = given_for(NODE, read_files(paths))
    theirs = of_rclpy(*(word for path in paths for word in ('--params-file', str(path))))
    assert alike(dict(sorted(given.values.items())), dict(sorted(theirs.items())))
    assert given.values == {'a': 1, 'b': 'v', 'c': [True], 'd': 1}
    assert given.own == {'d'}
    assert [note.split(':')[0] for note in given.notes] == ['a', 'c']
    assert all('as another type in line 1 of' in note for note in given.notes)


@pytest.mark.parametrize('content, note', [
    ('a: 010', 'a: 010 is 8 to ROS 2, which takes numbers with a leading zero for octal'),
    ('a: [1, 020]', 'a: 020 is 16 to ROS 2, which takes numbers with a leading zero for octal'),
    ('a: 1\n    a: 2', 'a: stands twice, in line 3 of FILE and in line 4 of FILE; the last one '
                       'counts')])
def test_what_is_read_otherwise_than_it_looks_is_noted(content, note, tmp_path):
    """A number that ROS takes for octal, and a name that stands twice, draw a note."""
    path = tmp_path / 'some.yaml'
    path.write_text(f'{HEAD}{content}\n/other: {{ros__parameters: {{a: 010}}}}\n')
    assert [text.replace(str(path), 'FILE') for text in given_for(NODE, read_files([path])).notes] \
        == [note]


@pytest.mark.parametrize('content', ['a: 07', 'a: 08', 'a: 0', 'a: 0x10', "a: '010'", 'a: 1.0'])
def test_what_reads_as_it_looks_is_not_noted(content, tmp_path):
    """Other numbers draw none."""
    path = tmp_path / 'some.yaml'
    path.write_text(f'{HEAD}{content}\n')
    assert given_for(NODE, read_files([path])).notes == ()


def test_rclpy_reads_as_the_issue_says():
    """The yardstick is no stub: rclpy refuses what it should and reads the rest."""
    assert of_rclpy('-p', 'a:=[n, e]') is None
    assert of_rclpy('-p', 'a:=[n]') == {'a': [False]}
