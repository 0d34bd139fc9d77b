"""What the node was told last, how long that counts, and what was too broken to count at all."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

LARGEST_WRENCH = 1e6  # [N, N*m]; beyond it a message is taken for broken
LARGEST_VELOCITY = 50.0  # [m/s, rad/s]
AHEAD = 100_000_000  # [ns] by which a stamp may be ahead of the clock
UNIT = 1e-3  # how far from 1 the norm of a unit quaternion may be


@dataclass
class Received:
    """The newest accepted message of one topic."""

    values: np.ndarray  # as they stood in the message
    time: int  # of receipt [ns]
    frame: str = ''  # the frame id that the message gave
    orientation: np.ndarray | None = None  # quaternion x, y, z, w
    old: int = 0  # its age at receipt, by its stamp [ns]

    def age(self, now: int) -> int:
        """Return the larger of the time since receipt and the age it had then [ns]."""
        return max(now - self.time, self.old)


class Inputs:
    """
    Newest command, velocity and current, in the axes of the messages; times in ns of one clock.

    Every `accept` drops a message whole that is not finite or too large, and counts it by cause.
    """

    def __init__(self) -> None:
        self.wrench: Received | None = None
        self.velocity: Received | None = None
        self.current: Received | None = None
        self.dropped: Counter[str] = Counter()  # messages by topic and cause

    def accept_wrench(self, wrench: np.ndarray, now: int, old: int = 0) -> None:
        """
        Remember a commanded wrench, (6,) [N, N*m].

        :param old: its age by its stamp [ns]; one from the future is dropped.
        """
        if old < -AHEAD:
            self.dropped['cmd_wrench stamped in the future'] += 1
        elif self._is_sound('cmd_wrench', wrench, LARGEST_WRENCH):
            self.wrench = Received(wrench, now, old=old)

    def accept_velocity(self, twist: np.ndarray, now: int, topic: str, frame: str = '',
                        orientation: np.ndarray | None = None) -> None:
        """
        Remember a velocity.

        :param twist: velocity and turn rate of the body origin in body axes, (6,) [m/s, rad/s].
        :param topic: it came on, for the count of what is dropped.
        :param frame: name of the parent frame, of an odometry.
        :param orientation: quaternion x, y, z, w that turns body axes into the parent frame's.
        """
        if self._is_sound(topic, twist, LARGEST_VELOCITY):
            self.velocity = Received(twist, now, frame, orientation)

    def accept_current(self, velocity: np.ndarray, frame: str, now: int) -> None:
        """Remember the velocity of the water in the axes of a frame, (3,) [m/s]."""
        if self._is_sound('current', velocity, LARGEST_VELOCITY):
            self.current = Received(velocity, now, frame)

    def forget(self) -> None:
        """Let all that came before count as expired: the clock has gone back."""
        self.wrench = None
        for received in (self.velocity, self.current):
            if received is not None:
                received.time = NEVER

    def velocity_through_water(self, now: int, current_timeout: int) -> tuple[np.ndarray, str]:
        """
        Return the velocity of the last odometry, less the current where one is known.

        :param current_timeout: age at which a current counts no more [ns].
        :return: (6,) in body axes [m/s, rad/s], zero if there was no odometry, and why a current
            that was received is ignored, or ''.
        """
        if self.velocity is None:
            return np.zeros(6), ''
        twist = self.velocity.values
        if self.current is None:
            return twist, ''
        if now - self.current.time > current_timeout:
            return twist, 'none came for too long'
        if self.current.frame != self.velocity.frame:
            return twist, (f"its frame is '{self.current.frame}', not the parent frame of the "
                           f"odometry, '{self.velocity.frame}'")
        orientation = self.velocity.orientation
        if not abs(np.linalg.norm(orientation) - 1.0) <= UNIT:  # not for NaN either
            return twist, 'the orientation in the odometry is no unit quaternion'
        through_water = twist.copy()
        through_water[:3] -= _into_body(self.current.values, orientation)
        return through_water, ''

    def _is_sound(self, topic: str, values: np.ndarray, largest: float) -> bool:
        if not np.isfinite(values).all():
            self.dropped[f'{topic} not finite'] += 1
        elif np.abs(values).max() > largest:
            self.dropped[f'{topic} beyond {largest:g}'] += 1
        else:
            return True
        return False


NEVER = -2**62  # [ns], a time longer ago than any time-out


def _into_body(vector: np.ndarray, orientation: np.ndarray) -> np.ndarray:
    """Turn a vector of the parent frame into body axes: q* v q, for a quaternion x, y, z, w."""
    orientation = orientation / np.linalg.norm(orientation)
    axis, w = -orientation[:3], orientation[3]
    twice = 2.0 * np.cross(axis, vector)
    return vector + w * twice + np.cross(axis, twice)
