"""The ticks of a run as columns of numbers."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.tick import Tick

_CHUNK = 8192  # rows


class Ticks:
    """Row after row of what the ticks decided; p thrusters, wrenches in the messages' axes."""

    def __init__(self, p: int) -> None:
        """Start with no ticks."""
        sizes = {'thrusts': p, 'lower': p, 'upper': p, 'setpoints': p, 'recorded': p,
                 'deflections': p, 'at_bound': p, 'wrench': 6, 'achieved': 6, 'unallocated': 6,
                 'velocity': 6, 'live': 1, 'solved': 1, 'stale': 1, 'stopped': 1}
        ends = np.cumsum(list(sizes.values())).tolist()
        self._columns = {name: slice(end - size, end)
                         for (name, size), end in zip(sizes.items(), ends)}
        self._chunks = [np.empty((_CHUNK, ends[-1]))]
        self._times: list[int] = []

    def __len__(self) -> int:
        return len(self._times)

    @property
    def times(self) -> np.ndarray:
        """Return the time of each tick, (n,) [ns]."""
        return np.array(self._times, dtype=np.int64)

    def __getitem__(self, name: str) -> np.ndarray:
        """
        Return a column over all ticks, (n, p) or (n, 6); flags are (n,).

        thrusts, lower, upper [N]; setpoints and recorded, in the unit of the topic (recorded is
        NaN where there is none); deflections of fins, 0 of thrusters [rad]; at_bound as in
        `Allocation`; wrench, achieved, unallocated [N, N*m]; velocity through the water [m/s,
        rad/s]; live: a wrench counts and the vehicle is enabled; solved; stale: the velocity
        counts no more; stopped: only because the recorded node was.
        """
        columns = self._columns[name]
        rows = np.concatenate([chunk[:, columns] for chunk in self._chunks])[:len(self)]
        return rows[:, 0] > 0.5 if name in ('live', 'solved', 'stale', 'stopped') else rows

    def add(self, time: int, tick: Tick, velocity: np.ndarray, setpoints: Sequence[float],
            deflections: Sequence[float], recorded: np.ndarray | None, stopped: bool) -> None:
        """Add a tick; `recorded` are the setpoints that were published at its time."""
        index = len(self) % _CHUNK
        if index == 0 and len(self):
            self._chunks.append(np.empty_like(self._chunks[0]))
        p = len(tick.thrusts)
        allocation = tick.allocation
        if recorded is None or len(recorded) != p:
            recorded = np.full(p, np.nan)
        self._chunks[-1][index] = np.concatenate([
            tick.thrusts, tick.limits[0], tick.limits[1], setpoints, recorded, deflections,
            np.zeros(p) if allocation is None else allocation.at_bound,
            np.zeros(6) if tick.wrench is None else tick.wrench,
            tick.achieved, tick.unallocated, velocity,
            [allocation is not None, allocation is None or allocation.solved, tick.motion.stale,
             stopped]])
        self._times.append(time)
