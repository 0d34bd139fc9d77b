"""What a file of any kind says of a vehicle: where its thrusters sit and which way they push."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from thrust_allocator.physics.frames import frd_signs

SNAP = 0.01  # how far from 1 the norm of a direction may be: 0.707 is meant as the root of 1/2
LARGEST_TORQUE_RATIO = 0.1  # [m]; the torque of a propeller is some 0.1 diameters times its thrust
_NOISE = 1e-9  # [m], below which a torque ratio is rounding


class SourceError(ValueError):
    """A file that cannot be imported; the message is one line and says what to do."""

    def __init__(self, message: str) -> None:
        """Keep the message, on one line even if what it quotes is not."""
        super().__init__(' '.join(message.split()))


@dataclass(frozen=True)
class Mount:
    """One thruster of a source; vectors are in the source's axes, from its own origin."""

    name: str  # as the source spells it
    position: tuple[float, ...]  # [m]
    direction: tuple[float, ...]  # unit vector along which positive thrust pushes the vehicle
    torque_ratio: float = 0.0  # reaction torque about direction per newton of thrust [m]
    limits: tuple[float | None, float | None] = (None, None)  # reverse, forward; None: not said [N]
    notes: tuple[str, ...] = ()  # what the reader of the parameter file should know

    @property
    def column(self) -> np.ndarray:
        """Return the wrench of 1 N of thrust: (6,), [d; r x d + k d] (physics of eq. 2.6)."""
        d = np.array(self.direction)
        return np.concatenate([d, np.cross(self.position, d) + self.torque_ratio * d])


@dataclass(frozen=True)
class Configuration:
    """One vehicle as a source describes it."""

    source: str  # path
    kind: str  # of source, in words
    frame: str  # axes of all vectors: flu or frd
    mounts: tuple[Mount, ...]
    origin: str  # which point the positions are measured from, in words
    water_density: float | None = None  # [kg/m^3]

    def from_origin(self, origin: Sequence[float], what: str = '') -> 'Configuration':
        """Return it with all positions measured from another point, in the source's axes [m]."""
        return replace(
            self, origin=f'{what}({", ".join(f"{x:g}" for x in origin)}) m from {self.origin}',
            mounts=tuple(replace(one, position=tuple(np.subtract(one.position, origin).tolist()))
                         for one in self.mounts))

    @property
    def matrix(self) -> np.ndarray:
        """Return the configuration matrix (6, p), rows surge to yaw, in frd axes [-, m]."""
        return (frd_signs(self.frame)
                * np.array([one.column for one in self.mounts]).reshape(-1, 6)).T


def unit(vector: Sequence[float], of: str) -> np.ndarray:
    """Return a direction with a norm of exactly 1; refuse one that is off by 1 % or more."""
    norm = float(np.linalg.norm(vector))
    if not abs(norm - 1.0) < SNAP:
        raise SourceError(f'{of}: has a direction of norm {norm:.4g}, must be 1 within 1 %: only '
                          'then is its thrust in newtons')
    return np.asarray(vector, dtype=float) / norm


def mount_of_column(name: str, column: np.ndarray, **details) -> Mount:
    """
    Return the thruster that a column (6,) of an allocation matrix stands for.

    Of all points on the line of thrust it takes the one nearest to the origin, r = d x m; what
    moment is left along the axis is the reaction torque of the propeller.
    """
    force, moment = column[:3], column[3:]
    if not np.any(np.abs(force) > 1e-9):
        raise SourceError(f'{name}: its column is '
                          + ('a pure moment, which no thruster gives' if np.any(moment) else
                             'all 0: it pushes nothing'))
    d = unit(force, name)
    moment = moment / float(np.linalg.norm(force))
    k = float(d @ moment)
    if abs(k) > LARGEST_TORQUE_RATIO:
        raise SourceError(f'{name}: its column has a moment of {k:.4g} N*m per newton along its '
                          f'own axis, must be within {LARGEST_TORQUE_RATIO} m, what a propeller '
                          'has: are rows swapped, or signs wrong?')
    return Mount(name, tuple(np.cross(d, moment).tolist()), tuple(d.tolist()),
                 k if abs(k) > _NOISE else 0.0, **details)
