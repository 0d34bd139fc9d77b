"""Parameter files: whose a section is, what is refused, and that ROS 2 reads them the same."""

import re
import sysconfig

import pytest
import rclpy
from thrust_allocator.parameters import file as parameter_file
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.check import read_parameters
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.ros.node import ThrustAllocator

HEAD = '/**:\n  ros__parameters:\n    '
MIXED = 'mixes whole and real numbers, which ROS 2 does not allow: must be written with decimals ' \
        'throughout, as in 2.0 (line 3 of FILE)'
NO_MAP = 'is no map, must lead from the name of a node to ros__parameters'


@pytest.fixture
def read(tmp_path):
    """Return a function that reads a file of the given text or bytes, for a node."""
    def read(content, node='/thrust_allocator'):
        path = tmp_path / 'vehicle.yaml'
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_parameter_file(path, node)
    return read


@pytest.fixture
def refusal(read, tmp_path):
    """Return a function that gives the message with which a file is refused, FILE for its path."""
    def refusal(content):
        with pytest.raises(ParameterError) as caught:
            read(content)
        return str(caught.value).replace(str(tmp_path / 'vehicle.yaml'), 'FILE')
    return refusal


def section(key, rate):
    """Return a section of a parameter file."""
    return f'{key}:\n  ros__parameters:\n    rate: {rate}\n'


@pytest.mark.parametrize('key, node', [
    ('/**', '/thrust_allocator'), ('/**', '/ns/thrust_allocator'), ('/**', '/a/b/c'),
    ('thrust_allocator', '/thrust_allocator'), ('/thrust_allocator', '/thrust_allocator'),
    ('/*', '/thrust_allocator'), ("'*'", '/thrust_allocator'),
    ('/ns/thrust_allocator', '/ns/thrust_allocator'), ('/*/*', '/ns/thrust_allocator'),
    ('ns/thrust_allocator', '/ns/thrust_allocator'), ('/ns/*', '/ns/thrust_allocator'),
    ('/*/thrust_allocator', '/ns/thrust_allocator'), ('/**/thrust_allocator', '/thrust_allocator'),
    ('/**/thrust_allocator', '/a/b/thrust_allocator'), ('/a/**', '/a/b/c')])
def test_a_top_key_matches(key, node, read):
    """A section applies if its key is the node's full name, or stands for it with wildcards."""
    assert read(section(key, 20.0), node) == {'rate': 20.0}


@pytest.mark.parametrize('key, node', [
    ('other', '/thrust_allocator'), ('thrust_allocator', '/ns/thrust_allocator'),
    ('/thrust_allocator', '/ns/thrust_allocator'), ('/ns/thrust_allocator', '/thrust_allocator'),
    ('/*', '/ns/thrust_allocator'), ('/*/thrust_allocator', '/thrust_allocator'),
    ('/ns/*', '/thrust_allocator'), ('/b/**', '/a/b/c'), ('thrust_allocato_', '/thrust_allocator'),
    ('thrust', '/thrust_allocator'), ('thrust_allocator', '/thrust_allocator2')])
def test_a_top_key_does_not_match(key, node, read):
    """A section for another node is left out, and the error lists the top keys there are."""
    with pytest.raises(ParameterError, match=re.escape(
            f'vehicle.yaml: has nothing for the node {node}; its top keys are '
            f'/{key.lstrip("/")}, /last, one must be the name of the node, or /** for every')):
        read(section(key, 20.0) + section('/last', 10.0), node)


def test_a_nested_namespace_matches(read):
    """A namespace may hold the node as a map within a map."""
    nested = 'ns:\n  deep:\n    node:\n      ros__parameters: {rate: 20.0}\n  node: ' \
             '{ros__parameters: {rate: 30.0}}\n'
    assert read(nested, '/ns/deep/node') == {'rate': 20.0}
    assert read(nested, '/ns/node') == {'rate': 30.0}


@pytest.mark.parametrize('keys, rate', [
    (['/**', 'thrust_allocator'], 2.0), (['thrust_allocator', '/**'], 2.0),
    (['/**', 'other'], 1.0), (['other', '/*', '/**', '/thrust_allocator'], 4.0)])
def test_a_later_section_wins(keys, rate, read):
    """Matching sections apply in the order of the file, whatever their keys."""
    sections = [section(key, float(i)) for i, key in enumerate(keys, 1)]
    assert read(''.join(sections)) == {'rate': rate}


def test_sections_complement_each_other(read):
    """What only an earlier section gives stays, also within a group."""
    assert read(HEAD + 'w: {a: 1, b: 2}\nthrust_allocator: {ros__parameters: {w: {b: 3}}}\n') == {
        'w.a': 1, 'w.b': 3}


def test_dotted_keys_equal_nested_maps(read):
    """A group may be written as a map, as dotted names, or half and half."""
    flat = {'thrusters.up.weight': 1.0, 'thrusters.up.model': 'constant'}
    for text in ('thrusters: {up: {weight: 1.0, model: constant}}',
                 'thrusters.up.weight: 1.0\n    thrusters.up.model: constant',
                 'thrusters: {up.weight: 1.0, up.model: constant}',
                 'thrusters.up: {weight: 1.0, model: constant}'):
        assert read(HEAD + text) == flat


def test_values_keep_their_type(read):
    """Numbers, words, flags and lists of one kind come through as ROS 2 reads them."""
    text = HEAD + '{a: 1, b: 1.5, c: 1.0e4, d: up, e: true, f: [1, 2], g: [1.0, 1.0e4, -2e-3], ' \
                  'h: [up, down], i: [true, false]}'
    assert repr(read(text)) == repr({
        'a': 1, 'b': 1.5, 'c': 1.0e4, 'd': 'up', 'e': True, 'f': [1, 2],
        'g': [1.0, 1.0e4, -2e-3], 'h': ['up', 'down'], 'i': [True, False]})


@pytest.mark.parametrize('names', ['[e1, e2]', '[e1, tunnel]', '[tunnel, e12]'])
def test_words_that_look_like_exponents_are_words(names, read):
    """A thruster may be called e1, which is no number without digits before the e."""
    assert read(f'{HEAD}a: {names}')['a'] == names.strip('[]').split(', ')


@pytest.mark.parametrize('value, problem', [
    ('', 'has no value, must have one (line 3 of FILE)'),
    ('[1, up]', 'is [1, up], must not mix whole numbers and words (line 3 of FILE)'),
    ('[1.0, true, 2.0]', 'is [1.0, true, 2.0], must not mix true or false and real numbers '
                         '(line 3 of FILE)'),
    ('[n, e, s, w]', "is [n, e, s, w], where ROS 2 takes n for false: must be quoted, as in 'n' "
                     '(line 3 of FILE)'),
    ('[x, y, z]', "is [x, y, z], where ROS 2 takes y for true: must be quoted, as in 'y' "
                  '(line 3 of FILE)'),
    ('["n", e, s]', None), ('2024-02-03', None), ('~', None), ('[]', None),
    ('[1, 2.0]', f'is [1, 2.0], {MIXED}'), ('[2.0, 1]', f'is [2.0, 1], {MIXED}'),
    ('[1, 1.0e4]', f'is [1, 1.0e4], {MIXED}')])
def test_a_value_that_ros_cannot_take_is_refused(value, problem, read, refusal):
    """What ROS 2 refuses is refused with the parameter's full name and its place; no more is."""
    if problem is None:
        assert list(read(f'{HEAD}a: {{b: {value}}}')) == ['a.b']
    else:
        assert refusal(f'{HEAD}a: {{b: {value}}}') == f'a.b: {problem}'


def test_a_long_list_is_cut_in_its_message(refusal):
    """A list of thousands of digits spoils no message."""
    message = refusal(f'{HEAD}a: [0x{"f" * 5000}, 1.0]')
    assert message.endswith('...], must not mix real numbers and words (line 3 of FILE)')
    assert len(message) < 200


@pytest.mark.parametrize('content, problem', [
    ('- rate: 5.0', NO_MAP), ('/**:\n', f'/**: {NO_MAP}'), ('ns:\n  - node\n', f'/ns: {NO_MAP}'),
    ('/**:\n  rate: 5.0\n', f'/**/rate: {NO_MAP}'),
    ('/**:\n  ros__parameters:\n', '/**.ros__parameters: is no map, must hold parameters'),
    ('/**:\n  ros__parameters: [1]\n', '/**.ros__parameters: is no map, must hold parameters'),
    ('ros__parameters: {a: 1}\n', 'ros__parameters must stand under the name of a node, and once '
                                  'there'),
    ('/**: {ros__parameters: {a: 1}, x: {ros__parameters: {b: 1}}}\n',
     'x: stands beside ros__parameters, must stand in it, or be the name of a node of its own'),
    ('thrust-allocator: {ros__parameters: {a: 1}}\n', "'thrust-allocator' is no name of a node, "
     'must consist of letters, digits, _ and slashes, or * and ** for any'),
    (HEAD + '? [a]\n    : 1\n', 'has a list where a name must stand, in line 3'),
    (HEAD + '"": 1\n', 'has an empty name in line 3'),
])
def test_a_file_of_another_form_is_refused(content, problem, refusal):
    """A file that does not lead from a node's name to ros__parameters is told where it fails."""
    assert refusal(content) == f'FILE: {problem}'


@pytest.mark.parametrize('content', ['', '5', '~', '{}', '/**: {}\n', b'\xff\xfe'])
def test_a_file_without_a_section_has_nothing(content, refusal):
    """A file that ROS 2 reads but that has no section has nothing for the node."""
    assert refusal(content) == ('FILE: has nothing for the node /thrust_allocator; its top keys '
                                'are none, one must be the name of the node, or /** for every node')


def test_an_empty_map_is_named(refusal):
    """A map without items, behind which ROS 2 reads no further, is named."""
    assert refusal(f'{HEAD}a: {{}}\n    b: 1\n') == 'a: is an empty map, must hold parameters'


@pytest.mark.parametrize('content, problem', [
    (HEAD + 'rate: [1.0,\n', '.*expected .* in line [345]'),
    (HEAD + 'rate: 1.0\n   weight: 2.0\n', '.*expected .* in line 4'),
    ('/**:\n\tros__parameters: {}\n', 'found character .*that cannot start .* in line 2'),
    (HEAD + 'a: &a {b: *a}\n', r'ROS 2 has no aliases such as \*a in line 3'),
    (b'\x00\x01\x02', '.*'), (b'\x7fELF\x02\xff\xfe', '.*'),
], ids=lambda content: repr(content[-20:]))
def test_invalid_yaml_is_refused_in_one_line(content, problem, refusal):
    """What is no YAML is refused with the line if it has one."""
    assert re.fullmatch(f'FILE: is not valid YAML: {problem}', refusal(content))


def test_a_file_that_cannot_be_read_is_refused(tmp_path):
    """A missing file and a directory are refused with the system's reason."""
    for path, reason in ((tmp_path / 'none.yaml', 'No such file or directory'),
                         (tmp_path, 'Is a directory')):
        with pytest.raises(ParameterError) as caught:
            read_parameter_file(path)
        assert str(caught.value) == f'{path}: cannot be read: {reason}'


def test_the_default_file_is_found():
    """MT-2012's file is found and describes five thrusters."""
    path = default_parameter_file()
    assert path.is_file() and path.name == 'mt2012.yaml'
    assert len(read_parameters(read_parameter_file(path)).values['thruster_names']) == 5


def test_the_default_file_is_looked_for_where_it_is_installed(tmp_path, monkeypatch):
    """The installed file comes before the source tree's; with neither, the error says where."""
    data, source = tmp_path / 'data', tmp_path / 'source'
    monkeypatch.delenv('AMENT_PREFIX_PATH', raising=False)
    monkeypatch.setattr(sysconfig, 'get_path', {'data': str(data)}.__getitem__)
    monkeypatch.setattr(parameter_file, '__file__',
                        str(source / 'thrust_allocator' / 'parameters' / 'x.py'))
    with pytest.raises(ParameterError) as caught:
        default_parameter_file()
    share = data / 'share' / 'thrust_allocator'
    assert str(caught.value) == f'mt2012.yaml: is missing from {share}, {source}'
    for place in (source, share):
        (place / 'config').mkdir(parents=True)
        (place / 'config' / 'mt2012.yaml').touch()
        assert default_parameter_file() == place / 'config' / 'mt2012.yaml'


def test_the_default_file_of_a_workspace_comes_first(tmp_path, monkeypatch):
    """Of the workspaces that are sourced, the first that has the file."""
    prefixes = [tmp_path / name for name in ('other', 'overlay', 'underlay')]
    monkeypatch.setenv('AMENT_PREFIX_PATH', ':'.join(map(str, prefixes)))
    assert not default_parameter_file().is_relative_to(tmp_path)
    for prefix in reversed(prefixes[1:]):
        (config := prefix / 'share' / 'thrust_allocator' / 'config').mkdir(parents=True)
        (config / 'mt2012.yaml').touch()
        assert default_parameter_file() == config / 'mt2012.yaml'


@pytest.mark.parametrize('more', [
    '', 'thrust_allocator: {ros__parameters: {water_density: 998}}',
    'thrust_allocator: {ros__parameters: {water_density: 9.98e2, thrusters.up.weight: 0x2}}',
    '/*: {ros__parameters: {wrench_weights: {heave: 50, sway: 1.0e1}, vehicle_frame: flu}}',
    '/thrust_allocator: {ros__parameters: {thrusters: {up: {position: [1, 2, -3]}}}}',
    'other: {ros__parameters: {water_density: 1.0}}',
], ids=['as it is', 'whole', 'exponent', 'wildcard', 'whole list', 'other node'])
def test_ros_reads_the_same_vehicle(more, tmp_path):
    """A node started with a file has the vehicle that this package reads from it."""
    path = tmp_path / 'vehicle.yaml'
    path.write_text(f'{default_parameter_file().read_text()}\n{more}\n')
    context = rclpy.Context()
    rclpy.init(args=['node', '--ros-args', '--params-file', str(path)], context=context)
    try:
        node = ThrustAllocator(context=context)
        node.destroy_node()
    finally:
        context.try_shutdown()
    assert node.vehicle == load_vehicle(path)
