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

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'Constant':
        """Build it from checked values: `bollard_thrust`."""
        return cls(values['bollard_thrust'])

    @cached_property
    def limits(self) -> LimitsLaw:
        """The Bollard limits, whatever the flow."""
        bollard_thrust = self.bollard_thrust
        return lambda *flow: bollard_thrust

    def thrust_in_flow(self, equivalent: float, *flow: float) -> float:
        """Return what the driver was told."""
        return equivalent

    def equivalent_in(self, *flow: float) -> Callable[[float], float]:
        """Return a function that returns the thrust itself."""
        return lambda thrust: thrust
