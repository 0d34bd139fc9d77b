"""The moving bounds tau_min(v, theta) and tau_max(v, theta) of the allocation problem."""

import numpy as np
from thrust_allocator.physics.flow import Flow, FlowAtThrusters
from thrust_allocator.physics.models import Limits, LimitsLaw
from thrust_allocator.physics.vehicle import Thruster, Vehicle


class ThrustBounds:
    """
    The thrust limits of a vehicle as a function of its velocity.

    Each thruster's law is plain Python on floats: for the handful of thrusters that a vehicle has,
    this takes a fraction of the time of array operations (doc/performance.md).
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self.flow = FlowAtThrusters(vehicle.thrusters)
        self._laws = [_law(thruster) for thruster in vehicle.thrusters]

    def __call__(self, velocity: np.ndarray) -> np.ndarray:
        """
        Return the limits at a velocity.

        :param velocity: (6,) velocity of the body origin through the water and turn rate, frd axes
            [m/s, rad/s].
        :return: (2, p), row 0 lower (<= 0), row 1 upper (>= 0), within the Bollard limits [N].
        """
        return self.in_flow(self.flow(velocity))

    def in_flow(self, flow: Flow) -> np.ndarray:
        """Return the limits, as for a velocity, where the thrusters' motion is known already."""
        return np.array([law(*motion) for law, motion in zip(self._laws, flow)]).T.copy()


def _law(thruster: Thruster) -> LimitsLaw:
    """Return the limits of a thruster as a function of its speed along and across its axis."""
    if not thruster.enabled:
        return lambda *flow: (0.0, 0.0)
    law = thruster.model.limits
    return _cut_off(law, thruster) if thruster.cutoff else law


def _cut_off(law: LimitsLaw, thruster: Thruster) -> LimitsLaw:
    """Return a law that takes a thruster out, continuously, where its limit is hardly any use."""
    reverse, forward = thruster.bollard_thrust
    # (limit - kappa T_0) / (1 - kappa), written so that it is T_0 to the bit at rest
    per_loss = thruster.cutoff / (1.0 - thruster.cutoff)

    def limits(*flow: float) -> Limits:
        lower, upper = law(*flow)
        return (min(0.0, lower - per_loss * (reverse - lower)),
                max(0.0, upper - per_loss * (forward - upper)))

    return limits
