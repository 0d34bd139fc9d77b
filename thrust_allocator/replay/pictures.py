"""The four pictures of a run."""

from collections.abc import Callable
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.replay.run import Run
from thrust_allocator.study import style

_BINS = 1200  # points of a line; of more ticks than twice that, the largest and smallest of each
_GAP = '#F3D9CC'
# Solid, for dashes are lost where a line swings fast; the wider one shows from under the other
_COMMANDED = {'color': style.line(0)['color'], 'lw': 2.4}
_ACHIEVED = {'color': style.line(5)['color'], 'lw': 1.0}
_THRUST = {'color': style.line(1)['color'], 'lw': 1.0}
_UNITS = ('N', 'N', 'N', 'N m', 'N m', 'N m')


def draw(run: Run, bag: str, folder: Path, suffix: str) -> dict[str, str]:
    """
    Draw the pictures into a folder, and return what each shows, by file name without its suffix.

    :param bag: name of the recording.
    :param suffix: of the file names, that tells vehicles apart.
    """
    pictures: dict[str, tuple[Callable[[Run, str, Path], None], str]] = {
        'setpoints': (_setpoints, 'Each thruster\'s thrust inside its moving limits'),
        'saturated': (_saturated, 'Which thruster is at a limit, and when'),
        'wrench': (_wrench, 'Commanded and achieved wrench; shaded where no wrench counted'),
        'motion': (_motion, 'Speed through the water and angle of attack; shaded where no '
                            'velocity counted')}
    told = {}
    with style.look():
        for name, (make, meaning) in pictures.items():
            make(run, bag, folder / f'{name}{suffix}')
            told[f'{name}{suffix}'] = meaning
    return told


def _setpoints(run: Run, bag: str, path: Path) -> None:
    names = [one.name for one in run.first.vehicle.thrusters]
    title = f'{run.name} on {bag}: thrust inside its moving limits'
    figure, axes = style.panels(
        -(-len(names) // 2), min(2, len(names)), 1.7, title,
        [Line2D([], [], label='thrust', **_THRUST),
         Patch(color=style.BOUNDS, label='limits')], sharex=True)
    x = _seconds(run)
    for i, (name, one) in enumerate(zip(names, axes.ravel())):
        _panel(one, name, 'N', x)
        low, high = run.ticks['lower'][:, i], run.ticks['upper'][:, i]
        grid, (lowest, _), (_, highest) = _thin(x, low, high)
        one.fill_between(grid, lowest, highest, color=style.BOUNDS, lw=0.0)
        _curve(one, x, run.ticks['thrusts'][:, i], _THRUST)
    style.finish(axes, len(names), 'time [s]')
    style.save(figure, path)


def _saturated(run: Run, bag: str, path: Path) -> None:
    names = [one.name for one in run.first.vehicle.thrusters]
    figure, axes = style.panels(1, 1, 0.8 + 0.28 * len(names),
                                f'{run.name} on {bag}: thrusters at a limit', [])
    x, bound = _seconds(run), run.ticks['at_bound'] != 0.0
    edges = np.linspace(x[0], x[-1] or 1.0, min(len(x), 400) + 1)
    index = np.clip(np.searchsorted(edges, x, side='right') - 1, 0, len(edges) - 2)
    count = np.bincount(index, minlength=len(edges) - 1)
    share = np.stack([np.bincount(index, one, len(edges) - 1) for one in bound.T.astype(float)])
    share = share / np.maximum(count, 1)
    mesh = axes[0, 0].pcolormesh(edges, np.arange(len(names) + 1), share, cmap='Greys', vmin=0.0,
                                 vmax=1.0, rasterized=True)
    axes[0, 0].set(yticks=np.arange(len(names)) + 0.5, yticklabels=names)
    axes[0, 0].invert_yaxis()
    figure.colorbar(mesh, ax=axes[0, 0], label='share of ticks', fraction=0.05, pad=0.02)
    style.finish(axes, 1, 'time [s]')
    style.save(figure, path)


def _wrench(run: Run, bag: str, path: Path) -> None:
    figure, axes = style.panels(
        3, 2, 1.7, f'{run.name} on {bag}: commanded and achieved wrench',
        [Line2D([], [], label='commanded', **_COMMANDED),
         Line2D([], [], label='achieved', **_ACHIEVED),
         Patch(color=_GAP, label='no wrench, or stopped')], sharex=True)
    x = _seconds(run)
    for i, dof in enumerate(DOFS):
        one = axes.T.ravel()[i]
        _panel(one, dof, _UNITS[i], x)
        _shade(one, x, ~run.ticks['live'])
        _curve(one, x, run.ticks['wrench'][:, i], _COMMANDED)
        _curve(one, x, run.ticks['achieved'][:, i], _ACHIEVED)
    style.finish(axes, 6, 'time [s]')
    style.save(figure, path)


def _motion(run: Run, bag: str, path: Path) -> None:
    figure, axes = style.panels(2, 1, 1.8, f'{run.name} on {bag}: motion through the water',
                                [Patch(color=_GAP, label='no velocity that counted')], sharex=True)
    x, velocity = _seconds(run), run.ticks['velocity'][:, :3]
    speed = np.linalg.norm(velocity, axis=1)
    across = np.hypot(velocity[:, 1], velocity[:, 2])
    angle = np.where(speed > 0.02, np.degrees(np.arctan2(across, velocity[:, 0])), np.nan)
    for one, title, unit, values in ((axes[0, 0], 'speed', 'm/s', speed),
                                     (axes[1, 0], 'angle of attack', 'degrees', angle)):
        _panel(one, title, unit, x)
        _shade(one, x, run.ticks['stale'])
        _curve(one, x, values, _THRUST)
    style.finish(axes, 2, 'time [s]')
    style.save(figure, path)


def _seconds(run: Run) -> np.ndarray:
    return (run.ticks.times - run.start) * 1e-9


def _panel(axes: Axes, title: str, unit: str, x: np.ndarray) -> None:
    style.over_speed(axes, (x[0], max(x[-1], x[0] + 1e-3)), title, unit)


def _curve(axes: Axes, x: np.ndarray, y: np.ndarray, line: dict) -> None:
    """Draw a line; of many ticks its highest and lowest points."""
    grid, (low, high) = _thin(x, y)
    if len(grid) == len(x):
        axes.plot(x, y, **line)
    else:
        axes.plot(np.repeat(grid, 2), np.stack([low, high], axis=1).ravel(), **line)


def _thin(x: np.ndarray, *curves: np.ndarray) -> tuple:
    """Return places along x, and for each curve its smallest and largest value around there."""
    if len(x) <= 2 * _BINS:
        return x, *((curve, curve) for curve in curves)
    starts = np.linspace(0, len(x), _BINS, endpoint=False).astype(int)
    return x[starts], *((np.fmin.reduceat(curve, starts), np.fmax.reduceat(curve, starts))
                        for curve in curves)


def _shade(axes: Axes, x: np.ndarray, flags: np.ndarray) -> None:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    for a, b in zip(edges[::2], edges[1::2]):
        axes.axvspan(x[a], x[min(b, len(x) - 1)], color=_GAP, lw=0.0)
