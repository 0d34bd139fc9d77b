"""The vehicle: its configuration matrix, its frames, C from propeller data, and its warnings."""

from dataclasses import FrozenInstanceError
import math

from hypothesis import assume, given, settings, strategies as st
import numpy as np
import pytest
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.check import read_parameters
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.models import Constant, MODELS
from thrust_allocator.physics.vehicle import Thruster, Vehicle

DOFS = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
COLUMNS = {  # physics: x forward, y starboard, z down; thrust axes meet the hull axis ahead
    'down': (0.9239, 0.0, -0.3827, 0.0, -0.5070, 0.0),
    'left': (0.9239, 0.3827, 0.0, 0.0, 0.0, -0.5070),
    'up': (0.9239, 0.0, 0.3827, 0.0, 0.5070, 0.0),
    'right': (0.9239, -0.3827, 0.0, 0.0, 0.0, 0.5070),
    'tunnel': (0.0, 0.0, 1.0, 0.0, -1.2, 0.0),
}
coordinate = st.floats(-10.0, 10.0)
point = st.tuples(coordinate, coordinate, coordinate)


def mt2012():
    """Return MT-2012's values as the file gives them."""
    return read_parameter_file(default_parameter_file())


def build(values):
    """Return the vehicle that some values describe."""
    return describe(values).vehicle


def single(position, direction, **more):
    """Return the values of a vehicle with one thruster, t, of model constant."""
    return {'thruster_names': ['t'], 'thrusters.t.model': 'constant',
            'thrusters.t.position': list(position), 'thrusters.t.direction': list(direction),
            'thrusters.t.bollard_thrust': [-10.0, 20.0]} | more


@pytest.mark.parametrize('name', COLUMNS)
def test_the_columns_of_mt2012(name):
    """B of MT-2012 is the corrected table of the paper, column by column."""
    vehicle = build(mt2012())
    index = [thruster.name for thruster in vehicle.thrusters].index(name)
    assert vehicle.configuration_matrix.shape == (6, 5)
    assert vehicle.configuration_matrix[:, index] == pytest.approx(COLUMNS[name], abs=1e-4)
    assert vehicle.thrusters[index].column() == pytest.approx(COLUMNS[name], abs=1e-4)


def test_thrusters_stand_in_the_order_of_thruster_names():
    """Columns, Bollard limits and thrusters follow thruster_names, not the file."""
    names = ['tunnel', 'right', 'down', 'up', 'left']
    vehicle = build(mt2012() | {'thruster_names': names})
    assert [thruster.name for thruster in vehicle.thrusters] == names
    assert vehicle.configuration_matrix.T == pytest.approx(
        np.array([COLUMNS[name] for name in names]), abs=1e-4)
    assert vehicle.bollard_thrust.tolist() == [[-122.0] + [-68.2] * 4, [122.1] + [120.1] * 4]


def test_weights_come_through():
    """Q, and R in the order of the DOFs, are those of the file."""
    changes = {f'wrench_weights.{dof}': 10.0**i for i, dof in enumerate(DOFS)}
    vehicle = build(mt2012() | changes | {'thrusters.left.weight': 3.0})
    assert vehicle.wrench_weights == (1.0, 10.0, 100.0, 1e3, 1e4, 1e5)
    assert [thruster.weight for thruster in vehicle.thrusters] == [1.0, 3.0, 1.0, 1.0, 1.0]


@given(st.lists(st.tuples(point, point, coordinate), min_size=1, max_size=6))
@settings(deadline=None)
def test_flu_and_frd_files_of_a_vehicle_agree(thrusters):
    """Flipping y and z of positions and directions, and saying flu, changes nothing in B."""
    assume(all(math.hypot(*direction) > 1e-3 for _, direction, _ in thrusters))
    names = [f't{i}' for i in range(len(thrusters))]
    frd = {'thruster_names': names}
    for name, (position, direction, torque_ratio) in zip(names, thrusters):
        one = single(position, direction) | {'thrusters.t.torque_ratio': torque_ratio}
        frd |= {key.replace('.t.', f'.{name}.'): value for key, value in one.items()
                if key != 'thruster_names'}
    flu = {key: [value[0], -value[1], -value[2]] if key.endswith(('position', 'direction'))
           else value for key, value in frd.items()}
    np.testing.assert_allclose(build(flu | {'vehicle_frame': 'flu'}).configuration_matrix,
                               build(frd).configuration_matrix, rtol=0.0, atol=1e-12)


def test_mt2012_in_flu_axes():
    """MT-2012's own file in flu axes has the same B, and read as frd another one."""
    flu = {name: [value[0], -value[1], -value[2]] if name.endswith(('position', 'direction'))
           else value for name, value in mt2012().items()}
    expected = build(mt2012()).configuration_matrix
    np.testing.assert_allclose(build(flu | {'vehicle_frame': 'flu'}).configuration_matrix,
                               expected, rtol=0.0, atol=1e-12)
    assert np.abs(build(flu).configuration_matrix - expected).max() > 0.5


@given(point, point, coordinate)
@settings(deadline=None)
def test_a_column_is_force_moment_and_reaction_torque(position, direction, torque_ratio):
    """A column is [d; r x d + k d] with d of length 1, by a formula written out."""
    length = math.sqrt(sum(x * x for x in direction))
    assume(length > 1e-3)
    dx, dy, dz = (x / length for x in direction)
    x, y, z = position
    vehicle = build(single(position, direction, **{'thrusters.t.torque_ratio': torque_ratio}))
    np.testing.assert_allclose(vehicle.configuration_matrix[:, 0], [
        dx, dy, dz, y * dz - z * dy + torque_ratio * dx, z * dx - x * dz + torque_ratio * dy,
        x * dy - y * dx + torque_ratio * dz], rtol=0.0, atol=1e-12)


@given(point, point)
@settings(deadline=None)
def test_wrenches_act_where_they_are_said_to(position, origin):
    """About another point the force is the same and the moment less origin x force; in flu too."""
    given = single(position, (0.6, 0.0, 0.8)) | {'thrusters.t.torque_ratio': 0.1}
    here = build(given).configuration_matrix[:, 0]
    there = build(given | {'wrench_origin': origin})
    column = there.configuration_matrix[:, 0]
    np.testing.assert_array_equal(column[:3], here[:3])
    np.testing.assert_allclose(column[3:], here[3:] - np.cross(origin, here[:3]), atol=1e-9)
    assert there.thrusters == build(given).thrusters  # the flow is that at the body origin's r
    turned = build(given | {'wrench_origin': [origin[0], -origin[1], -origin[2]],
                            'thrusters.t.position': [position[0], -position[1], -position[2]],
                            'thrusters.t.direction': (0.6, 0.0, -0.8), 'vehicle_frame': 'flu'})
    np.testing.assert_allclose(turned.configuration_matrix[:, 0], column, atol=1e-9)


@given(st.tuples(*[st.floats(-1e6, 1e6)] * 3))
@settings(deadline=None)
def test_directions_are_normalised(direction):
    """A direction of any length up to the largest has length 1 afterwards, and its own sense."""
    assume(math.hypot(*direction) > 1e-6)
    unit = np.array(build(single((0.0, 0.0, 0.0), direction)).thrusters[0].direction)
    assert np.linalg.norm(unit) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(unit, np.array(direction) / math.hypot(*direction), atol=1e-12)


def with_propeller(diameter, revolutions, slope, density, bollard_thrust):
    """Return what C is, (reverse, forward), of a propeller given by its data."""
    return build(single((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) | {
        'water_density': density, 'thrusters.t.model': 'propeller',
        'thrusters.t.bollard_thrust': bollard_thrust, 'thrusters.t.propeller.diameter': diameter,
        'thrusters.t.propeller.max_revolutions': revolutions,
        'thrusters.t.propeller.thrust_slope': slope}).thrusters[0].model.speed_loss


def test_speed_loss_of_mt2012_from_its_propeller():
    """The propeller that the paper's figures fit has C = 42.2 forward and 24.0 in reverse."""
    assert with_propeller(0.20, 15.13, 0.34, 1025.0, [-68.2, 120.1]) == pytest.approx(
        (24.0, 42.2), abs=0.1)


@given(st.floats(0.01, 2.0), st.floats(0.1, 30.0), st.floats(0.01, 1.0), st.floats(500.0, 1500.0),
       st.floats(-100.0, -1.0) | st.just(0.0), st.floats(50.0, 200.0))
@settings(deadline=None)
def test_speed_loss_follows_from_the_propeller(diameter, revolutions, slope, density, reverse,
                                               forward):
    """C is b1 rho Omega^2 D^4 forward; in reverse thrust vanishes at the same speed."""
    speed_loss = with_propeller(diameter, revolutions, slope, density, [reverse, forward])
    b1 = slope / (diameter * revolutions)
    expected = b1 * density * revolutions**2 * diameter**4
    assert speed_loss[1] == pytest.approx(expected, rel=1e-9)
    assert speed_loss[0] * forward == pytest.approx(expected * abs(reverse), rel=1e-9)


@pytest.mark.parametrize('data', [(10.0, 1.0, 1.0, 1001.0, [-1.0, 1.0]),
                                  (1.0, 1.0, 1.0, 1000.0, [-1001.0, 1.0])])
def test_a_propeller_of_absurd_loss_is_refused(data):
    """Data that give a C above 1e6 N*s/m, in either sense, are refused by name."""
    with pytest.raises(ParameterError, match=r'^thrusters\.t\.propeller: is .*1001000\.0.*, must '
                                             r'be such that speed_loss is at most 1e\+06$'):
        with_propeller(*data)


def test_models_have_their_coefficients():
    """speed_loss comes through as given, a tunnel has c and rho S, a constant model nothing."""
    models = [thruster.model for thruster in build(mt2012() | {'water_density': 998.0}).thrusters]
    assert [model.speed_loss for model in models[:4]] == [(24.0, 42.2)] * 4
    assert [model.opposed_loss for model in models[:4]] == [(9.9, 17.5)] * 4
    assert models[4].decay * models[4].jet_mass == pytest.approx(7.0 * 998.0 * 0.0707, rel=1e-12)
    assert isinstance(build(single((0, 0, 0), (1, 0, 0))).thrusters[0].model, Constant)


@pytest.mark.parametrize('weights, expected', [
    ({}, []),
    ({'roll': 1.0}, ['no thruster can act on roll: set wrench_weights.roll to 0, or its command '
                     'is never met']),
    ({'sway': 1.0}, ['the thrusters act on surge, sway, heave, pitch, yaw in only 4 independent '
                     'ways: not every wrench can be met; set the wrench_weights of what need not '
                     'be controlled to 0']),
    ({'sway': 1.0, 'yaw': 0.0}, []),
    ({'surge': 0.0, 'heave': 0.0, 'pitch': 0.0, 'yaw': 0.0, 'roll': 1.0},
     ['no thruster can act on roll: set wrench_weights.roll to 0, or its command is never met']),
], ids=['MT-2012', 'dead roll', 'sway tied to yaw', 'sway for yaw', 'only roll'])
def test_warnings_of_mt2012(weights, expected):
    """Controlled DOFs without a thruster and a deficient rank are found, others not."""
    changes = {f'wrench_weights.{dof}': weight for dof, weight in weights.items()}
    assert build(mt2012() | changes).warnings() == expected


def test_both_warnings_at_once():
    """A dead DOF is not counted again in the rank of the others."""
    warnings = build(mt2012() | {f'wrench_weights.{dof}': 1.0 for dof in DOFS}).warnings()
    assert [warning.split(':')[0] for warning in warnings] == [
        'no thruster can act on roll',
        'the thrusters act on surge, sway, heave, pitch, yaw in only 4 independent ways']


def test_nothing_can_be_changed():
    """Vehicle, thrusters and parameters are immutable, arrays read-only."""
    parameters = read_parameters(mt2012())
    vehicle = describe(mt2012()).vehicle
    for thing, name in ((vehicle, 'wrench_weights'), (vehicle, 'configuration_matrix'),
                        (vehicle.thrusters[0], 'weight'),
                        (vehicle.thrusters[0].model, 'speed_loss'), (parameters, 'values')):
        with pytest.raises(FrozenInstanceError):
            setattr(thing, name, None)
    for mapping in (parameters.values, parameters.definitions):
        with pytest.raises(TypeError):
            mapping['rate'] = 1.0
    for array in (vehicle.configuration_matrix, vehicle.bollard_thrust):
        with pytest.raises(ValueError, match='read-only'):
            array[0, 0] = 1.0
    for name in ('position', 'direction', 'bollard_thrust'):
        assert isinstance(parameters.values[f'thrusters.up.{name}'], tuple)
        assert isinstance(getattr(vehicle.thrusters[0], name), tuple)


def test_changing_what_was_read_changes_no_parameter():
    """Parameters keep no reference to the lists and maps that they were read from."""
    values = mt2012()
    parameters = read_parameters(values)
    before = dict(parameters.values)
    values['rate'] = 1.0
    values['thrusters.up.position'][0] = 99.0
    values['thruster_names'].append('x')
    parameters.of_thruster('up')['weight'] = 99.0
    assert dict(parameters.values) == before


def test_a_thruster_is_plain_unless_said_otherwise():
    """Of weight 1, on, without reaction torque, rate limit or cut-off."""
    one = Thruster('t', (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), Constant((-10.0, 20.0)))
    assert (one.weight, one.enabled, one.max_rate, one.cutoff) == (1.0, True, 0.0, 0.0)
    assert one.column().tolist() == [1.0, 0.0, 0.0, 0.0, 0.0, -1.0]


def test_what_is_rounding_is_no_thrust():
    """Beside thrusters with long arms, a DOF that only rounding acts on is as good as dead."""
    far = tuple(Thruster(name, (0.0, arm, 0.0), (1.0, 1e-8, 0.0), Constant((-10.0, 20.0)))
                for name, arm in (('one', 100.0), ('other', -100.0)))
    said, = Vehicle(far, (1.0, 1.0, 0.0, 0.0, 0.0, 1.0)).warnings()
    assert 'no thruster can act on sway' in said


@pytest.mark.parametrize('kind', MODELS.values(), ids=MODELS)
def test_models_are_values(kind):
    """Whatever the model, a thruster's cannot be changed behind the vehicle's back."""
    assert kind.__dataclass_params__.frozen
