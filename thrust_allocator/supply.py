"""The voltage that the thrusters are supplied with, and what it leaves of their thrust."""

from dataclasses import dataclass
import math
from typing import NamedTuple

TIME_CONSTANT = 2.0e9  # of the filter on the voltage [ns]
SILENCE = 10 * 10**9  # after which the last voltage stands, but not without a word [ns]
HIGHEST = 2.0  # nominal voltages; beyond it a message is taken for broken


class Supply(NamedTuple):
    """What is known of the supply."""

    share: float = 1.0  # of the thrust at rest that it leaves, (V / V_0)^n [-]
    missing: str = ''  # since when no voltage is known, in words, or ''


@dataclass(frozen=True)
class Rating:
    """
    What the Bollard limits were measured at, and how they change with the voltage.

    Thrust at full throttle goes with (V / V_0)^n; 1.2 fits a T200 from 10 to 20 V (Blue Robotics,
    T200 Public Performance Data).
    """

    nominal_voltage: float = 0.0  # V_0; 0: the battery is not considered [V]
    voltage_exponent: float = 1.2  # n [-]

    def share(self, voltage: float) -> float:
        """Return what a voltage [V] leaves of the thrust at rest, where one is nominal [-]."""
        return (voltage / self.nominal_voltage)**self.voltage_exponent


class Voltage(NamedTuple):
    """
    A voltage through a first-order filter.

    It is known at every time, not only when a message comes, lest limits go in steps; and slow
    enough that thrusters which pull the voltage down do not swing with it.
    """

    newest: float  # as received [V]
    smoothed: float  # as it was when that came [V]
    time: int  # of that [ns]

    def at(self, now: int) -> float:
        """Return the smoothed voltage [V]."""
        keep = math.exp(-max(now - self.time, 0) / TIME_CONSTANT)
        return self.newest + keep * (self.smoothed - self.newest)
