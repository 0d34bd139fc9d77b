"""The study's command line."""

import argparse
from collections.abc import Callable
import difflib
import math
from pathlib import Path
import re
from typing import NoReturn

from thrust_allocator.parameters.file import NODE_NAME
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.study.manoeuvre import DRAG, PITCH, unit

FASTEST = 50.0  # what the node takes for a velocity, too [m/s]
LARGEST = 1e9  # and for a wrench [N, N*m]
MOST_SPEEDS = 100_000
SPEEDS = '0:1.8:37'  # [m/s]


class Parser(argparse.ArgumentParser):
    """A parser whose errors take one line."""

    def error(self, message: str) -> NoReturn:
        """Print the message and exit with status 2."""
        self.exit(2, f'{self.prog}: {" ".join(message.split())}\n')


def nearest(name: str, known: list[str]) -> str:
    """Ask whether the most similar known name was meant."""
    close = difflib.get_close_matches(name, known, n=1)
    return f'; did you mean {close[0]}?' if close else ''


def _number(text: str, limit: float, of: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= limit:
        raise argparse.ArgumentTypeError(
            f'{text.strip()!r} is no {of}, must be a number from {-limit:g} to {limit:g}')
    return value


def _numbers(most: float, of: str, least_count: int) -> Callable[[str], list[float]]:
    """Return a reader of '0.3,0.5' and of 'first:last:count' that gives sorted numbers."""
    def read(text: str) -> list[float]:
        found: set[float] = set()
        for part in text.split(','):
            ends = part.split(':')
            if len(ends) == 1:
                found.add(_number(part, most, of))
                continue
            if len(ends) != 3 or not re.fullmatch(r'[0-9]{1,9}', ends[2]) \
                    or not 2 <= int(ends[2]) <= MOST_SPEEDS:
                raise argparse.ArgumentTypeError(
                    f'{part!r} is no range, must be FIRST:LAST:COUNT with a count from 2 to '
                    f'{MOST_SPEEDS}')
            first, last = (_number(end, most, of) for end in ends[:2])
            steps = int(ends[2]) - 1
            # Rounded, so that 0:1.8:37 holds 0.9 and not its neighbour
            found.update(round(first + i * (last - first) / steps, 12) for i in range(steps + 1))
        if len(found) < least_count:
            raise argparse.ArgumentTypeError(
                f'{text!r} has fewer than {least_count} different values')
        return sorted(found)
    return read


def _components(text: str) -> tuple[float, ...]:
    """Read 'pitch=50,heave=10' as a wrench (6,), frd axes [N, N*m]."""
    wrench = [0.0] * 6
    for part in text.split(','):
        dof, separator, value = part.partition('=')
        if not separator or dof.strip() not in DOFS:
            raise argparse.ArgumentTypeError(
                f'{part.strip()!r} must be DOF=VALUE with a DOF of {", ".join(DOFS)}'
                + nearest(dof.strip(), list(DOFS)))
        i = DOFS.index(dof.strip())
        wrench[i] = _number(value, LARGEST, f'{dof.strip()} in {unit(i)}')
    return tuple(wrench)


def _drag(text: str) -> tuple[float, ...]:
    """Read '40' or 'surge=40,sway=150' as forces per speed squared (3,) [N*s^2/m^2]."""
    if '=' not in text:
        return (_number(text, LARGEST, 'drag in N*s^2/m^2'), 0.0, 0.0)
    wrench = _components(text)
    if any(wrench[3:]):
        raise argparse.ArgumentTypeError('drag is a force: surge, sway and heave')
    return wrench[:3]


def _names(text: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name.strip() for name in text.split(',') if name.strip()))


def _failed(text: str) -> tuple[tuple[str, str], ...]:
    """Read 'left,mt2012:up' as (vehicle or '' for each, thruster)."""
    parts = (name.rpartition(':') for name in _names(text))
    return tuple((layout.strip(), thruster.strip()) for layout, _, thruster in parts)


def _count(text: str) -> int:
    if not re.fullmatch('[0-9]{1,4}', text) or int(text) < 1:
        raise argparse.ArgumentTypeError(f'{text!r} must be a whole number of 1 or more')
    return int(text)


def parser() -> Parser:
    """Return the parser of the command line."""
    one = Parser(prog='study', description='Show what bounds that move with the speed are worth '
                 'to a vehicle: pictures, tables and a report. Wrenches are in x forward, '
                 'y starboard, z down; positive pitch is nose up.')
    one.add_argument('vehicles', nargs='*', metavar='VEHICLE.yaml', type=Path,
                     help="the node's parameter file; several are candidate layouts; "
                     'none: MT-2012')
    one.add_argument('--output', required=True, metavar='DIR', type=Path,
                     help='folder for the results; made if it is not there')
    one.add_argument('--speeds', default=SPEEDS, metavar='LIST',
                     type=_numbers(FASTEST, 'speed in m/s', 2),
                     help=f'through the water: 0.3,0.5,0.9 or FIRST:LAST:COUNT; {SPEEDS} [m/s]')
    one.add_argument('--wrench', type=_components, metavar='DOF=VALUE,...',
                     help=f"the manoeuvre's wrench; pitch={PITCH:g}, or half of what the vehicle "
                     'can, if that is less [N, N*m]')
    one.add_argument('--drag', type=_drag, metavar='VALUE',
                     help=f'surge force per speed squared that holds the speed, {DRAG:g}; or '
                     'DOF=VALUE,... for surge, sway and heave [N*s^2/m^2]')
    one.add_argument('--failed', default=(), type=_failed, metavar='NAME,...',
                     help='thrusters that have failed throughout; VEHICLE:NAME of one of several '
                     'vehicles alone')
    one.add_argument('--headings', default='0', metavar='LIST',
                     type=_numbers(360.0, 'heading in degrees', 1),
                     help='of the bow, to starboard from straight into the current; the pictures '
                     'of a vehicle show the one nearest to 0; 0 [deg]')
    one.add_argument('--thruster', metavar='NAME',
                     help='whose bounds to draw in every direction; the first propeller')
    one.add_argument('--node', default=f'/{NODE_NAME}', metavar='NAME',
                     help='full name of the node whose parameters to read; %(default)s')
    where = one.add_mutually_exclusive_group()
    where.add_argument('--jobs', default=1, type=_count, metavar='N',
                       help='processes on this machine; 1')
    where.add_argument('--dask', metavar='ADDRESS',
                       help='run on a Dask cluster, by the address of its scheduler; its workers '
                       'need this package; extra `cluster`')
    return one
