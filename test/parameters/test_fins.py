"""The rules for the parameters of a fin, and the messages that broken ones get."""

import pytest
from support.parameter_values import message, vehicle
from thrust_allocator.parameters.check import read_parameters

FIN = {f'thrusters.fin.{name}': value for name, value in {
    'model': 'fin', 'position': [-1.5, 0.0, 0.0], 'direction': [0.0, 0.6, 0.8],
    'chord': [2.0, 0.0, 0.0], 'fin_area': 0.01, 'lift_slope': 3.0, 'max_deflection': 0.5,
    'cut_in_speed': 0.5}.items()}
FIN['thruster_names'] = ['down', 'left', 'up', 'right', 'tunnel', 'fin']


def test_the_defaults_of_a_fin():
    """It may turn as fast as it will, weighs 1, and has nothing left astern."""
    values = read_parameters(vehicle(FIN)).values
    own = {name: value for name, value in values.items() if name.startswith('thrusters.fin.')}
    assert {name: own[name] for name in own if name not in FIN} == {
        'thrusters.fin.astern_share': 0.0, 'thrusters.fin.max_rate': 0.0,
        'thrusters.fin.weight': 1.0, 'thrusters.fin.enabled': True,
        'thrusters.fin.effectiveness': 1.0}


@pytest.mark.parametrize('name, value, said', [
    ('bollard_thrust', [-1.0, 1.0], 'is given, must be left out: a fin has no thrust at rest; its '
     'limits follow from fin_area, lift_slope and max_deflection'),
    ('cutoff', 0.1, 'is given, must be left out: a fin has no thrust at rest that it could be a '
     'share of; cut_in_speed takes it out'),
    ('torque_ratio', 0.1, 'is given, must be left out: a fin has no propeller'),
    ('chord', [1.0, 1.0, 0.0],
     'is [1.0, 1.0, 0.0], must be at right angles to direction, [0.0, 0.6, 0.8]'),
    ('chord', [0.0, 0.0, 0.0], 'is [0.0, 0.0, 0.0], must be [x, y, z], each a number in '
     '[-1000000, 1000000], not all 0'),
    ('fin_area', 0.0, 'is 0.0, must be a number in (0, 1000000]'),
    ('fin_area', 1e6, 'is 1000000.0, must be such that the lift at 1 m/s is at most 1e+06 N/rad'),
    ('lift_slope', 0.0, 'is 0.0, must be a number in (0, 1000000]'),
    ('max_deflection', 0.0, 'is 0.0, must be a number in (0, 1.570796]'),
    ('max_deflection', 1.571, 'is 1.571, must be a number in (0, 1.570796]'),
    ('cut_in_speed', 0.0, 'is 0.0, must be a number in (0, 1000000]'),
    ('astern_share', 1.1, 'is 1.1, must be a number in [0, 1]'),
    ('max_rate', -1.0, 'is -1.0, must be a number in [0, 1000000]'),
    ('chords', 1.0, 'is no parameter here; did you mean thrusters.fin.chord?')],
    ids=lambda value: str(value)[:20])
def test_what_a_fin_cannot_have(name, value, said):
    """Each is refused by name, what only other models have with the words for what it has."""
    assert message(FIN | {f'thrusters.fin.{name}': value}) == f'thrusters.fin.{name}: {said}'


@pytest.mark.parametrize('name', ['chord', 'fin_area', 'lift_slope', 'max_deflection',
                                  'cut_in_speed'])
def test_what_a_fin_must_have(name):
    """A fin without one of them is refused; without bollard_thrust it is not."""
    name = f'thrusters.fin.{name}'
    assert message({key: value for key, value in FIN.items() if key != name}).startswith(
        f'{name}: is missing, must be ')
