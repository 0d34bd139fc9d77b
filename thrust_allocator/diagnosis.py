"""What a pilot should know: findings in words, and the figures of the last second."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import Allocation
from thrust_allocator.tick import Tick

SLACK = 0.5  # [N, N*m], with SLACK_SHARE of the command: what may be unallocated without a word
SLACK_SHARE = 0.01
UNITS = ('N', 'N', 'N', 'N*m', 'N*m', 'N*m')


class Level(IntEnum):
    """The levels of a diagnostic status."""

    OK = 0
    WARN = 1
    ERROR = 2


class Findings:
    """What is wrong at present, by kind; each is logged when it appears and when it is over."""

    def __init__(self, logger: Any) -> None:
        """Log to `logger`, which has the methods info, warning and error."""
        self._logger = logger
        self._present: dict[str, tuple[Level, str]] = {}

    def note(self, kind: str, text: str, level: Level = Level.WARN) -> None:
        """Note what is wrong, or with an empty text that nothing is."""
        if text:
            if kind not in self._present:
                if level == Level.ERROR:
                    self._logger.error(text)
                else:
                    self._logger.warning(text)
            self._present[kind] = level, text
        elif kind in self._present:
            self._logger.info(f'no longer: {self._present.pop(kind)[1]}')

    def note_tick(self, tick: Tick) -> None:
        """Note what a tick has found missing, and a solver that does not vouch for its result."""
        motion = tick.motion
        self.note('current', motion.current_ignored
                  and f'current ignored: {motion.current_ignored}')
        self.note('odometry', motion.missing and (
            f'no odometry {motion.missing}: using fallback_velocity'
            + ('' if motion.twist is None else ' where it is tighter')))
        self.note('wrench', 'no wrench: zero setpoints' if tick.wrench is None else '')
        self.note('enable', '' if tick.enabled else 'disabled: zero setpoints')
        self.note('solver', trouble(tick.allocation), Level.ERROR)

    def overall(self) -> tuple[Level, str]:
        """Return the worst level, and all findings in one line, the worst first."""
        if not self._present:
            return Level.OK, 'allocating'
        worst_first = sorted(self._present.values(), key=lambda finding: -finding[0])
        return worst_first[0][0], '; '.join(text for _, text in worst_first)


def trouble(allocation: Allocation | None) -> str:
    """Return what is wrong with a result that OSQP does not vouch for, or ''."""
    if allocation is None or allocation.solved:
        return ''
    return (f'OSQP reports {allocation.status}: setpoints inside the limits, but perhaps not the '
            'best')


def shortfall(allocation: Allocation, vehicle: Vehicle) -> str:
    """
    Say which thrusters are at a limit while the wrench is not met, and which DOFs are off.

    A command in a DOF of weight 0 is a finding of its own.

    :return: one line, or '' if there is nothing to say.
    """
    unallocated, wrench_weights = allocation.unallocated, vehicle.wrench_weights
    command = allocation.achieved + unallocated
    off = np.abs(unallocated) > SLACK + SLACK_SHARE * np.abs(command)
    parts = []
    at_bound = _at_bound(allocation, vehicle)
    missed = [f'{DOFS[i]} {abs(unallocated[i]):.1f} {UNITS[i]}'
              for i in np.flatnonzero(off) if wrench_weights[i]]
    if at_bound and missed:
        parts += [f'{", ".join(at_bound)} at {"its limit" if len(at_bound) == 1 else "the limit"}',
                  f'{", ".join(missed)} off {"its" if len(missed) == 1 else "their"} command']
    parts += [f'{DOFS[i]} is commanded but not controlled (wrench_weights.{DOFS[i]} is 0)'
              for i in range(6) if not wrench_weights[i] and abs(command[i]) > SLACK]
    return '; '.join(parts)


@dataclass
class Tally:
    """What is counted of the ticks from one report to the next."""

    times: list[float] = field(default_factory=list)  # each tick's duration [s]
    iterations: list[int] = field(default_factory=list)  # OSQP's, of each solve
    late: int = 0  # ticks
    newest: Allocation | None = None
    trouble: str = ''  # the newest failure of the solver, though it may be over

    def count(self, tick: Tick, seconds: float) -> None:
        """Count a tick that took so long [s]."""
        self.times.append(seconds)
        if tick.allocation is not None:
            self.newest = tick.allocation
            self.iterations.append(tick.allocation.iterations)
            self.trouble = trouble(tick.allocation) or self.trouble

    def figures(self) -> dict[str, str]:
        """Return mean and worst of what was counted, as text by key."""
        return {
            'iterations, mean': f'{np.mean(self.iterations or [0]):.2f}',
            'iterations, worst': str(max(self.iterations, default=0)),
            'tick time, mean [ms]': f'{1e3 * np.mean(self.times or [0.0]):.3f}',
            'tick time, worst [ms]': f'{1e3 * max(self.times, default=0.0):.3f}',
            'ticks': str(len(self.times)),
            'ticks late': str(self.late),
        }


def allocation_figures(allocation: Allocation | None, vehicle: Vehicle) -> dict[str, str]:
    """Return what the newest allocation of a period came to, as text by key."""
    unallocated = np.zeros(6) if allocation is None else allocation.unallocated
    at_bound = [] if allocation is None else _at_bound(allocation, vehicle)
    return {
        'solver status': 'not called' if allocation is None else allocation.status,
        'thrusters at a bound': ', '.join(at_bound),
        'thrusters off': ', '.join(one.name for one in vehicle.thrusters if not one.enabled),
        'unallocated force [N]': f'{np.linalg.norm(unallocated[:3]):.2f}',
        'unallocated moment [N*m]': f'{np.linalg.norm(unallocated[3:]):.2f}',
    }


def _at_bound(allocation: Allocation, vehicle: Vehicle) -> list[str]:
    """Return the names of the thrusters that are held at a bound, and not because they are off."""
    return [one.name for one, side in zip(vehicle.thrusters, allocation.at_bound)
            if side and one.enabled]
