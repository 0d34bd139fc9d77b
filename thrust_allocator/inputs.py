"""What the node was told last, how long that counts, and what was too broken to count at all."""

from collections import Counter
from dataclasses import dataclass
import math
from typing import NamedTuple

import numpy as np
from thrust_allocator.supply import HIGHEST, Rating, SILENCE, Supply, Voltage

LARGEST_WRENCH = 1e9  # [N, N*m]; beyond it a message is taken for broken
LARGEST_VELOCITY = 50.0  # [m/s, rad/s]
AHEAD = 100_000_000  # [ns] by which a stamp may be ahead of the clock
UNIT = 1e-3  # how far from 1 the norm of a unit quaternion may be


NEVER = -2**62  # [ns], a time longer ago than any time-out


class Timeouts(NamedTuple):
    """Ages beyond which what was received last counts no more [ns]."""

    wrench: int
    velocity: int  # 0: no velocity is expected
    current: int


class Smoothing(NamedTuple):
    """A first-order filter on the velocity."""

    time_constant: float  # 0: none [ns]
    longest_gap: float  # between two velocities, after which the filter is set anew [ns]


@dataclass
class Received:
    """The newest accepted message of one topic."""

    values: np.ndarray  # as they stood in the message, a velocity as the filter leaves it
    time: int  # of receipt [ns]
    frame: str = ''  # the frame id that the message gave
    child_frame: str = ''  # and that of the axes of the twist, of an odometry
    orientation: np.ndarray | None = None  # quaternion x, y, z, w
    old: int = 0  # its age at receipt, by its stamp [ns]

    def age(self, now: int) -> int:
        """Return the larger of the time since receipt and the age it had then [ns]."""
        return max(now - self.time, self.old)


class Motion(NamedTuple):
    """What is known of the vehicle's velocity through the water."""

    twist: np.ndarray | None  # (6,), axes of the messages [m/s, rad/s]; None: never received
    stale: bool  # whether it is too old to be relied on
    overdue: float  # for how long it has been [ns]
    missing: str  # since when one is missing that is expected, in words, or ''
    current_ignored: str  # why a current that was received does not count, or ''


class Inputs:
    """
    Newest command, velocity and current, in the axes of the messages; times in ns of one clock.

    Every `accept` drops a message whole that is not finite or too large, and counts it by cause.
    """

    def __init__(self) -> None:
        self.wrench: Received | None = None
        self.velocity: Received | None = None
        self.current: Received | None = None
        self.voltage: Voltage | None = None
        self.smoothing = Smoothing(0.0, 0.0)  # of the velocities that come
        self.dropped: Counter[str] = Counter()  # messages by topic and cause

    def accept_wrench(self, wrench: np.ndarray, now: int, old: int = 0) -> bool:
        """
        Remember a commanded wrench, (6,) [N, N*m], and tell whether it is sound.

        :param old: its age by its stamp [ns]; one from the future is dropped.
        """
        if old < -AHEAD:
            self.dropped['cmd_wrench stamped in the future'] += 1
            return False
        sound = self._is_sound('cmd_wrench', wrench, LARGEST_WRENCH)
        if sound:
            self.wrench = Received(wrench, now, old=old)
        return sound

    def accept_velocity(self, twist: np.ndarray, now: int, topic: str, frame: str = '',
                        orientation: np.ndarray | None = None, child_frame: str = '') -> None:
        """
        Remember a velocity.

        :param twist: velocity and turn rate of the body origin in body axes, (6,) [m/s, rad/s].
        :param topic: it came on, for the count of what is dropped.
        :param frame: name of the parent frame, of an odometry.
        :param orientation: quaternion x, y, z, w that turns body axes into the parent frame's.
        :param child_frame: name that the odometry gives the body axes.
        """
        if self._is_sound(topic, twist, LARGEST_VELOCITY):
            self.velocity = Received(
                self._smoothed(twist, now), now, frame, child_frame, orientation)

    def _smoothed(self, twist: np.ndarray, now: int) -> np.ndarray:
        time_constant, longest_gap = self.smoothing
        if not time_constant or self.velocity is None:
            return twist
        gap = now - self.velocity.time
        if not 0 <= gap <= longest_gap:
            return twist
        keep = math.exp(-gap / time_constant)
        return keep * self.velocity.values + (1.0 - keep) * twist

    def accept_current(self, velocity: np.ndarray, frame: str, now: int) -> None:
        """Remember the velocity of the water in the axes of a frame, (3,) [m/s]."""
        if self._is_sound('current', velocity, LARGEST_VELOCITY):
            self.current = Received(velocity, now, frame)

    def accept_voltage(self, voltage: float, now: int, rating: Rating) -> None:
        """Remember the voltage of the supply [V]; one that no battery can have is dropped."""
        if not math.isfinite(voltage):
            self.dropped['battery not finite'] += 1
        elif not 0.0 < voltage <= HIGHEST * rating.nominal_voltage:
            self.dropped[f'battery outside 0 to {HIGHEST:g} nominal_voltage'] += 1
        else:
            before = voltage if self.voltage is None else self.voltage.at(now)
            self.voltage = Voltage(voltage, before, now)

    def supply(self, now: int, rating: Rating) -> Supply:
        """Return what the supply leaves of the thrust: all of it if not known, or not counted."""
        if not rating.nominal_voltage:
            return Supply()
        if self.voltage is None:
            return Supply(missing='yet')
        missing = ('' if now - self.voltage.time <= SILENCE else
                   'since the clock went back' if self.voltage.time == NEVER else
                   f'for {1e-9 * (now - self.voltage.time):.1f} s')
        return Supply(rating.share(self.voltage.at(now)), missing)

    def forget(self) -> None:
        """Let all that came before count as expired: the clock has gone back."""
        self.wrench = None
        for received in (self.velocity, self.current):
            if received is not None:
                received.time = NEVER
        if self.voltage is not None:
            self.voltage = self.voltage._replace(time=NEVER)

    def live_wrench(self, now: int, timeouts: Timeouts) -> np.ndarray | None:
        """Return the commanded wrench, (6,) [N, N*m], or None if none counts (any more)."""
        live = self.wrench is not None and self.wrench.age(now) <= timeouts.wrench
        return self.wrench.values if live else None

    def motion(self, now: int, timeouts: Timeouts) -> Motion:
        """Return the velocity of the last odometry, less the current where one is known."""
        overdue = (math.inf if self.velocity is None
                   else self.velocity.age(now) - timeouts.velocity)
        stale = overdue > 0
        missing = self._missing_since(now) if stale and timeouts.velocity else ''
        if self.velocity is None:
            return Motion(None, stale, overdue, missing, '')
        if self.current is None:
            return Motion(self.velocity.values, stale, overdue, missing, '')
        ignored = self._why_no_current(now, timeouts)
        return Motion(self.velocity.values if ignored else self._less_current(), stale, overdue,
                      missing, ignored)

    def _missing_since(self, now: int) -> str:
        if self.velocity is None:
            return 'yet'
        if self.velocity.time == NEVER:
            return 'since the clock went back'
        return f'for {age_in_seconds(self.velocity, now)} s'

    def _why_no_current(self, now: int, timeouts: Timeouts) -> str:
        if self.current.age(now) > timeouts.current:
            return 'none came for too long'
        if self.current.frame != self.velocity.frame:
            return (f"its frame is '{self.current.frame}', not the parent frame of the odometry, "
                    f"'{self.velocity.frame}'")
        if not abs(np.linalg.norm(self.velocity.orientation) - 1.0) <= UNIT:  # not for NaN either
            return 'the orientation in the odometry is no unit quaternion'
        return ''

    def _less_current(self) -> np.ndarray:
        through_water = self.velocity.values.copy()
        through_water[:3] -= _into_body(self.current.values, self.velocity.orientation)
        return through_water

    def _is_sound(self, topic: str, values: np.ndarray, largest: float) -> bool:
        if all(-largest <= value <= largest for value in values.tolist()):  # not so for NaN
            return True
        cause = f'beyond {largest:g}' if np.isfinite(values).all() else 'not finite'
        self.dropped[f'{topic} {cause}'] += 1
        return False


def age_in_seconds(received: Received | None, now: int) -> str:
    """Return the age of what was received last, as text [s], or 'none'."""
    return 'none' if received is None or received.time == NEVER else (
        f'{received.age(now) * 1e-9:.1f}')


def _into_body(vector: np.ndarray, orientation: np.ndarray) -> np.ndarray:
    """Turn a vector of the parent frame into body axes: q* v q, for a quaternion x, y, z, w."""
    orientation = orientation / np.linalg.norm(orientation)
    axis, w = -orientation[:3], orientation[3]
    twice = 2.0 * np.cross(axis, vector)
    return vector + w * twice + np.cross(axis, twice)
