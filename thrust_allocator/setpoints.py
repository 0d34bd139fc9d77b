"""What a setpoint may stand for: the thrust in the flow, or what gives it at rest."""

from collections.abc import Sequence

from thrust_allocator.physics.flow import Flow
from thrust_allocator.physics.models import ThrusterModel


def _newton(thrusts: list[float], models: Sequence[ThrusterModel], flow: Flow) -> list[float]:
    return thrusts


def _bollard_newton(thrusts: list[float], models: Sequence[ThrusterModel],
                    flow: Flow) -> list[float]:
    return [one.bollard_equivalent(thrust, *motion)
            for thrust, one, motion in zip(thrusts, models, flow)]


def _bollard_fraction(thrusts: list[float], models: Sequence[ThrusterModel],
                      flow: Flow) -> list[float]:
    return [one.bollard_fraction(thrust, *motion)
            for thrust, one, motion in zip(thrusts, models, flow)]


# What a setpoint may stand for: the thrust wanted in the flow [N], or what a driver calibrated at
# rest must be told to deliver it, in newtons or as a share of Bollard thrust; a fin's servo its
# deflection in radians, or as a share of the largest
SETPOINTS = {'newton': _newton, 'bollard_newton': _bollard_newton,
             'bollard_fraction': _bollard_fraction}
