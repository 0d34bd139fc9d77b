"""`ros2 param dump` of a running vehicle is a file that starts the same vehicle."""

import pytest
from rcl_interfaces.msg import ParameterType
from rclpy.parameter import parameter_value_to_python
from support.live_parameters import change
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
import yaml

FILES = sorted(default_parameter_file().parent.glob('*.yaml'))
NAME = '/alpha/beta/thrust_allocator'
PROPELLER = {
    'model': 'propeller', 'position': [-1.88, 0.0, -0.23], 'direction': [0.92, 0.0, 0.38],
    'bollard_thrust': [-68.2, 120.1], 'weight': 1e-05, 'max_rate': 1e6,
    'propeller': {'diameter': 0.2, 'max_revolutions': 15.13, 'thrust_slope': 0.34}}


def dump(one):
    """Return the text that `ros2 param dump` writes of the node, read over its services."""
    client = one._parameters
    names = one._result(client.list_parameters([], 0)).result.names
    parameters = {}
    for name in sorted(names):
        value, = one._result(client.get_parameters([name])).values
        if value.type == ParameterType.PARAMETER_NOT_SET:
            continue
        *groups, last = name.split('.')
        place = parameters
        for group in groups:
            place = place.setdefault(group, {})
        found = parameter_value_to_python(value)
        place[last] = list(found) if value.type >= ParameterType.PARAMETER_BYTE_ARRAY else found
    return yaml.dump({NAME: {'ros__parameters': parameters}}, default_flow_style=False)


def vehicle(values):
    """Return the vehicle that a file's values describe."""
    return describe(values).vehicle


def assert_round_trip(one, start, path):
    """Dump a node, and check the file and a node that is started with it."""
    path.write_text(dump(one), encoding='utf-8')
    read = read_parameter_file(path, NAME)
    assert vehicle(read) == one.node.vehicle
    again, _ = start(file=path, remap='__ns:=/alpha/beta')
    assert again.vehicle == one.node.vehicle
    both = [{name: parameter.get_parameter_value() for name, parameter in
             node.get_parameters_by_prefix('').items()} for node in (one.node, again)]
    assert both[0] == both[1]


@pytest.mark.parametrize('file', FILES, ids=lambda file: file.stem)
def test_every_vehicle_of_the_package(stepped, start, tmp_path, file):
    """A dump of each file in config/ gives the same vehicle and parameters again."""
    one = stepped(file=file, remap='__ns:=/alpha/beta')
    text = dump(one)
    for of_every_node in ('use_sim_time: true', 'start_type_description_service:'):
        assert of_every_node in text
    assert_round_trip(one, start, tmp_path / 'dump.yaml')
    assert one.node.vehicle == vehicle(read_parameter_file(file, NAME))


@pytest.mark.parametrize('changes', [
    {'thrusters.up': PROPELLER}, {'thrusters.up.enabled': False, 'vehicle_frame': 'flu'},
    {'rate': 1e-05, 'thrusters.tunnel.area': 5e-324, 'wrench_timeout': 123456.789012345},
    {'thruster_names': ['on'], 'thrusters': {'on': {
        'model': 'constant', 'position': [0.0, 0.0, 0.0], 'direction': [0.0, 1.0, 0.0],
        'bollard_thrust': [-1.0, 1.0]}}}])
def test_other_vehicles(stepped, start, variant, tmp_path, changes):
    """So does one with propeller data, in flu axes, with odd numbers or names."""
    assert_round_trip(stepped(file=variant(changes), remap='__ns:=/alpha/beta'), start,
                      tmp_path / 'dump.yaml')


def test_what_was_tuned_live_is_dumped(stepped, start, tmp_path):
    """The dump holds what is in force, not what the node was started with."""
    one = stepped(remap='__ns:=/alpha/beta')
    changes = {'rate': 25, 'wrench_weights.heave': '1.0e3', 'thrusters.up.weight': 2.5,
               'thrusters.down.bollard_thrust': [-10, 20], 'thrusters.tunnel.enabled': False}
    assert all(successful for successful, _ in change(one, changes))
    assert_round_trip(one, start, tmp_path / 'dump.yaml')
    tunnel = one.node.vehicle.thrusters[4]
    assert not tunnel.enabled and one.node.vehicle.thrusters[0].bollard_thrust == (-10.0, 20.0)


def test_names_of_every_node_are_passed_over(stepped, start, tmp_path):
    """Settings that ROS gives every node stand in a dump, and are no parameters of a vehicle."""
    one = stepped(remap='__ns:=/alpha/beta')
    document = yaml.safe_load(dump(one))
    document[NAME]['ros__parameters']['qos_overrides'] = {
        '/clock': {'subscription': {'depth': 1, 'reliability': 'best_effort'}}}
    path = tmp_path / 'dump.yaml'
    path.write_text(yaml.dump(document), encoding='utf-8')
    description = describe(read_parameter_file(path, NAME))
    assert description.warnings == [] and description.vehicle == one.node.vehicle
    again, _ = start(file=path, remap='__ns:=/alpha/beta')
    assert again.vehicle == one.node.vehicle


@pytest.mark.parametrize('velocity_type', ['twist', 'twist_with_covariance'])
def test_a_vehicle_without_a_current(start, velocity_type):
    """With a twist for the velocity there is no current_timeout to dump, so the file starts."""
    node, _ = start(f'velocity_type:={velocity_type}')
    assert not node.has_parameter('current_timeout')
    values = {name: one.value for name, one in node.get_parameters_by_prefix('').items()
              if name not in ('use_sim_time', 'start_type_description_service')}
    assert vehicle(values) == node.vehicle
