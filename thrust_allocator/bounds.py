"""The moving bounds tau_min(v, theta) and tau_max(v, theta) of the allocation problem."""

from collections.abc import Callable

import numpy as np
from thrust_allocator.flow import FlowAtThrusters
from thrust_allocator.vehicle import Thruster, Vehicle


class ThrustBounds:
    """
    The thrust limits of a vehicle as a function of its velocity.

    Each thruster's law is plain Python on floats: for the handful of thrusters that a vehicle has,
    this takes a fraction of the time of array operations (doc/performance.md).
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self._flow = FlowAtThrusters(vehicle.thrusters)
        self._laws = [_law(thruster) for thruster in vehicle.thrusters]

    def __call__(self, velocity: np.ndarray) -> np.ndarray:
        """
        Return the limits at a velocity.

        :param velocity: (6,) velocity of the body origin through the water and turn rate, frd axes
            [m/s, rad/s].
        :return: (2, p), row 0 lower (<= 0), row 1 upper (>= 0), within the Bollard limits [N].
        """
        limits = [law(*flow) for law, flow in zip(self._laws, self._flow(velocity))]
        return np.array(tuple(zip(*limits)))


def _law(thruster: Thruster) -> Callable[[float, float], tuple[float, float]]:
    """Return the limits of a thruster as a function of its speed along and across its axis."""
    if thruster.loss is None:
        return lambda along, across: thruster.bollard_thrust
    return thruster.loss.law(thruster.bollard_thrust)
