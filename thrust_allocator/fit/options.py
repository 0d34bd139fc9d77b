"""The command line of a fit."""

import argparse
import math
from pathlib import Path
import re
from typing import NoReturn

from thrust_allocator.physics.models.propeller import ANGLE_LAWS


class Parser(argparse.ArgumentParser):
    """A parser whose errors take one line."""

    def error(self, message: str) -> NoReturn:
        """Print the message and exit with status 2."""
        self.exit(2, f'{self.prog}: {" ".join(message.split())}\n')


def parser() -> Parser:
    """Return the parser of the command line."""
    one = Parser(prog='fit', description="Coefficients of a thruster from its Bollard table and a "
                 'few steady runs in a flow. Columns: command, speed [m/s through the water], '
                 'angle [deg between thrust and motion], thrust [N] or thrust_kgf or thrust_lbf; '
                 'and, if you like, run and sigma (of the thrust, in its unit).')
    one.add_argument('table', metavar='TABLE.csv', type=Path, help='the measurements')
    one.add_argument('--thruster', required=True, metavar='NAME', type=_name,
                     help='name of the thruster in the snippet')
    one.add_argument('--model', choices=('propeller', 'tunnel'), default='propeller',
                     help='what it is; %(default)s')
    one.add_argument('--law', choices=ANGLE_LAWS,
                     help='angle law of a propeller; cosine unless said otherwise')
    one.add_argument('--quadratic', action='store_true',
                     help='fit speed_loss_quadratic too; needs two speeds or more')
    one.add_argument('--safe', action='store_true',
                     help='coefficients that promise no row more than its sigma too much')
    one.add_argument('--neutral', type=_real, metavar='COMMAND',
                     help='the command without thrust, such as 1500 of a PWM; 0')
    one.add_argument('--top-speed', type=_positive, metavar='V',
                     help="the vehicle's greatest speed [m/s]: a WARN where no run was as fast")
    one.add_argument('--area', type=_positive, metavar='S', help="of a tunnel's jet [m^2]")
    one.add_argument('--water-density', type=_positive, metavar='RHO', default=1025.0,
                     help='of the vehicle that the coefficients are for [kg/m^3]; %(default)g')
    one.add_argument('--output', required=True, metavar='DIR', type=Path,
                     help='folder for fit.yaml, report.md and the picture; made if not there')
    return one


def parse(args: list[str]) -> argparse.Namespace:
    """Return the options; a mistake exits with status 2 and one line."""
    one = parser()
    options = one.parse_args(args)
    if options.model == 'tunnel' and (options.law or options.quadratic):
        one.error('--law and --quadratic are of a propeller, must be left out for a tunnel')
    if options.model == 'propeller' and options.area:
        one.error('--area is of a tunnel, must be left out for a propeller')
    options.law = options.law or 'cosine'
    return options


def _name(text: str) -> str:
    if not re.fullmatch('[A-Za-z][A-Za-z0-9_]*', text):
        raise argparse.ArgumentTypeError(f'{text!r} must be a name of letters, digits and _')
    return text


def _real(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f'{text!r} must be a number')
    return value


def _positive(text: str) -> float:
    if (value := _real(text)) <= 0.0:
        raise argparse.ArgumentTypeError(f'{text!r} must be above 0')
    return value
