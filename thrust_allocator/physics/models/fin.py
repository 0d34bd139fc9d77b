"""A fin: no lift at rest, more with speed; the mirror image of a tunnel thruster."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
import math
from typing import Any

from thrust_allocator.physics.frames import frd_signs
from thrust_allocator.physics.models.model import Axis, Limits, LimitsLaw, ThrusterModel

REFERENCE_SPEED = 1.0  # of the lift that pictures and tolerances go by [m/s]


@dataclass(frozen=True)
class Fin(ThrusterModel):
    """
    A control surface whose lift is in proportion to its deflection and to the speed squared.

    In `flow` the first axis across is the chord. Lift L = e delta with e = k V |V|, as of the fins
    of REMUS (Prestero, Verification of a Six-Degree of Freedom Simulation Model, 2001). That the
    limit grows in from half the cut-in speed is ours: the slower the flow, the faster a
    deflection has to change for a given lift, without end at rest. Stall, the hull's incidence,
    the propeller's wash and the fin's drag are not modelled.
    """

    NAME = 'fin'
    PLURAL = 'fins'
    DEFLECTS = True

    chord: Axis = field()  # unit vector into the flow, frd axes; no default, unlike the base [-]
    gain: float  # k = 1/2 rho area lift_slope [N/rad per (m/s)^2]
    max_deflection: float  # [rad]
    cut_in_speed: float  # V_c, from which on the whole deflection is used [m/s]
    astern_share: float  # of the lift that is left when the flow comes from behind [-]
    strength: float = 1.0  # share of the lift that damage leaves; the supply takes nothing [-]

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'Fin':
        """Build it from checked values, its own and `water_density` and `vehicle_frame`."""
        chord = frd_signs(values['vehicle_frame'])[:3] * values['chord']
        return cls(
            tuple((chord / math.hypot(*chord)).tolist()),
            lift_gain(values['water_density'], values['fin_area'], values['lift_slope']),
            values['max_deflection'], values['cut_in_speed'], values['astern_share'],
            values['effectiveness'])

    def at_supply(self, share: float) -> 'Fin':
        """Return the fin itself."""
        return self

    @property
    def bollard_thrust(self) -> Limits:
        """Nothing: there is no lift at rest."""
        return 0.0, 0.0

    @property
    def reference_limits(self) -> Limits:
        """The lift at full deflection at 1 m/s [N]."""
        lift = self.gain * REFERENCE_SPEED**2 * self.max_deflection
        return -lift, lift

    @cached_property
    def limits(self) -> LimitsLaw:
        """-+ |e| delta_max s, with s rising from 0 at half the cut-in speed to 1 there."""
        max_deflection = self.max_deflection

        def limits(along: float, chordwise: float, other: float = 0.0) -> Limits:
            share = self._share(chordwise)
            if not share:
                return 0.0, 0.0
            lift = abs(self.thrust_per_radian(along, chordwise)) * max_deflection * share
            return 0.0 - lift, lift  # without lift astern, -lift would be -0.0

        return limits

    def thrust_per_radian(self, along: float, chordwise: float, other: float = 0.0) -> float:
        """Return e = k V |V|, of that the astern share in a flow from behind [N/rad]."""
        return self.strength * self.gain * chordwise * abs(chordwise) * (
            self.astern_share if chordwise < 0.0 else 1.0)

    def deflection(self, thrust: float, along: float, chordwise: float,
                   other: float = 0.0) -> float:
        """Return L / e, within the largest deflection; 0 where no lift is to be had [rad]."""
        slope = self.thrust_per_radian(along, chordwise)
        if not (thrust and slope and self._share(chordwise)):
            return 0.0
        return min(max(thrust / slope, -self.max_deflection), self.max_deflection)

    def thrust_in_flow(self, equivalent: float, *flow: float) -> float:
        """Return the lift of a deflection [N]."""
        return self.thrust_per_radian(*flow) * equivalent

    def equivalent_in(self, *flow: float) -> Callable[[float], float]:
        """Return the deflection as a function of the lift: what the servo must be told [rad]."""
        return lambda thrust: self.deflection(thrust, *flow)

    def bollard_fraction(self, thrust: float, *flow: float) -> float:
        """Return the deflection as a share of the largest, -1 to 1."""
        return self.deflection(thrust, *flow) / self.max_deflection

    def _share(self, chordwise: float) -> float:
        """Return s, the share of the largest deflection that is used at a speed."""
        return min(max(2.0 * abs(chordwise) / self.cut_in_speed - 1.0, 0.0), 1.0)


def lift_gain(water_density: float, fin_area: float, lift_slope: float) -> float:
    """
    Return k = 1/2 rho A dC_L/dalpha: lift by deflection and speed squared [N/rad per (m/s)^2].

    :param water_density: rho [kg/m^3].
    :param fin_area: A [m^2].
    :param lift_slope: of the lift coefficient over the deflection [1/rad].
    """
    return 0.5 * water_density * fin_area * lift_slope
