"""Thrust limits of a tunnel thruster at speed: Kostenko and Tolstonogov (2017), eq. 3.12, 3.13."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp
from typing import Any


@dataclass(frozen=True)
class TunnelLoss:
    """How a tunnel thruster loses thrust when the vehicle moves across its jet."""

    decay: float  # c; published values are 0.3 to 4 (Palmer et al. 2008) [-]
    jet_mass: float  # rho S, mass of a metre of the jet [kg/m]; only its product with c matters

    @classmethod
    def from_parameters(cls, name: str, values: Mapping[str, Any]) -> 'TunnelLoss':
        """Build it from the checked parameters of a thruster and the water's density."""
        return cls(values['decay'], values['water_density'] * values['area'])

    def law(self, bollard_thrust: tuple[float, float]) -> Callable[
            [float, float], tuple[float, float]]:
        """
        Return the limits T_0 exp(-c v_t^2 / v_jet^2), v_jet^2 = T_0 / (rho S), as a function.

        :param bollard_thrust: limits at rest (reverse <= 0, forward >= 0) [N].
        :return: function of the thruster's speed along its thrust axis, which does not matter, and
            v_t across it [m/s], that gives (lower <= 0, upper >= 0) [N].
        """
        reverse, forward = bollard_thrust

        def limits(along: float, across: float) -> tuple[float, float]:
            load = self.load(across)
            # A sense without thrust has none to lose
            return (reverse * exp(load / reverse) if reverse else 0.0,
                    forward * exp(-load / forward) if forward else 0.0)

        return limits

    def load(self, across: float) -> float:
        """Return c rho S v_t^2 [N], which set against the thrust tells how much of it is left."""
        return self.decay * self.jet_mass * across * across
