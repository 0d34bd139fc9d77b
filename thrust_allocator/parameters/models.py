"""The parameters of each thruster model, under `thrusters.<name>`."""

import math
from typing import NamedTuple

from thrust_allocator.parameters.definition import (
    ANY, Definition, NOT_NEGATIVE, pair, POSITIVE, REQUIRED)
from thrust_allocator.parameters.types import Choice, Real
from thrust_allocator.physics.models import Constant, Propeller, ThrusterModel, Tunnel
from thrust_allocator.physics.models.propeller import ANGLE_LAWS


class ModelParameters(NamedTuple):
    """What a model is told about a thruster, beside what every thruster has."""

    always: tuple[Definition, ...]
    either: tuple[tuple[Definition, ...], ...] = ()  # groups, of which just one is given

    @property
    def all(self) -> tuple[Definition, ...]:
        """Return every parameter that a thruster of this model may have."""
        return self.always + sum(self.either, ())


PAPER_ANGLES = (  # of angle_law paper alone
    Definition('critical_angle_slope', NOT_NEGATIVE, 0.20, 'rad*s/m',
               'a*: slope of the first critical angle; angle_law paper only'),
    Definition('critical_angle_min', Real(0.0, math.pi / 2, above=True), math.pi / 3, 'rad',
               'lower limit of the first critical angle; angle_law paper only'))

PROPELLER = ModelParameters(
    always=(
        Definition('angle_law', Choice(ANGLE_LAWS), 'paper', '',
                   'how the axial loss falls with the angle of the flow'),
        Definition('speed_loss_quadratic', pair(NOT_NEGATIVE), (0.0, 0.0), 'N*s^2/m^2',
                   'C2: thrust lost per unit of axial speed squared [reverse, forward]'),
        *PAPER_ANGLES,
        Definition('second_critical_angle_offset', ANY, 0.0, 'rad',
                   'c2: offset of the second critical angle from pi/2'),
        Definition('second_critical_angle_slope', ANY, 0.20, 'rad*s/m',
                   'b*: slope of the second critical angle'),
        Definition('opposed_loss', pair(NOT_NEGATIVE), (0.0, 0.0), 'N*s/m',
                   'Ca: thrust lost per unit of speed in opposed flow [reverse, forward]'),
        Definition('opposed_floor', Real(0.0, 1.0), 0.85, '',
                   'share of Bollard thrust that opposed flow cannot take')),
    either=(
        (Definition('speed_loss', pair(NOT_NEGATIVE), REQUIRED, 'N*s/m',
                    'C: thrust lost per unit of axial speed [reverse, forward]'),),
        (Definition('propeller.diameter', POSITIVE, REQUIRED, 'm', 'D'),
         Definition('propeller.max_revolutions', POSITIVE, REQUIRED, 'rev/s', 'greatest speed'),
         Definition('propeller.thrust_slope', POSITIVE, REQUIRED, '',
                    'a1: fall of the thrust coefficient per unit of advance ratio'))))

TUNNEL = ModelParameters(
    always=(Definition('area', POSITIVE, REQUIRED, 'm^2', 'S: cross-section of the jet'),
            Definition('decay', NOT_NEGATIVE, REQUIRED, '', 'c: decay of thrust with speed')))

MODEL_PARAMETERS: dict[type[ThrusterModel], ModelParameters] = {
    Propeller: PROPELLER, Tunnel: TUNNEL, Constant: ModelParameters(always=())}
