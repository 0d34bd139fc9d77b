"""How far thrusters and fins get from one tick to the next."""

from collections.abc import Sequence

import numpy as np
from thrust_allocator.physics.flow import Flow
from thrust_allocator.physics.vehicle import Thruster


class RateLimits:
    """
    The part of the limits that is within a step of where each thruster stands.

    A thruster stands at its thrust [N]; a fin at its deflection [rad], for that is what its servo
    keeps while the flow, and the lift with it, changes.
    """

    def __init__(self, thrusters: Sequence[Thruster]) -> None:
        """Remember how fast each is."""
        self._max_rates = np.array([thruster.max_rate for thruster in thrusters])
        self._unlimited = self._max_rates == 0.0
        self._none = bool(self._unlimited.all())
        self._fins = [(i, one.model) for i, one in enumerate(thrusters) if one.model.DEFLECTS]

    def __call__(self, limits: np.ndarray, stand: np.ndarray, flow: Flow,
                 seconds: float) -> np.ndarray:
        """
        Return the limits within reach.

        :param limits: (2, p), row 0 lower, row 1 upper [N].
        :param stand: where each thruster stands, (p,) [N; of a fin: rad].
        :param flow: how each thruster moves through the water now.
        :param seconds: since they came to stand there [s].
        :return: (2, p) [N].
        """
        if self._none:
            return limits
        step = np.where(self._unlimited, np.inf, self._max_rates * seconds)  # [N; of a fin: rad]
        if self._fins:
            stand = stand.copy()
            for i, model in self._fins:
                slope = model.thrust_per_radian(*flow[i])
                stand[i] *= slope
                step[i] = step[i] * abs(slope) if slope else 0.0  # inf * 0 is NaN
        return rate_limited(limits, stand, step)

    def stand(self, thrusts: np.ndarray, flow: Flow) -> np.ndarray:
        """Return where each thruster stands that gives thrusts (p,), (p,) [N; of a fin: rad]."""
        if not self._fins:
            return thrusts
        stand = thrusts.copy()
        for i, model in self._fins:
            stand[i] = model.deflection(float(thrusts[i]), *flow[i])
        return stand


def rate_limited(limits: np.ndarray, last: np.ndarray, step: np.ndarray) -> np.ndarray:
    """
    Return the part of the limits that is within a step of the last setpoints.

    Where none is, because the limits have moved away faster, the nearest limit: the speed bound
    wins over the rate.

    :param limits: (2, p), row 0 lower, row 1 upper [N].
    :param last: (p,) last setpoints [N].
    :param step: (p,) greatest change, infinite where there is no rate limit [N].
    :return: (2, p) [N].
    """
    lower, upper = limits
    return np.array((np.minimum(np.maximum(lower, last - step), upper),
                     np.maximum(np.minimum(upper, last + step), lower)))
