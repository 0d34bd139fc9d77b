"""URDF and SDF: where thrusters stand and push, through every chain of poses."""

from math import cos, pi, sin, sqrt

from hypothesis import given, settings, strategies as st
from support.importing import GZ, gz_thruster, sdf, sdf_thruster, urdf, urdf_joint
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from thrust_allocator.import_vehicle.pose import pose
from thrust_allocator.import_vehicle.sdf import SdfModel
from thrust_allocator.import_vehicle.simulator import parse_xml

HALF = sqrt(0.5)


def column(position, direction):
    """Return the wrench of 1 N at a point."""
    return np.concatenate([direction, np.cross(position, direction)])


def same(found, *columns):
    """Tell whether a matrix has these columns within 1e-6."""
    return np.abs(found - np.array(columns).T).max() < 1e-6


def turn(roll, pitch, yaw):
    """Return Rz(yaw) Ry(pitch) Rx(roll), written out: an oracle beside SciPy."""
    x = np.array([[1, 0, 0], [0, cos(roll), -sin(roll)], [0, sin(roll), cos(roll)]])
    y = np.array([[cos(pitch), 0, sin(pitch)], [0, 1, 0], [-sin(pitch), 0, cos(pitch)]])
    z = np.array([[cos(yaw), -sin(yaw), 0], [sin(yaw), cos(yaw), 0], [0, 0, 1]])
    return z @ y @ x


ANGLE = st.floats(-3.0, 3.0)
POSE = st.tuples(*[st.floats(-2.0, 2.0)] * 3, ANGLE, ANGLE, ANGLE)


@settings(max_examples=50, deadline=None)
@given(POSE, POSE)
def test_poses_compose_as_matrices_do(first, second):
    """A pose in a pose is the product of their 4 x 4 matrices, and its inverse undoes it."""
    chain = pose(first, '') @ pose(second, '')
    r1, r2 = turn(*first[3:]), turn(*second[3:])
    assert np.allclose(chain.rotation.as_matrix(), r1 @ r2, atol=1e-12)
    assert np.allclose(chain.translation, r1 @ second[:3] + first[:3], atol=1e-12)
    assert np.allclose((chain @ chain.inverse()).translation, 0.0, atol=1e-12)


def test_urdf_chain_of_fixed_joints(imported):
    """Each joint's origin counts, and the axis is in the joint's own frame."""
    found, text = imported(urdf(
        urdf_joint('arm', 'base_link', 'bracket', '0.5 0 0.1', f'0 0 {pi / 2}')
        + urdf_joint('left', 'bracket', 'left_prop', '0.2 0 0', f'0 0 {-pi / 4}', 'continuous')
        + urdf_joint('down', 'base_link', 'down_prop', '-0.3 0 0', '0 0 0', 'revolute', '0 0 -2')
        + f'<gazebo>{gz_thruster("left")}</gazebo><gazebo>{gz_thruster("down")}</gazebo>'))
    assert same(found, column([0.5, 0.2, 0.1], [HALF, HALF, 0]), column([-0.3, 0, 0], [0, 0, -1]))
    assert 'link base_link' in text and 'URDF with gz-sim thruster plugins' in text


def test_urdf_of_uuv_simulator(imported):
    """Thrust along the joint's axis, in the order of the ids; limits from the conversion."""
    plugin = ('<gazebo><plugin name="x" filename="libuuv_thruster_ros_plugin.so">'
              '<linkName>rov/{0}</linkName>{1}<thrusterID>{2}</thrusterID>{3}</plugin></gazebo>')
    found, text = imported(urdf(
        urdf_joint('j', 'base_link', 'rov/b', '0 1 0', f'0 {-pi / 2} 0', 'continuous')
        + urdf_joint('k', 'base_link', 'rov/a', '0 -1 0', '0 0 0', 'continuous')
        + plugin.format('b', '', 1, '<thrustMin>0</thrustMin><thrustMax>20</thrustMax>')
        + plugin.format('a', '<jointName>k</jointName>', 0,
                        '<clampMin>-100</clampMin><clampMax>200</clampMax><conversion>'
                        '<type>Basic</type><rotorConstant>0.001</rotorConstant></conversion>')))
    assert same(found, column([0, -1, 0], [1, 0, 0]), column([0, 1, 0], [0, 0, 1]))
    assert 'bollard_thrust: [-10.0, 40.0]' in text and 'bollard_thrust: [0.0, 20.0]' in text
    assert '"rov/a" in the source' in text and 'GUESS' not in text


def test_body_below_a_floating_joint(imported):
    """Positions are measured from base_link, whatever it floats or stands on."""
    found, _ = imported(
        '<robot name="r"><link name="world"/>'
        + urdf_joint('free', 'world', 'foot', '9 9 9', '1 1 1', 'floating')
        + urdf_joint('rise', 'foot', 'base_link', '0 0 5')
        + urdf_joint('t', 'base_link', 'prop', '1 0 0', kind='continuous', axis='0 1 0')
        + gz_thruster('t') + '</robot>')
    assert same(found, column([1, 0, 0], [0, 1, 0]))


@pytest.mark.parametrize('filename, name', [
    ('gz-sim-thruster-system', 'gz::sim::systems::Thruster'),
    ('libgz-sim7-thruster-system.so', 'gz::sim::v7::systems::Thruster'),
    ('ignition-gazebo-thruster-system', 'ignition::gazebo::systems::Thruster')])
def test_every_name_of_the_gz_plugin(imported, filename, name):
    """Old names of the plugin are read as new ones."""
    plugin = GZ.format('<joint_name>t_joint</joint_name>').replace(
        'gz-sim-thruster-system', filename).replace('gz::sim::systems::Thruster', name)
    found, _ = imported(sdf(sdf_thruster('t', '0 0.5 0 0 0 0').replace(
        gz_thruster('t_joint'), plugin)))
    assert same(found, column([0, 0.5, 0], [1, 0, 0]))


def test_sdf_poses_of_every_kind(imported):
    """Degrees, quaternions, relative_to a frame on a frame, and a link's own pose."""
    found, _ = imported(sdf(
        '<frame name="tail"><pose degrees="true">-1 0 0 0 0 90</pose></frame>'
        '<frame name="strut" attached_to="tail"><pose>0.5 0 0 0 0 0</pose></frame>'
        + sdf_thruster('a', '0 0.1 0 0 0 -90', pose_attributes='relative_to="strut" degrees="true"')
        + sdf_thruster('b', f'1 0 0 0 0 {HALF} {HALF}',
                       pose_attributes='rotation_format="quat_xyzw"')
        + sdf_thruster('c', f'0 0 1 0 {pi / 2} 0', axis='0 0 1')))
    assert same(found, column([-1.1, 0.5, 0], [1, 0, 0]), column([1, 0, 0], [0, 1, 0]),
                column([0, 0, 1], [1, 0, 0]))


def test_the_pose_of_an_sdf_joint_is_relative_to_its_child(imported):
    """It turns the axis on top of the link's turn; the thrust acts where the link is."""
    found, _ = imported(sdf(
        sdf_thruster('a', f'1 0 0 0 0 {pi / 2}', joint=f'<pose>0 0 7 0 0 {pi / 2}</pose>')
        + sdf_thruster('b', '2 0 0 0 0 0.3',
                       joint=f'<pose relative_to="base_link">0 0 0 0 {-pi / 2} 0</pose>')))
    assert same(found, column([1, 0, 0], [-1, 0, 0]), column([2, 0, 0], [0, 0, 1]))


def test_axes_expressed_in_another_frame(imported):
    """expressed_in, use_parent_model_frame, and SDF 1.4, whose axes are the model's."""
    turned = f'0 1 0 0 0 {pi / 2}'
    text = sdf(sdf_thruster('t', turned)).replace('<xyz>', '<xyz expressed_in="base_link">')
    assert same(imported(text)[0], column([0, 1, 0], [1, 0, 0]))
    text = sdf(sdf_thruster('t', turned), '1.6')
    assert same(imported(text)[0], column([0, 1, 0], [0, 1, 0]))
    of_model = text.replace('</axis>', '<use_parent_model_frame>1</use_parent_model_frame></axis>')
    assert same(imported(of_model)[0], column([0, 1, 0], [1, 0, 0]))
    assert same(imported(sdf(sdf_thruster('t', turned), '1.4'))[0], column([0, 1, 0], [1, 0, 0]))


def test_nested_models(imported):
    """A thruster in a model in the model, placed by a frame of its own and fixed by a joint."""
    inner = ('<model name="pod" placement_frame="flange"><pose>1 0 0 0 0 0</pose>'
             '<link name="shell"/><frame name="flange"><pose>-0.2 0 0 0 0 0</pose></frame>'
             + sdf_thruster('prop', f'0 0.3 0 0 0 {pi / 2}', parent='shell') + '</model>')
    found, text = imported(sdf(
        inner + '<joint name="mount" type="fixed"><parent>base_link</parent>'
        '<child>pod::shell</child></joint>'))
    assert same(found, column([1.2, 0.3, 0], [0, 1, 0]))
    assert 'prop_joint:' in text


def test_prefixes_that_nobody_declares(imported):
    """A gz: prefix without a declaration is read all the same, and so is a world around a model."""
    text = sdf('<gz:system_priority>1</gz:system_priority>'
               + sdf_thruster('t', '0 0 0 0 0 0')).replace(
        '<model', '<world name="w"><model', 1).replace('</model>', '</model></world>')
    assert same(imported(text)[0], column([0, 0, 0], [1, 0, 0]))


def test_thrust_coefficient_and_diameter_count_for_nothing(imported):
    """A negative coefficient turns the spin, not the force; a diameter makes no speed_loss."""
    found, text = imported(sdf(sdf_thruster(
        't', '0 0 0 0 0 0', plugin='<thrust_coefficient>-0.02</thrust_coefficient>'
        '<propeller_diameter>0.1</propeller_diameter><fluid_density>998</fluid_density>')))
    assert same(found, column([0, 0, 0], [1, 0, 0]))
    assert 'model: constant' in text and 'water_density: 998.0' in text
    assert 'diameter' not in text.split('/**:')[1] and 'speed_loss:' not in text


@pytest.mark.parametrize('plugin, limits, guessed', [
    ('<max_thrust_cmd>51.5</max_thrust_cmd><min_thrust_cmd>-40.2</min_thrust_cmd>',
     '[-40.2, 51.5]', False),
    ('<max_thrust_cmd>1000</max_thrust_cmd><min_thrust_cmd>-1000</min_thrust_cmd>',
     '[-40.0, 40.0]', True),
    ('', '[-40.0, 40.0]', True),
    ('<max_thrust_cmd>30</max_thrust_cmd>', '[-30.0, 30.0]', True),
    ('<max_thrust_cmd>300</max_thrust_cmd><min_thrust_cmd>-300</min_thrust_cmd>'
     '<use_angvel_cmd>true</use_angvel_cmd>', '[-40.0, 40.0]', True)])
def test_limits_where_the_file_has_them(imported, plugin, limits, guessed):
    """The default of 1000 N, and limits of revolutions, are no limits of thrust."""
    _, text = imported(sdf(sdf_thruster('t', '0 0 0 0 0 0', plugin=plugin)))
    line, = [line for line in text.splitlines() if 'bollard_thrust:' in line]
    assert f'bollard_thrust: {limits}' in line and ('GUESS' in line) == guessed


@settings(max_examples=30, deadline=None)
@given(POSE, POSE, POSE, st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(
    lambda axis: np.linalg.norm(axis) > 0.1))
def test_any_sdf_chain_against_matrices(frame, link, joint, axis):
    """The place and axis of a link on a frame, with a turned joint, are those of the matrices."""
    written = [' '.join(map(repr, one)) for one in (frame, link, joint, axis)]
    root = parse_xml(sdf(
        f'<frame name="f"><pose>{written[0]}</pose></frame>'
        + sdf_thruster('t', written[1], written[3], pose_attributes='relative_to="f"',
                       joint=f'<pose>{written[2]}</pose>')))
    spin = SdfModel(root.find('model'), '1.9').spin('t_joint', None)
    r1, r2, r3 = (turn(*one[3:]) for one in (frame, link, joint))
    assert np.allclose(spin.pose.translation, r1 @ link[:3] + frame[:3], atol=1e-9)
    assert np.allclose(spin.axis, r1 @ r2 @ r3 @ axis / np.linalg.norm(axis), atol=1e-9)
    assert isinstance(spin.pose.rotation, Rotation)
