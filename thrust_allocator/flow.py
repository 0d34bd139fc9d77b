"""The flow that each thruster meets: how fast, and at what angle of attack."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from thrust_allocator.vehicle import Thruster


class Flow(NamedTuple):
    """The water's motion past each of p thrusters, each array (p,)."""

    speed: np.ndarray  # |v_i| [m/s]
    transverse: np.ndarray  # v_t, the part of it across the thrust axis [m/s]
    angle: np.ndarray  # theta, angle of attack in [0, pi]: 0 when moving along the thrust axis


class FlowAtThrusters:
    """The map from the vehicle's velocity through the water to the flow at its thrusters."""

    def __init__(self, thrusters: Sequence[Thruster]) -> None:
        # v_i = v + omega x r_i is linear in (v, omega); so are its components along and across d_i
        identity = np.eye(3)
        self._along = np.empty((len(thrusters), 6))  # d . v_i
        self._across = np.empty((3, len(thrusters), 6))  # v_i x d
        for i, thruster in enumerate(thrusters):
            r, d = np.array(thruster.position), np.array(thruster.direction)
            velocity = np.hstack([identity, np.cross(identity, r).T])  # (3, 6): v + omega x r
            self._along[i] = d @ velocity
            self._across[:, i] = np.cross(velocity.T, d).T

    def __call__(self, velocity: np.ndarray) -> Flow:
        """
        Return the flow at the thrusters.

        :param velocity: (6,) velocity of the body origin through the water and turn rate, frd axes
            [m/s, rad/s].
        """
        along = self._along @ velocity
        across = self._across @ velocity
        transverse = np.sqrt((across * across).sum(axis=0))
        # atan2, because arccos of the normalised product is noisy near 0 and pi
        return Flow(np.hypot(along, transverse), transverse, np.arctan2(transverse, along))
