"""The node and a peer of it in one process: its topics, as documented."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from support.peer import cruise, SimulatedClock
from support.vehicles import NAMES, PAPER_TEST

OUT = {'thrust_limits': 'std_msgs/msg/Float64MultiArray',
       'thruster_setpoints': 'std_msgs/msg/Float64MultiArray',
       'achieved_wrench': 'geometry_msgs/msg/Wrench',
       'unallocated_wrench': 'geometry_msgs/msg/Wrench'}
IN = {'cmd_wrench': 'geometry_msgs/msg/Wrench', 'odom': 'nav_msgs/msg/Odometry',
      'current': 'geometry_msgs/msg/Vector3Stamped'}
FOR_TOOLS = {'thruster_states': 'sensor_msgs/msg/JointState',
             'wrench_limits': 'std_msgs/msg/Float64MultiArray',
             'thruster_markers': 'visualization_msgs/msg/MarkerArray'}
REPORTS = {'/diagnostics': ['diagnostic_msgs/msg/DiagnosticArray']}  # in every namespace
FLU = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])  # between frd and flu axes
WRENCH = np.array([60.0, 10.0, 20.0, 5.0, 30.0, -15.0])
TWIST = np.array([1.0, 0.3, -0.2, 0.05, 0.1, -0.1])


def assert_alike(tick, other, *topics):
    """Compare two ticks, in all topics if none is given."""
    for topic in topics or OUT:
        assert_allclose(tick[topic], other[topic], atol=1e-6, err_msg=topic)


def is_silent(tick):
    """Tell whether a tick has exact zeros in all but the limits."""
    return all((tick[topic] == 0.0).all() for topic in OUT if topic != 'thrust_limits')


@pytest.mark.parametrize('namespace', ['', '/alpha/beta'])
def test_topics(start, namespace):
    """All documented topics are there by type, in the node's own namespace."""
    _, peer = start(remap=f'__ns:={namespace or "/"}')
    who = ('thrust_allocator', namespace or '/')
    for found, expected, absolute in (
            (peer.get_publisher_names_and_types_by_node(*who), OUT | FOR_TOOLS, REPORTS),
            (peer.get_subscriber_names_and_types_by_node(*who), IN, {})):
        own = {name: types for name, types in found
               if name not in ('/rosout', '/parameter_events')}  # of every ROS node
        assert own == absolute | {
            f'{namespace}/{name}': [kind] for name, kind in expected.items()}
    services = dict(peer.get_service_names_and_types_by_node(*who))
    assert services[f'{namespace}/thrust_allocator/enable'] == ['std_srvs/srv/SetBool']
    assert np.abs(peer.settle(WRENCH, TWIST)['thruster_setpoints']).max() > 1.0


def test_quality_of_service(start):
    """Outputs are reliable, inputs best effort; the newest message is kept, for nobody to come."""
    node, _ = start('publish_individual:=true')
    profiles = {end.topic_name: (end.qos_profile.reliability, end.qos_profile.durability,
                                 end.qos_profile.depth)
                for end in (*node.publishers, *node.subscriptions)}
    outputs = [*OUT, 'thruster_states', *(f'thrusters/{name}/thrust' for name in NAMES)]
    assert {profiles[f'/{topic}'] for topic in outputs} == {
        (ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE, 1)}
    assert {profiles[f'/{topic}'] for topic in IN} == {
        (ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE, 1)}


@pytest.mark.parametrize('reliability', [ReliabilityPolicy.RELIABLE,
                                         ReliabilityPolicy.BEST_EFFORT])
def test_peers_of_either_reliability_are_served(start, reliability):
    """A peer is heard and hears, whether it is reliable or best effort."""
    _, peer = start(reliability=reliability)
    still, moving = peer.settle(WRENCH), peer.settle(WRENCH, TWIST)
    assert np.abs(still['thruster_setpoints']).max() > 1.0
    assert np.abs(moving['thrust_limits'] - still['thrust_limits']).max() > 1.0


def test_layout_of_the_arrays(start):
    """The arrays describe themselves, and the row of the lower limits comes first."""
    _, peer = start()
    peer.settle()
    messages = {item.topic: item.message for item in peer.received}
    limits, setpoints = messages['thrust_limits'], messages['thruster_setpoints']
    assert [(dim.label, dim.size, dim.stride) for dim in limits.layout.dim] == [
        ('limits', 2, 10), ('thrusters', 5, 5)]
    assert [(dim.label, dim.size, dim.stride) for dim in setpoints.layout.dim] == [
        ('thrusters', 5, 5)]
    assert (limits.layout.data_offset, setpoints.layout.data_offset) == (0, 0)
    assert list(limits.data) == [-68.2] * 4 + [-122.0] + [120.1] * 4 + [122.1]
    assert len(setpoints.data) == 5


def test_arrays_follow_thruster_names(start, variant):
    """Another order of thruster_names reorders both arrays and changes nothing else."""
    order = [4, 2, 0, 3, 1]
    _, peer = start()
    _, other = start(file=variant({'thruster_names': [NAMES[i] for i in order]}))
    tick, shuffled = peer.settle(WRENCH, TWIST), other.settle(WRENCH, TWIST)
    tick['thrust_limits'] = tick['thrust_limits'].reshape(2, 5)[:, order].ravel()
    tick['thruster_setpoints'] = tick['thruster_setpoints'][order]
    assert_alike(shuffled, tick)


def test_order_of_publication(start):
    """Each tick publishes the limits first, the setpoints second, and the two wrenches once."""
    _, peer = start()
    peer.wait_for_ticks(5)
    order = [item.topic for item in sorted(peer.received, key=lambda item: item.sent)]
    for i in range(order.index('thrust_limits'), len(order) - 3, 4):
        assert order[i:i + 2] == ['thrust_limits', 'thruster_setpoints']
        assert sorted(order[i + 2:i + 4]) == ['achieved_wrench', 'unallocated_wrench']


def test_every_tick_adds_up(start):
    """Whatever is sent: setpoints inside their tick's limits, achieved is B tau, the rest told."""
    node, peer = start('rate:=200.0', 'wrench_timeout:=60.0')
    random, sent = np.random.default_rng(1), [np.zeros(6)]

    def shake():
        sent.append(random.uniform(-200.0, 200.0, 6))
        peer.send_wrench(sent[-1])
        peer.send_twist(random.uniform(-2.0, 2.0, 6))

    peer.on_tick = shake
    saturated, answered = 0, set()
    for tick in peer.wait_for_ticks(60):
        lower, upper = tick['thrust_limits'].reshape(2, 5)
        thrusts = tick['thruster_setpoints']
        assert (lower <= thrusts).all() and (thrusts <= upper).all()
        saturated += ((thrusts == lower) | (thrusts == upper)).any()
        assert_allclose(tick['achieved_wrench'],
                        FLU * (node.vehicle.configuration_matrix @ thrusts), atol=1e-9)
        errors = [np.abs(tick['achieved_wrench'] + tick['unallocated_wrench'] - wrench).max()
                  for wrench in sent]
        assert min(errors) < 1e-9
        answered.add(int(np.argmin(errors)))
    assert saturated > 30 and len(answered) > 30


@pytest.mark.parametrize('speed, thrusts, stern, tunnel, pitch, heave', PAPER_TEST)
def test_the_papers_test(start, speed, thrusts, stern, tunnel, pitch, heave):
    """The table of the recomputed table of the paper's test comes out of the topics."""
    _, peer = start()
    tick = peer.settle(*cruise(speed, side=-1.0))
    assert_allclose(tick['thruster_setpoints'], thrusts, atol=0.02)
    lower, upper = tick['thrust_limits'].reshape(2, 5)
    assert_allclose(lower[:4], stern[0], atol=0.051)
    assert_allclose(upper, [stern[1]] * 4 + [tunnel], atol=0.051)
    assert_allclose(-tick['achieved_wrench'][[4, 2]], [pitch, heave], atol=0.02)


def test_zeros_until_a_wrench_comes(start):
    """Without a wrench there are exact zeros at every tick, while the limits follow the speed."""
    _, peer = start()
    first, moving = peer.settle(), peer.settle(twist=TWIST)
    assert (moving['thrust_limits'] != first['thrust_limits']).any()
    assert all(is_silent(tick) for tick in peer.ticks)


def test_a_wrench_holds_until_its_time_out(start):
    """One wrench alone is answered at each tick until it is too old."""
    _, peer = start('wrench_timeout:=60.0')
    answer = peer.settle(WRENCH)
    peer.wrench = None
    for tick in peer.wait_for_ticks(10):
        assert_alike(tick, answer)


def test_wrench_time_out(start):
    """A wrench too old gives exact zeros and nothing unallocated; the next one is answered."""
    _, peer = start('wrench_timeout:=0.1')
    answer = peer.settle(WRENCH, TWIST)
    assert np.abs(answer['unallocated_wrench']).max() > 1.0
    silent = peer.settle(None, TWIST)
    assert is_silent(silent)
    assert_array_equal(silent['thrust_limits'], answer['thrust_limits'])
    assert_alike(peer.settle(WRENCH, TWIST), answer)


def test_message_frames(start):
    """The same wrench and twist in flu and in frd axes give the same, each in its own axes."""
    _, frd = start('message_frame:=frd')
    _, flu = start('message_frame:=flu')
    in_frd, in_flu = frd.settle(WRENCH, TWIST), flu.settle(FLU * WRENCH, FLU * TWIST)
    mirrored = flu.settle(WRENCH, TWIST)
    for topic in ('thrust_limits', 'thruster_setpoints'):
        assert np.abs(mirrored[topic] - in_frd[topic]).max() > 1.0
    for topic in ('achieved_wrench', 'unallocated_wrench'):
        in_flu[topic] = FLU * in_flu[topic]
    assert_alike(in_flu, in_frd)


def test_a_dof_of_weight_zero(start):
    """A wrench in a DOF that is not controlled is told as unallocated, and moves no thruster."""
    _, peer = start()
    ignored = np.array([0.0, 30.0, 0.0, 5.0, 0.0, 0.0])
    alone = peer.settle(ignored)
    assert_allclose(alone['thruster_setpoints'], 0.0, atol=1e-9)
    assert_allclose(alone['unallocated_wrench'], ignored, atol=1e-9)
    surge = np.array([50.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    without, both = peer.settle(surge), peer.settle(surge + ignored)
    assert_allclose(both['thruster_setpoints'], without['thruster_setpoints'], atol=1e-9)
    assert_allclose(both['unallocated_wrench'], without['unallocated_wrench'] + ignored, atol=1e-9)


def test_simulated_time(start):
    """With use_sim_time no tick comes while /clock stands, and time-outs are in its seconds."""
    _, peer = start('use_sim_time:=true', 'wrench_timeout:=50.0')
    clock = SimulatedClock(peer)
    peer.settle(WRENCH)
    peer.wrench, clock.step = None, 0
    clock.wait_for_pulses(5)
    before = len(peer.received)
    clock.wait_for_pulses(20)
    assert len(peer.received) == before
    clock.step = 20 * 10**6
    assert not is_silent(peer.wait_for_ticks(5)[-1])
    clock.step = 10 * 10**9
    peer.wait_until(lambda: is_silent(peer.ticks[-1]), 'zeros once 50 s have passed on /clock')


def test_simulated_time_jumps_back(start):
    """After /clock has jumped backwards a wrench from before counts no more."""
    _, peer = start('use_sim_time:=true', 'wrench_timeout:=50.0')
    clock = SimulatedClock(peer)
    peer.settle(WRENCH)
    peer.wrench = None
    clock.wait_for_pulses(5)
    clock.time -= 500 * 10**9
    clock.wait_for_pulses(5)
    assert is_silent(peer.wait_for_ticks(5)[-1])
