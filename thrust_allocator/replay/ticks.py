"""The ticks of a run as columns of numbers."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from thrust_allocator.tick import Tick

_CHUNK = 4096  # rows
_FLAGS = ('live', 'solved', 'stale', 'stopped')


class _Row(NamedTuple):
    """What is kept of a tick; p thrusters, wrenches in the messages' axes."""

    times: int  # [ns]
    thrusts: np.ndarray  # (p,) [N]
    lower: np.ndarray  # (p,) [N]
    upper: np.ndarray
    setpoints: Sequence[float]  # (p,), in the unit of the topic
    recorded: np.ndarray  # (p,), likewise; NaN where there is none
    deflections: Sequence[float]  # (p,), of fins; 0 of thrusters [rad]
    at_bound: np.ndarray  # (p,), as in `Allocation`
    wrench: np.ndarray  # (6,) [N, N*m]
    achieved: np.ndarray
    unallocated: np.ndarray
    velocity: np.ndarray  # through the water, (6,) [m/s, rad/s]
    live: bool  # a wrench counts and the vehicle is enabled
    solved: bool
    stale: bool  # the velocity counts no more
    stopped: bool  # only because the recorded node was


class Ticks:
    """Row after row of what the ticks decided, held in arrays."""

    def __init__(self, p: int) -> None:
        """Start with no ticks of p thrusters."""
        self._rows: list[_Row] = []  # those that no chunk has yet
        self._chunks: list[dict[str, np.ndarray]] = []
        self._zeros, self._none, self._no_wrench = np.zeros(p), np.full(p, np.nan), np.zeros(6)

    def __len__(self) -> int:
        return _CHUNK * len(self._chunks) + len(self._rows)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a column of `_Row` over all ticks: (n,), (n, p) or (n, 6)."""
        return np.concatenate([chunk[name] for chunk in self._chunks]
                              + ([_column(name, self._rows)] if self._rows else []))

    @property
    def times(self) -> np.ndarray:
        """Return the time of each tick, (n,) [ns]."""
        return self['times']

    def add(self, time: int, tick: Tick, velocity: np.ndarray, setpoints: Sequence[float],
            deflections: Sequence[float] | None, recorded: np.ndarray | None,
            stopped: bool) -> None:
        """Add a tick; `recorded` are the setpoints that were published at its time."""
        allocation = tick.allocation
        if recorded is None or len(recorded) != len(tick.thrusts):
            recorded = self._none
        self._rows.append(_Row(
            time, tick.thrusts, tick.limits[0], tick.limits[1], setpoints, recorded,
            self._zeros if deflections is None else deflections,
            self._zeros if allocation is None else allocation.at_bound,
            self._no_wrench if tick.wrench is None else tick.wrench,
            tick.achieved, tick.unallocated, velocity, allocation is not None,
            allocation is None or allocation.solved, tick.motion.stale, stopped))
        if len(self._rows) == _CHUNK:
            self._chunks.append({name: _column(name, self._rows) for name in _Row._fields})
            self._rows = []


def _column(name: str, rows: Sequence[_Row]) -> np.ndarray:
    kind = np.int64 if name == 'times' else bool if name in _FLAGS else float
    return np.array([getattr(row, name) for row in rows], dtype=kind)
