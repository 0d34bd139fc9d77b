"""A tunnel thruster at speed: Kostenko and Tolstonogov (2017), eq. 3.12, 3.13."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import exp, hypot, log
from typing import Any

from scipy.special import wrightomega
from thrust_allocator.physics.models.model import Limits, LimitsLaw, ThrusterModel


@dataclass(frozen=True)
class Tunnel(ThrusterModel):
    """A thruster in a tunnel, which loses thrust when the vehicle moves across its jet."""

    NAME = 'tunnel'
    PLURAL = 'tunnels'

    bollard_thrust: Limits  # T_0 (reverse <= 0, forward >= 0) [N]
    decay: float  # c; published values are 0.3 to 4 (Palmer et al. 2008) [-]
    jet_mass: float  # rho S, mass of a metre of the jet [kg/m]; only its product with c matters
    strength: float = 1.0  # T_0' / T_0 [-]

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'Tunnel':
        """Build it from checked values, `bollard_thrust`, `decay`, `area` and `water_density`."""
        return cls(values['bollard_thrust'], values['decay'],
                   values['water_density'] * values['area'], values['effectiveness'])

    @cached_property
    def limits(self) -> LimitsLaw:
        """T_0 exp(-c v_t^2 / v_jet^2) (eq. 3.13), v_jet^2 = T_0 / (rho S) (eq. 3.12)."""
        reverse, forward = (self.strength * full for full in self.bollard_thrust)

        def limits(along: float, one: float, other: float = 0.0) -> Limits:
            load = self._load(one, other)
            # A sense without thrust has none to lose
            return (reverse * exp(load / reverse) if reverse else 0.0,
                    forward * exp(-load / forward) if forward else 0.0)

        return limits

    def thrust_in_flow(self, equivalent: float, along: float, one: float,
                       other: float = 0.0) -> float:
        """Return e exp(-c rho S v_t^2 / e) for an equivalent e T_0 / T_0', of its sign [N]."""
        equivalent *= self.strength
        if equivalent == 0.0:
            return equivalent
        return equivalent * exp(-self._load(one, other) / abs(equivalent))

    def equivalent_in(self, along: float, one: float,
                      other: float = 0.0) -> Callable[[float], float]:
        """Return the inverse of `thrust_in_flow`, by Wright's omega function [N]."""
        load = self._load(one, other)
        log_load = log(load) if load > 0.0 else 0.0
        strength, bollard = self.strength, self.bollard_thrust

        def equivalent(thrust: float) -> float:
            if thrust == 0.0:
                return thrust
            side, tau = (1, thrust) if thrust > 0.0 else (0, -thrust)
            # tau = e exp(-load / e): with y = load / e, y + ln y = ln(load / tau)
            y = float(wrightomega(log_load - log(tau)).real) if load > 0.0 else 0.0
            e = load / y if y > 1.0 else tau * exp(y)  # neither overflows nor divides by 0
            e = min(e / strength, abs(bollard[side]))  # which rounding could exceed
            return e if side else -e

        return equivalent

    def _load(self, one: float, other: float) -> float:
        """Return c rho S v_t^2 [N], which set against the thrust tells how much of it is left."""
        across = hypot(one, other)
        return self.decay * self.jet_mass * across * across
