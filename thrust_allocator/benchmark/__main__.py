"""Measure the allocator: `python -m thrust_allocator.benchmark`, all of it or some parts."""

import argparse
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
import os
from pathlib import Path
import platform
import sys

from thrust_allocator.benchmark import (
    evidence, giving_way_cost, growth, node_cost, saturation, solvers)

PARTS = ('solvers', 'growth', 'saturation', 'evidence', 'node')
PACKAGES = ('numpy', 'osqp', 'scipy', 'quadprog', 'daqp', 'casadi', 'ros-jazzy-rclpy')


def machine() -> str:
    """Say on what the figures were measured."""
    try:
        lines = Path('/proc/cpuinfo').read_text(encoding='utf-8').splitlines()
        names = [line.split(':', 1)[1].strip() for line in lines if line.startswith('model name')]
    except OSError:
        names = []
    processor = names[0] if names else platform.processor() or platform.machine()
    return (f'{processor}, {os.cpu_count()} cores; {platform.system()} {platform.release()}; '
            f'Python {platform.python_version()}; ' + ', '.join(map(_version, PACKAGES)))


def _version(package: str) -> str:
    try:
        return f'{package} {version(package)}'
    except PackageNotFoundError:
        return f'{package} missing'


def _svg(path: str) -> Path:
    chosen = Path(path)
    if chosen.suffix != '.svg' or not chosen.absolute().parent.is_dir():
        raise argparse.ArgumentTypeError(
            f'{path} must end in .svg and lie in a folder that exists')
    return chosen


def _folder(path: str) -> Path:
    if not (chosen := Path(path)).is_dir():
        raise argparse.ArgumentTypeError(f'{path} must be a folder that exists')
    return chosen


def main(args: Sequence[str] | None = None) -> int:
    """
    Run the parts that the command line names and print their tables.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status, 0. A mistake on the command line exits with status 2.
    """
    parser = argparse.ArgumentParser(
        prog='benchmark',
        description='Measure the allocator beside others. The extra `bench` brings them along; '
        'one that is not installed is reported as missing.')
    parser.add_argument('parts', nargs='*', metavar='PART',
                        help=f'what to measure, of {", ".join(PARTS)}; without one, all')
    parser.add_argument('--plot', type=_svg, metavar='FILE',
                        help='draw the growth as an SVG file; needs matplotlib and part growth')
    parser.add_argument('--pictures', type=_folder, metavar='DIR',
                        help='draw the evidence into this folder; needs matplotlib and part '
                        'evidence')
    parser.add_argument('--quick', action='store_true', help='a short run, for a first look')
    options = parser.parse_args(None if args is None else args[1:])
    unknown = [part for part in options.parts if part not in PARTS]
    if unknown:
        parser.error(f'{unknown[0]} is no part, must be one of {", ".join(PARTS)}')
    parts = options.parts or PARTS
    if options.plot and 'growth' not in parts:
        parser.error('--plot draws the growth: name that part too, or none')
    if (options.plot or options.pictures) and _version('matplotlib').endswith('missing'):
        parser.error('pictures need matplotlib, which is not installed; the extra is `bench`')
    if options.pictures and 'evidence' not in parts:
        parser.error('--pictures draws the evidence: name that part too, or none')
    print(f'{machine()}\n', flush=True)
    if 'solvers' in parts:
        solvers.report(*((300, 1) if options.quick else ()))
    if 'growth' in parts:
        growth.report(*((300, 1) if options.quick else ()), plot=options.plot)
    if 'saturation' in parts:
        saturation.report(*((1000,) if options.quick else ()))
        giving_way_cost.report(*((1,) if options.quick else ()))
    if 'evidence' in parts:
        evidence.report(options.pictures)
    if 'node' in parts:
        node_cost.report(options.quick)
    return 0


if __name__ == '__main__':
    sys.exit(main())
