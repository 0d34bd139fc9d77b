"""The bounds of one thruster in every direction of flow."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.flow import axes_across
from thrust_allocator.physics.models import MODELS
from thrust_allocator.physics.vehicle import Thruster, Vehicle

ANGLES = 61  # from 0 to 180 degrees
SPEEDS = 41  # from 0 to the largest of the study


class Directions(NamedTuple):
    """Limits of a thruster over its own speed and angle of attack."""

    speeds: np.ndarray  # (n,) [m/s]
    angles: np.ndarray  # (m,) of attack, between motion and thrust axis [deg]
    limits: np.ndarray  # (n, m, 2), reverse <= 0 and forward >= 0 [N]


def most_telling(vehicle: Vehicle) -> Thruster:
    """Return the first thruster whose limits depend on the direction most: a propeller first."""
    in_use = [thruster for thruster in vehicle.thrusters if thruster.enabled]
    return min(in_use or vehicle.thrusters,
               key=lambda thruster: list(MODELS).index(thruster.model.NAME))


def directions(thruster: Thruster, largest_speed: float) -> Directions:
    """
    Return the limits of a thruster that moves through the water in every direction.

    Of a fin that is every direction in the plane of its lift and its chord.

    :param largest_speed: of the thruster [m/s].
    """
    alone = replace(thruster, position=(0.0, 0.0, 0.0), enabled=True)
    bounds = ThrustBounds(Vehicle((alone,), (0.0,) * 6))
    along = np.array(thruster.direction)
    across = axes_across(thruster)[0]
    speeds = np.linspace(0.0, largest_speed, SPEEDS)
    angles = np.linspace(0.0, 180.0, ANGLES)
    limits = [[bounds(np.concatenate([
        speed * (np.cos(angle) * along + np.sin(angle) * across), np.zeros(3)]))[:, 0]
        for angle in np.radians(angles)] for speed in speeds]
    return Directions(speeds, angles, np.array(limits))
