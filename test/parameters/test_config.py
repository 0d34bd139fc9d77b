"""The vehicles in config/: each is the one that it is said to be, and flies by every DOF."""

from math import exp, radians, sqrt

import numpy as np
import pytest
from scipy.optimize import linprog
from support.paths import CONFIG
from thrust_allocator.parameters.build import describe, load_vehicle
from thrust_allocator.parameters.file import read_parameter_file
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.models import Fin, Tunnel
from thrust_allocator.solve.problem import AllocationProblem

FILES = sorted(file.stem for file in CONFIG.glob('*.yaml'))

# What each vehicle does about a positive command in one DOF alone, frd axes, from its drawing: the
# sense of every thruster, in the order of thruster_names; 0: not used
SENSES = {
    'mt2012': {  # down, left, up, right, tunnel
        'surge': '++++0', 'heave': '-0+0+', 'pitch': '-0+0-', 'yaw': '0-0+0'},
    'bluerov2_heavy': {  # front r l, rear r l, vertical front r l, rear r l; horizontal ones low
        'surge': '--++ ++--', 'sway': '+-+- +-+-', 'heave': '0000 ++++', 'roll': '0000 +-+-',
        'pitch': '0000 --++', 'yaw': '+--+ 0000'},
    'delphin2': {  # front and rear vertical, front and rear horizontal, propeller
        'surge': '0000+', 'sway': '00++0', 'heave': '++000', 'pitch': '-+000', 'yaw': '00+-0'},
}
SENSES['delphin2_fins'] = {dof: f'{senses} 0000' for dof, senses in SENSES['delphin2'].items()}
CASES = [(name, dof) for name, senses in SENSES.items() for dof in senses]

# The greatest wrench of either sense in one DOF alone [N, N*m], from the published thrusts and
# lengths by hand; MT-2012's are those of physics
T200 = (39.9, 51.4)
REACH = [
    # The front pair is mounted the other way round: ahead and astern are alike
    ('bluerov2_heavy', 'surge', *[2.0 * sum(T200) / sqrt(2.0)] * 2),
    ('bluerov2_heavy', 'sway', *[2.0 * sum(T200) / sqrt(2.0)] * 2),
    ('bluerov2_heavy', 'heave', 4.0 * T200[0], 4.0 * T200[1]),
    ('bluerov2_heavy', 'yaw', *[2.0 * sum(T200) * (0.156 + 0.111) / sqrt(2.0)] * 2),
    # Of the down and up thrust of a roll or pitch without heave, the weaker one limits both
    ('bluerov2_heavy', 'roll', *[4.0 * T200[0] * 0.218] * 2),
    ('bluerov2_heavy', 'pitch', *[4.0 * T200[0] * 0.120] * 2),
    ('delphin2', 'surge', 9.4, 15.7),
    ('delphin2', 'sway', *[19.3 * (1.45 - 0.205) / (1.45 - 0.80)] * 2),
    ('delphin2', 'heave', *[19.3 * 1.06 / (1.34 - 0.80)] * 2),
    ('delphin2', 'pitch', *[19.3 * 1.06] * 2),
    ('delphin2', 'yaw', *[19.3 * (1.45 - 0.205)] * 2),
    ('mt2012', 'surge', 4.0 * 0.92388 * 68.2, 4.0 * 0.92388 * 120.1),
]


def load(name):
    """Return a vehicle of config/."""
    return load_vehicle(CONFIG / f'{name}.yaml')


def reach(vehicle, dof, sign):
    """Return the greatest wrench at rest in one DOF, no other controlled DOF being disturbed."""
    matrix = vehicle.configuration_matrix
    others = [i for i in range(6) if vehicle.wrench_weights[i] and i != dof]
    found = linprog(-sign * matrix[dof], A_eq=matrix[others], b_eq=np.zeros(len(others)),
                    bounds=vehicle.bollard_thrust.T)
    assert found.success
    return -found.fun


def test_every_vehicle_is_checked():
    """Each file in config/ has its senses here, for exactly the DOFs that it controls."""
    assert set(FILES) == set(SENSES)
    for name in FILES:
        controlled = [dof for dof, weight in zip(DOFS, load(name).wrench_weights) if weight]
        assert controlled == list(SENSES[name])


@pytest.mark.parametrize('name', FILES)
def test_a_file_is_a_sound_vehicle(name):
    """Nothing in the file is ignored, every controlled DOF has thrusters of its own."""
    description = describe(read_parameter_file(CONFIG / f'{name}.yaml'))
    scaled = [one.name for one in description.vehicle.thrusters if name == 'bluerov2_heavy']
    assert description.warnings == [
        f'the speed loss of {", ".join(scaled)} in reverse is scaled from the forward one, which '
        'is optimistic: measure it, and give speed_loss instead of propeller'][:len(scaled)]
    for thruster in description.vehicle.thrusters:  # written to five digits
        given = description.parameters.values[f'thrusters.{thruster.name}.direction']
        assert np.linalg.norm(given) == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize('name', FILES)
def test_the_node_takes_the_file(name, start):
    """ROS 2 reads from the file the vehicle that the package's own reader does."""
    node, _ = start(file=CONFIG / f'{name}.yaml')
    assert node.vehicle == load(name)


@pytest.mark.parametrize('name', FILES)
def test_port_and_starboard_are_mirror_images(name):
    """Each thruster's mirror image is there, with the same limits for the same push."""
    def key(position, direction, limits):
        if tuple(direction) < (0.0, 0.0, 0.0):  # a thruster is its own reverse
            direction, limits = -direction, -limits[::-1]
        return (*(position + 0.0).tolist(), *(direction + 0.0).tolist(), *limits.tolist())

    mirror = np.array([1.0, -1.0, 1.0])
    here, there = set(), set()
    for thruster in load(name).thrusters:
        position, direction, limits = (np.array(value) for value in (
            thruster.position, thruster.direction, thruster.model.reference_limits))
        here.add(key(position, direction, limits))
        there.add(key(mirror * position, mirror * direction, limits))
    assert len(here) == len(load(name).thrusters)
    assert here == there


@pytest.mark.parametrize('name, dof, negative, positive', REACH)
def test_reach_at_rest(name, dof, negative, positive):
    """The greatest wrench in one DOF is what thrusts and lengths give by hand."""
    vehicle, i = load(name), DOFS.index(dof)
    assert (reach(vehicle, i, -1.0), reach(vehicle, i, 1.0)) == pytest.approx(
        (negative, positive), rel=1e-4)


@pytest.mark.parametrize('name', FILES)
def test_sideways_reach_is_the_same_both_ways(name):
    """Sway, roll and yaw reach as far to port as to starboard."""
    vehicle = load(name)
    for dof in (1, 3, 5):
        if vehicle.wrench_weights[dof]:
            assert reach(vehicle, dof, -1.0) == pytest.approx(reach(vehicle, dof, 1.0), rel=1e-9)


@pytest.mark.parametrize('sign', [1.0, -1.0], ids=['ahead', 'back'])
@pytest.mark.parametrize('name, dof', CASES)
def test_each_dof_alone(name, dof, sign):
    """Half of what can be reached is met within 1 %, by the thrusters and senses of the drawing."""
    vehicle, i = load(name), DOFS.index(dof)
    size = 0.5 * min(reach(vehicle, i, 1.0), reach(vehicle, i, -1.0))
    command = np.zeros(6)
    command[i] = sign * size
    result = AllocationProblem(vehicle).solve(command, ThrustBounds(vehicle)(np.zeros(6)))
    assert result.solved
    assert not result.at_bound[np.abs(vehicle.bollard_thrust).max(axis=0) > 0.0].any()
    # MT-2012's heave, of weight 100, is given up by 1.04 %: 1.046 N^2 of thrust per N^2 of heave
    allowed = 0.01 if vehicle.wrench_weights[i] >= 1e4 else 0.011
    controlled = np.flatnonzero(vehicle.wrench_weights)
    assert np.abs(result.unallocated[controlled]).max() < allowed * size

    used = sign * result.thrusts / np.abs(result.thrusts).max()
    senses = ''.join('+' if share > 0.01 else '-' if share < -0.01 else '0' for share in used)
    assert senses == SENSES[name][dof].replace(' ', '')


@pytest.mark.parametrize('speed', [0.3, 0.8])
@pytest.mark.parametrize('name', FILES)
def test_limits_at_cruise(name, speed):
    """Ahead, tunnels lose in both senses, propellers where they drive; nothing gains but fins."""
    vehicle = load(name)
    bounds = ThrustBounds(vehicle)
    limits = np.abs(bounds(np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0])))
    bollard = np.abs(vehicle.bollard_thrust)
    for i, thruster in enumerate(vehicle.thrusters):
        if isinstance(thruster.model, Fin):
            full = 0.5 * 18.57 * radians(30.0) * speed**2  # half of what its software gives a pair
            share = min(2.0 * speed / 0.5 - 1.0, 1.0)
            assert limits[:, i] == pytest.approx([full * share] * 2, rel=1e-4)
            continue
        assert (limits[:, i] <= bollard[:, i]).all()
        assert (limits[:, i] > 0.02 * bollard[:, i]).all()
        ahead = thruster.direction[0]
        if isinstance(thruster.model, Tunnel):
            assert (limits[:, i] < bollard[:, i]).all()
        elif ahead:
            driving = 1 if ahead > 0.0 else 0
            assert limits[driving, i] < bollard[driving, i]
        else:
            assert (limits[:, i] == bollard[:, i]).all()  # across the flow


def test_delphin2_loses_what_its_software_says():
    """At 1 m/s its tunnels keep exp(-0.35) of their thrust, its propeller what its curve gives."""
    vehicle = load('delphin2')
    limits = ThrustBounds(vehicle)(np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert limits[1, :4] == pytest.approx(19.3 * exp(-0.35), rel=5e-3)
    assert all(0.3 <= thruster.model.decay <= 4.0 for thruster in vehicle.thrusters[:4])

    revolutions, diameter = 4.645, 0.305
    for speed in (0.25, 0.5, 0.75, 1.0):
        advance = (1.0 - 0.36) * speed / (revolutions * diameter)
        coefficient = 0.09455 * (1.0 - (advance / 0.69986)**1.5205)
        thrust = 1000.0 * revolutions**2 * diameter**4 * coefficient * (1.0 - 0.11)
        limit = vehicle.thrusters[4].model.limits(speed, 0.0)[1]
        assert limit == pytest.approx(thrust, abs=0.01 * 15.7)


def test_a_t200_is_that_of_the_maker():
    """Limits are the table's at 16 V in newtons; in a flow they vanish near J = 0.75."""
    gravity, revolutions, diameter = 9.80665, 3533.4 / 60.0, 0.076
    for thruster in load('bluerov2_heavy').thrusters:
        assert thruster.bollard_thrust == pytest.approx((-4.069 * gravity, 5.245 * gravity),
                                                        abs=0.05)
        for limit, loss in zip(thruster.bollard_thrust, thruster.model.speed_loss):
            advance = abs(limit) / loss / (revolutions * diameter)
            assert advance == pytest.approx(0.75, rel=0.03)
