"""Thrust limits of propellers in oblique flow: Kostenko and Tolstonogov (2017), eq. 3.7-3.11."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any

import numpy as np

SECOND_CRITICAL_ANGLE_MAX = 2.0 * math.pi / 3.0  # [rad], ours: keeps it well below pi


@dataclass(frozen=True)
class PropellerLoss:
    """How a propeller loses thrust in a flow; pairs are (reverse, forward)."""

    speed_loss: tuple[float, float]  # C [N*s/m]
    critical_angle_slope: float  # a* [rad*s/m]
    critical_angle_min: float  # [rad]
    second_critical_angle_offset: float  # c_2 [rad]
    second_critical_angle_slope: float  # b* [rad*s/m]
    opposed_loss: tuple[float, float]  # C_a [N*s/m]
    opposed_floor: float  # phi, share of Bollard thrust that opposed flow cannot take [-]

    @classmethod
    def from_parameters(cls, values: Mapping[str, Any], water_density: float) -> 'PropellerLoss':
        """
        Build it from a thruster's checked parameters.

        C is given, or follows from the propeller: C = a_1 rho Omega_max D^3 [N*s/m] by eq. 3.8,
        3.10 and 3.11 together, where a_1 is the slope of the thrust coefficient over the advance
        ratio. In reverse C is scaled with the Bollard limits: thrust vanishes at the same speed.

        :param water_density: [kg/m^3].
        """
        if 'speed_loss' in values:
            speed_loss = values['speed_loss']
        else:
            forward = (values['propeller.thrust_slope'] * water_density
                       * values['propeller.max_revolutions'] * values['propeller.diameter']**3)
            reverse_limit, forward_limit = values['bollard_thrust']
            speed_loss = (forward * -reverse_limit / forward_limit, forward)
        return cls(
            speed_loss, values['critical_angle_slope'], values['critical_angle_min'],
            values['second_critical_angle_offset'], values['second_critical_angle_slope'],
            values['opposed_loss'], values['opposed_floor'])


class PropellerLimits:
    """The limits of n propellers as a function of the flow, for both senses of thrust."""

    def __init__(self, bollard_thrust: np.ndarray, losses: Sequence[PropellerLoss]) -> None:
        """
        Gather the coefficients.

        :param bollard_thrust: (2, n) magnitudes, row 0 reverse, row 1 forward [N].
        :param losses: the n propellers' coefficients.
        """
        self._bollard_thrust = bollard_thrust
        self._speed_loss = _rows(losses, 'speed_loss')
        self._angle_slope = _rows(losses, 'critical_angle_slope')
        self._angle_min = _rows(losses, 'critical_angle_min')
        self._second_angle_start = math.pi / 2 + _rows(losses, 'second_critical_angle_offset')
        self._second_angle_slope = _rows(losses, 'second_critical_angle_slope')
        self._opposed_loss = _rows(losses, 'opposed_loss')
        self._opposed_most = (1.0 - _rows(losses, 'opposed_floor')) * bollard_thrust

    def __call__(self, speed: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """
        Return the limits in the given flow.

        Eq. 3.11 up to the first critical incoming angle, no loss up to the second one, and beyond
        it the loss in opposed flow after Kim and Chung (2006). Continuous in both arguments, never
        above Bollard thrust, never below zero; not monotone in speed, by the paper's own law.

        :param speed: (n,) speed of the flow [m/s].
        :param angle: (n,) angle of attack in [0, pi] [rad].
        :return: (2, n) magnitudes, row 0 reverse, row 1 forward [N].
        """
        incoming = np.stack([math.pi - angle, angle])  # the angle that each sense of thrust sees
        first = np.maximum(math.pi / 2 - self._angle_slope * speed, self._angle_min)
        second = np.clip(self._second_angle_start + self._second_angle_slope * speed,
                         first, SECOND_CRITICAL_ANGLE_MAX)
        axial_loss = self._speed_loss * speed * (
            1.0 - np.sin(math.pi / 2 * np.minimum(incoming / first, 1.0)))  # eq. 3.11
        opposed_loss = np.minimum(self._opposed_loss * speed, self._opposed_most) * (
            1.0 - np.cos(math.pi / 2 * np.maximum(incoming - second, 0.0) / (math.pi - second)))
        return np.maximum(self._bollard_thrust - axial_loss - opposed_loss, 0.0)


def _rows(losses: Sequence[PropellerLoss], name: str) -> np.ndarray:
    """Return one coefficient of every propeller: (n,), or (2, n) if it differs with the sense."""
    return np.array([getattr(loss, name) for loss in losses]).T
