"""The report: pictures, tables and sentences of a study, written to a folder."""

from collections.abc import Callable, Sequence
from pathlib import Path

import joblib
import numpy as np
from thrust_allocator.markdown import table
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Thruster
from thrust_allocator.study import authority_picture, findings, pictures, tables
from thrust_allocator.study.authority import HELD
from thrust_allocator.study.directions import directions
from thrust_allocator.study.grid import Case, Outcome
from thrust_allocator.study.manoeuvre import Manoeuvre, unit
from thrust_allocator.study.saturation import (
    reach_of, saturation, saturation_table, TIMES_AUTHORITY)
from thrust_allocator.study.style import dotted
from thrust_allocator.study.sweep import ALLOCATORS, DRIVERS, shares, Sweep, without

ROWS = 19  # of a table over speed, at most
COMMANDS = 1000  # beyond reach
FRAME = 'Axes: x forward, y starboard, z down; positive pitch is nose up.'


class Drawings:
    """Pictures that are yet to be drawn, by one process or several: they take longer than CSV."""

    def __init__(self) -> None:
        self._pending: list = []

    def add(self, draw: Callable[..., None], *args: object) -> None:
        """Remember to call a function of `pictures`."""
        self._pending.append(joblib.delayed(draw)(*args))

    def draw(self, jobs: int) -> None:
        """Draw all pictures with so many processes on this machine."""
        joblib.Parallel(n_jobs=min(jobs, len(self._pending)))(self._pending)


def layout_report(drawings: Drawings, folder: Path, cases: Sequence[Case],
                  outcomes: Sequence[Outcome], manoeuvre: Manoeuvre, speeds: Sequence[float],
                  thruster: Thruster, within: str = '') -> list[str]:
    """
    Write the tables of all pictures of one vehicle, and return what the report says.

    :param cases: at one heading; the first is the one without further failures, drawn in 1 and 2.
    :param thruster: whose bounds to draw in every direction.
    :param within: how to get from the report to `folder`: '' or a name with a slash.
    """
    case, outcome = cases[0], outcomes[0]
    vehicle, allocation = without(case.vehicle, case.failed), outcome.allocation
    moving = allocation.thrusts[:, list(ALLOCATORS).index('moving bounds')]
    who = {dof: shares(vehicle, moving, dof) for dof in main_dofs(manoeuvre, case)}
    tables.write_allocation(folder / 'allocation_against_speed.csv', vehicle, speeds, allocation,
                            who)
    setting = dotted(findings.setting(case, manoeuvre))
    drawings.add(pictures.draw_allocation, folder / 'allocation_against_speed', setting, vehicle,
                 speeds, allocation, who)
    tables.write_worth(folder / 'worth.csv', speeds, allocation)
    drawings.add(pictures.draw_worth, folder / 'worth', setting, vehicle, speeds, allocation)
    tables.write_authority(folder / 'authority.csv', speeds, cases, outcomes)
    drawings.add(authority_picture.draw_authority, folder / 'authority', setting, speeds, cases,
                 outcomes)
    found = directions(thruster, float(np.abs(speeds).max()) or 1.0)
    tables.write_directions(folder / 'directions.csv', found)
    drawings.add(pictures.draw_directions, folder / 'directions', case.layout, thruster,
                 found)
    beyond = saturation(vehicle, reach_of(vehicle), COMMANDS)
    tables.write_giving_way(folder / 'giving_way.csv', beyond)
    drawings.add(pictures.draw_giving_way, folder / 'giving_way',
                 f'{case.layout}, {findings.named(case.failed)}; at rest; {COMMANDS} commands up '
                 f'to {TIMES_AUTHORITY:g} times its authority', beyond)

    state = f' ({findings.named(case.failed)})' if case.failed else ''
    weights = case.vehicle.wrench_weights
    lines = [
        f'## {case.layout}{state}, heading {case.heading:g}° to the current', '',
        *_figure(within, 'allocation_against_speed', 'Allocation against speed',
                 'The thrusts that the allocator with moving bounds asks for, inside those bounds, '
                 f'and who gives what share of the {" and the ".join(DOFS[dof] for dof in who)}.'),
        *_figure(within, 'worth', 'What moving bounds are worth',
                 'What the vehicle gets beyond or short of the command when the thrusts of each '
                 'allocator are passed through the thrust that is really available at that speed, '
                 'for two kinds of motor driver.')]
    for d in range(len(DRIVERS)):
        lines += [*_worth_table(allocation, speeds, weights, d), '']
    lines += [
        *_figure(within, 'authority', 'Authority against speed',
                 'The largest and smallest wrench within reach of each controlled DOF: the band as '
                 'it stands, lines with one thruster more failed, those that cost most there. '
                 f'Left while the {HELD["heavier"]} the cruise wrench and the others are free, '
                 f'right while {HELD["all"]} it.'),
        *_reach_tables(cases, outcomes, manoeuvre, speeds),
        *(f'- {sentence}' for sentence in findings.gaps(cases, outcomes, speeds)), '',
        *_figure(within, 'directions', f'Bounds in every direction: {thruster.name}',
                 f'The forward and the reverse limit of {thruster.name} over its speed through the '
                 'water and the angle between its motion and its thrust axis.'),
        *_figure(within, 'giving_way', 'What gives way beyond reach',
                 f'{COMMANDS} commands that the pseudo-inverse cannot follow, in every direction, '
                 f'up to {TIMES_AUTHORITY:g} times the authority at rest: by how much their '
                 'direction is missed, and how much of them, along it, is lost.'),
        saturation_table(beyond), '']
    return lines


def main_dofs(manoeuvre: Manoeuvre, case: Case) -> list[int]:
    """Return the DOFs of the manoeuvre, or the first controlled one if it has none."""
    return findings.manoeuvre_dofs(manoeuvre) or [
        int(np.flatnonzero(case.vehicle.wrench_weights)[0])]


def candidates_report(drawings: Drawings, folder: Path, cases: Sequence[Case],
                      outcomes: Sequence[Outcome], manoeuvre: Manoeuvre,
                      speeds: Sequence[float]) -> list[str]:
    """
    Set layouts side by side, or the headings of a single one, and return what the report says.

    Each value is the wrench that can be had in either sense while the DOFs of equal or larger
    weight hold; of a layout, the least over all headings.
    """
    layouts = list(dict.fromkeys(case.layout for case in cases))
    several = len(layouts) > 1
    groups: dict[str, tuple[list[np.ndarray], list[np.ndarray]]] = {}
    fewest = {name: min(len(case.failed) for case in cases if case.layout == name)
              for name in layouts}
    for case, outcome in zip(cases, outcomes):
        name = case.layout if several else f'heading {case.heading:g}°'
        both_ways = np.minimum(outcome.authority[:, 0, :, 1], -outcome.authority[:, 0, :, 0])
        groups.setdefault(name, ([], []))[
            len(case.failed) > fewest[case.layout]].append(both_ways)
    series = {name: tuple(np.minimum.reduce(some or [np.full((len(speeds), 6), np.nan)])
                          for some in pair) for name, pair in groups.items()}
    dofs = [dof for dof in range(6)
            if any(case.vehicle.wrench_weights[dof] > 0.0 for case in cases)]
    tables.write_candidates(folder / 'candidates.csv', speeds, series)
    states = dict.fromkeys(f'{case.layout}, {findings.named(case.failed)}' for case in cases
                           if len(case.failed) == fewest[case.layout])
    headings = ', '.join(f'{heading:g}' for heading in sorted({case.heading for case in cases}))
    drawings.add(pictures.draw_candidates, folder / 'candidates',
                 dotted(f'{"; ".join(states)}; heading {headings}° to the current; {manoeuvre}'),
                 speeds, dofs, series)
    what = 'The least authority of each layout over all headings' if several else \
        'The authority at each heading to the current'
    return ['## Side by side', '', *_figure(
        '', 'candidates', 'Authority both ways, by candidate',
        f'{what}, in whichever sense there is less of it, while the {HELD["heavier"]} the cruise '
        'wrench: thick as it stands, thin at the worst further failure of a single thruster; '
        'a gap where the cruise wrench cannot be held.')]


def verdict(shown: Sequence[tuple[Sequence[Case], Sequence[Outcome]]], manoeuvre: Manoeuvre,
            speeds: Sequence[float]) -> list[str]:
    """
    Return the lines of what comes first: what moving bounds are worth, and what stays in reach.

    :param shown: of each vehicle the cases and outcomes that its pictures show, intact first.
    """
    rows = [(cases[0].layout, *row) for cases, outcomes in shown for d in range(len(DRIVERS))
            for row in findings.worth(outcomes[0].allocation, speeds,
                                      cases[0].vehicle.wrench_weights, d)]
    found = [findings.authority(*one, manoeuvre, speeds) for one in shown]
    return [f'Delivered minus commanded wrench where moving bounds change it most: {manoeuvre}', '',
            *table(('vehicle', *findings.WORTH), rows).splitlines(), '',
            f'Within reach: {found[0][0]}, while', '',
            *table(('', *HELD.values()), [row for _, some in found for row in some]).splitlines()]


def write_report(path: Path, command: str, manoeuvre: Manoeuvre, sections: Sequence[str],
                 summary: Sequence[str]) -> None:
    """Write report.md: what was asked, what came out, how to read it."""
    text = [
        '# A study of thrust allocation', '', *summary, '',
        f'The command at every speed v: {manoeuvre}. {FRAME} A heading is to starboard from '
        'straight into the current.', '',
        *sections,
        '## How to read it', '',
        *(f'- *{key}*: {label}.' for key, label in ALLOCATORS.items()),
        '- All three know which thrusters have failed. The pseudo-inverse is taken over the '
        'controlled DOFs and weighted by Q.',
        *(f'- *{key}*: {label}.' for key, label in DRIVERS.items()),
        '- The driver with a Bollard curve takes the setpoint for a thrust at rest. Told the '
        'Bollard-equivalent thrust instead, it delivers like the other one, inside moving bounds.',
        '- The share of a wrench is in percent of what the setpoints add up to.',
        '- `grid.csv` has every point of the study: layouts, headings, failures, speeds.', '',
        'Made by:', '', '```sh', command, '```', '']
    path.write_text(dotted('\n'.join(text)), encoding='utf-8')


def _figure(folder: str, name: str, title: str, sentence: str) -> list[str]:
    return [f'### {title}', '', f'![{title}]({folder}{name}.png)', '',
            f'{sentence} ([SVG]({folder}{name}.svg), [CSV]({folder}{name}.csv))', '']


def _worth_table(allocation: Sweep, speeds: Sequence[float], weights: Sequence[float],
                 driver: int) -> list[str]:
    errors = allocation.errors[:, :, driver]
    dofs = [i for i in np.flatnonzero(weights)
            if np.abs(errors[..., i]).max() > findings.NOTHING]
    if not dofs:
        return ['Every allocator gives what was commanded, to 0.005 N and N*m.']
    every = -(-(len(speeds) - 1) // (ROWS - 1)) or 1
    header = ['v, m/s'] + [f'{DOFS[dof]}, {unit(dof)}: {name}' for dof in dofs
                           for name in ALLOCATORS]
    rows = [[f'{speeds[i]:g}'] + [f'{errors[i, a, dof]:.3f}' for dof in dofs
                                  for a in range(len(ALLOCATORS))]
            for i in range(0, len(speeds), every)]
    return [f'Delivered minus commanded wrench, driver: {list(DRIVERS)[driver]}.', '',
            table(header, rows)]


def _reach_tables(cases: Sequence[Case], outcomes: Sequence[Outcome], manoeuvre: Manoeuvre,
                  speeds: Sequence[float]) -> list[str]:
    lines = []
    for dof in findings.manoeuvre_dofs(manoeuvre):
        rows = [[findings.named(case.failed),
                 *findings.reach(case, outcome, manoeuvre, dof, speeds)]
                for case, outcome in zip(cases, outcomes)]
        lines += [f'{manoeuvre.wrench[dof]:g} {unit(dof)} of {DOFS[dof]} beside the cruise wrench '
                  'is within reach:', '', table(['', *HELD.values()], rows), '']
    return lines
