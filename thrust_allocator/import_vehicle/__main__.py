"""The importer's process: `ros2 run thrust_allocator import_vehicle FILE --output my.yaml`."""

import argparse
from collections.abc import Sequence
import math
from pathlib import Path
import sys
from typing import NoReturn

from thrust_allocator.import_vehicle.compare import compare
from thrust_allocator.import_vehicle.configuration import Configuration, SourceError
from thrust_allocator.import_vehicle.parameter_file import parameter_file
from thrust_allocator.import_vehicle.source import PARAMETER_FILE, read_source
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.guesses import marked_guesses
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.frames import FRAMES


class _Parser(argparse.ArgumentParser):
    """A parser whose errors take one line."""

    def error(self, message: str) -> NoReturn:
        """Print the message and exit with status 2."""
        self.exit(2, f'{self.prog}: {" ".join(message.split())}\n')


def main(args: Sequence[str] | None = None) -> int:
    """
    Import a vehicle, compare two descriptions of it, or both.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0; 1 for a file that cannot be imported, and where the two
        descriptions disagree. A mistake on the command line exits with status 2.
    """
    parser = _parser()
    options = parser.parse_args(list(sys.argv if args is None else args)[1:])
    if options.output is None and options.against is None:
        parser.error('the following arguments are required: --output, or --against')
    try:
        found = read_source(options.file, options.frame, options.origin)
        other = read_source(options.against, options.frame) if options.against else found
        if options.frame and options.frame not in (found.frame, other.frame):
            raise SourceError(f'{options.file}: says that it is in {found.frame} axes, must not '
                              f'be given --frame {options.frame}')
        if options.output:
            _write(options.output, found)
        if options.against:
            return _compare(found, other)
    except (SourceError, ParameterError) as error:
        print(f'import_vehicle: {error}', file=sys.stderr)
        return 1
    return 0


def _write(path: Path, found: Configuration) -> None:
    """Write the parameter file, unless it would not start, and say what is left to do."""
    if found.kind == PARAMETER_FILE:
        raise SourceError(f'{found.source}: is a parameter file already, must be compared '
                          '(--against) and not imported')
    if path.exists() and Path(found.source).exists() and path.samefile(found.source):
        raise SourceError(f'--output: {path} is the file that is imported, must be another')
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(parameter_file(found), encoding='utf-8')
    except OSError as error:
        raise SourceError(f'--output: {path} cannot be written: {error.strerror}') from None
    for warning in load_vehicle(path).warnings():
        print(f'import_vehicle: {warning}', file=sys.stderr)
    guesses = len(marked_guesses(path))
    print(f'{path}: {len(found.mounts)} thrusters from {found.source} ({found.kind}), '
          + (f'the limits of {guesses} of them guessed: search it for GUESS' if guesses else
             'with the limits that it gives'))


def _compare(found: Configuration, other: Configuration) -> int:
    agreed, differences = compare(found, other)
    print(f'{found.source} ({found.kind}) against {other.source} ({other.kind}):')
    for line in agreed:
        print(f'  {line}')
    for line in differences:
        print(f'! {line}')
    print('They disagree.' if differences else 'They agree.')
    return 1 if differences else 0


def _parser() -> _Parser:
    parser = _Parser(prog='import_vehicle', description='Write a parameter file from what there is '
                     'of a vehicle already: a URDF or SDF with thruster plugins, an allocation '
                     'matrix or a thruster layout in YAML.')
    parser.add_argument('file', metavar='FILE', type=Path, help='what to import')
    parser.add_argument('--frame', choices=FRAMES,
                        help='axes of a matrix or layout that does not say its own')
    parser.add_argument('--origin', metavar='X,Y,Z', type=_point,
                        help='where to measure positions from, e.g. the centre of gravity, in the '
                        "file's axes and from its origin [m]")
    parser.add_argument('--against', metavar='OTHER', type=Path,
                        help='compare with another description of the vehicle, of any kind, or '
                        'with a parameter file; status 1 where they disagree')
    parser.add_argument('--output', metavar='my_vehicle.yaml', type=Path,
                        help='parameter file to write')
    return parser


def _point(text: str) -> list[float]:
    try:
        point = [float(word) for word in text.split(',')]
    except ValueError:
        point = []
    if len(point) != 3 or not all(map(math.isfinite, point)):
        raise argparse.ArgumentTypeError(f'{text!r} must be X,Y,Z, three numbers in m (with '
                                         '--origin=X,Y,Z where X is negative)')
    return point


if __name__ == '__main__':
    sys.exit(main())
