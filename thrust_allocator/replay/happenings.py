"""What happened on a mission, in words, and why setpoints are not the recorded ones."""

from collections import Counter
from collections.abc import Iterator

import numpy as np
from thrust_allocator.replay.figures import Arrivals, differences
from thrust_allocator.replay.run import Event, Run

MANY = 5.0  # usual intervals without a message, from which on that is a gap
SHORTEST = 0.2  # and the shortest time that is one [s]
ALIKE = 0.005  # share of Bollard thrust that recorded and recomputed setpoints may be apart
SAG = 0.03  # share of the first voltage that a battery may fall without a word
STARTING = 500 * 10**6  # [ns], in which a node may not be connected to all of its topics yet
FEEDS = ('cmd_wrench', 'odom', 'twist', 'current', 'battery')


def happenings(run: Run, arrivals: Arrivals, end: int) -> list[Event]:
    """Return what happened, in the order of time."""
    ticks, times = run.ticks, run.ticks.times
    found = [*run.events, *_gaps(run, arrivals, end)]
    found += [Event(start, 'the recorded node gave zeros in spite of a wrench, for '
                    f'{seconds:.2f} s: disabled, shut down, or not connected yet')
              for start, seconds in _spans(times, ticks['stopped'])]
    found += [Event(start, f'OSQP vouches for no result, for {seconds:.2f} s')
              for start, seconds in _spans(times, ~ticks['solved'])]
    found += [Event(run.start, f'thruster {one.name} is off')
              for one in run.first.vehicle.thrusters if not one.enabled]
    return sorted([*found, *_sag(run)])


def _gaps(run: Run, arrivals: Arrivals, end: int) -> Iterator[Event]:
    """Yield the gaps of each topic, and what the node makes of them."""
    times, ticks = run.ticks.times, run.ticks
    quiet = {'cmd_wrench': (~ticks['live'] & ~ticks['stopped'], 'zero setpoints'),
             'odom': (ticks['stale'], 'limits no wider than at fallback_velocity'),
             'twist': (ticks['stale'], 'limits no wider than at fallback_velocity')}
    for name in FEEDS:
        came = arrivals.times.get(name)
        if not came:
            continue
        moments = np.array([run.start, *came, end])
        usual = np.median(np.diff(came)) if len(came) > 2 else 0.0
        steps = np.diff(moments)
        for i in np.flatnonzero(steps > max(MANY * usual, SHORTEST * 1e9)):
            text = f'no {name} for {steps[i] * 1e-9:.2f} s'
            if name in quiet:
                flags, effect = quiet[name]
                within = (times > moments[i]) & (times <= moments[i + 1]) & flags
                if within.any():
                    text += f': {effect} at {int(within.sum())} ticks'
            yield Event(int(moments[i]), text)


def _sag(run: Run) -> Iterator[Event]:
    """Yield how far the battery fell, when, and what that leaves of the thrust."""
    known = [(time, voltage) for time, voltage in run.voltages if 0.0 < voltage < np.inf]
    if not known:
        return
    time, lowest = min(known, key=lambda one: one[1])
    if lowest > (1.0 - SAG) * known[0][1]:
        return
    values = run.description.parameters.values
    nominal, exponent = values['nominal_voltage'], values['voltage_exponent']
    effect = (f'{(lowest / nominal)**exponent:.0%} of the thrust at nominal_voltage' if nominal else
              'not considered, for nominal_voltage is 0')
    yield Event(time, f'battery down from {known[0][1]:.1f} to {lowest:.1f} V: {effect}')


def _spans(times: np.ndarray, flags: np.ndarray) -> list[tuple[int, float]]:
    """Return start [ns] and length [s] of each run of ticks that are flagged."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(times[a]), float(times[min(b, len(times) - 1)] - times[a]) * 1e-9)
            for a, b in zip(edges[::2], edges[1::2])]


def explained(run: Run) -> dict[str, int]:
    """
    Return how many ticks are more than 0.5 % of Bollard thrust from the recorded ones, by cause.

    The recorder's times are its own: a tick may have seen a message more or less than it seems.
    Such a tick lies between the recomputed ones before and after it.
    """
    apart = differences(run)
    far = np.flatnonzero(apart > ALIKE)  # not where it is NaN
    if not len(far):
        return {}
    recorded, setpoints = run.ticks['recorded'], run.ticks['setpoints']
    around = np.stack([setpoints[np.clip(far + step, 0, len(setpoints) - 1)]
                       for step in (-1, 0, 1)])
    slack = ALIKE * np.abs(around).max(axis=0) + 1e-9
    inside = ((recorded[far] >= around.min(axis=0) - slack)
              & (recorded[far] <= around.max(axis=0) + slack)).all(axis=1)
    times, stopped = run.ticks.times, run.ticks['stopped']
    since = times[far] - np.maximum.accumulate(np.where(stopped, times, run.start))[far]
    causes = np.select(
        [~recorded[far].any(axis=1), inside, since < STARTING], [
            'recorded zeros: the node had stopped, or no wrench counted any more',
            'a message earlier or later than the recorder has it',
            'in the first half second after a start'], 'not explained')
    return dict(Counter(causes.tolist()))
