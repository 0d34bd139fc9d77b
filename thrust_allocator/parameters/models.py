"""The parameters of each thruster model, under `thrusters.<name>`."""

from collections.abc import Callable, Mapping
import math
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from thrust_allocator.parameters.definition import (
    ANY, Definition, NOT_NEGATIVE, pair, POSITIVE, POWER, REQUIRED)
from thrust_allocator.parameters.types import (
    BollardThrust, Choice, Direction, LARGEST, ParameterError, Real)
from thrust_allocator.physics.models import Constant, Fin, Propeller, ThrusterModel, Tunnel
from thrust_allocator.physics.models.fin import lift_gain
from thrust_allocator.physics.models.propeller import ANGLE_LAWS, speed_loss_of_propeller

SQUARE = 1e-3  # cosine of the angle between a fin's chord and direction that counts as 90 degrees


class ModelParameters(NamedTuple):
    """What a model is told about a thruster, beside what every thruster has."""

    always: tuple[Definition, ...]
    either: tuple[tuple[Definition, ...], ...] = ()  # groups, of which just one is given
    instead: Mapping[str, str] = MappingProxyType({})  # what other models have, and why not this
    # Refuses values, by full name, that contradict each other; told what stands before the names
    check: Callable[[Mapping[str, Any], str], None] = lambda values, prefix: None

    @property
    def all(self) -> tuple[Definition, ...]:
        """Return every parameter that a thruster of this model may have."""
        return self.always + sum(self.either, ())


BOLLARD = (
    Definition('bollard_thrust', BollardThrust(), REQUIRED, 'N',
               'greatest thrust at rest [reverse, forward]'),
    Definition('bollard_power', pair(POWER), (0.0, 0.0), 'W',
               'power at bollard_thrust [reverse, forward]; needed where power_limit is given'),
    Definition('cutoff', Real(0.0, 1.0, below=True), 0.0, '',
               'share of Bollard thrust below which a limit is not worth using'),
    Definition('torque_ratio', ANY, 0.0, 'm', 'k: reaction torque about direction per N',
               live=False),
)  # of whatever pushes at rest

PAPER_ANGLES = (  # of angle_law paper alone
    Definition('critical_angle_slope', NOT_NEGATIVE, 0.20, 'rad*s/m',
               'a*: slope of the first critical angle; angle_law paper only'),
    Definition('critical_angle_min', Real(0.0, math.pi / 2, above=True), math.pi / 3, 'rad',
               'lower limit of the first critical angle; angle_law paper only'))


def _check_propeller(values: Mapping[str, Any], prefix: str) -> None:
    if values[f'{prefix}angle_law'] == 'cosine':
        _check_cosine(values, prefix)
    if f'{prefix}propeller.diameter' in values:
        _check_data(values, prefix)


def _check_data(values: Mapping[str, Any], prefix: str) -> None:
    """Refuse a propeller that gives no C, or one beyond what speed_loss may be."""
    bollard_thrust = values[f'{prefix}bollard_thrust']
    if bollard_thrust[1] == 0.0:
        raise ParameterError.wrong(
            f'{prefix}bollard_thrust', list(bollard_thrust),
            '[reverse, forward] with forward > 0 where propeller is given; or give speed_loss')
    speed_loss = speed_loss_of_propeller(
        values[f'{prefix}propeller.thrust_slope'], values['water_density'],
        values[f'{prefix}propeller.max_revolutions'], values[f'{prefix}propeller.diameter'],
        bollard_thrust)
    if max(speed_loss) > LARGEST:
        raise ParameterError.wrong(f'{prefix}propeller', speed_loss,
                                   f'such that speed_loss is at most {LARGEST:g}')


def _check_cosine(values: Mapping[str, Any], prefix: str) -> None:
    """Refuse what only the paper's angle law would heed, unless it is the default, as in a dump."""
    for name, _, default, *_ in PAPER_ANGLES:
        if not math.isclose(values[prefix + name], default, rel_tol=1e-4):
            raise ParameterError.wrong(prefix + name, values[prefix + name],
                                       f'left out, or {default:.5g}, where angle_law is cosine, '
                                       'which has no such angle')


def _check_fin(values: Mapping[str, Any], prefix: str) -> None:
    """Refuse a chord that is not at right angles to the lift, and a lift beyond any vehicle."""
    chord, direction = values[f'{prefix}chord'], values[f'{prefix}direction']
    cosine = np.dot(chord, direction) / math.hypot(*chord) / math.hypot(*direction)
    if abs(cosine) > SQUARE:
        raise ParameterError.wrong(f'{prefix}chord', list(chord),
                                   f'at right angles to direction, {list(direction)}')
    area = values[f'{prefix}fin_area']
    if lift_gain(values['water_density'], area, values[f'{prefix}lift_slope']) > LARGEST:
        raise ParameterError.wrong(f'{prefix}fin_area', area, 'such that the lift at 1 m/s is at '
                                   f'most {LARGEST:g} N/rad')


PROPELLER = ModelParameters(
    always=(
        *BOLLARD,
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
                    'a1: fall of the thrust coefficient per unit of advance ratio'))),
    check=_check_propeller)

TUNNEL = ModelParameters(
    always=(*BOLLARD, Definition('area', POSITIVE, REQUIRED, 'm^2', 'S: cross-section of the jet'),
            Definition('decay', NOT_NEGATIVE, REQUIRED, '', 'c: decay of thrust with speed')))

FIN = ModelParameters(
    always=(
        Definition('chord', Direction(), REQUIRED, '',
                   'into the flow, at right angles to direction', live=False),
        Definition('fin_area', POSITIVE, REQUIRED, 'm^2', 'its planform'),
        Definition('lift_slope', POSITIVE, REQUIRED, '1/rad',
                   'lift coefficient per unit of deflection'),
        Definition('max_deflection', Real(0.0, math.pi / 2, above=True), REQUIRED, 'rad',
                   'greatest deflection, either way'),
        Definition('cut_in_speed', POSITIVE, REQUIRED, 'm/s',
                   'from which on all of it is used; below half of it none'),
        Definition('astern_share', Real(0.0, 1.0), 0.0, '',
                   'share of the lift that is left when the flow comes from behind')),
    instead={
        'bollard_thrust': 'has no thrust at rest; its limits follow from fin_area, lift_slope and '
                          'max_deflection',
        'bollard_power': 'takes none to speak of',
        'cutoff': 'has no thrust at rest that it could be a share of; cut_in_speed takes it out',
        'torque_ratio': 'has no propeller'},
    check=_check_fin)

MODEL_PARAMETERS: dict[type[ThrusterModel], ModelParameters] = {
    Propeller: PROPELLER, Tunnel: TUNNEL, Fin: FIN, Constant: ModelParameters(always=BOLLARD)}
