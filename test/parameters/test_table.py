"""Every rule for a vehicle's parameters, and the message that a broken one gets."""

import math
import re

from hypothesis import example, given, settings, strategies as st
import pytest
from support.parameter_values import DOWN, message, PROPELLER, TUNNEL, UP, vehicle
from thrust_allocator.parameters.check import read_parameters
from thrust_allocator.parameters.definition import BY_AUTHORITY
from thrust_allocator.parameters.types import ParameterError

DOFS = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
NAMES = 'a list of one or more different names such as tunnel or FL_2 ([A-Za-z][A-Za-z0-9_]*)'
# What is allowed: text of the message, outermost values allowed, values next to them not
POSITIVE = '(0, 1000000]', [5e-324, 1e6], [0.0]
ALMOST_1 = math.nextafter(1.0, 0.0)
NOT_NEGATIVE = '[0, 1000000]', [0.0, 1e6], []
ANY = '[-1000000, 1000000]', [-1e6, 1e6], []
NUMBERS = {
    'rate': ('(0, 1000]', [5e-324, 1000.0], [0.0]),
    **{f'wrench_weights.{dof}': ('[0.001, 1e+07]', [1e-3, 1e7], [-1e-3]) for dof in DOFS},
    UP + 'critical_angle_min': ('(0, 1.570796]', [5e-324, math.pi / 2], [0.0]),
    UP + 'opposed_floor': ('[0, 1]', [0.0, 1.0], []),
    UP + 'effectiveness': ('[0, 1]', [0.0, 1.0], []),
    'voltage_exponent': ('[0, 3]', [0.0, 3.0], []),
    TUNNEL + 'cutoff': ('[0, 1)', [0.0, ALMOST_1], []),
    **dict.fromkeys(['odometry_timeout', 'nominal_voltage', UP + 'max_rate',
                     UP + 'critical_angle_slope', TUNNEL + 'decay'], NOT_NEGATIVE),
    **dict.fromkeys(['water_density', 'wrench_timeout', 'current_timeout', UP + 'weight',
                     TUNNEL + 'area', *PROPELLER], POSITIVE),
    **dict.fromkeys([UP + 'torque_ratio', UP + 'second_critical_angle_offset',
                     UP + 'second_critical_angle_slope'], ANY),
}
PAIR = '[reverse, forward], each a number in [0, 1000000]'
POINT = '[x, y, z], each a number in [-1000000, 1000000]'
LISTS = {  # text of the message, a good list, and each item's ends
    UP + 'position': (POINT, [1.0, 1.0, 1.0], [(-1e6, 1e6)] * 3),
    UP + 'direction': (POINT + ', not all 0', [1.0, 1.0, 1.0], [(-1e6, 1e6)] * 3),
    UP + 'bollard_thrust': ('[reverse, forward]: a number in [-1e+09, 0] and a number in '
                            '[0, 1e+09], not both 0', [-1.0, 1.0], [(-1e9, 0), (0, 1e9)]),
    UP + 'speed_loss': (PAIR, [1.0, 1.0], [(0, 1e6)] * 2),
    UP + 'opposed_loss': (PAIR, [1.0, 1.0], [(0, 1e6)] * 2),
    UP + 'speed_loss_quadratic': (PAIR, [1.0, 1.0], [(0, 1e6)] * 2),
    'fallback_velocity': (POINT, [1.0, 1.0, 1.0], [(-1e6, 1e6)] * 3),
    'wrench_origin': (POINT, [1.0, 1.0, 1.0], [(-1e6, 1e6)] * 3),
}
FLAGS = ['start_enabled', 'tick_on_wrench', UP + 'enabled']
WORDS = {'vehicle_frame': 'one of frd, flu', 'message_frame': 'one of frd, flu',
         UP + 'model': 'one of propeller, tunnel, fin, constant',
         UP + 'angle_law': 'one of paper, cosine'}
ALLOWED = {
    'thruster_names': NAMES,
    **{name: ('0 or ' if name.startswith('wrench_weights') else '') + f'a number in {interval}'
       for name, (interval, _, _) in NUMBERS.items()},
    **{name: text for name, (text, _, _) in LISTS.items()},
    **WORDS,
    **dict.fromkeys(FLAGS, 'true or false'),
}


def cases(table):
    """Turn (name, value) pairs into parametrize cases with readable ids."""
    return [pytest.param(name, value, id=f'{name}={value!r}'[:70]) for name, value in table]


def outside():
    """Yield every (name, value) just beyond an end of the ranges, and not finite."""
    for name, (_, ends, excluded) in NUMBERS.items():
        beyond = [math.nextafter(max(ends), math.inf)]
        beyond += excluded or [math.nextafter(min(ends), -math.inf)]
        if name.startswith('wrench_weights'):
            beyond += [math.nextafter(1e-3, 0.0)]
        for value in [*beyond, math.nan, math.inf, -math.inf]:
            yield name, value
    for name, (_, good, ends) in LISTS.items():
        for i, (low, high) in enumerate(ends):
            for value in (math.nextafter(low, -math.inf), math.nextafter(high, math.inf),
                          math.nan, math.inf, -math.inf, True, 'x', None, [1.0]):
                yield name, [*good[:i], value, *good[i + 1:]]


def of_wrong_type():
    """Yield (name, value) with values that are no number, no list of the length, or no word."""
    words = ['', 'fast', '1', '1.0', '1.0e', 'e4', '.e4', '1.2.3e4', '0x1', ' 1e0', 'nan', '1e999']
    for name in NUMBERS:
        for value in [*words, True, False, None, [], [1.0], {'a': 1.0}]:
            yield name, value
    for name, (_, good, _) in LISTS.items():
        for value in ['fast', '1.0', True, None, 1.0, [], good[1:], [*good, 1.0], {'a': 1.0}]:
            yield name, value
    for name in WORDS:
        for value in ['', 'FRD', 'propeler', 1, True, None, [], ['frd']]:
            yield name, value
    for name in FLAGS:
        for value in [0, 1, 1.0, 'true', 'false', 'yes', '', None, [], [True], {'a': True}]:
            yield name, value
    for value in ['up', '', True, None, 1, 1.0, [], {'a': 1}]:
        yield 'thruster_names', value


WRONG_SIDES = [(UP + 'direction', [0.0, 0.0, 0.0]), (UP + 'direction', [0, -0.0, 1e-10])] + [
    (UP + 'bollard_thrust', limits)
    for limits in ([68.2, 120.1], [-68.2, -120.1], [120.1, -68.2], [0.0, 0.0], [0, 0])]


@pytest.mark.parametrize('name, value', cases([*outside(), *of_wrong_type(), *WRONG_SIDES]))
def test_a_wrong_value_is_refused(name, value):
    """The message names the parameter, the value and what is allowed."""
    assert message({name: value}) == f'{name}: is {value!r}, must be {ALLOWED[name]}'


@pytest.mark.parametrize('name, value', cases(
    [(name, end) for name, (_, ends, _) in NUMBERS.items() for end in ends]
    + [(name, tuple(row[side] for row in ends)) for name, (_, _, ends) in LISTS.items()
       for side in (0, 1) if name != UP + 'direction']
    + [(f'wrench_weights.{dof}', 0.0) for dof in DOFS]
    + [(name, flag) for name in FLAGS for flag in (True, False)]
    + [('vehicle_frame', 'flu'), ('message_frame', 'frd'), (UP + 'bollard_thrust', (-1e9, 1e9))]))
def test_the_ends_of_a_range_are_allowed(name, value):
    """The outermost values are taken, in lists all at once; one Bollard limit may be 0."""
    given = vehicle({name: value})
    if name.startswith('thrusters.down.propeller.'):  # their product is C, which has its own end
        given |= {one: 1e-9 for one in PROPELLER if one != name}
    if name == 'rate':  # the period has to fit a clock
        given[name] = value = max(value, 1e-9)
    assert read_parameters(given).values[name] == value


@pytest.mark.parametrize('name', [
    'thruster_names', *PROPELLER, TUNNEL + 'area', TUNNEL + 'decay',
    *(f'thrusters.{thruster}.{name}' for thruster in ('up', 'right', 'tunnel')
      for name in ('model', 'position', 'direction', 'bollard_thrust'))])
def test_a_missing_parameter_is_named(name):
    """What is required of each thruster, model, propeller group and the node is asked for."""
    allowed = ALLOWED.get(name) or ALLOWED[UP + name.rpartition('.')[2]]
    assert message(without=[name]) == f'{name}: is missing, must be {allowed}'


@pytest.mark.parametrize('changes, expected', [
    ({DOWN + 'speed_loss': [24.0, 42.2]},
     f'{DOWN}speed_loss: is given together with {DOWN}propeller, must stand alone'),
    ({UP + 'propeller.diameter': 0.2},
     f'{UP}speed_loss: is given together with {UP}propeller, must stand alone'),
    ({DOWN + 'bollard_thrust': [-68.2, 0.0]},
     f'{DOWN}bollard_thrust: is [-68.2, 0.0], must be [reverse, forward] with forward > 0 where '
     'propeller is given; or give speed_loss'),
    ({UP + 'angle_law': 'cosine', UP + 'critical_angle_slope': 0.1},
     f'{UP}critical_angle_slope: is 0.1, must be left out, or 0.2, where angle_law is cosine, '
     'which has no such angle'),
    ({UP + 'angle_law': 'cosine', UP + 'critical_angle_min': 1.2},
     f'{UP}critical_angle_min: is 1.2, must be left out, or 1.0472, where angle_law is cosine, '
     'which has no such angle'),
    ({f'wrench_weights.{dof}': 0 for dof in DOFS},
     'wrench_weights: are all 0, must leave at least one DOF controlled'),
    ({'thruster_names': ['down', 'left', 'up', 'right']},
     'thrusters.tunnel: is not in thruster_names, must be one of down, left, up, right'),
    ({'thrusters.tunell.weight': 1.0},
     'thrusters.tunell: is not in thruster_names, must be one of down, left, up, right, tunnel; '
     'did you mean tunnel?'),
    ({'thruster_names': ['down', 'left', 'up', 'right', 'tunnel', 'stern']},
     'thrusters.stern: is missing, must describe the thruster that thruster_names lists'),
    ({'thruster_names': ['up', 'down', 'up']}, f"thruster_names: has 'up' twice, must be {NAMES}"),
], ids=['speed_loss and propeller', 'speed_loss and part of propeller', 'no forward thrust',
        'a slope without an angle', 'an angle of the other law', 'nothing controlled',
        'not listed', 'misspelt', 'not described', 'twice'])
def test_a_contradiction_is_refused(changes, expected):
    """Values that contradict each other are refused with the name of one of them."""
    assert message(changes) == expected


def test_the_defaults_of_the_other_law_are_no_contradiction():
    """A dump of a vehicle with the law cosine holds them, and starts the same vehicle."""
    changes = {UP + 'angle_law': 'cosine', UP + 'critical_angle_slope': 0.2,
               UP + 'critical_angle_min': 1.0472}
    assert read_parameters(vehicle(changes)).values[UP + 'angle_law'] == 'cosine'


def test_a_propeller_without_loss_is_refused():
    """Without speed_loss and propeller the message offers both."""
    assert message(without=[UP + 'speed_loss']) == (
        f'{UP}speed_loss: is missing, must be {PAIR}; or give {UP}propeller instead')


@pytest.mark.parametrize('entry', ['', '1up', '_up', 'up-1', 'up 1', 'up.1', 'up\n', 'süd',
                                   1, 1.0, True, None, ['up']], ids=repr)
def test_a_malformed_thruster_name_is_refused(entry):
    """A name that is not of the form [A-Za-z][A-Za-z0-9_]* is quoted in the message."""
    assert message({'thruster_names': ['down', entry]}) == (
        f'thruster_names: has the entry {entry!r}, must be {NAMES}')


@pytest.mark.parametrize('name, meant', [
    (UP + 'wieght', UP + 'weight'), (UP + 'speed_los', UP + 'speed_loss'),
    (DOWN + 'propeller.diametr', DOWN + 'propeller.diameter'), (TUNNEL + 'arae', TUNNEL + 'area'),
    ('wrench_weights.surg', 'wrench_weights.surge'), ('wrench_weights.jaw', 'wrench_weights.yaw')])
def test_an_unknown_name_in_a_group_is_refused(name, meant):
    """A misspelt name under thrusters or wrench_weights is refused with the nearest known one."""
    assert message({name: 1.0}) == f'{name}: is no parameter here; did you mean {meant}?'


@pytest.mark.parametrize('name', [
    TUNNEL + 'speed_loss', TUNNEL + 'opposed_floor', TUNNEL + 'propeller.diameter', UP + 'area',
    UP + 'decay', 'thrusters.right.speed_loss', 'thrusters.right.area', 'wrench_weights'])
def test_a_coefficient_of_another_model_is_refused(name):
    """A coefficient that the thruster's model does not have is refused, as is a bare group."""
    assert re.fullmatch(re.escape(name) + r': is no parameter here(; did you mean \S+\?)?',
                        message({name: 1.0}))


def test_a_loss_in_reverse_that_is_scaled_is_a_warning():
    """Nobody has measured it; a thruster that cannot reverse has none."""
    assert read_parameters(vehicle()).warnings == (
        'the speed loss of down in reverse is scaled from the forward one, which is optimistic: '
        'measure it, and give speed_loss instead of propeller',)
    assert read_parameters(vehicle({DOWN + 'bollard_thrust': [0.0, 120.1]})).warnings == ()


@pytest.mark.parametrize('one', [1, '1.0e0', '1e0', '+1.0E+00', '10.0e-1', '.1e1'])
@pytest.mark.parametrize('name', [name for name in (*NUMBERS, *LISTS) if name != TUNNEL + 'cutoff'])
def test_whole_numbers_and_strings_are_reals(name, one):
    """Where a real number is meant, a whole one and 1.0e4 as PyYAML reads it mean the same."""
    first = -1.0 if name == UP + 'bollard_thrust' else 1.0
    plain, other = 1.0, one
    if name in LISTS:
        plain, other = [[first, x, *[0.5] * (len(LISTS[name][1]) - 2)] for x in (1.0, one)]
    expected, value = [read_parameters(vehicle({name: x})).values[name] for x in (plain, other)]
    assert repr(value) == repr(expected)


def test_the_defaults_are_those_documented():
    """What may be left out has its documented value; nothing else is read."""
    required = {UP + 'model': 'propeller', UP + 'position': (1.0, 2.0, 3.0),
                UP + 'direction': (0.0, 1.0, 0.0), UP + 'bollard_thrust': (-1.0, 2.0),
                UP + 'speed_loss': (3.0, 4.0), 'thruster_names': ('up',)}
    parameters = read_parameters(required)
    assert {name: value for name, value in parameters.values.items() if value is not None} == {
        **required, 'rate': 50.0, 'water_density': 1025.0, 'vehicle_frame': 'frd',
        'message_frame': 'flu', 'tick_on_wrench': True, 'start_enabled': True,
        'wrench_timeout': 0.5,
        'odometry_timeout': 0.5, 'current_timeout': 10.0,
        'velocity_time_constant': 0.0, 'fallback_velocity': (0.0, 0.0, 0.0),
        'wrench_origin': (0.0, 0.0, 0.0), 'nominal_voltage': 0.0, 'voltage_exponent': 1.2,
        'stamped_wrench': False, 'velocity_type': 'odometry', 'setpoint_unit': 'newton',
        'publish_individual': False, 'marker_frame': 'base_link',
        **{f'wrench_weights.{dof}': BY_AUTHORITY for dof in DOFS},
        'direction_keeping': 0.0, 'direction_keeping_dofs': DOFS, 'power_limit': 0.0,
        UP + 'bollard_power': (0.0, 0.0),
        UP + 'enabled': True, UP + 'effectiveness': 1.0, UP + 'weight': 1.0,
        UP + 'max_rate': 0.0, UP + 'cutoff': 0.0, UP + 'torque_ratio': 0.0,
        UP + 'critical_angle_slope': 0.2, UP + 'critical_angle_min': math.pi / 3,
        UP + 'second_critical_angle_offset': 0.0,
        UP + 'second_critical_angle_slope': 0.2, UP + 'opposed_loss': (0.0, 0.0),
        UP + 'opposed_floor': 0.85, UP + 'angle_law': 'paper',
        UP + 'speed_loss_quadratic': (0.0, 0.0)}


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary()
    | st.sampled_from(['propeller', 'up']),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=6)


@settings(max_examples=1000, deadline=None)
@given(st.sampled_from([*ALLOWED, 'wrench_weights'])
       | st.text().map(UP.__add__) | st.text(), ANYTHING)
@example('rate', 10**5000)
@example('thrusters.two\nlines.weight', 1.0)
def test_nothing_but_one_line_comes_of_anything(name, value):
    """Whatever a parameter's name and value, the answer is Parameters or a one-line error."""
    try:
        lines = read_parameters(vehicle({name: value})).warnings
    except ParameterError as error:
        lines = [str(error)]
    assert all(len(line.splitlines()) == 1 for line in lines)
