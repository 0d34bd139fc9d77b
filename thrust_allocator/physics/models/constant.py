"""A thruster whose limits hold at every speed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from thrust_allocator.physics.models.model import Limits, LimitsLaw, ThrusterModel


@dataclass(frozen=True)
class Constant(ThrusterModel):
    """A thruster that loses nothing in a flow, or for which nothing better is known."""

    NAME = 'constant'
    PLURAL = 'constant thrusters'

    bollard_thrust: Limits  # (reverse <= 0, forward >= 0) [N]
    strength: float = 1.0  # T_0' / T_0 [-]

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'Constant':
        """Build it from checked values: `bollard_thrust` and `effectiveness`."""
        return cls(values['bollard_thrust'], values['effectiveness'])

    @cached_property
    def limits(self) -> LimitsLaw:
        """The Bollard limits, whatever the flow."""
        reverse, forward = (self.strength * full for full in self.bollard_thrust)
        both = reverse + 0.0, forward  # -0.0 + 0.0 is 0.0
        return lambda *flow: both

    def thrust_in_flow(self, equivalent: float, *flow: float) -> float:
        """Return what the driver was told, or what is left of it."""
        return self.strength * equivalent

    def equivalent_in(self, *flow: float) -> Callable[[float], float]:
        """Return a function that returns the thrust itself, as if all of it were left."""
        strength = self.strength
        return lambda thrust: thrust / strength if thrust else thrust
