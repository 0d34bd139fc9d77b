"""Thrust limits of tunnel thrusters at speed: Kostenko and Tolstonogov (2017), eq. 3.12, 3.13."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class TunnelLoss:
    """How a tunnel thruster loses thrust when the vehicle moves across its jet."""

    area: float  # S, cross-section of the jet [m^2]; only the product decay * area matters
    decay: float  # c; published values are 0.3 to 4 (Palmer et al. 2008) [-]


class TunnelLimits:
    """The limits of n tunnel thrusters as a function of the flow, for both senses of thrust."""

    def __init__(self, bollard_thrust: np.ndarray, losses: Sequence[TunnelLoss],
                 water_density: float) -> None:
        """
        Gather the coefficients.

        :param bollard_thrust: (2, n) magnitudes, row 0 reverse, row 1 forward [N].
        :param losses: the n tunnels' coefficients.
        :param water_density: [kg/m^3].
        """
        self._bollard_thrust = bollard_thrust
        decay_area = np.array([loss.decay * loss.area for loss in losses])
        # c / v_jet^2 with v_jet^2 = T_0 / (rho S); a sense without thrust has none to lose
        self._exponent = np.divide(
            -water_density * decay_area, bollard_thrust,
            out=np.zeros_like(bollard_thrust), where=bollard_thrust > 0.0)  # [s^2/m^2]

    def __call__(self, transverse: np.ndarray) -> np.ndarray:
        """
        Return the limits T_0 exp(-c v_t^2 / v_jet^2) in the given flow.

        :param transverse: (n,) speed of the flow across the thrust axis, v_t [m/s].
        :return: (2, n) magnitudes, row 0 reverse, row 1 forward [N].
        """
        return self._bollard_thrust * np.exp(self._exponent * transverse**2)
