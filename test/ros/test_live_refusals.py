"""Parameters that the running node refuses, with the reason, and batches that are one change."""

import re

import numpy as np
from numpy.testing import assert_array_equal
import pytest
from rclpy.parameter import Parameter
from support.live_parameters import AHEAD, change, expected, GENTLE, TWIST, UP
from support.peer import TYPES_OUT
from thrust_allocator.parameters.models import MODEL_PARAMETERS
from thrust_allocator.parameters.table import NODE, THRUSTER

DOWN, TUNNEL = 'thrusters.down.', 'thrusters.tunnel.'
READ_ONLY = {  # what shapes the node, and rclpy's own
    'thruster_names': ['down', 'left', 'up', 'right', 'tunnel'], 'vehicle_frame': 'flu',
    'message_frame': 'flu', 'start_enabled': False, UP + 'model': 'constant',
    UP + 'position': [0.0, 0.0, 0.0], UP + 'direction': [1.0, 0.0, 0.0], UP + 'torque_ratio': 0.1,
    'stamped_wrench': True, 'velocity_type': 'twist', 'setpoint_unit': 'bollard_newton',
    'use_sim_time': False, 'start_type_description_service': False}


def assert_refused(one, changes, reason, atomically=False):
    """Refuse a change with a reason, and go on as if nothing had been: to the bit."""
    one.steps(2, AHEAD, TWIST)
    before, values = one.step(), one.node.get_parameters(list(values_of(one)))
    (successful, said), = change(one, changes, atomically)
    after = one.step()
    assert not successful and re.search(reason, said), f'{changes}: {said}'
    for topic in TYPES_OUT:
        assert before[topic].tobytes() == after[topic].tobytes(), topic
    assert [value.value for value in values] == [
        value.value for value in one.node.get_parameters([value.name for value in values])]


def values_of(one):
    """Return all parameters of the node by name."""
    return one.node.get_parameters_by_prefix('')


WRONG = [
    ('rate', 0.0, r'rate: is 0.0, must be a number in \(0, 1000\]'),
    ('rate', -1.0, r'rate out of range .*0.0.*1000.0.*-1.0'),
    ('rate', 1001, r'rate out of range'), ('rate', '2.0e3', r'rate out of range'),
    ('rate', float('nan'), 'rate out of range'),
    ('rate', 1e-300, 'rate: is 1e-300, must be large enough'),
    ('rate', 'fast', "expected 'Type.DOUBLE' got 'Type.STRING'"),
    ('rate', True, "expected 'Type.DOUBLE' got 'Type.BOOL'"),
    ('rate', [50.0], "expected 'Type.DOUBLE' got 'Type.DOUBLE_ARRAY'"),
    ('rate', None, 'cannot be undeclared'),
    ('water_density', 0.0, 'water_density: is 0.0'), ('wrench_timeout', 0, 'wrench_timeout: is'),
    ('odometry_timeout', -1e-9, 'odometry_timeout out of range'),
    ('fallback_velocity', [1.0, 0.0], r'fallback_velocity: is \[1.0, 0.0\], must be \[x, y, z\]'),
    ('fallback_velocity', [1.0, 0.0, float('inf')], 'fallback_velocity: is'),
    ('wrench_weights.heave', 1e-4, 'wrench_weights.heave: is 0.0001, must be 0 or a number in'),
    ('wrench_weights.heave', 1.1e7, 'wrench_weights.heave out of range'),
    (UP + 'weight', 0.0, 'thrusters.up.weight: is 0.0'),
    (UP + 'bollard_thrust', [68.2, 120.1], r'bollard_thrust: is \[68.2, 120.1\], must be'),
    (UP + 'bollard_thrust', [0.0, 0.0], 'bollard_thrust: is .*not both 0'),
    (UP + 'bollard_thrust', ['a', 'b'], "got 'Type.STRING_ARRAY'"),
    (UP + 'speed_loss', [-1.0, 1.0], 'speed_loss: is'),
    (UP + 'critical_angle_min', 1.6, 'critical_angle_min out of range'),
    (UP + 'opposed_floor', 1.01, 'opposed_floor out of range'),
    (UP + 'cutoff', 1.0, r'cutoff: is 1.0, must be a number in \[0, 1\)'),
    (UP + 'max_rate', -1.0, 'max_rate out of range'),
    (UP + 'enabled', 1, "expected 'Type.BOOL' got 'Type.INTEGER'"),
    (UP + 'enabled', 'false', "got 'Type.STRING'"),
    ('marker_frame', 'two words', "marker_frame: is 'two words', must be a word"),
    ('rte', 50.0, r"undeclared parameter.*'rte'"),
    (UP + 'wieght', 1.0, r"undeclared parameter.*'thrusters.up.wieght'"),
    (UP + 'decay', 1.0, r"undeclared parameter.*'thrusters.up.decay'"),
    ('qos_overrides./x.depth', 1, 'undeclared parameter'),
    (UP + 'weight', 1e-12, 'wrench_weights: are .*beyond double precision'),
    (UP + 'weight', 5e-324, 'wrench_weights: are .*beyond double precision'),
    (UP + 'weight', 1e-310, 'wrench_weights: are .*beyond double precision'),
]


@pytest.mark.parametrize('atomically', [False, True])
def test_a_wrong_value(stepped, atomically):
    """A value out of range, of the wrong type or for no parameter is refused; nothing changes."""
    one = stepped()
    for name, value, reason in WRONG:
        assert_refused(one, {name: value}, reason, atomically)


def test_what_is_read_only_says_so(stepped):
    """Each parameter that shapes the node at start is refused as read-only, by name."""
    one = stepped()
    for name, value in READ_ONLY.items():
        assert_refused(one, {name: value}, 'read-only')
        assert_refused(one, {'rate': 100.0, name: value}, 'read-only', atomically=True)


def test_nothing_else_is_read_only():
    """The table has no read-only parameter beyond these."""
    table = (*NODE, *THRUSTER, *(one for model in MODEL_PARAMETERS.values() for one in model.all))
    fixed = {one.name for one in table if not one.live}
    assert fixed < {name.removeprefix(UP) for name in READ_ONLY} | {'chord'}  # test_fins has it


def test_what_contradicts_the_vehicle(stepped, variant):
    """A value good in itself is refused if the whole would then describe no vehicle."""
    one = stepped(file=variant({'thrusters.up': {
        'model': 'propeller', 'position': [-1.88, 0.0, -0.23], 'direction': [0.92, 0.0, 0.38],
        'bollard_thrust': [-68.2, 120.1],
        'propeller': {'diameter': 0.2, 'max_revolutions': 15.13, 'thrust_slope': 0.34}}}))
    assert_refused(one, {UP + 'bollard_thrust': [-68.2, 0.0]},
                   'thrusters.up.bollard_thrust: .*where propeller is given')
    assert_refused(one, {UP + 'propeller.diameter': 1000.0},
                   'thrusters.up.propeller: is .*speed_loss is at most')
    assert_refused(one, {UP + 'speed_loss': [24.0, 42.2]}, 'undeclared')


def test_ill_conditioned_weights(stepped):
    """Weights beyond double precision are refused before they harm anything."""
    one = stepped()
    assert_refused(one, {UP + 'weight': 1e-9, 'wrench_weights.pitch': 1e7},
                   'wrench_weights: are .*beyond double precision, must be at most [0-9.e+]+, '
                   'or every thruster must weigh at least',
                   atomically=True)


ONE_DOF = {f'wrench_weights.{dof}': 0.0 for dof in ('surge', 'heave', 'roll', 'yaw')}


def test_a_batch_is_one_change(stepped, variant):
    """Two values that are only valid together are refused one by one and taken atomically."""
    one = stepped(file=variant(ONE_DOF))
    both = {'wrench_weights.pitch': 0.0, 'wrench_weights.heave': 1000.0}
    assert_refused(one, {'wrench_weights.pitch': 0.0}, 'wrench_weights: are all 0')
    one.step(GENTLE)
    assert change(one, both, atomically=True) == [(True, '')]
    after = one.step()
    limits, setpoints = expected(variant(ONE_DOF | both), GENTLE, TWIST)
    np.testing.assert_allclose(after['thruster_setpoints'], setpoints, atol=1e-6)


def test_a_batch_is_all_or_nothing(stepped):
    """One mistake anywhere in an atomic batch, and none of it is in force."""
    one, good = stepped(), {UP + 'enabled': False, 'wrench_weights.heave': 5.0,
                            TUNNEL + 'decay': 0.5}
    for name, value, reason in (
            (UP + 'opposed_floor', 2.0, 'opposed_floor out of range'),
            ('rate', 0.0, 'rate: is 0.0'), ('rte', 1.0, 'undeclared'),
            (UP + 'model', 'tunnel', 'read-only'), (DOWN + 'weight', 'x', 'Wrong parameter type')):
        assert_refused(one, {**good, name: value}, reason, atomically=True)
        assert_refused(one, {name: value, **good}, reason, atomically=True)


def test_one_by_one_the_good_ones_count(stepped, variant):
    """Of a set that is not atomic, the good ones are in force and each bad one has its reason."""
    one = stepped()
    one.step(AHEAD, TWIST)
    answers = change(one, {UP + 'weight': 2.0, 'rate': 0.0, TUNNEL + 'decay': 3.0})
    assert [successful for successful, _ in answers] == [True, False, True]
    assert 'rate: is 0.0' in answers[1][1]
    after = one.step()
    limits, setpoints = expected(
        variant({UP + 'weight': 2.0, TUNNEL + 'decay': 3.0}), AHEAD, TWIST)
    np.testing.assert_allclose(after['thrust_limits'], limits, atol=1e-12)
    np.testing.assert_allclose(after['thruster_setpoints'], setpoints, atol=1e-6)


def test_an_empty_batch_and_a_repeated_name(stepped):
    """An atomic set of nothing changes nothing, and of two values for one name the last counts."""
    one = stepped()
    assert_refused(one, {}, 'empty', atomically=True)
    result, = one.set_parameters_of_node(
        [Parameter('rate', value=10.0), Parameter('rate', value=50.0)], atomically=True)
    assert result.successful
    before = one.step()
    assert_array_equal(one.step()['thruster_setpoints'], before['thruster_setpoints'])
