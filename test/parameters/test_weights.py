"""Weights that are left out follow from what the vehicle can give."""

import numpy as np
import pytest
from support.paths import CONFIG
from support.vehicles import described
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.frames import DOFS

POWER = {'bollard_power': [300.0, 400.0]}


def given(name='bluerov2_heavy', **changes):
    """Return a file's values with some changed, full names with '__' for each dot."""
    values = read_parameter_file(CONFIG / f'{name}.yaml')
    return values | {name.replace('__', '.'): value for name, value in changes.items()}


def bare(*thrusters):
    """Return the values of a vehicle of constant thrusters at (x, y, z) along (x, y, z)."""
    values = {'thruster_names': [f't{i}' for i in range(len(thrusters))]}
    for i, (position, direction) in enumerate(thrusters):
        values |= {f'thrusters.t{i}.{key}': value for key, value in {
            'model': 'constant', 'position': position, 'direction': direction,
            'bollard_thrust': [-10.0, 10.0]}.items()}
    return values


def said_of_weights(description):
    """Return the warnings that are about weights."""
    return [line for line in description.warnings if line.startswith('wrench_weights')]


def test_all_left_out_is_a_note():
    """A line for the log says the six of them, and nothing is wrong."""
    description = describe(given())
    assert said_of_weights(description) == []
    line, = description.remarks
    for dof, weight in zip(DOFS, description.vehicle.wrench_weights):
        assert f'{dof} {weight:.4g}' in line
        assert description.parameters.values[f'wrench_weights.{dof}'] == weight


def test_some_left_out_is_a_warning_with_all_six():
    """Those given stay as they are; those left out are as if all were."""
    description = describe(given(wrench_weights__surge=3e3, wrench_weights__roll=2e4))
    weights, alone = description.vehicle.wrench_weights, described('bluerov2_heavy').wrench_weights
    assert (weights[0], weights[3]) == (3e3, 2e4)
    assert [weights[i] for i in (1, 2, 4, 5)] == [alone[i] for i in (1, 2, 4, 5)]
    line, = said_of_weights(description)
    assert line.startswith('wrench_weights: leaves out sway, heave, pitch, yaw; ')
    assert all(f'{dof} {weight:.4g}' in line for dof, weight in zip(DOFS, weights))
    assert description.remarks == ()


def test_what_no_thruster_can_serve_comes_to_zero_and_is_said():
    """Two thrusters along x leave surge and yaw; a warning for each other DOF."""
    description = describe(bare(([0, 1.0, 0], [1.0, 0, 0]), ([0, -1.0, 0], [1.0, 0, 0])))
    weights = description.vehicle.wrench_weights
    assert [bool(weight) for weight in weights] == [True, False, False, False, False, True]
    assert [line.partition(':')[0] for line in said_of_weights(description)] == [
        f'wrench_weights.{dof}' for dof in ('sway', 'heave', 'roll', 'pitch')]


def test_only_zeros_left_is_refused():
    """Where all that thrusters can serve is given as 0, nothing is controlled."""
    with pytest.raises(ParameterError, match='wrench_weights.sway: is left out, must be given'):
        describe(bare(([0, 0, 0], [1.0, 0, 0])) | {'wrench_weights.surge': 0.0})


def test_a_change_keeps_the_weights():
    """They are of the vehicle at start, with all thrusters enabled, whatever changes after."""
    off = describe(given(thrusters__rear_left__enabled=False))
    assert off.vehicle.wrench_weights == described('bluerov2_heavy').wrench_weights
    changed = off.changed({'thrusters.rear_left.bollard_thrust': [-1.0, 1.0],
                           'thrusters.rear_right.enabled': False})
    assert changed.vehicle.wrench_weights == off.vehicle.wrench_weights


def test_explicit_weights_are_no_matter_of_authority():
    """MT-2012 and Delphin2 say all six, and pitch outranks heave."""
    for name in ('mt2012', 'delphin2'):
        description = describe(given(name))
        assert description.remarks == ()
        weights = description.vehicle.wrench_weights
        assert weights[4] == 100.0 * weights[2]


@pytest.mark.parametrize('changes, start', [
    ({'power_limit': 300.0}, 'thrusters.down.bollard_power: is [0.0, 0.0], must be [reverse, '),
    ({'direction_keeping': 1.5}, 'direction_keeping: is 1.5, must be a number in [0, 1]'),
    ({'direction_keeping_dofs': ['surge', 'depth']}, "direction_keeping_dofs: has the entry 'dep"),
    ({'direction_keeping_dofs': ['yaw', 'yaw']}, "direction_keeping_dofs: has 'yaw' twice"),
    ({'direction_keeping_dofs': []}, 'direction_keeping_dofs: is [], must be a list of one or'),
    ({'direction_keeping_dofs': 'yaw'}, "direction_keeping_dofs: is 'yaw', must be a list of one"),
    ({'power_limit': -1.0}, 'power_limit: is -1.0, must be'),
])
def test_refusals(changes, start):
    """One line names the parameter, what it is, and what it must be."""
    with pytest.raises(ParameterError) as refusal:
        describe(read_parameter_file(default_parameter_file()) | changes)
    assert str(refusal.value).startswith(start)


def test_a_vehicle_with_too_many_faces_keeps_no_direction():
    """It is refused with their number; without direction keeping it is as good as any."""
    rng = np.random.default_rng(3)
    values = bare(*((rng.normal(size=3).tolist(), rng.normal(size=3).tolist())
                    for _ in range(16)))
    assert describe(values).vehicle.wrench_weights
    with pytest.raises(ParameterError, match='direction_keeping: is 0.5, must be 0 .*8736 faces'):
        describe(values | {'direction_keeping': 0.5})
