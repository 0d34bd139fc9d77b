"""Vehicles for the tests: the paper's one, and random ones."""

import math

import numpy as np
from support.paths import CONFIG
from thrust_allocator.parameters.build import describe, load_vehicle
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant, Fin, Propeller, ThrusterModel, Tunnel
from thrust_allocator.physics.vehicle import Thruster, Vehicle

# The table of the paper's test, recomputed: speed; thrusts down, left, up, right, tunnel; limits of
# a stern thruster; limit of the tunnel; pitch and heave that are reached
PAPER_TEST = (
    (0.0, (-25.74, 0.00, 25.74, 0.00, -19.92), (-68.2, 120.1), 122.1, 50.00, -0.22),
    (0.3, (-24.77, 0.97, 26.71, 0.97, -19.92), (-66.4, 112.5), 84.0, 50.00, -0.22),
    (0.5, (-23.03, 2.71, 28.45, 2.71, -19.92), (-65.3, 107.6), 43.2, 50.00, -0.22),
    (0.7, (-25.13, 5.30, 35.73, 5.30, -15.90), (-64.2, 102.9), 15.9, 49.94, 7.39),
    (0.9, (-35.34, 8.77, 52.88, 8.77, -4.20), (-63.1, 98.4), 4.2, 49.77, 29.56),
    (1.2, (-33.08, 15.59, 64.25, 15.59, -0.31), (-62.5, 92.1), 0.3, 49.71, 36.94),
    (1.5, (-24.66, 24.35, 73.37, 24.35, -0.01), (-62.7, 86.3), 0.0, 49.71, 37.50),
    (1.8, (-16.86, 37.97, 81.19, 37.97, 0.00), (-63.0, 81.2), 0.0, 49.71, 37.52),
)
NAMES = ['down', 'left', 'up', 'right', 'tunnel']  # of MT-2012
HEAVE, PITCH = 2, 4
RUDDER = {  # a fin for MT-2012, as a change of its file
    'thruster_names': [*NAMES, 'rudder'], 'thrusters.rudder': {
        'model': 'fin', 'position': [-1.9, 0.0, 0.0], 'direction': [0.0, 1.0, 0.0],
        'chord': [1.0, 0.0, 0.0], 'fin_area': 0.02, 'lift_slope': 3.0, 'max_deflection': 0.5,
        'cut_in_speed': 0.5, 'astern_share': 0.3, 'max_rate': 1.0, 'weight': 0.1}}


def described(name: str) -> Vehicle:
    """Return one of the vehicles that come with the package."""
    return load_vehicle(CONFIG / f'{name}.yaml')


def mt2012(**changes) -> Vehicle:
    """Return the default vehicle; a change is a full parameter name with '__' for each dot."""
    given = read_parameter_file(default_parameter_file())
    given.update({name.replace('__', '.'): value for name, value in changes.items()})
    return describe(given).vehicle


def paper_test(speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the command and the velocity of the paper's test at a speed, in frd axes."""
    return np.array([40.0 * speed**2, 0.0, 0.0, 0.0, 50.0, 0.0]), np.array([speed] + [0.0] * 5)


def thruster(name='t', position=(0.0, 0.0, 0.0), direction=(1.0, 0.0, 0.0),
             model=Constant((-100.0, 100.0)), weight=1.0, torque_ratio=0.0) -> Thruster:
    """Return a thruster; of model 'constant' unless another is given."""
    return Thruster(name, position, direction, model, weight, torque_ratio)


def limits_of(*thrusters, velocity) -> np.ndarray:
    """Return the limits (2, p) of a vehicle made of these thrusters."""
    return ThrustBounds(Vehicle(thrusters, (1.0,) * 6))(np.array(velocity, dtype=float))


def propeller(**changes) -> Propeller:
    """Return MT-2012's propeller with some coefficients changed."""
    coefficients = {
        'bollard_thrust': (-68.2, 120.1), 'speed_loss': (24.0, 42.2), 'critical_angle_slope': 0.20,
        'critical_angle_min': math.pi / 3, 'second_critical_angle_offset': 0.0,
        'second_critical_angle_slope': 0.20, 'opposed_loss': (9.9, 17.5), 'opposed_floor': 0.85}
    return Propeller(**coefficients | changes)


def fin(**changes) -> Fin:
    """Return the fin of the table of closed forms with some coefficients changed."""
    coefficients = {'chord': (1.0, 0.0, 0.0), 'gain': 0.5 * 1000.0 * 0.0062 * 3.0,
                    'max_deflection': math.radians(30.0), 'cut_in_speed': 0.5, 'astern_share': 0.5}
    return Fin(**coefficients | changes)


def random_vehicle(rng: np.random.Generator, thrusters: int | None = None,
                   fins: float = 0.0) -> Vehicle:
    """
    Return a vehicle of 4 to 12 thrusters of all models, R from 1e1 to 1e6, some of them 0.

    :param fins: share of them that are fins.
    """
    count = thrusters or int(rng.integers(4, 13))
    wrench_weights = 10.0**rng.uniform(1.0, 6.0, 6) * (rng.random(6) < 0.85)
    if not wrench_weights.any():
        wrench_weights[0] = 1e3
    return Vehicle(tuple(_random_thruster(rng, i, fins) for i in range(count)),
                   tuple(wrench_weights.tolist()))


def _random_thruster(rng: np.random.Generator, index: int, fins: float = 0.0) -> Thruster:
    direction = rng.normal(size=3)
    if rng.random() < 0.3:  # along an axis, as most real thrusters are: makes B degenerate
        direction = np.eye(3)[rng.integers(3)]
    direction /= np.linalg.norm(direction)
    if fins and rng.random() < fins:
        chord = np.cross(direction, rng.normal(size=3))
        chord /= np.linalg.norm(chord)
        return thruster(f't{index}', tuple(rng.uniform(-2.0, 2.0, 3)), tuple(direction), fin(
            chord=tuple(chord), gain=rng.uniform(5.0, 200.0)), rng.choice([1.0, 0.1]))
    reverse = 0.0 if rng.random() < 0.1 else -rng.uniform(20.0, 150.0)
    bollard = reverse, rng.uniform(20.0, 150.0)
    model: ThrusterModel = (
        Constant(bollard), Tunnel(bollard, rng.uniform(0.3, 7.0), 1025.0 * 0.07),
        propeller(bollard_thrust=bollard,
                  speed_loss=(rng.uniform(5.0, 30.0), rng.uniform(10.0, 50.0))))[rng.integers(3)]
    return thruster(f't{index}', tuple(rng.uniform(-2.0, 2.0, 3)), tuple(direction), model,
                    rng.choice([1.0, 1.0, 0.5, 3.0]), rng.choice([0.0, 0.0, 0.02]))
