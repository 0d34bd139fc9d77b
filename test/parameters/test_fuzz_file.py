"""Parameter files as they come out of a shredder: a valid vehicle, or one line that says why."""

import copy
import math

from hypothesis import given, settings, strategies as st
import numpy as np
import pytest
from support.processes import NODE, TIMEOUT
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.file import default_parameter_file
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.solve.problem import AllocationProblem
import yaml

TEXT = default_parameter_file().read_text(encoding='utf-8')
DOCUMENT = yaml.safe_load(TEXT)
PARAMETERS = DOCUMENT['/**']['ros__parameters']
HEAD = '/**:\n  ros__parameters:\n    '
WRENCH = np.array([50.0, -20.0, 30.0, 5.0, 40.0, -10.0])  # [N, N*m]
VELOCITY = np.array([0.7, 0.1, -0.2, 0.05, 0.0, 0.1])  # [m/s, rad/s]


def places(node, path=()):
    """Return the path of each key under a node, the node's own groups included."""
    found = []
    for key, value in node.items():
        found.append((*path, key))
        if isinstance(value, dict):
            found += places(value, (*path, key))
    return found


PLACES = places(DOCUMENT)
NAMES = [*sorted({place[-1] for place in PLACES}),
         'wieght', 'RATE', '', 'up.weight', 'use_sim_time']

numbers = st.one_of(
    st.floats(), st.integers(), st.integers(-2**70, 2**70),
    st.sampled_from([0.0, -0.0, 1e-300, 1e300, 5e-324, 1e6, 1e-9, math.nan, math.inf, -math.inf,
                     2**63, -2**63 - 1, '1e4', '1.0e400', '.5e-3', '1_000', '0x10', '1:30']))
scalars = st.one_of(
    numbers, st.booleans(), st.none(), st.text(max_size=20), st.binary(max_size=20), st.dates(),
    st.datetimes(), st.sampled_from([*NAMES, 'propeller', 'tunnel', 'constant', 'frd', 'flu']))
values = st.recursive(
    scalars, lambda inner: st.one_of(
        st.lists(inner, max_size=6), st.dictionaries(st.text(max_size=8), inner, max_size=4),
        st.dictionaries(st.sampled_from(NAMES), inner, max_size=4)), max_leaves=12)
texts = st.text(max_size=100).map(lambda text: text.encode('utf-8', 'replace'))
triples = st.lists(st.one_of(st.floats(-1e6, 1e6), numbers), min_size=2, max_size=3)


def parent_of(document, place):
    """Return the map in which a place stands, or None if an earlier change took it away."""
    for key in place[:-1]:
        document = document.get(key) if isinstance(document, dict) else None
    return document if isinstance(document, dict) and place[-1] in document else None


@st.composite
def mutations(draw):
    """Draw MT-2012's document with one to four of its keys changed, as YAML."""
    document = copy.deepcopy(DOCUMENT)
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.sampled_from(PLACES))
        parent = parent_of(document, place)
        if parent is None:
            continue
        value = parent[place[-1]]
        kind = draw(st.sampled_from(
            ['remove', 'rename', 'retype', 'scale', 'list', 'nest', 'lift', 'move']))
        if kind in ('remove', 'rename', 'move'):
            del parent[place[-1]]
        if kind == 'rename':
            parent[draw(st.one_of(st.sampled_from(NAMES), st.text(max_size=8), scalars))] = value
        elif kind == 'retype':
            parent[place[-1]] = draw(values)
        elif kind == 'scale' and isinstance(value, (float, list)):
            factor = draw(st.sampled_from([-1.0, 0.0, 1e-12, 1e-6, 1e3, 1e12, 1e308]))
            scaled = [factor * one if isinstance(one, float) else one
                      for one in (value if isinstance(value, list) else [value])]
            parent[place[-1]] = scaled if isinstance(value, list) else scaled[0]
        elif kind == 'list':
            parent[place[-1]] = draw(triples)
        elif kind == 'nest':
            parent[place[-1]] = {draw(st.sampled_from(NAMES)): value}
        elif kind == 'lift' and isinstance(value, dict):
            parent.update(value)
        elif kind == 'move':
            target = parent_of(document, draw(st.sampled_from(PLACES)))
            if target is not None:
                target[place[-1]] = value
    return yaml.safe_dump(document, allow_unicode=draw(st.booleans()),
                          default_flow_style=draw(st.booleans())).encode('utf-8', 'replace')


@st.composite
def spliced(draw):
    """Draw MT-2012's text with bytes of any kind put in place of some of its own."""
    text = TEXT.encode()
    start = draw(st.integers(0, len(text)))
    end = start + draw(st.integers(0, 40))
    junk = draw(st.one_of(
        st.binary(max_size=20), texts,
        st.sampled_from([b'\t', b'\r\n', b'\n---\n', b'...\n', b': ', b'- ', b'{', b'[', b'*a',
                         b'&a ', b'!!float ', b'!!binary ', b'!!set ', b'<<: ', b'? ', b'| ',
                         b'> ', b'%YAML 9.9\n', b'\xff\xfe', b'\xef\xbb\xbf', b'#', b'"', b"'",
                         b'@', b'`', b'.nan', b'.inf'])))
    return text[:start] + junk + text[end:]


files = st.one_of(
    mutations(), mutations(), mutations(), spliced(), st.binary(max_size=200), texts,
    values.map(lambda value: f'{HEAD}a: {yaml.safe_dump(value)}'.encode('utf-8', 'replace')))


@pytest.fixture(scope='module')
def path(tmp_path_factory):
    """Return the path that every drawn file is written to in its turn."""
    return tmp_path_factory.mktemp('fuzz') / 'vehicle.yaml'


def vehicle_or_one_line(path):
    """Check that a file describes a vehicle that allocates; else return the line why not."""
    try:
        vehicle = load_vehicle(path)
        problem, bounds = AllocationProblem(vehicle), ThrustBounds(vehicle)
    except ParameterError as error:
        line = str(error)
        assert line.strip() and len(line.splitlines()) == 1, line
        return line
    limits = bounds(VELOCITY)
    assert np.isfinite(limits).all() and (limits[0] <= 0.0).all() and (limits[1] >= 0.0).all()
    thrusts = problem.solve(WRENCH, limits).thrusts
    assert (limits[0] <= thrusts).all() and (thrusts <= limits[1]).all()
    assert all('\n' not in warning for warning in vehicle.warnings())
    return ''


@given(content=files)
@settings(max_examples=1000, deadline=None, derandomize=True)
def test_a_file_is_a_vehicle_or_one_line(content, path):
    """Whatever the file holds, it describes a vehicle that allocates, or one line says why not."""
    path.write_bytes(content)
    assert len(vehicle_or_one_line(path)) < 1000


def edited(old, new):
    """Return MT-2012's file with some text in place of other text, which stands there once."""
    assert TEXT.count(old) == 1
    return TEXT.replace(old, new).encode('utf-8', 'surrogatepass')


NASTY = {
    'binary': b'\x7fELF\x02\x01\x00\xff\xfe',
    'utf-16': TEXT.encode('utf-16'),
    'too deep': b'[' * 20000,
    'deep maps': HEAD.encode() + b'{a: ' * 500 + b'1' + b'}' * 500,
    'huge number': edited('rate: 50.0', 'rate: 1' + 5000 * '0'),
    'huge period': edited('rate: 50.0', 'rate: 1.0e-10'),
    'tiny rate': edited('rate: 50.0', 'rate: 1.0e-320'),
    'many names': edited('[down, left, up, right, tunnel]', str([f't{i}' for i in range(5000)])),
    'empty map': edited('rate: 50.0', 'rate: {}'),
    'empty key': edited('rate: 50.0', "'': 50.0"),
    'newline in a name': edited('      up:\n', '      "u\\np":\n'),
    'zero in a word': edited('message_frame: flu', 'message_frame: "fl\\0u"'),
    'half a character': edited('message_frame: flu', 'message_frame: "\\ud800"'),
    'node name': edited('/**:', '"/n\\n de":'),
    'weights far apart': edited('surge: 10000.0', 'surge: 1.0e7').replace(
        b'bollard_thrust: [-122.0, 122.1]', b'bollard_thrust: [-122.0, 122.1]\n'
        b'        weight: 1.0e-12'),
    'far thruster': edited('[1.20, 0.0, 0.0]', '[1.0e6, 0.0, 0.0]'),
}


@pytest.mark.parametrize('name', NASTY)
def test_nasty_files(name, path):
    """Such a file, too, is a vehicle that allocates, or one line says why not."""
    path.write_bytes(NASTY[name])
    vehicle_or_one_line(path)


def test_nasty_files_through_the_process(launch, tmp_path):
    """The node as a process runs such a file, or ends with one line and status 1."""
    processes = {}
    for name in ('binary', 'too deep', 'newline in a name', 'half a character', 'node name',
                 'huge period', 'far thruster'):
        file = tmp_path / f'{name}.yaml'
        file.write_bytes(NASTY[name])
        processes[name] = launch(*NODE, '--ros-args', '--params-file', file)
    for name, process in processes.items():
        said = []
        while line := process.stderr.readline():
            said.append(line)
            if 'no wrench: zero setpoints' in line:  # its first tick: it runs
                process.terminate()
        stdout = process.communicate(timeout=TIMEOUT)[0]
        runs = any('no wrench: zero setpoints' in line for line in said)
        assert (process.returncode, stdout) == (0 if runs else 1, ''), (name, said)
        if not runs:
            assert len(said) == 1 and said[0].startswith('thrust_allocator: '), (name, said)
