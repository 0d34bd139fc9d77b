"""A propeller in oblique flow: Kostenko and Tolstonogov (2017), eq. 3.7-3.11, or cos^2."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import atan2, cos, hypot, pi, sin, sqrt
from typing import Any

from thrust_allocator.physics.models.model import Limits, LimitsLaw, ThrusterModel

# How the axial loss falls with the angle of the flow: by eq. 3.11, or with the cosine squared,
# which is what measurements say (doc/evidence.md)
ANGLE_LAWS = ('paper', 'cosine')
HALF_PI = pi / 2  # [rad]
SECOND_CRITICAL_ANGLE_MAX = 2.0 * pi / 3.0  # [rad], ours: keeps it well below pi


@dataclass(frozen=True)
class Propeller(ThrusterModel):
    """
    A propeller, which loses thrust by its speed and its angle to the flow.

    Of the loss along its axis, C v + C_2 v^2, the part C v is in proportion to the speed of
    rotation; C_2, the curvature of the thrust coefficient over the advance ratio, does not depend
    on it. The greatest speed of rotation goes with the root of T_0', and so do C and C_a.
    """

    NAME = 'propeller'
    PLURAL = 'propellers'

    bollard_thrust: Limits  # T_0 (reverse <= 0, forward >= 0) [N]
    speed_loss: tuple[float, float]  # C (reverse, forward) [N*s/m]
    critical_angle_slope: float  # a*, of the paper's angle law alone [rad*s/m]
    critical_angle_min: float  # of the paper's angle law alone [rad]
    second_critical_angle_offset: float  # c_2 [rad]
    second_critical_angle_slope: float  # b* [rad*s/m]
    opposed_loss: tuple[float, float]  # C_a (reverse, forward) [N*s/m]
    opposed_floor: float  # phi, share of Bollard thrust that opposed flow cannot take [-]
    speed_loss_quadratic: tuple[float, float] = (0.0, 0.0)  # C_2 (reverse, forward) [N*s^2/m^2]
    angle_law: str = 'paper'  # of ANGLE_LAWS
    strength: float = 1.0  # T_0' / T_0 [-]

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'Propeller':
        """Build it from checked values; C is given, or follows from the propeller's data."""
        speed_loss = values.get('speed_loss') or speed_loss_of_propeller(
            values['propeller.thrust_slope'], values['water_density'],
            values['propeller.max_revolutions'], values['propeller.diameter'],
            values['bollard_thrust'])
        return cls(
            values['bollard_thrust'], speed_loss, values['critical_angle_slope'],
            values['critical_angle_min'], values['second_critical_angle_offset'],
            values['second_critical_angle_slope'], values['opposed_loss'],
            values['opposed_floor'], values['speed_loss_quadratic'], values['angle_law'],
            values['effectiveness'])

    @cached_property
    def limits(self) -> LimitsLaw:
        """
        The limits as a function of the flow.

        The axial loss by the angle law up to the first critical incoming angle, no loss up to the
        second one, and beyond it the loss in opposed flow after Kim and Chung (2006). With the
        law `cosine` the first one is pi/2. Continuous, never above Bollard thrust, never across
        zero; with the paper's law not monotone in speed.
        """
        cosine, revolutions = self.angle_law == 'cosine', sqrt(self.strength)
        reverse, forward = (
            _sense(self._full(side), revolutions * axial, quadratic, revolutions * opposed,
                   self.opposed_floor, cosine)
            for side, axial, quadratic, opposed
            in zip((0, 1), self.speed_loss, self.speed_loss_quadratic, self.opposed_loss))
        first_slope, first_min = (0.0, HALF_PI) if cosine else (
            self.critical_angle_slope, self.critical_angle_min)
        second_start = HALF_PI + self.second_critical_angle_offset
        second_slope = self.second_critical_angle_slope

        def limits(along: float, one: float, other: float = 0.0) -> Limits:
            across = hypot(one, other)
            speed = hypot(along, across)
            angle = atan2(across, along)  # arccos of the normalised product is noisy at 0 and pi
            first = max(HALF_PI - first_slope * speed, first_min)  # eq. 3.9
            second = min(max(second_start + second_slope * speed, first),
                         SECOND_CRITICAL_ANGLE_MAX)
            return (0.0 - reverse(pi - angle, speed, first, second),  # -x could be -0.0
                    forward(angle, speed, first, second))

        return limits

    def thrust_in_flow(self, equivalent: float, *flow: float) -> float:
        """Return e - dL_1 sqrt(e / T_0') - dL_2, see `_losses`, for e T_0 / T_0' [N]."""
        equivalent *= self.strength
        if equivalent == 0.0:
            return equivalent
        side, e = (1, equivalent) if equivalent > 0.0 else (0, -equivalent)
        full = self._full(side)
        turning, steady = self._losses(side, flow)
        thrust = max(e - turning * sqrt(e / full) - steady, 0.0)
        return thrust if side else -thrust

    def equivalent_in(self, *flow: float) -> Callable[[float], float]:
        """Return the inverse of `thrust_in_flow`, the root of a quadratic in sqrt(e) [N]."""
        laws = []
        for side, bollard in enumerate(map(abs, self.bollard_thrust)):
            full, (turning, steady) = self._full(side), self._losses(side, flow)
            # tau + steady = e - 2 half sqrt(e)
            laws.append((bollard, 0.5 * turning / sqrt(full) if full else 0.0, steady))
        strength = self.strength

        def equivalent(thrust: float) -> float:
            if thrust == 0.0:
                return thrust
            forward, tau = (1, thrust) if thrust > 0.0 else (0, -thrust)
            bollard, half, steady = laws[forward]
            e = (half + sqrt(half * half + tau + steady))**2
            e = min(e / strength, bollard)  # which rounding could exceed
            return e if forward else -e

        return equivalent

    def _full(self, side: int) -> float:
        """Return T_0' of one sense [N]."""
        return self.strength * abs(self.bollard_thrust[side])

    def _losses(self, side: int, flow: tuple[float, ...]) -> tuple[float, float]:
        """
        Return what one sense of thrust loses at full speed of rotation, in two parts [N].

        :return: dL_1 in proportion to the speed of rotation, dL_2 whatever it is: that of C_2.
        """
        full = self._full(side)
        steady = full - abs(self._with_quadratic_alone.limits(*flow)[side]) \
            if self.speed_loss_quadratic[side] else 0.0
        return full - abs(self.limits(*flow)[side]) - steady, steady

    @cached_property
    def _with_quadratic_alone(self) -> 'Propeller':
        return replace(self, speed_loss=(0.0, 0.0), opposed_loss=(0.0, 0.0))


def speed_loss_of_propeller(thrust_slope: float, water_density: float, max_revolutions: float,
                            diameter: float, bollard_thrust: Limits) -> tuple[float, float]:
    """
    Return C = a_1 rho Omega_max D^3 by eq. 3.8, 3.10 and 3.11 together, (reverse, forward) [N*s/m].

    In reverse it is scaled with the Bollard limits: thrust vanishes at the same speed.

    :param thrust_slope: a_1, fall of the thrust coefficient over the advance ratio (eq. 3.8) [-].
    :param water_density: rho [kg/m^3].
    :param max_revolutions: Omega_max [rev/s].
    :param diameter: D [m].
    :param bollard_thrust: (reverse <= 0, forward > 0) [N].
    """
    forward = thrust_slope * water_density * max_revolutions * diameter**3
    reverse_limit, forward_limit = bollard_thrust
    return forward * -reverse_limit / forward_limit, forward


def _sense(bollard: float, axial: float, quadratic: float, opposed: float, floor: float,
           cosine: bool) -> Callable[[float, float, float, float], float]:
    """
    Return the limit of one sense of thrust, which sees the flow at the angle `incoming`.

    It is Bollard thrust less what the flow takes (eq. 3.7), and no less than 0.
    """
    most = (1.0 - floor) * bollard  # that opposed flow can take [N]

    def limit(incoming: float, speed: float, first: float, second: float) -> float:
        if incoming <= first:
            share = cos(incoming)**2 if cosine else 1.0 - sin(HALF_PI * incoming / first)
            left = bollard - (axial + quadratic * speed) * speed * share  # eq. 3.11, and C_2
        elif incoming <= second:
            left = bollard
        else:
            left = bollard - min(opposed * speed, most) * (
                1.0 - cos(HALF_PI * (incoming - second) / (pi - second)))
        return left if left > 0.0 else 0.0

    return limit
