"""A storm of parameter changes while wrenches flow: the setpoints never leave their limits."""

import gc
import time

from diagnostic_msgs.msg import DiagnosticArray
import numpy as np
from numpy.testing import assert_allclose
import pytest
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.clock import Clock, ClockType
from rclpy.parameter import Parameter
from sensor_msgs.msg import BatteryState
from support.stepped_peer import inside_limits
from support.vehicles import RUDDER
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.file import is_of_every_node
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.ros.parameters import plain
from thrust_allocator.solve.problem import AllocationProblem

CHANGES = 400  # half of them invalid
PERIOD = 0.01  # between two wrenches, and two changes [s]
PATIENCE = 60.0  # [s]
WRENCH = np.array([40.0, 0.0, 5.0, 0.0, -20.0, 3.0])
TWIST = np.array([0.7, 0.1, -0.1, 0.0, 0.1, 0.0])
THRUSTERS = ('down', 'left', 'up', 'right', 'tunnel')
SIGNS = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])  # between flu and frd axes


def good(random):
    """Return a change of one or two parameters that must be taken."""
    uniform = random.uniform
    one = f'thrusters.{random.choice(THRUSTERS)}.'
    propeller, tunnel = f'thrusters.{random.choice(THRUSTERS[:4])}.', 'thrusters.tunnel.'
    choices = (
        {one + 'weight': uniform(0.5, 5.0)}, {one + 'enabled': bool(random.random() < 0.7)},
        {one + 'bollard_thrust': [-uniform(0.0, 150.0), uniform(1.0, 150.0)]},
        {one + 'cutoff': uniform(0.0, 0.9)}, {one + 'max_rate': random.choice([0.0, 50.0, 500.0])},
        {propeller + 'speed_loss': [uniform(0.0, 50.0), 20.0]},
        {propeller + 'critical_angle_slope': uniform(0.0, 1.0)},
        {propeller + 'critical_angle_min': uniform(0.1, 1.5)},
        {propeller + 'second_critical_angle_slope': uniform(-1.0, 1.0)},
        {propeller + 'opposed_loss': [uniform(0.0, 50.0)] * 2},
        {propeller + 'opposed_floor': uniform(0.0, 1.0)},
        {tunnel + 'area': uniform(0.01, 0.2), tunnel + 'decay': uniform(0.0, 9.0)},
        {one + 'effectiveness': uniform(0.0, 1.0)},
        {'thrusters.rudder.fin_area': uniform(1e-3, 0.1), 'thrusters.rudder.cut_in_speed': 0.3},
        {'thrusters.rudder.max_deflection': uniform(0.1, 1.0)},
        {'thrusters.rudder.enabled': bool(random.random() < 0.7)},
        {'nominal_voltage': random.choice([0.0, 16.0]), 'voltage_exponent': uniform(0.0, 3.0)},
        {'wrench_origin': uniform(-0.1, 0.1, 3).tolist()},
        {'rate': uniform(45.0, 55.0)}, {'water_density': uniform(900.0, 1100.0)},
        {f'wrench_weights.{random.choice(["surge", "heave", "yaw"])}': 10.0**uniform(0.0, 5.0)},
        {'wrench_weights.pitch': '1.0e4', 'wrench_timeout': uniform(0.3, 1.0)},
        {'odometry_timeout': uniform(0.0, 1.0)},
        {'fallback_velocity': [uniform(-1.0, 1.0), 0.0, 0.0]},
        {'publish_individual': bool(random.random() < 0.5)}, {'marker_frame': 'hull'})
    return choices[random.integers(len(choices))]


def bad(random):
    """Return a change that must be refused, perhaps together with one that would be taken."""
    choices = (
        {'rate': -1.0}, {'rate': 'fast'}, {'rate': 0}, {'wrench_weights.heave': 1e-5},
        {'thrusters.up.weight': 0.0}, {'thrusters.up.weight': 1e-300}, {'rte': 1.0},
        {'thrusters.up.bollard_thrust': [1.0, -1.0]}, {'thrusters.up.enabled': 1},
        {'thrusters.up.opposed_floor': float('nan')}, {'thrusters.tunnel.speed_loss': [1.0, 1.0]},
        {'thrusters.rudder.chord': [0.0, 0.0, 1.0]}, {'thrusters.up.effectiveness': 1.1},
        {'thrusters.up.position': [0.0, 0.0, 0.0]}, {'message_frame': 'frd'},
        {'use_sim_time': True}, {'thruster_names': ['up']}, {'wrench_timeout': None},
        {f'wrench_weights.{dof}': 0.0 for dof in DOFS})
    change = choices[random.integers(len(choices))]
    return {**good(random), **change} if len(change) == 1 else change


class Storm:
    """Sends a wrench, a twist and a change every 10 ms, and keeps the answers."""

    def __init__(self, peer):
        """Begin."""
        self.peer, self.random = peer, np.random.default_rng(6)
        self._battery = peer.create_publisher(BatteryState, 'battery', 1)
        self.sent = []  # (change, whether it is valid, the answer to come)
        self._each = peer.create_client(SetParameters, 'thrust_allocator/set_parameters')
        self._all = peer.create_client(
            SetParametersAtomically, 'thrust_allocator/set_parameters_atomically')
        peer.wait_until(lambda: self._each.service_is_ready() and self._all.service_is_ready(),
                        'the services')
        self._timer = peer.create_timer(
            PERIOD, self.blow, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def blow(self):
        """Send one of each."""
        self.peer.send_wrench(self.random.uniform(-300.0, 300.0, 6))
        self._battery.publish(BatteryState(voltage=self.random.uniform(12.0, 17.0)))
        self.peer.send_twist(self.random.uniform(-1.5, 1.5, 6))
        count = len(self.sent)
        if count == CHANGES:
            self._timer.cancel()
            return
        valid = bool(count % 2)
        change = (good if valid else bad)(self.random)
        parameters = [Parameter(name, value=value).to_parameter_msg()
                      for name, value in change.items()]
        kind, client = ((SetParameters, self._each) if count % 4 == 1
                        else (SetParametersAtomically, self._all))
        self.sent.append((change, valid, client.call_async(kind.Request(parameters=parameters))))

    @property
    def is_over(self):
        """Tell whether all changes have been answered."""
        return len(self.sent) == CHANGES and all(answer.done() for _, _, answer in self.sent)


def problems():
    """Return how many allocation problems are in memory, with no collection of garbage."""
    return sum(isinstance(one, AllocationProblem) for one in gc.get_objects())


@pytest.fixture
def no_collection():
    """Collect no garbage meanwhile: what is replaced must be freed by itself."""
    gc.disable()
    yield
    gc.enable()


def test_storm(no_collection, start, variant):
    """1,000 changes, half invalid, at 100 Hz: right answers, setpoints inside, a healthy end."""
    node, peer = start(file=variant(RUDDER))
    statuses = []
    peer.create_subscription(DiagnosticArray, '/diagnostics', statuses.append, 100)
    peer.on_tick = lambda: None
    storm, before = Storm(peer), problems()
    deadline = time.monotonic() + PATIENCE
    while not storm.is_over:
        assert time.monotonic() < deadline
        peer.spinner.spin_once(timeout_sec=0.02)
    for change, valid, answer in storm.sent:
        results = getattr(answer.result(), 'results', None) or [answer.result().result]
        assert all(one.successful for one in results) is valid, (change, results)
        assert valid or results[0].reason
    assert problems() <= before + 1, 'all that were replaced are freed'
    ticks = peer.ticks
    assert len(ticks) > 100 and all(inside_limits(tick) for tick in ticks)
    assert sum(np.any(tick['thruster_setpoints']) for tick in ticks) > 100
    assert not {status.level for array in statuses for status in array.status} & {b'\x02'}

    sent = [item.sent for item in sorted(peer.received, key=lambda item: item.sent)
            if item.topic == 'thruster_setpoints']
    peer.received.clear()

    # The end: what stands in the parameters is what the node does
    assert all(result.successful for result in node.set_parameters([
        Parameter('wrench_timeout', value=10.0), Parameter('odometry_timeout', value=10.0),
        Parameter('nominal_voltage', value=0.0), Parameter('thrusters.up.enabled', value=True),
        # Limits that go by a rate are never the same at two ticks
        *(Parameter(f'thrusters.{name}.max_rate', value=0.0)
          for name in (*THRUSTERS, 'rudder'))]))
    peer.on_tick = peer.send
    tick = peer.settle(WRENCH, TWIST)
    vehicle = describe({
        name: plain(one.value) for name, one in node.get_parameters_by_prefix('').items()
        if not is_of_every_node(name)}).vehicle
    limits = ThrustBounds(vehicle)(SIGNS * TWIST)
    assert_allclose(tick['thruster_setpoints'], AllocationProblem(vehicle).solve(
        SIGNS * WRENCH, limits).thrusts, atol=1e-5)

    figures = [{pair.key: pair.value for pair in array.status[0].values} for array in statuses]
    print(f'\n{len(ticks)} ticks, {sum(int(one["ticks late"]) for one in figures)} late, '
          f'worst gap {1e-6 * max(np.diff(sent)):.1f} ms')
