"""The replay's process: `ros2 run thrust_allocator replay BAG VEHICLE.yaml --output DIR`."""

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
import shlex
import sys

from thrust_allocator.parameters.build import describe, Description
from thrust_allocator.parameters.file import given_for, read_files
from thrust_allocator.parameters.guesses import marked_guesses
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.replay.errors import ReplayError
from thrust_allocator.replay.options import parser
from thrust_allocator.study.progress import Progress

NEEDED = {'rosbags': 'which reads the bag', 'matplotlib': 'which draws the pictures'}


def main(args: Sequence[str] | None = None) -> int:
    """
    Replay a recording and write what it comes to into a folder.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0, or 1 for a mistake in a parameter file, for a bag that cannot be
        read, and for what is missing on this machine. A mistake on the command line exits with 2.
    """
    args = list(sys.argv if args is None else args)
    options = parser().parse_args(args[1:])
    try:
        _replay(options, shlex.join(['ros2', 'run', 'thrust_allocator', 'replay', *args[1:]]))
    except (ParameterError, ReplayError) as error:
        print(f'replay: {error}', file=sys.stderr)
        return 1
    except OSError as error:
        print(f'replay: {error.filename or options.output} cannot be written: {error.strerror}',
              file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print('replay: interrupted', file=sys.stderr)
        return 1
    return 0


def _replay(options: argparse.Namespace, command: str) -> None:
    for module, purpose in NEEDED.items():
        if find_spec(module) is None:
            raise ReplayError(f"{module}, {purpose}, is not installed: pip install "
                              "'thrust_allocator[replay]'")
    if options.output.exists() and not options.output.is_dir():
        raise ReplayError(f'--output: {options.output} is not a directory')
    vehicles = dict(_vehicles(options))
    # What needs the extra is not imported before it is known to be there
    from thrust_allocator.replay.bag import Bag
    from thrust_allocator.replay.figures import Arrivals, figures
    from thrust_allocator.replay.happenings import happenings
    from thrust_allocator.replay.outputs import write_bag, write_summary, write_ticks
    from thrust_allocator.replay.pictures import draw
    from thrust_allocator.replay.report import write_report
    from thrust_allocator.replay.run import Run

    with Bag(options.bag, dict(options.topic), options.node) as bag:
        as_recorded = bag.has('thruster_setpoints')
        runs = [Run(name, description, settings, bag.start, as_recorded)
                for name, (description, settings) in vehicles.items()]
        arrivals, progress = Arrivals(bag.start), Progress('replay', 'messages')
        for i, message in enumerate(bag):
            if message.name != 'parameter_events':
                arrivals.note(message.name, message.time)
            for run in runs:
                run.take(message)
            if not i % 256:
                progress(i + 1, bag.count + 1)
        for run in runs:
            run.finish(bag.end)
    if not all(len(run.ticks) for run in runs):
        raise ReplayError(f'{options.bag}: has no wrench in it that makes a tick')
    folder = options.output
    folder.mkdir(parents=True, exist_ok=True)
    found = {run.name: figures(run, arrivals, bag.end) for run in runs}
    happened = {run.name: happenings(run, arrivals, bag.end) for run in runs}
    for run in runs:
        found[run.name]['events'] = [
            {'time': (event.time - bag.start) * 1e-9, 'text': event.text}
            for event in happened[run.name]]
    pictures = {run.name: draw(run, options.bag.name, folder,
                               f'_{run.topic}' if len(runs) > 1 else '') for run in runs}
    write_summary(folder / 'summary.json', found, {
        'bag': str(options.bag), 'topics': {name: topic for topic, name in bag.topics.items()}})
    write_ticks(folder / 'ticks.csv', runs)
    write_bag(folder / 'replay.mcap', runs)
    write_report(folder / 'report.md', command, options.bag, bag.topics, as_recorded, runs, found,
                 happened, pictures)
    for name, one in found.items():
        apart = one['difference']
        print(f'{name}: {one["ticks"]} ticks in {one["seconds"]:.1f} s, '
              f'{len(happened[name])} events, setpoints '
              + ('not recorded' if apart is None else
                 f'{apart["median"]:.1e} of Bollard thrust from the recorded ones (median)'))
    print(f'{folder / "report.md"}')


def _vehicles(options: argparse.Namespace) -> Iterator[tuple[str, tuple[Description, dict]]]:
    """Yield vehicles by a name that is theirs alone, and the same with what is set by hand."""
    stems = Counter(file.stem for file in options.vehicles)
    known = set()
    for file in options.vehicles:
        name = file.stem if stems[file.stem] == 1 else f'{file.resolve().parent.name}_{file.stem}'
        if name in known:
            raise ReplayError(f'{file}: goes by the name {name} like another one, must have a name '
                              'of its own')
        known.add(name)
        try:
            given = given_for(options.node, read_files([file]))
            description = describe(given.values, given.own, given.notes)
        except ParameterError as error:
            message = str(error)
            raise ParameterError(message if str(file) in message else f'{file}: {message}') \
                from None
        guesses = [f'{one} is marked as a guess' for one in marked_guesses(file)]
        for warning in (*description.warnings, *guesses):
            print(f'replay: {name}: {warning}', file=sys.stderr)
        yield name, (description, {})
        if options.settings:
            try:
                changed = describe({**given.values, **dict(options.settings)})
            except ParameterError as error:
                raise ParameterError(f'--set: {error}') from None
            settings = {key: changed.parameters.values[key] for key, _ in options.settings}
            yield (f'{name} with ' + ', '.join(map(_set, settings.items())),
                   (changed, settings))


def _set(setting: tuple[str, object]) -> str:
    name, value = setting
    return f'{name} {value:g}' if isinstance(value, float) else f'{name} {value}'


if __name__ == '__main__':
    sys.exit(main())
