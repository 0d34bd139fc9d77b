"""What a pilot should know of the ticks of the last second: findings, and figures."""

from dataclasses import dataclass, field
import math

import numpy as np
from thrust_allocator.diagnosis.causes import Allocated
from thrust_allocator.diagnosis.findings import Findings, Level
from thrust_allocator.diagnosis.shortfall import shortfall, Yardstick
from thrust_allocator.physics.power import PredictedPower
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import Allocation
from thrust_allocator.tick import Tick


def note_tick(findings: Findings, tick: Tick, now: int) -> None:
    """Note what a tick has found missing, and a solver that does not vouch for its result."""
    motion, note = tick.motion, findings.note
    note('current', motion.current_ignored and f'current ignored: {motion.current_ignored}', now)
    note('odometry', motion.missing and (
        f'no odometry {motion.missing}: using fallback_velocity'
        + ('' if motion.twist is None else ' where it is tighter')), now)
    note('battery', tick.supply.missing and (
        f'no battery voltage {tick.supply.missing}: the limits are those '
        + ('of the last one' if tick.supply.missing != 'yet' else 'at nominal_voltage')), now)
    note('enable', '' if tick.enabled else 'disabled: zero setpoints', now)
    note('solver', trouble(tick.allocation), now, Level.ERROR)


def trouble(allocation: Allocation | None) -> str:
    """Return what is wrong with a result that OSQP does not vouch for, or ''."""
    if allocation is None or allocation.solved:
        return ''
    return (f'OSQP reports {allocation.status}: setpoints inside the limits, but perhaps not the '
            'best')


def thrusters_off(vehicle: Vehicle) -> str:
    """Say which thrusters are off, or ''."""
    off = _off(vehicle)
    return f'{off} off: enabled is false' if off else ''


def _off(vehicle: Vehicle) -> str:
    return ', '.join(one.name for one in vehicle.thrusters if not one.enabled)


@dataclass
class Tally:
    """What is counted of the ticks from one report to the next."""

    times: list[float] = field(default_factory=list)  # each tick's duration [s]
    allocated: list[Allocated] = field(default_factory=list)  # those that had a wrench
    late: int = 0  # ticks
    newest: Tick | None = None

    def count(self, tick: Tick, seconds: float) -> None:
        """Count a tick that took so long [s]."""
        self.times.append(seconds)
        self.newest = tick
        if tick.allocation is not None:
            self.allocated.append(
                Allocated(tick.wrench, tick.unallocated, tick.allocation, tick.speed_limits))

    def shortfall(self, vehicle: Vehicle, yardstick: Yardstick) -> str:
        """Say what was missing of the commands, or ''."""
        return shortfall(self.allocated, len(self.times), vehicle, yardstick.floor)

    def figures(self, vehicle: Vehicle) -> dict[str, str]:
        """Return what was counted, and what the newest allocation came to, as text by key."""
        iterations = [one.allocation.iterations for one in self.allocated] or [0]
        times = self.times or [0.0]
        return {
            **allocation_figures(
                self.allocated[-1].allocation if self.allocated else None, vehicle),
            'iterations, mean': f'{sum(iterations) / len(iterations):.2f}',
            'iterations, worst': str(max(iterations)),
            'tick time, mean [ms]': f'{1e3 * sum(times) / len(times):.3f}',
            'tick time, worst [ms]': f'{1e3 * max(times):.3f}',
            'ticks': str(len(self.times)),
            'ticks late': str(self.late),
            **self._giving_way(vehicle),
        }

    def _giving_way(self, vehicle: Vehicle) -> dict[str, str]:
        """Return by how much the newest command was scaled, and its power, as text by key."""
        scales, power = (1.0, 1.0), 'unknown'
        if self.allocated:
            newest = self.allocated[-1].allocation
            scales = newest.direction_scale, newest.power_scale
        predicted = PredictedPower(vehicle.thrusters)
        if predicted.known and self.newest is not None:
            tick = self.newest
            watts = predicted.in_flow(tick.flow, tick.models, tick.supply.share)(tick.thrusts)
            power = f'{watts:.1f}'
        return {'scale to keep the direction': f'{scales[0]:.3f}',
                'scale to keep the power limit': f'{scales[1]:.3f}',
                'predicted power [W]': power}


def allocation_figures(allocation: Allocation | None, vehicle: Vehicle) -> dict[str, str]:
    """Return what the newest allocation of a second came to, as text by key."""
    unallocated = np.zeros(6) if allocation is None else allocation.unallocated
    at_bound = [] if allocation is None else [
        one.name for one, side in zip(vehicle.thrusters, allocation.at_bound)
        if side and one.enabled]
    return {
        'solver status': 'not called' if allocation is None else allocation.status,
        'thrusters at a bound': ', '.join(at_bound),
        'thrusters off': _off(vehicle),
        'unallocated force [N]': f'{math.hypot(*unallocated[:3]):.2f}',
        'unallocated moment [N*m]': f'{math.hypot(*unallocated[3:]):.2f}',
    }
