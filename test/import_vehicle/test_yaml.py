"""Matrices and layouts in YAML: the thrusters that they stand for, and their names and limits."""

from math import pi, sqrt

from hypothesis import given, settings, strategies as st
import numpy as np
import pytest
from thrust_allocator.import_vehicle.configuration import mount_of_column
import yaml

HALF = sqrt(0.5)
# Two thrusters at 45 degrees and a vertical one, with the moments that their places give
POSITIONS = np.array([[0.4, 0.3, 0.0], [0.4, -0.3, 0.0], [-0.2, 0.1, 0.5]])
DIRECTIONS = np.array([[HALF, -HALF, 0.0], [HALF, HALF, 0.0], [0.0, 0.0, 1.0]])
B = np.vstack([DIRECTIONS.T, np.cross(POSITIONS, DIRECTIONS).T])


def dump(document) -> str:
    """Return a document as YAML."""
    return yaml.safe_dump(document)


def ros(document, node='/**') -> dict:
    """Return a document as the parameters of a node."""
    return {node: {'ros__parameters': document}}


ROWS = dict(zip(('x', 'y', 'z', 'rx', 'ry', 'rz'), B.tolist()))


@pytest.mark.parametrize('document', [
    {'tam': B.tolist()},
    {'thruster_manager': {'tam': B.tolist(), 'max_thrust': 2000.0}},
    ros({'tam': B.ravel().tolist()}),
    ros({'tam': ROWS}, 'controller'),
    ros({'tam': {f'{key}': value for key, value in ROWS.items()}, 'rate': 30}),
    {'vehicle': {'allocation_matrix': B.tolist(), 'inertia': np.eye(6).tolist()}},
    {'six_rows': B.tolist()}], ids=str)
def test_matrices_of_every_shape(imported, document):
    """Nested, flat, in named rows, and any list of six rows give the same thrusters."""
    found, _ = imported(dump(document), '--frame', 'flu')
    assert np.abs(found - B).max() < 1e-6


def test_frd_matrix(imported):
    """In frd axes a matrix is what it says, in frd axes."""
    found, text = imported(dump({'tam': B.tolist()}), '--frame', 'frd', frame='frd')
    assert np.abs(found - B).max() < 1e-6 and 'vehicle_frame: frd' in text


def test_names_and_limits_of_a_controller(imported):
    """Names stand beside the matrix, limits in the section of each thruster's own controller."""
    sections = {f'c{i}': {'ros__parameters': {
        'thruster': f't-{i}', 'min_thrust': -40.0 - i, 'max_thrust': 60.0}} for i in range(3)}
    _, text = imported(dump({**ros({'tam': ROWS, 'thrusters': ['t-0', 't-1', 't-2']}, 'a'),
                             **sections}), '--frame', 'flu')
    assert 'thruster_names: [t_0, t_1, t_2]' in text and '"t-1" in the source' in text
    assert 'bollard_thrust: [-41.0, 60.0]' in text and 'GUESS' not in text


@pytest.mark.parametrize('document', [
    {'thruster_position': POSITIONS.T.ravel().tolist(),
     'thruster_force_direction': DIRECTIONS.T.ravel().tolist()},
    {'positions': POSITIONS.T.tolist(), 'directions': DIRECTIONS.T.tolist()},
    {'thrusters': {f't{i}': {'position': POSITIONS[i].tolist(),
                             'direction': DIRECTIONS[i].tolist()} for i in range(3)}},
    {'thrusters': [{'name': f't{i}', **dict(zip(
        ('x', 'y', 'z', 'dx', 'dy', 'dz'), [*POSITIONS[i].tolist(), *DIRECTIONS[i].tolist()]))}
        for i in range(3)]},
    {'thrusters': np.hstack([POSITIONS, DIRECTIONS]).tolist()},
    {'thruster_poses': [[0.4, 0.3, 0.0, 0.0, 0.0, -pi / 4], [0.4, -0.3, 0.0, 0.0, 0.0, pi / 4],
                        [-0.2, 0.1, 0.5, 0.0, -pi / 2, 0.0]]},
    {'thrusters': [{'pos': POSITIONS[i].tolist(), 'rpy': turn, 'name': f't{i}'}
                   for i, turn in enumerate(([0, 0, -45], [0, 0, 45], [0, -90, 0]))]},
    {'thrusters': {'a': {'pose': [0.4, 0.3, 0.0, 0.0, 0.0, -pi / 4]},
                   'b': {'pose': [0.4, -0.3, 0.0, 0.0, 0.0, pi / 4]},
                   'c': {'pose': [-0.2, 0.1, 0.5, 0.0, -HALF, 0.0, HALF]}}},
    np.hstack([POSITIONS, DIRECTIONS]).tolist()], ids=str)
def test_layouts_of_every_shape(imported, document):
    """Rows, entries by name, lists of six numbers and poses give the same thrusters."""
    found, _ = imported(dump(document), '--frame', 'frd', frame='frd')
    assert np.abs(found - B).max() < 1e-6


def test_moments_are_counted_about_the_centre_of_mass(imported):
    """A layout's centre of mass is the origin, unless --origin gives another."""
    document = dump({'physical': {'center_of_mass': [0.1, 0.0, 0.2]}, 'propulsion': {
        'thruster_position': POSITIONS.T.ravel().tolist(),
        'thruster_direction': DIRECTIONS.T.ravel().tolist(),
        'constraints': {'max_force': [50.0, 60.0, 70.0], 'min_force': -30.0}}})
    for args, origin in (((), [0.1, 0.0, 0.2]), (('--origin', '0,0,0'), [0.0, 0.0, 0.0]),
                         (('--origin=-1,2,3',), [-1.0, 2.0, 3.0])):
        found, text = imported(document, '--frame', 'flu', *args)
        moments = np.cross(POSITIONS - origin, DIRECTIONS).T
        assert np.abs(found - np.vstack([DIRECTIONS.T, moments])).max() < 1e-6
        assert ('centre of mass' in text.split('\n#\n')[0].replace('\n# ', ' ')) == (not args)
    assert 'bollard_thrust: [-30.0, 70.0]' in text


def test_origin_shifts_a_matrix(imported):
    """The lever arms of a matrix are measured from the origin that is given."""
    found, _ = imported(dump({'tam': B.tolist()}), '--frame', 'flu', '--origin', '0.1,0.2,0.3')
    moments = np.cross(POSITIONS - [0.1, 0.2, 0.3], DIRECTIONS).T
    assert np.abs(found - np.vstack([DIRECTIONS.T, moments])).max() < 1e-6


def test_a_file_that_says_its_axes(imported):
    """Then --frame is not needed."""
    found, text = imported(dump({'frame': 'FRD', 'tam': B.tolist()}), frame='frd')
    assert np.abs(found - B).max() < 1e-6 and 'vehicle_frame: frd' in text


def test_rounded_columns_are_snapped(imported):
    """0.707 means the root of one half; the whole column is scaled, as if 1 N were pushed."""
    column = [0.707, -0.707, 0.0, 0.0, 0.0, 0.1888]
    found, _ = imported(dump({'tam': [[one] for one in column]}), '--frame', 'flu')
    assert np.abs(found[:, 0] - [HALF, -HALF, 0, 0, 0, 0.1888 * HALF / 0.707]).max() < 1e-6


def test_a_moment_along_the_axis_becomes_torque_ratio(imported):
    """The reaction torque of a propeller is kept apart from its lever arm."""
    _, text = imported(dump({'tam': [[1.0], [0.0], [0.0], [-0.02], [0.0], [0.5]]}),
                       '--frame', 'flu')
    assert 'torque_ratio: -0.02' in text and 'position: [0.0, -0.5, 0.0]' in text


@settings(max_examples=100, deadline=None)
@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3), st.tuples(*[st.floats(-3.0, 3.0)] * 3),
       st.floats(-0.09, 0.09))
def test_any_column_comes_back(direction, position, k):
    """Position and torque ratio that are made of a column give the column again."""
    norm = np.linalg.norm(direction)
    if norm < 0.1:
        return
    d = np.array(direction) / norm
    column = np.concatenate([d, np.cross(position, d) + k * d])
    assert np.abs(mount_of_column('t', column).column - column).max() < 1e-8
