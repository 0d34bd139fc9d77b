"""Measurements that others have published, each file with its source and licence."""

from importlib.resources import files
from typing import NamedTuple

import numpy as np


class Oblique(NamedTuple):
    """A rotor at constant revolutions: share of its thrust at rest, (m,) rows."""

    advance_ratio: np.ndarray  # V/(n D), V the whole speed [-]
    angle: np.ndarray  # between thrust and motion [rad]
    share: np.ndarray  # [-]


class OpenWater(NamedTuple):
    """A propeller straight ahead."""

    name: str
    advance_ratio: np.ndarray  # J, from 0 [-]
    thrust: np.ndarray  # K_T [-]
    torque: np.ndarray  # K_Q [-]


def rotor_in_oblique_flow() -> Oblique:
    """Return the rotor's table, row by row of the file: by advance ratio, then by angle."""
    header, *rows = _rows('rotor_in_oblique_flow.csv')
    angles = np.radians([float(cell) for cell in header[1:]])
    table = np.array([[float(cell) for cell in row] for row in rows])
    return Oblique(np.repeat(table[:, 0], len(angles)), np.tile(angles, len(table)),
                   table[:, 1:].ravel())


def b_series() -> list[OpenWater]:
    """Return the propellers of the B-series."""
    rows = _rows('b_series.csv')
    found = []
    for thrust, torque in zip(rows[::2], rows[1::2]):
        blades, area, pitch, _, *values = thrust
        found.append(OpenWater(
            f'B{blades}-{100.0 * float(area):.0f}, P/D {pitch}', 0.05 * np.arange(len(values)),
            np.array(values, dtype=float), np.array(torque[4:], dtype=float)))
    return found


def _rows(name: str) -> list[list[str]]:
    text = files(__name__).joinpath(name).read_text('utf-8')
    return [line.split(',') for line in text.splitlines() if not line.startswith('#')]
