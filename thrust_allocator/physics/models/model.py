"""What every thruster model answers: its limits in a flow, and what a motor driver must be told."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import fields
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

Limits = tuple[float, float]  # (lower <= 0, upper >= 0) [N]
Axis = tuple[float, float, float]  # unit vector, frd axes [-]

# Limits as a function of the thruster's speed through the water along its thrust axis and along
# two axes across it [m/s]
LimitsLaw = Callable[[float, float, float], Limits]


class ThrusterModel(ABC):
    """
    How one thruster loses thrust in a flow.

    `flow` stands for the thruster's speed through the water along its thrust axis and along two
    axes across it [m/s]. The *Bollard-equivalent* of a thrust is what the same propeller speed
    gives at rest, as new and at nominal voltage: what a motor driver must be told that goes by a
    curve measured at rest. Kostenko
    and Tolstonogov (2017) give the loss at full speed only (eq. 3.11-3.13); that it is in
    proportion to the speed of rotation, so to the root of the equivalent, is ours.
    """

    NAME: ClassVar[str]  # the word for it in a parameter file
    PLURAL: ClassVar[str]  # several of them, in a picture's legend
    DEFLECTS: ClassVar[bool] = False  # whether it is a surface, told angles and rates of angles

    bollard_thrust: Limits  # at rest, as new and at nominal voltage: T_0 [N]
    strength: float  # share of that which wear and the supply leave: T_0' / T_0 [-]
    chord: Axis | None = None  # the first axis across; None: any two will do

    def at_supply(self, share: float) -> 'ThrusterModel':
        """
        Return the model at another voltage of the supply.

        :param share: of the thrust at rest that the voltage leaves, (V / V_0)^n [-].
        """
        return replace(self, strength=share * self.strength)

    @property
    def reference_limits(self) -> Limits:
        """Limits that tolerances and pictures can go by: at rest, if there are any there [N]."""
        return self.bollard_thrust

    @classmethod
    @abstractmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'ThrusterModel':
        """
        Build the model of one thruster.

        :param values: checked values of the thruster's parameters by their names, and of the
            node's, such as `water_density`.
        """

    @cached_property
    @abstractmethod
    def limits(self) -> LimitsLaw:
        """The limits as a function of the flow, within the Bollard limits, (lower, upper) [N]."""

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields alone: a law, once built, cannot be pickled."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @abstractmethod
    def thrust_in_flow(self, equivalent: float, *flow: float) -> float:
        """
        Return the thrust that a driver told `equivalent` delivers in the flow [N].

        :param equivalent: Bollard-equivalent thrust, within the Bollard limits [N].
        :return: of the sign of `equivalent`, or 0 where the propeller is too slow to push at all.
        """

    @abstractmethod
    def equivalent_in(self, *flow: float) -> Callable[[float], float]:
        """
        Return `bollard_equivalent` as a function of the thrust alone, for one flow.

        The inverse of `thrust_in_flow` where the thrust is not 0; at the limit it is Bollard
        thrust.
        """

    def bollard_equivalent(self, thrust: float, *flow: float) -> float:
        """
        Return what a driver calibrated at rest must be told to deliver `thrust` in the flow [N].

        Of a surface, the deflection that its servo must be told [rad].

        :param thrust: wanted in the flow, within the limits there [N].
        """
        return self.equivalent_in(*flow)(thrust)

    def thrust_per_radian(self, *flow: float) -> float:
        """Return the thrust of a surface in the flow by its deflection [N/rad]."""
        return 0.0

    def deflection(self, thrust: float, *flow: float) -> float:
        """Return the deflection at which a surface gives `thrust` in the flow [rad]."""
        return 0.0

    def bollard_fraction(self, thrust: float, *flow: float) -> float:
        """Return the Bollard-equivalent of `thrust` as a share of full throttle, -1 to 1."""
        equivalent = self.bollard_equivalent(thrust, *flow)
        return equivalent / abs(self.bollard_thrust[equivalent > 0.0]) if equivalent else 0.0
