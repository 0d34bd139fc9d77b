"""The laws over the measurements that they are held against."""

from pathlib import Path

from matplotlib.lines import Line2D
import numpy as np
from thrust_allocator.benchmark.evidence import (
    fit, held_out, LAWS, limits, oblique_points, Points, straight_points, STRAIGHT, TIP)
from thrust_allocator.benchmark.published import b_series, rotor_in_oblique_flow
from thrust_allocator.study import style

_ANGLES = (0.0, 22.5, 45.0, 60.0, 90.0)  # drawn [deg]


def draw(folder: Path) -> list[Path]:
    """Draw both pictures as SVG and PNG; return the SVG files."""
    with style.look():
        return [_oblique(folder / 'evidence_oblique'), _straight(folder / 'evidence_straight')]


def _oblique(path: Path) -> Path:
    """Draw a panel for each law: share of the thrust at rest over advance ratio, by angle."""
    rotor = rotor_in_oblique_flow()
    points = oblique_points(rotor)
    figure, axes = style.panels(
        2, 3, 2.6, 'A small rotor in oblique flow: measured (marks) and by law (lines)',
        [Line2D([], [], marker='o', label=f'{angle:g}°', **style.line(i))
         for i, angle in enumerate(_ANGLES)], sharey=True)
    ratios = np.linspace(0.0, 0.55, 60)
    for one, law in zip(axes.ravel(), LAWS):
        style.over_speed(one, ratios, law.name, 'share of thrust at rest')
        found = held_out(law, points)[0]
        for i, angle in enumerate(np.radians(_ANGLES)):
            speed = TIP * ratios
            line = limits(law, found, Points(speed * np.cos(angle), speed * np.sin(angle), speed))
            one.plot(ratios, line, **style.line(i))
            mine = np.isclose(rotor.angle, angle)
            one.plot(rotor.advance_ratio[mine], rotor.share[mine], 'o', ms=3.5,
                     color=style.line(i)['color'])
    style.finish(axes, len(LAWS), 'advance ratio V/(n D)')
    style.save(figure, path)
    return path.with_suffix('.svg')


def _straight(path: Path) -> Path:
    """Draw a panel for each propeller, straight ahead."""
    names = ('Bollard limits', 'C', 'C and C2')
    chord = 'C through the top speed'
    figure, axes = style.panels(
        2, 3, 2.6, 'Propellers straight ahead: measured (marks) and by law (lines)',
        [Line2D([], [], label=name, **style.line(i + 1))
         for i, name in enumerate((*names, chord))], sharey=True)
    for one, propeller in zip(axes.ravel(), b_series()):
        points = straight_points(propeller)
        ratios = points.along / TIP
        style.over_speed(one, (0.0, ratios[-1]), propeller.name, 'share of thrust at rest')
        one.plot(ratios, points.share, 'o', ms=3.5, color=style.line(0)['color'])
        lines = [limits(law, fit(law, points.some(slice(0, None, 2))), points)
                 for law in STRAIGHT]
        lines.append(limits(LAWS[3], [(1.0 - points.share[-1]) / points.along[-1]], points))
        for i, line in enumerate(lines):
            one.plot(ratios, line, **style.line(i + 1))
    style.finish(axes, len(b_series()), 'advance ratio V/(n D)')
    style.save(figure, path)
    return path.with_suffix('.svg')
