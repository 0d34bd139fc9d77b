"""The sequences of ticks that the benchmark is run on; the same numbers at every run."""

from typing import NamedTuple

import numpy as np
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.file import default_parameter_file
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Propeller, Tunnel
from thrust_allocator.physics.vehicle import Thruster, Vehicle

RATE = 50.0  # ticks per second, the node's default [Hz]
TOP_SPEED = 1.8  # of the paper's test [m/s]

# Velocity: an AUV of MT-2012's size reaches a new speed in seconds (half a tonne against a drag of
# 40 v^2 N), and turns faster than that. Surge about a cruising speed, the rest about 0.
MEAN_VELOCITY = np.array([0.9, 0.0, 0.0, 0.0, 0.0, 0.0])  # [m/s, rad/s]
SPREAD_OF_VELOCITY = np.array([0.4, 0.15, 0.15, 0.1, 0.1, 0.15])  # standard deviation
TIME_OF_VELOCITY = np.array([5.0, 3.0, 3.0, 1.0, 1.0, 1.0])  # time constants [s]

# Wrench: a controller closes its loops at a few tenths of a hertz; 0.5 s is 0.3 Hz
TIME_OF_WRENCH = np.full(6, 0.5)  # [s]
SMOOTH = 0.15  # standard deviation of each DOF, of what all thrusters together could give in it
FULL = 0.6  # the same for the walk with reversals: most commands are out of reach
REVERSAL = 1.0  # mean time between two reversals [s]
ON, OFF = 10.0, 2.0  # mean time that a thruster stays switched on and off [s]


class Tick(NamedTuple):
    """What the allocator is given at one tick."""

    wrench: np.ndarray  # f, (6,), frd axes [N, N*m]
    velocity: np.ndarray  # (6,), frd axes [m/s, rad/s]
    limits: np.ndarray  # (2, p), row 0 lower, row 1 upper; 0 and 0 for one switched off [N]


class Walk(NamedTuple):
    """A vehicle and its ticks, one after another."""

    name: str
    vehicle: Vehicle
    ticks: list[Tick]


def mt2012() -> Vehicle:
    """Return the default vehicle."""
    return load_vehicle(default_parameter_file())


def paper_sweep(count: int = 1801) -> Walk:
    """Return the paper's test: MT-2012 gathers speed and holds 50 N*m of pitch."""
    vehicle = mt2012()
    speeds = np.linspace(0.0, TOP_SPEED, count)
    wrenches, velocities = np.zeros((2, count, 6))
    wrenches[:, 0], wrenches[:, 4], velocities[:, 0] = 40.0 * speeds**2, 50.0, speeds
    return _walk("the paper's sweep", vehicle, wrenches, velocities)


def smooth_walk(vehicle: Vehicle, count: int = 10_000, seed: int = 1) -> Walk:
    """Return a random walk whose velocity and wrench move as a vehicle's do."""
    rng = np.random.default_rng(seed)
    return _walk('smooth walk', vehicle, _wrenches(rng, vehicle, count, SMOOTH),
                 _velocities(rng, count))


def switching_walk(vehicle: Vehicle, count: int = 10_000, seed: int = 2) -> Walk:
    """Return a walk with the wrench reversed at full scale and thrusters switched off and on."""
    rng = np.random.default_rng(seed)
    wrenches = _wrenches(rng, vehicle, count, FULL)
    reversed_now = rng.random(count) < 1.0 / (REVERSAL * RATE)
    wrenches *= np.where(np.cumsum(reversed_now) % 2, -1.0, 1.0)[:, np.newaxis]
    walk = _walk('reversals and switching', vehicle, wrenches, _velocities(rng, count))
    on = np.ones(len(vehicle.thrusters), dtype=bool)
    for tick in walk.ticks:
        on ^= rng.random(len(on)) < np.where(on, 1.0 / (ON * RATE), 1.0 / (OFF * RATE))
        tick.limits[:, ~on] = 0.0
    return walk


def random_vehicle(thrusters: int, seed: int = 0) -> Vehicle:
    """Return a vehicle of MT-2012's kinds: every fifth thruster a tunnel, the rest propellers."""
    rng = np.random.default_rng([seed, thrusters])
    kinds = mt2012().thrusters
    propeller, tunnel = (next(one for one in kinds if one.model.NAME == model.NAME)
                         for model in (Propeller, Tunnel))
    chosen = [tunnel if i % 5 == 4 else propeller for i in range(thrusters)]
    directions = rng.normal(size=(thrusters, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    positions = rng.uniform(-2.0, 2.0, (thrusters, 3))
    return Vehicle(
        tuple(Thruster(f'{i}', tuple(position), tuple(direction), kind.model,
                       kind.weight, kind.torque_ratio)
              for i, (kind, position, direction) in enumerate(
                  zip(chosen, positions.tolist(), directions.tolist()))),
        (1e4,) * 6)


def _wrenches(rng: np.random.Generator, vehicle: Vehicle, count: int, share: float) -> np.ndarray:
    """Return wandering wrenches, (count, 6), 0 in the DOFs that are not controlled."""
    reach = np.abs(vehicle.configuration_matrix) @ np.abs(vehicle.reference_limits).mean(axis=0)
    reach[np.array(vehicle.wrench_weights) == 0.0] = 0.0
    return share * reach * _filtered_noise(rng, count, TIME_OF_WRENCH)


def _velocities(rng: np.random.Generator, count: int) -> np.ndarray:
    return MEAN_VELOCITY + SPREAD_OF_VELOCITY * _filtered_noise(rng, count, TIME_OF_VELOCITY)


def _filtered_noise(rng: np.random.Generator, count: int, times: np.ndarray) -> np.ndarray:
    """Return white noise through first-order filters, (count, n): mean 0, deviation 1."""
    keep = np.exp(-1.0 / (RATE * times))
    noise = rng.normal(size=(count, len(times)))
    noise[1:] *= np.sqrt(1.0 - keep**2)
    for i in range(1, count):
        noise[i] += keep * noise[i - 1]
    return noise


def _walk(name: str, vehicle: Vehicle, wrenches: np.ndarray, velocities: np.ndarray) -> Walk:
    bounds = ThrustBounds(vehicle)
    return Walk(name, vehicle, [Tick(wrench, velocity, bounds(velocity))
                                for wrench, velocity in zip(wrenches, velocities)])
