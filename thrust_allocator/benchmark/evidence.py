"""The laws of thrust at speed against measurements: half of the points fitted, half predicted."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, least_squares
from thrust_allocator.benchmark.published import b_series, Oblique, OpenWater, rotor_in_oblique_flow
from thrust_allocator.markdown import table
from thrust_allocator.parameters.models import MODEL_PARAMETERS
from thrust_allocator.parameters.table import THRUSTER
from thrust_allocator.physics.models import Propeller

# Advance ratios are turned into speeds as if each propeller were the T200 of BlueROV2, 0.076 m and
# 58.9 rev/s: only the paper's law, whose critical angle goes with the speed, depends on it
TIP = 0.076 * 58.9  # n D [m/s]
_DEFAULTS = {one.name: one.default for one in (*THRUSTER, *MODEL_PARAMETERS[Propeller].all)
             if not one.name.startswith('propeller.')}


class Law(NamedTuple):
    """A law and its coefficients, which start at 1; Bollard thrust is 1."""

    name: str
    angle_law: str
    fitted: tuple[str, ...]  # of speed_loss, speed_loss_quadratic, critical_angle_slope


LAWS = (
    Law('Bollard limits at every speed', 'cosine', ()),
    Law("the paper's law", 'paper', ('speed_loss',)),
    Law("the paper's law, a* fitted too", 'paper', ('speed_loss', 'critical_angle_slope')),
    Law('cosine', 'cosine', ('speed_loss',)),
    Law('cosine with quadratic', 'cosine', ('speed_loss', 'speed_loss_quadratic')))
STRAIGHT = (LAWS[0], LAWS[3], LAWS[4])  # straight ahead the angle laws are one


@dataclass(frozen=True)
class Points:
    """Measured shares of the thrust at rest (n,)."""

    along: np.ndarray  # speed along the thrust [m/s]
    across: np.ndarray  # and across it [m/s]
    share: np.ndarray  # [-]

    def some(self, chosen: np.ndarray | slice) -> 'Points':
        """Return some of the points."""
        return Points(self.along[chosen], self.across[chosen], self.share[chosen])


def limits(law: Law, found: Sequence[float], points: Points) -> np.ndarray:
    """Return the forward limits of the package's own model, Bollard thrust being 1 (n,) [-]."""
    values = {**_DEFAULTS, 'bollard_thrust': (0.0, 1.0), 'angle_law': law.angle_law,
              'speed_loss': (0.0, 0.0)}
    for name, value in zip(law.fitted, found):
        values[name] = float(value) if name == 'critical_angle_slope' else (0.0, float(value))
    model = Propeller.from_values(values).limits
    return np.array([model(along, across)[1] for along, across in
                     zip(points.along.tolist(), points.across.tolist())])


def fit(law: Law, points: Points) -> np.ndarray:
    """Return the coefficients by least squares, thrusts above that at rest taken for it."""
    if not law.fitted:
        return np.array([])
    start = [0.1] * len(law.fitted)
    return least_squares(lambda x: limits(law, x, points) - np.clip(points.share, 0.0, 1.0), start,
                         bounds=(0.0, np.inf)).x


def oblique_points(rotor: Oblique) -> Points:
    """Return the rotor's table as points."""
    speed = TIP * rotor.advance_ratio
    return Points(speed * np.cos(rotor.angle), speed * np.sin(rotor.angle), rotor.share)


def straight_points(propeller: OpenWater) -> Points:
    """Return a propeller's curve, as far as it pushes, without the point at rest."""
    pushing = slice(1, int((propeller.thrust > 0.0).sum()))
    speed = TIP * propeller.advance_ratio[pushing]
    return Points(speed, np.zeros_like(speed), propeller.thrust[pushing] / propeller.thrust[0])


def held_out(law: Law, points: Points) -> tuple[np.ndarray, np.ndarray]:
    """Fit the odd points; return the coefficients and the errors of the even ones (+ too much)."""
    found, rest = fit(law, points.some(slice(0, None, 2))), points.some(slice(1, None, 2))
    return found, limits(law, found, rest) - rest.share


def report(pictures: Path | None = None) -> None:
    """Print the tables, and draw the pictures if `pictures` says into which folder."""
    print('### A rotor in oblique flow\n\n' + oblique_table(), end='\n\n')
    print('### By angle\n\n' + angle_table(), end='\n\n')
    print('### Five propellers straight ahead\n\n' + straight_table(), end='\n\n')
    print('### C from low speeds, and through the top speed\n\n' + chord_table(), end='\n\n')
    print('### Drives that hold torque or power\n\n' + drive_table(), end='\n\n', flush=True)
    if pictures:
        from thrust_allocator.benchmark.evidence_pictures import draw
        print('Drawn: ' + ', '.join(map(str, draw(pictures))))


def _figures(error: np.ndarray, share: np.ndarray) -> tuple[str, str, str]:
    """Return R^2, RMS and worst optimism, the latter two in % of Bollard thrust."""
    spread = ((share - share.mean())**2).sum()
    return (f'{1.0 - (error**2).sum() / spread:.2f}', f'{100.0 * np.sqrt((error**2).mean()):.1f}',
            f'{100.0 * error.max():+.1f}')


HEADER = ('R²', 'RMS, % of Bollard', 'worst optimism, %')


def oblique_table() -> str:
    """Return what each law makes of the rotor's even points."""
    points = oblique_points(rotor_in_oblique_flow())
    share = points.share[1::2]
    return table(('law', *HEADER),
                 [(law.name, *_figures(held_out(law, points)[1], share)) for law in LAWS])


def angle_table() -> str:
    """Return the worst optimism by angle, % of Bollard thrust, of all points by the odd ones."""
    rotor = rotor_in_oblique_flow()
    points = oblique_points(rotor)
    rows = []
    errors = [limits(law, held_out(law, points)[0], points) - points.share for law in LAWS]
    for angle in np.unique(rotor.angle):
        mine = rotor.angle == angle
        rows.append((f'{np.degrees(angle):g}°',
                     *(f'{100.0 * error[mine].max():+.1f}' for error in errors)))
    return table(('angle', *(law.name for law in LAWS)), rows)


def straight_table() -> str:
    """Return what each law makes of the even points of each propeller, straight ahead."""
    return table(
        ('propeller', 'law', *HEADER),
        [(one.name, law.name, *_figures(held_out(law, points)[1], points.share[1::2]))
         for one in b_series() for points in (straight_points(one),) for law in STRAIGHT])


def chord_table() -> str:
    """Return what a C fitted to the slower half says of the faster one, and a chord of the rest."""
    rows = []
    for one in b_series():
        points = straight_points(one)
        half = len(points.share) // 2
        upper = points.some(slice(half, None))
        slow = [limits(law, fit(law, points.some(slice(0, half))), upper) - upper.share
                for law in STRAIGHT[1:]]
        c = (1.0 - points.share[-1]) / points.along[-1]
        chord = limits(LAWS[3], [c], points) - points.share
        rows.append((one.name, *(f'{100.0 * error.mean():+.1f} / {100.0 * error.max():+.1f}'
                                 for error in (*slow, chord))))
    return table(('propeller', 'C from the slower half', 'C and C2 from it',
                  'C through the top speed, below it'), rows)


def drive_table() -> str:
    """Return the thrust at half the speed of no thrust, by what the drive holds."""
    rows = []
    for one in b_series():
        half = 0.5 * float(np.interp(0.0, -one.thrust, one.advance_ratio))
        rows.append((one.name, *(f'{held(one, half, power):.2f}' for power in (0, 2, 3))))
    return table(('propeller', 'revolutions', 'torque', 'power'), rows)


def held(one: OpenWater, speed: float, power: int) -> float:
    """
    Return the share of its thrust at rest that a propeller keeps at a speed.

    :param speed: V/(n_0 D) with n_0 the revolutions at rest [-].
    :param power: of the revolutions in what the drive holds, K_Q(J) n^power: 0 the revolutions
        themselves, 2 torque, 3 power.
    """
    def excess(n: float) -> float:
        return float(np.interp(speed / n, one.advance_ratio, one.torque)) * n**power - one.torque[0]

    n = brentq(excess, 0.5, 4.0) if power else 1.0
    return float(np.interp(speed / n, one.advance_ratio, one.thrust)) * n**2 / one.thrust[0]
