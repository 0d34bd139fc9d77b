"""
Draw the picture of the README: the paper's test case, solved over a sweep of speeds.

Run it from the top of the project, with the extra `plot` installed:
python doc/allocation_against_speed.py
"""

from pathlib import Path

import matplotlib
from matplotlib import pyplot
import numpy as np
from thrust_allocator.allocation import AllocationProblem
from thrust_allocator.bounds import ThrustBounds
from thrust_allocator.parameter_file import default_parameter_file, read_parameter_file
from thrust_allocator.parameters import read_parameters
from thrust_allocator.vehicle import Vehicle

SPEEDS = np.linspace(0.0, 1.8, 181)  # [m/s]
# Okabe and Ito's colours, which colour-blind readers can tell apart; the dashes survive print
STERN = {'up': ('#D55E00', '-'), 'left': ('#009E73', '--'), 'down': ('#0072B2', '-.')}
BOUNDS = '#CCCCCC'


def sweep() -> tuple[list[str], np.ndarray, np.ndarray]:
    """Return names, thrusts (n, p) and limits (n, 2, p) of MT-2012 over SPEEDS [N]."""
    vehicle = Vehicle.from_parameters(
        read_parameters(read_parameter_file(default_parameter_file())))
    problem, bounds = AllocationProblem(vehicle), ThrustBounds(vehicle)
    ticks = [problem.solve(np.array([40.0 * speed**2, 0.0, 0.0, 0.0, 50.0, 0.0]),
                           bounds(np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0])))
             for speed in SPEEDS]
    return ([thruster.name for thruster in vehicle.thrusters],
            np.array([tick.thrusts for tick in ticks]), np.array([tick.limits for tick in ticks]))


def main() -> None:
    """Draw allocation_against_speed.svg beside this file."""
    names, thrusts, limits = sweep()
    matplotlib.rcParams.update({'svg.hashsalt': 'thrust_allocator', 'font.size': 11})
    figure, (stern, tunnel) = pyplot.subplots(1, 2, figsize=(9.0, 3.8), layout='constrained')
    stern.fill_between(SPEEDS, *limits[:, :, names.index('up')].T, color=BOUNDS,
                       label='bounds of each')
    for name, (colour, dashes) in STERN.items():
        label = 'left, right' if name == 'left' else name
        stern.plot(SPEEDS, thrusts[:, names.index(name)], dashes, color=colour, lw=2, label=label)
    tunnel.fill_between(SPEEDS, *limits[:, :, names.index('tunnel')].T, color=BOUNDS,
                        label='bounds')
    tunnel.plot(SPEEDS, thrusts[:, names.index('tunnel')], color='black', lw=2, label='tunnel')
    for axes, title in ((stern, 'Stern propellers'), (tunnel, 'Bow tunnel thruster')):
        axes.set(title=title, xlabel='speed straight ahead (m/s)', ylabel='thrust (N)',
                 xlim=(SPEEDS[0], SPEEDS[-1]), ylim=(-135.0, 135.0))
        axes.axhline(0.0, color='black', lw=0.5)
        axes.spines[['top', 'right']].set_visible(False)
    stern.legend(ncols=2, loc='lower right', frameon=False, fontsize=9)
    tunnel.legend(loc='lower right', frameon=False, fontsize=9)
    figure.savefig(Path(__file__).with_suffix('.svg'), metadata={'Date': None})


if __name__ == '__main__':
    main()
