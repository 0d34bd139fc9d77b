"""The study's process: `ros2 run thrust_allocator study`, or `python -m thrust_allocator.study`."""

import argparse
from collections import Counter
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
import shlex
import sys

from thrust_allocator.parameters.build import load_description
from thrust_allocator.parameters.file import default_parameter_file
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.study.directions import most_telling
from thrust_allocator.study.errors import missing, StudyError
from thrust_allocator.study.grid import Case, evaluate_all, Outcome
from thrust_allocator.study.manoeuvre import Manoeuvre, paper_test
from thrust_allocator.study.options import nearest, Parser, parser
from thrust_allocator.study.progress import Progress
from thrust_allocator.study.sweep import without
from thrust_allocator.study.tables import write_grid


def main(args: Sequence[str] | None = None) -> int:
    """
    Make a study and write it to a folder.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0, or 1 for a mistake in a parameter file and for what is missing on
        this machine. A mistake on the command line exits with status 2.
    """
    args = list(sys.argv if args is None else args)
    read = parser()
    options = read.parse_args(args[1:])
    try:
        return _study(read, options, shlex.join(['ros2', 'run', 'thrust_allocator', 'study',
                                                 *args[1:]]))
    except (ParameterError, StudyError) as error:
        print(f'study: {error}', file=sys.stderr)
    except KeyboardInterrupt:
        print('study: interrupted', file=sys.stderr)
    return 1


def _study(read: Parser, options: argparse.Namespace, command: str) -> int:
    if options.output.exists() and not options.output.is_dir():
        read.error(f'--output: {options.output} is not a directory')
    if find_spec('matplotlib') is None:
        raise StudyError(missing('matplotlib, which draws the pictures', 'plot'))
    vehicles = _vehicles(options.vehicles or [default_parameter_file()], options.node)
    _check_names(read, options, vehicles)
    gone = {name: _failed_of(name, options.failed) for name in vehicles}
    vehicles = {name: without(one, gone[name]) for name, one in vehicles.items()}
    manoeuvre = _manoeuvre(options, vehicles)
    cases = [Case(name, vehicle, failed, heading)
             for name, vehicle in vehicles.items() for heading in options.headings
             for failed in _failures(vehicle, gone[name])]
    outcomes = evaluate_all(cases, manoeuvre, options.speeds, options.jobs, options.dask,
                            Progress())
    try:
        summary = _write(options, command, cases, outcomes, manoeuvre)
    except OSError as error:
        raise StudyError(f'--output: {error.filename or options.output} cannot be written: '
                         f'{error.strerror}') from None
    print('\n'.join(summary))
    return 0


def _vehicles(files: Sequence[Path], node: str) -> dict[str, Vehicle]:
    """Return the vehicles by a name that is theirs alone; their warnings go to stderr."""
    stems = Counter(file.stem for file in files)
    vehicles = {}
    for file in files:
        name = file.stem if stems[file.stem] == 1 else f'{file.resolve().parent.name}_{file.stem}'
        if name in vehicles:
            raise StudyError(f'{file}: goes by the name {name} like another one, must have a name '
                             'of its own')
        try:
            description = load_description(file, node)
        except ParameterError as error:
            message = str(error)
            raise ParameterError(message if str(file) in message else f'{file}: {message}') \
                from None
        for warning in description.warnings:
            print(f'study: {name}: {warning}', file=sys.stderr)
        vehicles[name] = description.vehicle
    return vehicles


def _check_names(read: Parser, options: argparse.Namespace,
                 vehicles: dict[str, Vehicle]) -> None:
    """Refuse vehicles that are not there, and names and DOFs that a vehicle does not have."""
    for layout, _ in options.failed:
        if layout and layout not in vehicles:
            read.error(f'--failed: {layout} is no vehicle here, must be one of '
                       f'{", ".join(vehicles)}{nearest(layout, list(vehicles))}')
    for layout, vehicle in vehicles.items():
        names = [thruster.name for thruster in vehicle.thrusters]
        for option, wanted in (('--failed', _failed_of(layout, options.failed)),
                               ('--thruster', [options.thruster] if options.thruster else [])):
            for name in wanted:
                if name not in names:
                    read.error(f'{option}: {name} is no thruster of {layout}, must be one of '
                               f'{", ".join(names)}{nearest(name, names)}')
        for dof, value, weight in zip(DOFS, options.wrench or (), vehicle.wrench_weights):
            if value and not weight:
                read.error(f'--wrench: {layout} does not control {dof}: its wrench_weights.{dof} '
                           'is 0')


def _manoeuvre(options: argparse.Namespace, vehicles: dict[str, Vehicle]) -> Manoeuvre:
    fitted = Manoeuvre()
    if options.wrench is None or options.drag is None:
        fitted = paper_test(list(vehicles.values()), float(max(map(abs, options.speeds))))
    chosen = Manoeuvre(fitted.wrench if options.wrench is None else options.wrench,
                       fitted.drag if options.drag is None else options.drag)
    if options.wrench is None and chosen.wrench != Manoeuvre().wrench \
            or options.drag is None and chosen.drag != Manoeuvre().drag:
        print("study: the paper's test is beyond reach here (--wrench, --drag); the command is "
              f'{chosen}', file=sys.stderr)
    return chosen


def _failed_of(layout: str, failed: Sequence[tuple[str, str]]) -> tuple[str, ...]:
    """Return which thrusters of a vehicle have failed: those named for it, and for every one."""
    return tuple(dict.fromkeys(name for of, name in failed if of in ('', layout)))


def _failures(vehicle: Vehicle, failed: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Return the failures to study: those given, and with each single other thruster besides."""
    return [failed] + [(*failed, thruster.name) for thruster in vehicle.thrusters
                       if thruster.enabled]


def _write(options: argparse.Namespace, command: str, cases: Sequence[Case],
           outcomes: Sequence[Outcome], manoeuvre: Manoeuvre) -> list[str]:
    """Write all files and return the summary."""
    from thrust_allocator.study import report  # needs matplotlib

    folder, speeds = options.output, options.speeds
    folder.mkdir(parents=True, exist_ok=True)
    layouts = list(dict.fromkeys(case.layout for case in cases))
    drawn = min(options.headings, key=abs)
    sections, drawings = [], report.Drawings()
    if len(layouts) > 1 or len(options.headings) > 1:
        sections += report.candidates_report(drawings, folder, cases, outcomes, manoeuvre, speeds)
    shown = []
    for layout in layouts:
        chosen = [(case, outcome) for case, outcome in zip(cases, outcomes)
                  if case.layout == layout and case.heading == drawn]
        shown.append(tuple(zip(*chosen)))
        within = f'{layout}/' if len(layouts) > 1 else ''
        place = folder / within
        place.mkdir(exist_ok=True)
        vehicle = chosen[0][0].vehicle
        thruster = next((one for one in vehicle.thrusters if one.name == options.thruster),
                        most_telling(vehicle))
        sections += report.layout_report(
            drawings, place, *zip(*chosen), manoeuvre, speeds, thruster, within)
    drawings.draw(options.jobs)
    write_grid(folder / 'grid.csv', speeds, cases, outcomes)
    summary = report.verdict(shown, manoeuvre, speeds)
    report.write_report(folder / 'report.md', command, manoeuvre, sections, summary)
    return summary


if __name__ == '__main__':
    sys.exit(main())
