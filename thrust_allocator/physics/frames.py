"""The two conventions for body axes, and the order of the six degrees of freedom."""

import numpy as np

DOFS = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')

# frd: x forward, y starboard, z down (the paper's axes, and the ones used throughout this
# package). flu: x forward, y left, z up (REP 103).
FRAMES = ('frd', 'flu')


def frd_signs(frame: str) -> np.ndarray:
    """
    Return the signs that turn a wrench or twist of `frame` into frd axes, and back.

    The two frames differ by half a turn about x, so forces, moments, velocities and turn rates all
    keep their first component and change the sign of the other two.

    :param frame: 'frd' or 'flu'.
    :return: (6,) array of +1 and -1, its own inverse; its first half serves positions.
    """
    side = {'frd': 1.0, 'flu': -1.0}[frame]
    return np.array([1.0, side, side, 1.0, side, side])
