"""What gives way, in the running node: direction, power, weights, and what could still be asked."""

import json

import numpy as np
from numpy.testing import assert_allclose
import pytest
from rclpy.parameter import Parameter
from std_msgs.msg import Float64MultiArray
from support.attainable import largest_along
from support.paths import CONFIG
from support.vehicles import described
from thrust_allocator.physics.bounds import ThrustBounds

BLUEROV2 = CONFIG / 'bluerov2_heavy.yaml'
FLU = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])  # between frd and flu axes
FAR = [300.0, 100.0, -200.0, 20.0, 10.0, 40.0]  # beyond reach in every direction
AHEAD = [1.0, 0.2, 0.0, 0.0, 0.0, 0.1]


def angle(one, other):
    """Return the angle between two vectors [deg]."""
    return np.degrees(np.arccos(one @ other / np.linalg.norm(one) / np.linalg.norm(other)))


def settled(peer, wrench, twist):
    """Return the last of a few ticks."""
    return peer.steps(3, wrench, twist)[-1]


def changed(peer, **values):
    """Set parameters over the service; they must be accepted."""
    for result in peer.set_parameters_of_node(
            [Parameter(name, value=value) for name, value in values.items()]):
        assert result.successful, result.reason


def test_direction_keeping_is_live_and_reported(stepped):
    """BlueROV2 Heavy keeps the direction; with 0 the weights decide; the rest is unallocated."""
    peer = stepped(file=BLUEROV2)
    kept = settled(peer, FAR, AHEAD)
    assert angle(kept['achieved_wrench'], np.array(FAR)) < 0.01
    assert_allclose(kept['achieved_wrench'] + kept['unallocated_wrench'], FAR, atol=1e-6)
    scale = float(peer.report()[2]['scale to keep the direction'])
    assert scale == pytest.approx(np.linalg.norm(kept['achieved_wrench']) / np.linalg.norm(FAR),
                                  abs=2e-3)
    changed(peer, direction_keeping=0.0)
    weighted = settled(peer, FAR, AHEAD)
    assert angle(weighted['achieved_wrench'], np.array(FAR)) > 3.0
    assert peer.report()[2]['scale to keep the direction'] == '1.000'
    changed(peer, direction_keeping=1.0, direction_keeping_dofs=['roll'])  # it alone is in reach
    assert_allclose(settled(peer, FAR, AHEAD)['thruster_setpoints'],
                    weighted['thruster_setpoints'], atol=1e-9)


def test_power_limit_is_live_and_reported(stepped):
    """The thrusts are scaled until what they take fits, and the diagnostics say both."""
    peer = stepped(file=BLUEROV2)
    free = settled(peer, FAR, AHEAD)
    before = peer.report()[2]
    assert float(before['predicted power [W]']) > 900.0
    assert before['scale to keep the power limit'] == '1.000'
    changed(peer, power_limit=600.0)
    limited = settled(peer, FAR, AHEAD)
    figures = peer.report()[2]
    assert float(figures['predicted power [W]']) == pytest.approx(600.0, abs=0.1)
    assert 0.1 < float(figures['scale to keep the power limit']) < 1.0
    assert angle(limited['achieved_wrench'], free['achieved_wrench']) < 0.1
    assert_allclose(limited['achieved_wrench'] + limited['unallocated_wrench'], FAR, atol=1e-6)


def test_power_limit_needs_the_power_of_every_thruster(stepped):
    """MT-2012 gives none: refused with the parameter's name, and nothing changes."""
    peer = stepped()
    result, = peer.set_parameters_of_node([Parameter('power_limit', value=100.0)])
    assert not result.successful
    assert result.reason.startswith('thrusters.down.bollard_power: is [0.0, 0.0], must be')
    settled(peer, FAR, AHEAD)
    assert peer.report()[2]['predicted power [W]'] == 'unknown'


def test_weights_left_out_are_said_and_stay(stepped, capfd):
    """The weights are logged and can be read; changing thrusters does not change them."""
    peer = stepped(file=BLUEROV2)
    weights = peer.node.vehicle.wrench_weights
    assert weights[2] == 1e5 and min(weights) >= 1e3 and max(weights) <= 1e7
    assert peer.node.get_parameter('wrench_weights.pitch').value == weights[4]
    assert 'INFO' in (said := capfd.readouterr().err)
    assert ('wrench_weights by authority: surge 1.528e+05, sway 1.528e+05, heave 1e+05, '
            'roll 2.104e+06, pitch 6.944e+06, yaw 2.143e+06') in said
    changed(peer, **{'thrusters.front_left.enabled': False,
                     'thrusters.rear_left.bollard_thrust': [-10.0, 10.0]})
    assert peer.node.vehicle.wrench_weights == weights
    changed(peer, **{'wrench_weights.yaw': 1e4})
    assert peer.node.vehicle.wrench_weights == (*weights[:5], 1e4)


@pytest.mark.parametrize('frame', ['frd', 'flu'])
@pytest.mark.parametrize('off', [(), ('front_left', 'vertical_rear_left')])
def test_wrench_limits(stepped, frame, off):
    """Each component's range at the present speed, the others as achieved, is HiGHS's to 1e-6 N."""
    peer = stepped(f'message_frame:={frame}', file=BLUEROV2)
    received = []
    listener = peer.create_subscription(Float64MultiArray, 'wrench_limits', received.append, 10)
    changed(peer, **{f'thrusters.{name}.enabled': False for name in off},
            **{'thrusters.rear_right.max_rate': 5.0})
    tick = peer.steps(5, [30.0, 10.0, 0.0, 1.0, 0.0, 3.0], AHEAD)[-1]
    received.clear()
    peer.wait_until(lambda: received, 'wrench_limits')
    peer.destroy_subscription(listener)
    assert [one.label for one in received[-1].layout.dim] == ['limits', 'components']
    found = np.array(received[-1].data).reshape(2, 6)
    vehicle = described('bluerov2_heavy')
    signs = FLU if frame == 'flu' else np.ones(6)
    limits = ThrustBounds(vehicle)(signs * AHEAD) * [one.name not in off
                                                     for one in vehicle.thrusters]
    matrix, achieved = vehicle.configuration_matrix, signs * tick['achieved_wrench']
    for dof in range(6):
        ways = [side * largest_along(matrix, achieved, side * signs[dof] * np.eye(6)[dof], limits)
                for side in (-1.0, 1.0)]
        assert_allclose(found[:, dof], tick['achieved_wrench'][dof] + ways, atol=1e-6)


def test_wrench_limits_of_a_dof_that_is_not_controlled(stepped):
    """MT-2012 does not control roll: both ends are what is achieved."""
    peer = stepped()
    received = []
    peer.create_subscription(Float64MultiArray, 'wrench_limits', received.append, 10)
    tick = peer.steps(5, [30.0, 0.0, 0.0, 0.0, 10.0, 0.0], AHEAD)[-1]
    received.clear()
    peer.wait_until(lambda: received, 'wrench_limits')
    lower, upper = np.array(received[-1].data).reshape(2, 6)
    for dof in (1, 3):
        assert lower[dof] == upper[dof] == pytest.approx(tick['achieved_wrench'][dof], abs=1e-9)
    assert (lower[[0, 4, 5]] < upper[[0, 4, 5]] - 1.0).all()


def test_no_wrench_limits_of_a_vehicle_with_too_many_faces(stepped, tmp_path):
    """One WARN says so, and the vehicle is allocated all the same."""
    rng = np.random.default_rng(3)
    thrusters = {f't{i}': {
        'model': 'constant', 'position': rng.normal(size=3).tolist(),
        'direction': rng.normal(size=3).tolist(), 'bollard_thrust': [-10.0, 10.0]}
        for i in range(16)}
    path = tmp_path / 'many.yaml'
    path.write_text(json.dumps({'/**': {'ros__parameters': {  # also YAML
        'thruster_names': list(thrusters), 'thrusters': thrusters}}}), encoding='utf-8')
    peer = stepped(file=path)
    received = []
    peer.create_subscription(Float64MultiArray, 'wrench_limits', received.append, 10)
    peer.steps(3, [10.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0] * 6)
    peer.wait_until(lambda: peer.logged('no wrench_limits'), 'the warning')
    assert not received and len(peer.logged('no wrench_limits')) == 1
