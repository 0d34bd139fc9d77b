"""The picture for RViz and Foxglove: every value of its markers, in either frame convention."""

from builtin_interfaces.msg import Time
import numpy as np
from numpy.testing import assert_allclose
import pytest
from rclpy.parameter import Parameter
from support.peer import cruise
from support.vehicles import mt2012, NAMES
from thrust_allocator.ros.markers import LONGEST, thruster_markers
from visualization_msgs.msg import Marker, MarkerArray

FRD, FLU = np.array([1.0, 1.0, 1.0]), np.array([1.0, -1.0, -1.0])
LIMITS = np.array([[-60.0, -60.0, -60.0, -60.0, -100.0], [100.0, 100.0, 100.0, 100.0, 80.0]])
THRUSTS = np.array([50.0, -30.0, 100.0, 1e-3, -100.0])  # of which the fourth is idle
SPAN = np.linalg.norm([1.20 + 1.88, 0.46, 0.46])  # of MT-2012's thrusters [m]
PER_NEWTON = LONGEST * SPAN / 122.1  # length of an arrow [m/N]


def draw(vehicle=None, thrusts=THRUSTS, limits=LIMITS, signs=FRD):
    """Return the markers by kind, each a list in the order of the thrusters."""
    message = thruster_markers((vehicle or mt2012()).thrusters, thrusts, limits, signs,
                               'hull', Time(sec=7))
    found = {}
    for marker in message.markers:
        assert marker.header.frame_id == 'hull' and marker.header.stamp.sec == 7
        assert marker.pose.orientation.w == 1.0 and marker.scale.x > 0.0
        assert (marker.action == Marker.ADD) == bool(marker.points)
        found.setdefault(marker.ns, []).append(marker)
    for kind in found.values():
        assert [marker.id for marker in kind] == list(range(5))
    assert set(found) == {'thrust', 'bounds', 'off'}
    return found


def points(marker):
    """Return a marker's points, (n, 3)."""
    return np.array([[point.x, point.y, point.z] for point in marker.points])


@pytest.mark.parametrize('signs', [FRD, FLU], ids=['frd', 'flu'])
def test_arrows(signs):
    """An arrow starts at its thruster and goes along the force, as long as the thrust is great."""
    vehicle = mt2012()
    for thruster, thrust, marker in zip(
            vehicle.thrusters, THRUSTS, draw(vehicle, signs=signs)['thrust']):
        if abs(thrust) < 0.1:
            assert marker.action == Marker.DELETE and not marker.points
            continue
        assert (marker.type, marker.action) == (Marker.ARROW, Marker.ADD)
        assert marker.scale.y > marker.scale.x > 0.0  # head and shaft
        tail, head = points(marker)
        assert_allclose(tail, signs * thruster.position, atol=1e-12)
        assert_allclose(head - tail, thrust * PER_NEWTON * signs * thruster.direction, atol=1e-12)


def test_the_tunnel_in_both_frames():
    """Positive thrust of MT-2012's tunnel is down: -z in flu, where up has y to the left too."""
    up = THRUSTS.copy()
    up[4] = 50.0
    flu = draw(thrusts=up, signs=FLU)
    tail, head = points(flu['thrust'][4])
    assert head[2] < tail[2] == 0.0
    assert_allclose(points(flu['thrust'][1])[0], [-1.88, 0.23, 0.0], atol=1e-12)  # left: +y
    assert points(flu['thrust'][2])[0][2] == 0.23  # up: +z


def test_colour_is_the_share_of_the_bound():
    """From yellow for none to vermilion for all, linear in between, each sense by its own bound."""
    none, half, full = (np.array(draw(thrusts=share * np.array([100.0, -60.0, 100.0, 100.0, -100.0])
                                      + 1e-12)['thrust'], dtype=object)
                        for share in (0.01, 0.5, 1.0))
    for little, middle, much in zip(none, half, full):
        colours = np.array([[one.color.r, one.color.g, one.color.b, one.color.a]
                            for one in (little, middle, much)])
        assert_allclose(colours[2], [0.84, 0.37, 0.0, 1.0], atol=1e-6)
        assert_allclose(colours[1], [0.89, 0.63, 0.13, 1.0], atol=1e-6)
        assert_allclose(colours[0], [0.939, 0.8848, 0.2574, 1.0], atol=1e-4)


def test_bounds():
    """A faint line reaches from the lower to the upper limit on the thrust axis."""
    vehicle = mt2012()
    for thruster, lower, upper, marker in zip(vehicle.thrusters, *LIMITS, draw(vehicle)['bounds']):
        assert marker.type == Marker.LINE_LIST and marker.color.a < 1.0
        axis = PER_NEWTON * np.array(thruster.direction)
        assert_allclose(points(marker), [thruster.position + lower * axis,
                                         thruster.position + upper * axis], atol=1e-12)


def test_a_thruster_that_is_off():
    """It has a cross in its place and neither arrow nor bounds; the others have no cross."""
    off = mt2012(thrusters__up__enabled=False)
    limits, thrusts = LIMITS.copy(), THRUSTS.copy()
    limits[:, 2] = thrusts[2] = 0.0
    found = draw(off, thrusts, limits)
    for kind in ('thrust', 'bounds'):
        assert found[kind][2].action == Marker.DELETE
    assert [one.action == Marker.ADD for one in found['off']] == [
        False, False, True, False, False]
    cross = points(found['off'][2])
    assert found['off'][2].type == Marker.LINE_LIST and cross.shape == (6, 3)
    assert_allclose(cross.mean(axis=0), off.thrusters[2].position, atol=1e-12)
    assert_allclose(np.abs(np.diff(cross, axis=0)[::2]), 0.04 * 2 * SPAN * np.eye(3), atol=1e-12)


def test_thrusters_in_one_place():
    """A vehicle whose thrusters stand in one place has a span of 1 m for its picture."""
    places = {f'thrusters__{name}__position': [1.0, 2.0, 3.0] for name in NAMES}
    tail, head = points(draw(mt2012(**places))['thrust'][4])
    assert_allclose(head - tail, [0.0, 0.0, -100.0 * LONGEST / 122.1], atol=1e-12)


def test_the_node_draws_the_last_tick(start):
    """With a listener the node sends what its setpoints and limits say, in marker_frame."""
    node, peer = start()
    drawn = []
    peer.create_subscription(MarkerArray, 'thruster_markers', drawn.append, 1)
    wrench, twist = cruise(0.9, side=-1.0)
    tick = peer.settle(wrench, twist)
    node.set_parameters([Parameter('marker_frame', value='hull')])
    drawn.clear()
    peer.wait_until(lambda: len(drawn) > 1, 'two pictures')
    expected = thruster_markers(
        node.vehicle.thrusters, tick['thruster_setpoints'], tick['thrust_limits'].reshape(2, 5),
        FLU, 'hull', drawn[-1].markers[0].header.stamp)
    assert len(drawn[-1].markers) == len(expected.markers) == 15
    for found, wanted in zip(drawn[-1].markers, expected.markers):
        assert (found.ns, found.id, found.type, found.action) == (
            wanted.ns, wanted.id, wanted.type, wanted.action)
        assert found.header == wanted.header
        assert_allclose(points(found), points(wanted), atol=1e-6)


def test_nothing_is_drawn_while_nobody_looks(start, monkeypatch):
    """Without a subscriber no marker is computed; with the first one the drawing begins."""
    drawings = []
    monkeypatch.setattr('thrust_allocator.ros.node.thruster_markers',
                        lambda *_: drawings.append(1) or MarkerArray())
    node, peer = start()
    timer, = (timer for timer in node.timers if timer.timer_period_ns == 200_000_000)
    peer.settle(*cruise(0.9, side=-1.0))
    for _ in range(3):
        timer.callback()
    assert not drawings
    peer.create_subscription(MarkerArray, 'thruster_markers', lambda message: None, 1)
    peer.wait_until(lambda: drawings, 'a picture')
