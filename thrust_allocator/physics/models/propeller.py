"""Thrust limits of a propeller in oblique flow: Kostenko and Tolstonogov (2017), eq. 3.7-3.11."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin
from typing import Any

from thrust_allocator.parameters.types import LARGEST, ParameterError

SECOND_CRITICAL_ANGLE_MAX = 2.0 * pi / 3.0  # [rad], ours: keeps it well below pi


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
    def from_parameters(cls, name: str, values: Mapping[str, Any]) -> 'PropellerLoss':
        """
        Build it from the checked parameters of a thruster and the water's density.

        C is given, or follows from the propeller: C = a_1 rho Omega_max D^3 [N*s/m] by eq. 3.8,
        3.10 and 3.11 together, where a_1 is the slope of the thrust coefficient over the advance
        ratio. In reverse C is scaled with the Bollard limits: thrust vanishes at the same speed.

        :raises ParameterError: if the propeller gives a C beyond what speed_loss may be.
        """
        if 'speed_loss' in values:
            speed_loss = values['speed_loss']
        else:
            forward = (values['propeller.thrust_slope'] * values['water_density']
                       * values['propeller.max_revolutions'] * values['propeller.diameter']**3)
            reverse_limit, forward_limit = values['bollard_thrust']
            speed_loss = (forward * -reverse_limit / forward_limit, forward)
            if max(speed_loss) > LARGEST:
                raise ParameterError.wrong(f'thrusters.{name}.propeller', speed_loss,
                                           f'such that speed_loss is at most {LARGEST:g}')
        return cls(
            speed_loss, values['critical_angle_slope'], values['critical_angle_min'],
            values['second_critical_angle_offset'], values['second_critical_angle_slope'],
            values['opposed_loss'], values['opposed_floor'])

    def law(self, bollard_thrust: tuple[float, float]) -> Callable[
            [float, float], tuple[float, float]]:
        """
        Return the limits as a function of the flow.

        Eq. 3.11 up to the first critical incoming angle, no loss up to the second one, and beyond
        it the loss in opposed flow after Kim and Chung (2006). Continuous, never above Bollard
        thrust, never across zero; not monotone in speed, by the paper's own law.

        :param bollard_thrust: limits at rest (reverse <= 0, forward >= 0) [N].
        :return: function of the thruster's speed along its thrust axis and across it, the latter
            >= 0 [m/s], that gives (lower <= 0, upper >= 0) [N].
        """
        reverse, forward = (
            _sense(bollard, axial, opposed, self.opposed_floor) for bollard, axial, opposed
            in zip((-bollard_thrust[0], bollard_thrust[1]), self.speed_loss, self.opposed_loss))
        first_slope, first_min = self.critical_angle_slope, self.critical_angle_min
        second_start = pi / 2 + self.second_critical_angle_offset
        second_slope = self.second_critical_angle_slope

        def limits(along: float, across: float) -> tuple[float, float]:
            speed = hypot(along, across)
            angle = atan2(across, along)  # arccos of the normalised product is noisy at 0 and pi
            first = max(pi / 2 - first_slope * speed, first_min)
            second = min(max(second_start + second_slope * speed, first),
                         SECOND_CRITICAL_ANGLE_MAX)
            return (0.0 - reverse(pi - angle, speed, first, second),  # -x could be -0.0
                    forward(angle, speed, first, second))

        return limits


def _sense(bollard: float, axial: float, opposed: float, floor: float) -> Callable[
        [float, float, float, float], float]:
    """Return the limit of one sense of thrust, which sees the flow at the angle `incoming`."""
    most = (1.0 - floor) * bollard  # that opposed flow can take [N]

    def limit(incoming: float, speed: float, first: float, second: float) -> float:
        if incoming <= first:
            left = bollard - axial * speed * (1.0 - sin(pi / 2 * incoming / first))  # eq. 3.11
        elif incoming <= second:
            left = bollard
        else:
            left = bollard - min(opposed * speed, most) * (
                1.0 - cos(pi / 2 * (incoming - second) / (pi - second)))
        return left if left > 0.0 else 0.0

    return limit
