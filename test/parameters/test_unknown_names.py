"""Names that are no parameters: whose they may be, which are slips, and which are to come."""

import pytest
from thrust_allocator.parameters.check import read_parameters
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.parameters.spelling import is_slip
from thrust_allocator.parameters.types import ParameterError

MT2012_VALUES = {'start_enabled': True, 'fallback_velocity': [0.0, 0.0, 0.0],
                 **read_parameter_file(default_parameter_file())}


def refusal(changes, own=(), without=()):
    """Return the message with which MT-2012 is refused with other values."""
    given = {name: value for name, value in MT2012_VALUES.items() if name not in without}
    with pytest.raises(ParameterError) as caught:
        read_parameters({**given, **changes}, own)
    return str(caught.value)


def test_foreign_names_are_one_warning():
    """Names that no other node would hold against us are ignored, and said so in one line."""
    foreign = ['kp', 'zzz', 'camera.fps', 'use_filter']
    parameters = read_parameters({**MT2012_VALUES, **dict.fromkeys(foreign, [])})
    assert parameters.warnings == (
        'camera.fps, kp, use_filter, zzz: no parameter of this node, ignored',)
    assert parameters.values == read_parameters(MT2012_VALUES).values
    assert read_parameters(MT2012_VALUES).warnings == ()


def test_many_foreign_names_do_not_make_a_long_line():
    """Of more than twelve names the first twelve are said."""
    line, = read_parameters(MT2012_VALUES | {f'zzzzz{i:03}': 1 for i in range(300)}).warnings
    assert line.startswith('zzzzz000, zzzzz001, ') and 'zzzzz011, ...: no ' in line


@pytest.mark.parametrize('name, meant, without', [
    ('start_enable', 'start_enabled', ['start_enabled']),
    ('wrench_weight.surge', 'wrench_weights.surge', ['wrench_weights.surge']),
    ('rat', 'rate', ['rate']), ('rates', 'rate', ['rate']), ('rite', 'rate', ['rate']),
    ('fallback_velosity', 'fallback_velocity', ['fallback_velocity']),
    ('falback_velosity', 'fallback_velocity', ['fallback_velocity']),
    ('setpoints_unit', 'setpoint_unit', []), ('Rate', 'rate', ['rate'])])
def test_a_slip_is_refused(name, meant, without):
    """A name one letter off a known one that is not given, two off a long one, is meant for us."""
    assert refusal({name: 1.0}, without=without) == (
        f'{name}: is no parameter here; did you mean {meant}?')


def test_a_slip_of_a_group_is_refused():
    """So is one of a group's name, whatever it holds."""
    weights = [name for name in MT2012_VALUES if name.startswith('wrench_weights.')]
    for name in ('wrench_weight', 'wrench_wieghts'):
        assert refusal({name: 1.0}, without=weights).startswith(f'{name}: is no parameter here')


@pytest.mark.parametrize('name, without', [
    ('rates', []),  # rate is given: no slip of it
    ('rt', ['rate']), ('raet', ['rate']),  # two letters off four
    ('fabak_velocity', ['fallback_velocity']), ('frame', []), ('a', [])])
def test_what_is_no_slip_is_another_nodes(name, without):
    """A name farther off, or off one that is given itself, is ignored with a warning."""
    given = {key: value for key, value in MT2012_VALUES.items() if key not in without}
    line, = read_parameters({**given, name: 1.0}).warnings
    assert line == f'{name}: no parameter of this node, ignored'


@pytest.mark.parametrize('name, known, slip', [
    ('abcdefgh', 'abcdefgh', True), ('abcdefg', 'abcdefgh', True), ('bcdefg', 'abcdefgh', True),
    ('xbcdefgy', 'abcdefgh', True), ('abdcefgh', 'abcdefgh', True), ('bcdef', 'abcdefgh', False),
    ('abcdefg', 'abcdxfg', True), ('abxdefx', 'abcdefg', False), ('', 'a', True), ('', 'ab', False),
    ('aab', 'ab', True), ('ab', 'aab', True), ('ba', 'ab', False), ('abcabcab', 'abcab', False)])
def test_edit_distance(name, known, slip):
    """One letter put in, taken out or exchanged; two where the known name has eight or more."""
    assert is_slip(name, [known]) is slip


@pytest.mark.parametrize('name', ['kp', 'zzz', 'rates'])
def test_any_unknown_name_of_our_own_is_refused(name):
    """A name given for this node alone, or by -p, is nobody else's."""
    assert refusal({name: 1.0}, own=[name]).startswith(f'{name}: is no parameter here')


@pytest.mark.parametrize('names', [['FL', 'T1', 'up', 'aB_9']])
def test_upper_case_names(names):
    """Thrusters may be called FL or T1."""
    given = {'thruster_names': names}
    for name in names:
        given |= {f'thrusters.{name}.model': 'constant', f'thrusters.{name}.position': [0.0] * 3,
                  f'thrusters.{name}.direction': [1.0, 0.0, 0.0],
                  f'thrusters.{name}.bollard_thrust': [-1e9, 1e9]}
    assert list(read_parameters(given).values['thruster_names']) == names


def test_names_that_ros_takes_for_booleans():
    """A list of y, n and the like, all booleans to ROS, says that they must be quoted."""
    message = refusal({'thruster_names': [False, True]})
    assert message.startswith('thruster_names: is [False, True], must be a list')
    assert message.endswith("they must be quoted, as in 'n'")
