"""Words out of numbers: what moving bounds gain and cost, and where authority is lost."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.study.authority import HELD
from thrust_allocator.study.grid import Case, Outcome
from thrust_allocator.study.manoeuvre import Manoeuvre, unit
from thrust_allocator.study.sweep import ALLOCATORS, DRIVERS, Sweep

PSEUDO_INVERSE, FIXED, MOVING = range(len(ALLOCATORS))
# Columns of what moving bounds are worth
WORTH = ('driver', 'v, m/s', 'error of', 'moving bounds', 'fixed bounds', 'pseudo-inverse',
         'with moving bounds it is')
NOTHING = 0.005  # a difference that two decimals do not show [N, N*m]


def setting(case: Case, manoeuvre: Manoeuvre) -> str:
    """Say of what vehicle, state, heading and command something is told."""
    return (f'{case.layout}, {named(case.failed)}; heading {case.heading:g}° to the current; '
            f'{manoeuvre}')


def worth(allocation: Sweep, speeds: Sequence[float], weights: Sequence[float],
          driver: int) -> list[tuple[str, ...]]:
    """
    Return rows under WORTH: what moving bounds gain and cost, at the speed where it is most.

    Errors, delivered minus commanded, are weighed as the allocator does, squared and times R; the
    rows name the DOF that gains most by that measure and the one that pays most, the larger of the
    two first.

    :param weights: R, (6,).
    :param driver: index into DRIVERS, named by the rows.
    """
    errors = allocation.errors[:, :, driver]
    change = (errors[:, FIXED]**2 - errors[:, MOVING]**2) * weights  # > 0: moving bounds gain
    at = int(np.abs(change.sum(axis=1)).argmax())
    seen = np.abs(errors[at, FIXED] - errors[at, MOVING]) > NOTHING
    ends = sorted({int(change[at].argmax()), int(change[at].argmin())},
                  key=lambda dof: -abs(change[at, dof]))
    name = list(DRIVERS)[driver]
    rows = [(name, f'{speeds[at]:g}', f'{DOFS[dof]}, {unit(dof)}',
             *(f'{errors[at, allocator, dof]:+.2f}'
               for allocator in (MOVING, FIXED, PSEUDO_INVERSE)),
             'smaller' if change[at, dof] > 0.0 else 'larger')
            for dof in ends if seen[dof] and change[at, dof]]
    return rows or [(name, 'any', 'all', *('the same',) * 3, 'the same')]


def at_speeds(mask: np.ndarray, speeds: Sequence[float]) -> str:
    """Say at which of the speeds `mask`, (n,) bool, holds."""
    if mask.all() or not mask.any():
        return 'at every speed' if mask.all() else 'at no speed'
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    runs = [(speeds[first], speeds[end - 1]) for first, end in zip(edges[::2], edges[1::2])]
    return 'at ' + ', '.join(f'{first:g}' if first == last else f'{first:g} to {last:g}'
                             for first, last in runs) + ' m/s'


def named(failed: Sequence[str]) -> str:
    """Return how a case of failed thrusters is called."""
    return 'without ' + ' and '.join(failed) if failed else 'intact'


def manoeuvre_dofs(manoeuvre: Manoeuvre) -> list[int]:
    """Return the DOFs in which the manoeuvre's wrench is not 0."""
    return [i for i, value in enumerate(manoeuvre.wrench) if value]


def within_reach(outcome: Outcome, manoeuvre: Manoeuvre, dof: int) -> np.ndarray:
    """Tell where the manoeuvre is within a DOF's authority, (n, 2) bool: for each of HELD."""
    wanted = outcome.allocation.commands[:, dof, np.newaxis]
    slack = 1e-9 * np.abs(wanted)
    smallest, largest = np.moveaxis(outcome.authority[:, :, dof], -1, 0)
    return (smallest - slack <= wanted) & (wanted <= largest + slack)


def reach(case: Case, outcome: Outcome, manoeuvre: Manoeuvre, dof: int,
          speeds: Sequence[float]) -> list[str]:
    """Say of each of HELD at which speeds the manoeuvre is within reach."""
    return [at_speeds(mask, speeds) for mask in within_reach(outcome, manoeuvre, dof).T]


def authority(cases: Sequence[Case], outcomes: Sequence[Outcome], manoeuvre: Manoeuvre,
              speeds: Sequence[float]) -> tuple[str, list[tuple[str, ...]]]:
    """
    Return what is asked of authority, and where it is within reach.

    :return: the wrench in words, and rows of a case and the speeds for each of HELD: intact, and
        with the thruster failed that costs most.
    """
    def amount(one: Outcome) -> tuple[int, float]:
        mask = within_reach(one, manoeuvre, dof)
        spans = np.nan_to_num(one.authority[:, :, dof, 1] - one.authority[:, :, dof, 0])
        return int(mask.sum()), float(spans.sum())

    dofs = manoeuvre_dofs(manoeuvre) or [i for i, weight in enumerate(
        cases[0].vehicle.wrench_weights) if weight][:1]
    dof = dofs[0]
    worst = min(range(len(cases)), key=lambda i: amount(outcomes[i]))
    return (f'{manoeuvre.wrench[dof]:g} {unit(dof)} of {DOFS[dof]} beside the cruise wrench',
            [(f'{cases[i].layout}, {named(cases[i].failed)}',
              *reach(cases[i], outcomes[i], manoeuvre, dof, speeds))
             for i in dict.fromkeys((0, worst))])


def gaps(cases: Sequence[Case], outcomes: Sequence[Outcome],
         speeds: Sequence[float]) -> list[str]:
    """Return a sentence for each gap in authority: in which DOFs, when, and in which cases."""
    found: dict[tuple, list[str]] = {}  # cases by what is missing
    for case, outcome in zip(cases, outcomes):
        missing = np.isnan(outcome.authority[..., 0])  # (n, 2, 6)
        groups: dict[bytes, list[int]] = {}
        for dof in np.flatnonzero(case.vehicle.wrench_weights):
            groups.setdefault(missing[:, :, dof].tobytes(), []).append(int(dof))
        for dofs in groups.values():
            if missing[:, :, dofs[0]].any():
                where = [at_speeds(mask, speeds) for mask in missing[:, :, dofs[0]].T]
                found.setdefault((tuple(dofs), *where), []).append(named(case.failed))
    sentences = []
    for (dofs, heavier, everything), names in found.items():
        when = heavier
        if heavier != everything:
            when = f'{everything} while {HELD["all"]}' + (
                '' if heavier == 'at no speed' else f', {heavier} while {HELD["heavier"]}')
        sentences.append(f'A gap for {", ".join(DOFS[dof] for dof in dofs)} {when}, where the '
                         f'cruise wrench cannot be held: {", ".join(names)}.')
    return sentences
