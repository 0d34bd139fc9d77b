"""Sentences out of numbers: what moving bounds gain and cost, and where authority is lost."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.study.authority import HELD
from thrust_allocator.study.grid import Case, Outcome
from thrust_allocator.study.manoeuvre import Manoeuvre, unit
from thrust_allocator.study.sweep import ALLOCATORS, DRIVERS, Sweep

PSEUDO_INVERSE, FIXED, MOVING = range(len(ALLOCATORS))
NOTHING = 0.005  # a difference that two decimals do not show [N, N*m]


def worth(allocation: Sweep, speeds: Sequence[float], weights: Sequence[float],
          driver: int) -> str:
    """
    Return a sentence on what moving bounds gain and cost, at the speed where it is most.

    Errors are weighed as the allocator does, squared and times R; the sentence names the DOF that
    gains most by that measure and the one that pays most, by delivered minus commanded wrench.

    :param weights: R, (6,).
    :param driver: index into DRIVERS, named by the sentence.
    """
    errors = allocation.errors[:, :, driver]
    change = (errors[:, FIXED]**2 - errors[:, MOVING]**2) * weights  # > 0: moving bounds gain
    at = int(np.abs(change.sum(axis=1)).argmax())
    seen = np.abs(errors[at, FIXED] - errors[at, MOVING]) > NOTHING
    gain, price = int(change[at].argmax()), int(change[at].argmin())
    gains = bool(seen[gain] and change[at, gain] > 0.0)
    costs = bool(seen[price] and change[at, price] < 0.0)
    name = list(DRIVERS.values())[driver]
    if not (gains or costs):
        return f'With {name}, bounds fixed at Bollard and moving ones deliver the same.'

    def three(dof: int) -> str:
        moving, fixed, inverse = errors[at, [MOVING, FIXED, PSEUDO_INVERSE], dof]
        return (f'{DOFS[dof]} is off by {moving:+.2f} {unit(dof)} with moving bounds '
                f'({fixed:+.2f} with bounds fixed at Bollard, {inverse:+.2f} by pseudo-inverse)')

    parts = [('moving bounds gain: ', gain)] if gains else []
    if costs:
        parts.append(('the price: ' if gains else 'moving bounds cost: ', price))
    if gains and costs and change[at].sum() < 0.0:
        parts = [('moving bounds cost: ', price), ('they gain: ', gain)]
    said = '; '.join(what + three(dof) for what, dof in parts)
    return f'With {name}, at {speeds[at]:g} m/s: {said}.'


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
              speeds: Sequence[float]) -> str:
    """Return a sentence on authority, intact and with the thruster failed that costs most."""
    def amount(one: Outcome) -> tuple[int, float]:
        mask = within_reach(one, manoeuvre, dof)
        spans = np.nan_to_num(one.authority[:, :, dof, 1] - one.authority[:, :, dof, 0])
        return int(mask.sum()), float(spans.sum())

    dofs = manoeuvre_dofs(manoeuvre) or [i for i, weight in enumerate(
        cases[0].vehicle.wrench_weights) if weight][:1]
    dof = dofs[0]
    worst = min(range(len(cases)), key=lambda i: amount(outcomes[i]))
    command = manoeuvre.wrench[dof]
    said = []
    for i in dict.fromkeys((0, worst)):
        heavier, everything = reach(cases[i], outcomes[i], manoeuvre, dof, speeds)
        same = '' if heavier == everything else f' ({everything} if all controlled DOFs hold)'
        said.append(f'{named(cases[i].failed)} {heavier}{same}')
    return (f'Authority: {command:g} {unit(dof)} of {DOFS[dof]} while holding the cruise wrench is '
            f'within reach {"; ".join(said)}.')


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
