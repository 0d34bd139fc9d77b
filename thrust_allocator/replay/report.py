"""report.md: what a replay found, for people."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from thrust_allocator.physics.frames import DOFS
from thrust_allocator.replay.happenings import explained
from thrust_allocator.replay.run import Event, Run

_UNITS = ('N', 'N', 'N', 'N·m', 'N·m', 'N·m')
_MOST = 40  # events that are listed


def write_report(path: Path, command: str, bag: Path, topics: Mapping[str, str], as_recorded: bool,
                 runs: Sequence[Run], found: Mapping[str, Mapping[str, Any]],
                 happened: Mapping[str, Sequence[Event]],
                 pictures: Mapping[str, Mapping[str, str]]) -> None:
    """Write the report; mappings but for `topics` are by the name of the vehicle."""
    lines = [f'# Replay of {bag.name}', '', f'    {command}', '',
             '**The motion is held as recorded.** Velocity, wrench and battery are those of the '
             'recording, whatever the setpoints here would have made of them: another vehicle, or '
             'other weights, would have moved otherwise, and its controller asked for something '
             'else.', '', *_about(runs[0], topics, as_recorded), '', '## Figures', '',
             *_figures(found), '', *_differences(runs, found)]
    for run in runs:
        title = f' of {run.name}' if len(runs) > 1 else ''
        lines += ['', f'## What happened{title}', '', *_happened(run, happened[run.name]), '',
                  f'## Pictures{title}', '']
        for name, meaning in pictures[run.name].items():
            lines += [f'{meaning}.', '', f'![{meaning}]({name}.png)', '']
    path.write_text('\n'.join(lines).rstrip() + '\n', 'utf-8')


def _about(run: Run, topics: Mapping[str, str], as_recorded: bool) -> list[str]:
    ticks = ('when `thruster_setpoints` were recorded' if as_recorded else
             "by the node's own schedule, for no setpoints were recorded")
    return [f'Ticks come {ticks}. Wrenches are in the axes of the topics. Topics: '
            + ', '.join(f'`{name}` from `{topic}`' for topic, name in sorted(topics.items())) + '.']


def _figures(found: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """Yield the table of all vehicles side by side."""
    yield '| | ' + ' | '.join(found) + ' |'
    yield '|---|' + '---|' * len(found)
    each = list(found.values())

    def row(name: str, values: Sequence[str]) -> str:
        return f'| {name} | ' + ' | '.join(values) + ' |'

    yield row('ticks', [f'{one["ticks"]}' for one in each])
    yield row('seconds', [f'{one["seconds"]:.1f}' for one in each])
    yield row('share of ticks with a live wrench', [f'{one["live_share"]:.1%}' for one in each])
    for dof, unit in zip(DOFS, _UNITS):
        yield row(f'{dof} unallocated, rms / largest [{unit}]',
                  [f'{one["unallocated_rms"][dof]:.3g} / {one["unallocated_max"][dof]:.3g}'
                   for one in each])
    for dof in DOFS:
        if any(one['reversed_share'][dof] for one in each):
            yield row(f'{dof} comes out with the other sign, share of ticks',
                      [f'{one["reversed_share"][dof]:.1%}' for one in each])
    for name in dict.fromkeys(name for one in each for name in one['saturated_share']):
        yield row(f'{name} at a limit, share of ticks',
                  [f'{one["saturated_share"][name]:.1%}' if name in one['saturated_share'] else '–'
                   for one in each])
    yield row('energy proxy: one thruster at full power for [s]',
              [f'{one["energy_proxy"]:.1f}' for one in each])
    yield row('ticks that OSQP does not vouch for', [f'{one["not_solved"]}' for one in each])
    yield row('messages dropped', [', '.join(f'{n} {cause}' for cause, n in one['dropped'].items())
                                   or '0' for one in each])
    first = each[0]
    for topic in first['rate']:
        yield row(f'{topic}: rate [Hz] / longest gap [s]',
                  [f'{one["rate"][topic]:.1f} / {one["longest_gap"][topic]:.2f}' for one in each])


def _differences(runs: Sequence[Run], found: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    yield '## Recorded and recomputed setpoints'
    yield ''
    if all(one['difference'] is None for one in found.values()):
        yield 'No setpoints of as many thrusters were recorded.'
        return
    yield ('Largest difference of the thrusters at each tick, as a share of Bollard thrust. Near 0 '
           'for the vehicle and parameters that it was recorded with.')
    yield ''
    yield '| | median | p99 | largest | ticks more than 0.5 % apart, by cause |'
    yield '|---|---|---|---|---|'
    for run in runs:
        one = found[run.name]['difference']
        if one:
            causes = '; '.join(f'{n} {cause}' for cause, n in explained(run).items()) or 'none'
            yield (f'| {run.name} | {one["median"]:.2g} | {one["p99"]:.2g} | {one["max"]:.2g} | '
                   f'{causes} |')


def _happened(run: Run, events: Sequence[Event]) -> Iterator[str]:
    if not events:
        yield 'Nothing out of the ordinary.'
    for event in events[:_MOST]:
        yield f'- {(event.time - run.start) * 1e-9:.2f} s: {event.text}'
    if len(events) > _MOST:
        yield f'- and {len(events) - _MOST} more'
