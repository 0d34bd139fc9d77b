"""The moving bounds tau_min(v, theta) and tau_max(v, theta) of the allocation problem."""

import numpy as np
from thrust_allocator.flow import FlowAtThrusters
from thrust_allocator.propeller import PropellerLimits, PropellerLoss
from thrust_allocator.tunnel import TunnelLimits, TunnelLoss
from thrust_allocator.vehicle import Vehicle


class ThrustBounds:
    """The thrust limits of a vehicle as a function of its velocity."""

    def __init__(self, vehicle: Vehicle) -> None:
        thrusters = vehicle.thrusters
        self._flow = FlowAtThrusters(thrusters)
        self._bollard_thrust = np.abs(vehicle.bollard_thrust)
        self._propellers = _indices(vehicle, PropellerLoss)
        self._propeller_limits = PropellerLimits(
            self._bollard_thrust[:, self._propellers],
            [thrusters[i].loss for i in self._propellers])
        self._tunnels = _indices(vehicle, TunnelLoss)
        self._tunnel_limits = TunnelLimits(
            self._bollard_thrust[:, self._tunnels],
            [thrusters[i].loss for i in self._tunnels], vehicle.water_density)

    def __call__(self, velocity: np.ndarray) -> np.ndarray:
        """
        Return the limits at a velocity.

        :param velocity: (6,) velocity of the body origin through the water and turn rate, frd axes
            [m/s, rad/s].
        :return: (2, p), row 0 lower (<= 0), row 1 upper (>= 0), within the Bollard limits [N].
        """
        flow = self._flow(velocity)
        limits = self._bollard_thrust.copy()  # magnitudes; model 'constant' keeps them
        if self._propellers.size:
            limits[:, self._propellers] = self._propeller_limits(
                flow.speed[self._propellers], flow.angle[self._propellers])
        if self._tunnels.size:
            limits[:, self._tunnels] = self._tunnel_limits(flow.transverse[self._tunnels])
        limits[0] = 0.0 - limits[0]  # not -x, which would make -0.0
        return limits


def _indices(vehicle: Vehicle, loss: type) -> np.ndarray:
    return np.array([i for i, thruster in enumerate(vehicle.thrusters)
                     if isinstance(thruster.loss, loss)], dtype=int)
