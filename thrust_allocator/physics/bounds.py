"""The moving bounds tau_min(v, theta) and tau_max(v, theta) of the allocation problem."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.physics.flow import Flow, FlowAtThrusters
from thrust_allocator.physics.models import Limits, LimitsLaw, ThrusterModel
from thrust_allocator.physics.vehicle import Thruster, Vehicle


class ThrustBounds:
    """
    The thrust limits of a vehicle as a function of its velocity.

    Each thruster's law is plain Python on floats: for the handful of thrusters that a vehicle has,
    this takes a fraction of the time of array operations (doc/performance.md).
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self.flow = FlowAtThrusters(vehicle.thrusters)
        self._thrusters = vehicle.thrusters
        self._use([thruster.model for thruster in vehicle.thrusters], 1.0)

    def set_supply(self, share: float) -> None:
        """
        Have the limits follow the voltage of the supply.

        :param share: of the thrust at rest that it leaves, (V / V_0)^n [-].
        """
        if share != self.supply:
            self._use([thruster.model.at_supply(share) for thruster in self._thrusters], share)

    def _use(self, models: Sequence[ThrusterModel], share: float) -> None:
        self.models, self.supply = tuple(models), share
        self._laws = [_law(one, model) for one, model in zip(self._thrusters, models)]

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


def _law(thruster: Thruster, model: ThrusterModel) -> LimitsLaw:
    """Return the limits of a thruster as a function of its speed along and across its axis."""
    if not thruster.in_use:
        return lambda *flow: (0.0, 0.0)
    return _cut_off(model.limits, thruster.cutoff) if thruster.cutoff else model.limits


def _cut_off(law: LimitsLaw, cutoff: float) -> LimitsLaw:
    """Return a law that takes a thruster out, continuously, where its limit is hardly any use."""
    reverse, forward = law(0.0, 0.0, 0.0)  # T_0'
    # (limit - kappa T_0') / (1 - kappa), written so that it is T_0' to the bit at rest
    per_loss = cutoff / (1.0 - cutoff)

    def limits(*flow: float) -> Limits:
        lower, upper = law(*flow)
        return (min(0.0, lower - per_loss * (reverse - lower)),
                max(0.0, upper - per_loss * (forward - upper)))

    return limits
