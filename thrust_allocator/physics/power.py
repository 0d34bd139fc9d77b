"""The power that thrusts are predicted to take in a flow."""

from collections.abc import Callable, Sequence

import numpy as np
from thrust_allocator.physics.flow import Flow
from thrust_allocator.physics.models import ThrusterModel
from thrust_allocator.physics.vehicle import Thruster

FULLY_COUNTED = 0.01  # share of Bollard thrust from which on a thruster's power counts whole


class PredictedPower:
    """
    P = sum P_0 |e / (eta T_0)|^1.5, with e what the propeller's speed gives at rest.

    Power goes with the third power of the propeller's speed, thrust at rest with the second. The
    exponent fits a T200 (Blue Robotics, 16 V) within 6 % at part load.

    A thruster in a flow must turn before it pushes at all, so that its power has a step at zero
    thrust. Nothing that is scaled to a power may have one: below a hundredth of Bollard thrust the
    power is counted in proportion to the thrust.
    """

    def __init__(self, thrusters: Sequence[Thruster]) -> None:
        """Remember the thrusters."""
        self._thrusters = [(i, one) for i, one in enumerate(thrusters) if any(one.bollard_power)]

    @property
    def known(self) -> bool:
        """Tell whether the power of any thruster is known."""
        return bool(self._thrusters)

    def in_flow(self, flow: Flow, models: Sequence[ThrusterModel],
                supply: float = 1.0) -> Callable[[np.ndarray], float]:
        """
        Return the power as a function of the thrusts alone.

        :param flow: how each thruster moves through the water.
        :param models: of the thrusters at the present supply.
        :param supply: share of the thrust at rest that it leaves: a lower voltage leaves as much
            less speed of rotation to be driven [-].
        :return: function of thrusts (p,) within the limits in that flow [N], that gives power [W].
        """
        laws = [(i, models[i].equivalent_in(*flow[i]), one.bollard_thrust, one.bollard_power)
                for i, one in self._thrusters]

        def power(thrusts: np.ndarray) -> float:
            total, wanted = 0.0, thrusts.tolist()
            for i, equivalent, bollard_thrust, bollard_power in laws:
                thrust = wanted[i]
                if thrust:
                    side = thrust > 0.0
                    full = bollard_thrust[side]
                    share = equivalent(thrust) / full
                    counted = min(1.0, thrust / (FULLY_COUNTED * full))
                    total += bollard_power[side] * share**1.5 * counted
            return total * supply**1.5

        return power
