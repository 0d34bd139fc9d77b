"""What of a thruster's law a table can tell: the coefficients to fit, and why not the others."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
import math

import numpy as np
from thrust_allocator.fit.errors import FitError
from thrust_allocator.fit.measurements import Measurements, SENSES
from thrust_allocator.parameters.models import MODEL_PARAMETERS
from thrust_allocator.parameters.table import THRUSTER
from thrust_allocator.physics.models import Limits, Propeller, ThrusterModel, Tunnel

AXIAL = math.radians(75.0)  # beyond it too little of the axial loss is left to tell it
OBLIQUE = math.radians(10.0)  # below it the angle laws are alike
_DEFAULTS = {one.name: one.default for one in THRUSTER}
SECOND = math.pi / 2 + 0.2  # about where opposed flow begins at 1 m/s


@dataclass(frozen=True)
class Coefficient:
    """One unknown; `side` None: of both senses."""

    name: str
    side: int | None
    unit: str
    start: float
    high: float = math.inf  # it is not negative either

    def __str__(self) -> str:
        return self.name if self.side is None else f'{self.name} {SENSES[self.side]}'


@dataclass(frozen=True)
class Law:
    """A model with some of its coefficients unknown."""

    model: str
    values: Mapping[str, object]  # of the coefficients that are known, by name
    coefficients: tuple[Coefficient, ...]
    reasons: tuple[str, ...] = field(default=())  # why the others are left alone

    def thruster(self, bollard: Limits, found: Sequence[float]) -> ThrusterModel:
        """Return the package's own model with some values of the unknowns."""
        values = {**_DEFAULTS, **self.values, 'bollard_thrust': bollard}
        for one, value in zip(self.coefficients, found):
            if one.side is None:
                values[one.name] = float(value)
            else:
                pair = list(values[one.name])
                pair[one.side] = float(value)
                values[one.name] = tuple(pair)
        return (Propeller if self.model == 'propeller' else Tunnel).from_values(values)

    @property
    def names(self) -> list[str]:
        """Return the names of the unknowns, each once for both senses."""
        return list(dict.fromkeys(one.name for one in self.coefficients))


def propeller_law(rows: Measurements, angle_law: str, quadratic: bool) -> Law:
    """
    Return the propeller's law with what the rows can tell.

    :raises FitError: if they cannot tell C of either sense, or what `quadratic` asks for.
    """
    values: dict[str, object] = {one.name: one.default for one in MODEL_PARAMETERS[Propeller].all
                                 if not one.name.startswith('propeller.')}
    values |= {'angle_law': angle_law, 'speed_loss': (0.0, 0.0)}
    flow = rows.rows(~rows.at_rest)
    found: list[Coefficient] = []
    reasons: list[str] = []
    for side in np.unique(rows.side).tolist():
        for one in _of_sense(flow.rows(flow.side == side), side, quadratic, reasons):
            found.append(one)
    if not any(one.name == 'speed_loss' for one in found):
        raise FitError('the table has no flow within 75 degrees of a sense of thrust, must have '
                       'some: nothing else tells speed_loss')
    if angle_law == 'paper':
        if (why := _no_angle(flow)):
            reasons.append(f'critical_angle_slope keeps its default: {why}')
        else:
            found.append(Coefficient('critical_angle_slope', None, 'rad*s/m', 0.2, 2.0))
    reasons.append('critical_angle_min, second critical angle and opposed_floor keep their '
                   'defaults: a table tells one angle at most')
    return Law('propeller', values, tuple(found), tuple(reasons))


def tunnel_law(rows: Measurements, area: float | None, density: float) -> Law:
    """Return the tunnel's law; only the product of density, area and decay can be told."""
    across = rows.speed * np.sin(rows.angle)
    if not (across > 0.05).any():
        raise FitError('the table has no flow across the tunnel (angle 90), must have some: '
                       'nothing else tells decay')
    surface = area or 0.01
    product = rows.full / float((across**2).max())  # a third of the thrust left at the fastest
    reasons = (f'only the product of area and decay can be told: area {surface:g} m^2 is '
               + ('given' if area else 'assumed (--area)') + f', water_density {density:g} kg/m^3',)
    return Law('tunnel', {'area': surface, 'water_density': density},
               (Coefficient('decay', None, '', product / (density * surface)),), reasons)


def _of_sense(flow: Measurements, side: int, quadratic: bool,
              reasons: list[str]) -> Iterator[Coefficient]:
    """Yield what the rows of one sense can tell."""
    sense = SENSES[side]
    into = flow.rows(flow.incoming < AXIAL)
    if len(into):
        # As if half of the largest loss that can be were C's, at the fastest of them
        start = 0.3 * flow.thrust.max() / into.speed.max() + 1e-6
        yield Coefficient('speed_loss', side, 'N*s/m', max(start, 1e-6))
        if quadratic:
            speeds = np.unique(np.round(into.speed / into.speed.max(), 2))
            if len(speeds) < 2:
                raise FitError(f'--quadratic: the table has one speed {sense}, must have two or '
                               'more to tell speed_loss and speed_loss_quadratic apart')
            yield Coefficient('speed_loss_quadratic', side, 'N*s^2/m^2',
                              0.3 * start / into.speed.max())
    else:
        reasons.append(f'speed_loss {sense} is not fitted: no flow within 75 degrees of its thrust '
                       '(angles count from positive thrust: astern under reverse thrust is 180)')
    against = flow.rows(flow.incoming > SECOND + 0.2 * flow.speed)
    if len(against):
        # Beyond this the floor takes over at every row, and no more can be told
        most = 0.15 * flow.thrust.max() / against.speed.min()
        yield Coefficient('opposed_loss', side, 'N*s/m', 0.3 * max(most, 1e-6), max(most, 1e-6))
    else:
        reasons.append(f'opposed_loss {sense} keeps its default 0: no flow against its jet')


def _no_angle(flow: Measurements) -> str:
    """Say why the rows cannot tell how the loss falls with the angle; nothing: they can."""
    incoming = flow.incoming[flow.incoming < AXIAL]
    if not (incoming > OBLIQUE).any():
        return 'all runs are along the axis'
    if not (incoming < OBLIQUE).any() and np.ptp(incoming) < OBLIQUE:
        return 'all runs are at one angle'
    return ''
