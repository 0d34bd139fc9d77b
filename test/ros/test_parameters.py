"""The node's parameters over ROS: read, changed, refused."""

import numpy as np
import pytest
from rclpy.parameter import Parameter
from support.vehicles import NAMES
from thrust_allocator.parameters.types import ParameterError


def test_parameters_are_readable(start, variant):
    """Every parameter can be read with its value in effect and its type, defaults included."""
    node, _ = start('wrench_timeout:=0.25', file=variant({
        'rate': 20, 'thrusters.up.position': [-2, 0, 0], 'thrusters.up.weight': 2}))
    expected = {
        'rate': 20.0, 'wrench_timeout': 0.25, 'message_frame': 'flu', 'start_enabled': True,
        'odometry_timeout': 0.5, 'current_timeout': 10.0, 'fallback_velocity': [0.0, 0.0, 0.0],
        'thrusters.up.enabled': True, 'thrusters.up.max_rate': 0.0, 'thrusters.up.cutoff': 0.0,
        'wrench_weights.pitch': 1e4, 'wrench_weights.sway': 0.0, 'thruster_names': NAMES,
        'thrusters.up.model': 'propeller', 'thrusters.up.weight': 2.0,
        'thrusters.up.position': [-2.0, 0.0, 0.0], 'thrusters.up.critical_angle_min': np.pi / 3,
        'thrusters.down.bollard_thrust': [-68.2, 120.1], 'thrusters.tunnel.decay': 7.0}
    for name, value in expected.items():
        found = node.get_parameter(name)
        assert found.type_ == Parameter(name, value=value).type_
        assert (list(found.value) if isinstance(value, list) else found.value) == value


def test_enabled_can_be_changed(start):
    """A thruster's `enabled` takes true and false, and reads as what it is."""
    node, _ = start()
    for value in (False, True):
        result, = node.set_parameters([Parameter('thrusters.up.enabled', value=value)])
        assert result.successful
        assert node.get_parameter('thrusters.up.enabled').value is value


@pytest.mark.parametrize('rule, named', [
    ('rate:=-1.0', r'rate: is -1.0, must be .*\(0, 1000\]'),
    ('wrench_weights.swai:=1.0', r'wrench_weights.swai: .*wrench_weights.sway'),
    ('odometry_timeout:=-0.5', r'odometry_timeout: is -0.5, must be .*\[0, 1000000\]'),
    ('start_enabled:=1', 'start_enabled: is 1, must be true or false'),
    ('thrusters.up.cutoff:=1.0', r'thrusters.up.cutoff: is 1.0, must be .*\[0, 1\)'),
    ('thrusters.stern.weight:=1.0', r'thrusters.stern: is not in thruster_names')])
def test_a_mistake_in_the_parameters(start, rule, named):
    """The constructor raises ParameterError, which names the parameter."""
    with pytest.raises(ParameterError, match=named):
        start(rule)


def test_no_parameters_for_this_node(start, variant):
    """If the file has nothing for this node, the error asks about its top key."""
    file = variant({}, top_key='/other/thrust_allocator')
    with pytest.raises(ParameterError,
                       match='thruster_names: .*top key.* /alpha/thrust_allocator'):
        start(file=file, remap='__ns:=/alpha')


def test_what_a_user_should_know_is_logged_at_the_start(start, variant, capfd):
    """A controlled DOF that no thruster acts on is a WARN on stderr before the first tick."""
    start(file=variant({'wrench_weights.roll': 100.0}))
    said, = [line for line in capfd.readouterr().err.splitlines() if 'roll' in line]
    assert '[WARN]' in said and 'no thruster can act on roll' in said
