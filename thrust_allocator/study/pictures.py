"""The pictures; each function draws one and writes it as PNG and SVG."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Thruster, Vehicle
from thrust_allocator.study.directions import Directions
from thrust_allocator.study.manoeuvre import unit
from thrust_allocator.study.saturation import Saturation
from thrust_allocator.study.style import (
    BOUNDS, dotted, finish, line, look, over_speed, panels, save)
from thrust_allocator.study.sweep import ALLOCATORS, DRIVERS, Sweep

SPEED = 'speed through the water (m/s)'
WORTH_SHOWN = 0.5  # a DOF is drawn if an error gets larger than this [N, N*m]
WORTH_LINES = (  # in the order of ALLOCATORS; the first lies under the second where they agree
    {'color': '#E69F00', 'linestyle': '-', 'lw': 4.0, 'alpha': 0.75},
    {'color': '#0072B2', 'linestyle': '--'}, {'color': '#000000', 'linestyle': '-'})


def draw_allocation(path: Path, setting: str, vehicle: Vehicle, speeds: Sequence[float],
                    allocation: Sweep, shares: dict[int, dict[str, np.ndarray]]) -> None:
    """Draw each thruster's thrust inside its moving bounds, and who gives what share of DOFs."""
    columns = 3
    used = len(vehicle.thrusters) + len(shares)
    rows = -(-used // columns)
    moving = list(ALLOCATORS).index('moving bounds')
    thrust = {'color': '#000000', 'linestyle': '-'}
    names = dict.fromkeys(name for who in shares.values() for name in who)
    styles = {name: line(i + 1) for i, name in enumerate(names)}
    legend = [Line2D([], [], label='thrust', **thrust),
              Patch(color=BOUNDS, label='moving bounds')]
    legend += [Line2D([], [], label=name, **style) for name, style in styles.items()]
    with look():
        figure, axes = panels(rows, columns, 2.25, 'Allocation against speed', legend, setting,
                              sharex=True)
        largest = 1.1 * np.abs([vehicle.bollard_thrust, *allocation.limits]).max()
        for i, (one, thruster) in enumerate(zip(axes.ravel(), vehicle.thrusters)):
            one.fill_between(speeds, *allocation.limits[:, :, i].T, color=BOUNDS, lw=0)
            one.plot(speeds, allocation.thrusts[:, moving, i], **thrust)
            over_speed(one, speeds, thruster.name, 'thrust (N)')
            one.set_ylim(-largest, largest)
        for one, (dof, who) in zip(axes.ravel()[len(vehicle.thrusters):], shares.items()):
            for name, share in who.items():
                one.plot(speeds, share, **styles[name])
            over_speed(one, speeds, f'share of {DOFS[dof]}', 'share (%)')
        finish(axes, used, SPEED)
        save(figure, path)


def draw_worth(path: Path, setting: str, vehicle: Vehicle, speeds: Sequence[float],
               allocation: Sweep) -> None:
    """Draw delivered minus commanded wrench by allocator, for each driver and telling DOF."""
    errors = allocation.errors
    dofs = [dof for dof in np.flatnonzero(vehicle.wrench_weights)
            if np.abs(errors[..., dof]).max() > WORTH_SHOWN]
    dofs = dofs or [int(np.argmax(np.array(vehicle.wrench_weights) > 0.0))]
    legend = [Line2D([], [], label=label, **style)
              for label, style in zip(ALLOCATORS.values(), WORTH_LINES)]
    with look():
        figure, axes = panels(len(dofs), len(DRIVERS), 2.1,
                              'Error of the wrench: delivered minus commanded', legend, setting,
                              sharex=True, sharey='row')
        for row, dof in zip(axes, dofs):
            for d, (one, driver) in enumerate(zip(row, DRIVERS)):
                for a, style in enumerate(WORTH_LINES):
                    one.plot(speeds, errors[:, a, d, dof], **style)
                over_speed(one, speeds, f'{DOFS[dof]} error, driver: {driver}',
                           f'{DOFS[dof]} error ({dotted(unit(dof))})' if d == 0 else '')
        finish(axes, axes.size, SPEED)
        save(figure, path)


def draw_directions(path: Path, setting: str, thruster: Thruster, found: Directions) -> None:
    """Draw the limits of one thruster as contours over angle of attack and speed."""
    with look():
        figure, axes = panels(1, 2, 3.2, f'Bounds in every direction: {thruster.name}', [],
                              setting, sharey=True)
        for one, side, name in zip(axes[0], (1, 0), ('forward', 'reverse')):
            limits = np.abs(found.limits[..., side])
            most = max(abs(thruster.bollard_thrust[side]), limits.max()) or 1.0
            levels = MaxNLocator(12).tick_values(limits.min(), most)
            shades = one.contourf(found.angles, found.speeds, limits, levels, cmap='cividis')
            if np.ptp(limits) > 0.0:
                middle = 0.5 * (levels[0] + levels[-1])
                lines = one.contour(
                    found.angles, found.speeds, limits, levels, linewidths=0.8,
                    colors=['white' if level < middle else 'black' for level in levels])
                for text in one.clabel(lines, fmt='%g', fontsize=9):
                    angle, speed = text.get_position()
                    if not (8.0 < angle < 172.0 and 0.06 < speed / found.speeds[-1] < 0.92):
                        text.remove()  # the frame would cut it off
            one.set(title=f'{name} limit', xlabel='angle of attack (°)',
                    ylabel='speed of the thruster (m/s)' if side else '',
                    xticks=range(0, 181, 30))
            figure.colorbar(shades, ax=one, label=f'{name} thrust (N)')
        save(figure, path)


def draw_giving_way(path: Path, setting: str, found: Saturation) -> None:
    """Draw which share of the commands keeps how much of its direction and of its length."""
    styles = {name: line(i) for i, name in enumerate(found.angles)}
    legend = [Line2D([], [], label=name, **style) for name, style in styles.items()]
    with look():
        figure, axes = panels(1, 2, 3.0, 'What gives way beyond reach', legend, setting,
                              sharey=True)
        for one, values, label in ((axes[0, 0], found.angles, 'direction error (°)'),
                                   (axes[0, 1], found.lost, 'lost of the command (%)')):
            for name, style in styles.items():
                ordered = np.sort(values[name]) * (100.0 if values is found.lost else 1.0)
                share = np.linspace(0.0, 100.0, len(ordered))
                one.plot(np.append(0.0, ordered), np.append(0.0, share), **style)
            one.set(xlabel=label, xlim=(0.0, None), ylim=(0.0, 101.0))
            one.grid(color='#E4E4E4', lw=0.6)
        axes[0, 0].set_ylabel('commands with no more (%)')
        save(figure, path)


def draw_candidates(path: Path, setting: str, speeds: Sequence[float], dofs: Sequence[int],
                    series: dict[str, tuple[np.ndarray, np.ndarray]]) -> None:
    """Draw the authority that every series has both ways, intact and at its worst failure."""
    columns = min(2, len(dofs))
    widths = ({'lw': 2.0}, {'lw': 0.9})
    legend = [Line2D([], [], label=name, **line(i)) for i, name in enumerate(series)]
    legend += [Line2D([], [], color='#777777', label=label, **width) for label, width in zip(
        ('thick: as it stands', 'thin: worst further failure'), widths)]
    with look():
        figure, axes = panels(-(-len(dofs) // columns), columns, 2.6,
                              'Authority both ways, by candidate', legend, setting,
                              sharex=True)
        for one, dof in zip(axes.ravel(), dofs):
            for i, pair in enumerate(series.values()):
                for values, width in zip(pair, widths):
                    one.plot(speeds, values[:, dof], **{**line(i), **width})
            over_speed(one, speeds, DOFS[dof], f'{DOFS[dof]} ({dotted(unit(dof))})')
        finish(axes, len(dofs), SPEED)
        save(figure, path)


def draw_stages(path: Path, title: str, speeds: Sequence[float],
                found: dict[str, np.ndarray]) -> None:
    """Draw a limit after each of the stages that move it, (n,) by name, over speed."""
    legend = [Line2D([], [], label=name, **line(i)) for i, name in enumerate(found)]
    with look():
        figure, axes = panels(1, 1, 3.6, title, legend)
        for i, limit in enumerate(found.values()):
            axes[0, 0].plot(speeds, limit, **line(i))
        over_speed(axes[0, 0], speeds, '', 'upper limit (N)')
        finish(axes, 1, SPEED)
        save(figure, path)
