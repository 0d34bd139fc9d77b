"""What a run comes to, in figures."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np
from thrust_allocator.diagnosis.shortfall import Yardstick
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.replay.run import Run


class Arrivals:
    """When the messages of each topic came: how often, and the longest time without."""

    def __init__(self, start: int) -> None:
        """Begin at a time [ns]."""
        self._start = start
        self.times: dict[str, list[int]] = defaultdict(list)  # by topic [ns]

    def note(self, topic: str, time: int) -> None:
        """Note that a message came."""
        self.times[topic].append(time)

    def rate(self, end: int) -> dict[str, float]:
        """Return messages per second of the recording, by topic [Hz]."""
        return {topic: len(times) / max((end - self._start) * 1e-9, 1e-9)
                for topic, times in self.times.items()}

    def longest_gap(self, end: int) -> dict[str, float]:
        """Return the longest time without a message, by topic, from start to end [s]."""
        return {topic: float(np.diff([self._start, *times, end]).max() * 1e-9)
                for topic, times in self.times.items()}


def figures(run: Run, arrivals: Arrivals, end: int) -> dict[str, Any]:
    """
    Return the figures of a run, as `summary.json` has them.

    Shares are of the ticks with a live wrench; `difference` is of recorded and recomputed
    setpoints, as a share of Bollard thrust, the largest of the thrusters at each tick.
    """
    ticks, names = run.ticks, [one.name for one in run.description.vehicle.thrusters]
    live = ticks['live']
    saturated = (ticks['at_bound'][live] != 0.0)
    missed, wrench, achieved = (ticks[name][live] for name in ('unallocated', 'wrench', 'achieved'))
    floor = Yardstick(run.description.vehicle).floor
    reversed_ = ((wrench * achieved < 0.0) & (np.abs(wrench) > floor)
                 & (np.abs(achieved) > floor))
    count = max(int(live.sum()), 1)
    return {
        'ticks': len(ticks),
        'seconds': (end - run.start) * 1e-9,
        'live_share': float(live.mean()) if len(ticks) else 0.0,
        'saturated_share': dict(zip(names, (saturated.sum(axis=0) / count).tolist())),
        'unallocated_rms': _by_dof(np.sqrt((missed**2).sum(axis=0) / count)),
        'unallocated_max': _by_dof(np.abs(missed).max(axis=0, initial=0.0)),
        'reversed_share': _by_dof(reversed_.sum(axis=0) / count),
        'dropped': dict(sorted(run.dropped.items())),
        'longest_gap': arrivals.longest_gap(end),
        'rate': arrivals.rate(end),
        'not_solved': int((~ticks['solved']).sum()),
        'energy_proxy': energy_proxy(run),
        'difference': difference(run),
    }


def energy_proxy(run: Run) -> float:
    """
    Return how long one thruster at full power would take for the energy that all of them took [s].

    The integral of the sum of (e / T0)^1.5, with e the Bollard-equivalent thrust: power goes with
    the cube of revolutions, thrust with their square. Fins take no part.
    """
    times, power = np.array([*run.power, (run.ticks.times[-1], 0.0)]).T
    return float(power[:-1] @ np.diff(times) * 1e-9)


def differences(run: Run) -> np.ndarray:
    """Return, (n,), how far recorded and recomputed setpoints are apart, a share of Bollard."""
    ticks, vehicle = run.ticks, run.description.vehicle
    unit = run.description.parameters.values['setpoint_unit']
    scale = np.abs(vehicle.reference_limits).max(axis=0)
    if unit != 'newton':  # then those of fins are deflections
        scale[[one.model.DEFLECTS for one in vehicle.thrusters]] = 1.0
    if unit == 'bollard_fraction':
        scale = np.ones_like(scale)
    return (np.abs(ticks['recorded'] - ticks['setpoints']) / scale).max(axis=1)


def difference(run: Run) -> dict[str, float] | None:
    """Return median, p99 and max of the differences, or None if no setpoints were recorded."""
    apart = differences(run)
    apart = apart[np.isfinite(apart)]
    if not len(apart):
        return None
    return {'median': float(np.median(apart)), 'p99': float(np.percentile(apart, 99.0)),
            'max': float(apart.max())}


def _by_dof(values: np.ndarray) -> Mapping[str, float]:
    return dict(zip(DOFS, values.tolist()))
