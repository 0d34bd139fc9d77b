"""What `ros2 param describe` says of the running node, and that doc/parameters.md says the same."""

import json
import re

import pytest
from rclpy.parameter import parameter_value_to_python, Parameter
from support.documents import shown
from support.paths import ROOT
from thrust_allocator.parameters.file import is_of_every_node
from thrust_allocator.parameters.models import MODEL_PARAMETERS
from thrust_allocator.parameters.table import NODE, THRUSTER
from thrust_allocator.parameters.types import Real

DOCUMENT = ROOT / 'doc/parameters.md'
UNITS = {'Hz', 'V', 'W', 'kg/m^3', 's', 'm/s', 'm', 'N', 'N/s or rad/s', 'N*s/m', 'N*s^2/m^2',
         'rad', '1/rad', 'rad*s/m', 'rev/s', 'm^2'}
PLACE = {'position': [0.0, 0.0, 0.0], 'direction': [1.0, 0.0, 0.0], 'bollard_thrust': [-1.0, 1.0]}
BARE = {  # one thruster of each description, with nothing given that has a default
    'measured': PLACE | {'model': 'propeller', 'speed_loss': [1.0, 1.0]},
    'computed': PLACE | {'model': 'propeller', 'propeller': {
        'diameter': 0.1, 'max_revolutions': 10.0, 'thrust_slope': 0.5}},
    'tunnel': PLACE | {'model': 'tunnel', 'area': 0.1, 'decay': 1.0},
    'constant': PLACE | {'model': 'constant'},
    'fin': {'model': 'fin', 'position': [0.0, 0.0, 0.0], 'direction': [0.0, 1.0, 0.0],
            'chord': [1.0, 0.0, 0.0], 'fin_area': 0.01, 'lift_slope': 3.0, 'max_deflection': 0.5,
            'cut_in_speed': 0.5}}


@pytest.fixture
def described(stepped, tmp_path):
    """Return (descriptor, value) by the name in the table, of a node with defaults only."""
    path = tmp_path / 'bare.yaml'
    path.write_text(json.dumps({'/**': {'ros__parameters': {  # also YAML
        'thruster_names': list(BARE), 'thrusters': BARE}}}), encoding='utf-8')
    one = stepped('tick_on_wrench:=true', file=path)
    client = one._parameters
    names = sorted(name for name in one._result(client.list_parameters([], 0)).result.names
                   if not is_of_every_node(name))
    descriptors = one._result(client.describe_parameters(names)).descriptors
    values = one._result(client.get_parameters(names)).values
    found = {}
    for name, descriptor, value in zip(names, descriptors, values):
        assert descriptor.name == name
        short = re.sub(r'^thrusters\.[a-z]+\.', '', name)
        # `stepped` sets message_frame
        plain = 'flu' if name == 'message_frame' else parameter_value_to_python(value)
        found.setdefault(short, []).append((descriptor, plain))
    return found


@pytest.fixture
def rows():
    """Return the rows of the document's tables by name: allowed, unit, default, live, meaning."""
    lines = re.findall(r'^\| `(.*?)` \| (.*) \|$', DOCUMENT.read_text('utf-8'), re.M)
    assert len(lines) == len(dict(lines))
    return {name: rest.split(' | ') for name, rest in lines}


def test_the_document_describes_the_running_node(described, rows):
    """Each declared parameter has its row, which says what the node says, and there is no other."""
    assert set(rows) == set(described)
    for name, (allowed, unit, default, live, meaning) in rows.items():
        for descriptor, value in described[name]:
            assert descriptor.description == meaning + ('' if unit == '–' else f' [{unit}]')
            assert descriptor.additional_constraints == allowed
            assert descriptor.read_only == (live == 'no')
            assert descriptor.type == Parameter(name, value=value).type_.value
            assert not descriptor.dynamic_typing
            if default not in ('required', 'by authority'):
                value = value if isinstance(value, (bool, float, str)) else tuple(value)
                assert shown(value) == default, name


def test_units(rows):
    """Every unit is one that is known; what has none is a count, a choice or a ratio."""
    assert {unit for _, unit, *_ in rows.values()} == UNITS | {'–'}
    for name, (allowed, unit, *_) in rows.items():
        assert unit == '–' or 'number' in allowed, name


def test_ranges(described):
    """A scalar has the range of its table entry for a slider, and nothing else has one."""
    ranges = {one.name: one.type for one in (
        *NODE, *THRUSTER, *(one for model in MODEL_PARAMETERS.values() for one in model.all))
        if isinstance(one.type, Real)}
    for name, found in described.items():
        for descriptor, value in found:
            assert descriptor.integer_range == []
            if name in ranges:
                span, = descriptor.floating_point_range
                low = 0.0 if ranges[name].or_zero else ranges[name].low
                assert (span.from_value, span.to_value, span.step) == (low, ranges[name].high, 0.0)
                assert span.from_value <= value <= span.to_value
            else:
                assert len(descriptor.floating_point_range) == 0
    assert {'rate', 'water_density', 'weight', 'cutoff', 'critical_angle_min'} <= set(ranges)


def test_every_parameter_says_what_is_allowed(described):
    """A description and a constraint in words stand with every parameter."""
    for name, found in described.items():
        for descriptor, _ in found:
            assert descriptor.description and descriptor.additional_constraints, name
