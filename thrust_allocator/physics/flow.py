"""The flow that each thruster meets: its speed along the thrust axis and two axes across it."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.physics.vehicle import Thruster

# Of each thruster: speed along its thrust axis and along two axes across it [m/s]
Flow = list[tuple[float, float, float]]


class FlowAtThrusters:
    """
    The map from the vehicle's velocity through the water to the motion of each thruster.

    Thruster i moves at v_i = v + omega x r_i. That is linear in (v, omega), and so are its
    components along d_i and two axes across it, a fin's chord first: one matrix product gives them
    all.
    """

    def __init__(self, thrusters: Sequence[Thruster]) -> None:
        self._components = np.vstack([_components(thruster) for thruster in thrusters])

    def __call__(self, velocity: np.ndarray) -> Flow:
        """
        Return how each thruster moves through the water.

        The angle of attack is atan2(hypot(one, other), along).

        :param velocity: (6,) velocity of the body origin through the water and turn rate, frd axes
            [m/s, rad/s].
        :return: for each thruster its speed along its thrust axis and along two axes across it
            [m/s].
        """
        flat = self._components.dot(velocity).tolist()
        return list(zip(flat[0::3], flat[1::3], flat[2::3]))


def _components(thruster: Thruster) -> np.ndarray:
    """Return the (3, 6) map from (v, omega) to v_i along d_i and along two axes across it."""
    identity = np.eye(3)
    velocity = np.hstack([identity, np.cross(identity, thruster.position).T])  # v + omega x r_i
    return np.vstack([thruster.direction, axes_across(thruster)]) @ velocity


def axes_across(thruster: Thruster) -> np.ndarray:
    """Return two unit vectors across the thrust axis, (2, 3); the first is the chord, if any."""
    chord = thruster.model.chord
    if chord is None:
        return np.linalg.svd(np.array([thruster.direction]))[2][1:]  # the first is +d or -d
    return np.array([chord, np.cross(thruster.direction, chord)])
