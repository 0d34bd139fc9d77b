"""The wrenches that thrusters could give if only their senses mattered, and not their limits."""

import numpy as np


class Cone:
    """
    The cone {S B_D tau: tau of the senses that the thrusters have} of a one-sided vehicle.

    Along a wrench outside of it not even a small share is attainable.
    """

    def __init__(self, matrix: np.ndarray, wrench_weights: np.ndarray,
                 limits: np.ndarray) -> None:
        """
        Remember which way each thruster pushes.

        :param matrix: B, (6, p).
        :param wrench_weights: R, (6,), the metric; a DOF of weight 0 is not in D.
        :param limits: (2, p) at rest, row 0 lower, row 1 upper, both 0 for one that is off [N].
        """
        self._dofs = np.flatnonzero(wrench_weights)
        self._root = np.sqrt(np.asarray(wrench_weights, dtype=float)[self._dofs])
        reverse, forward = limits[0] < 0.0, limits[1] > 0.0
        scaled = self._root[:, np.newaxis] * matrix[self._dofs]
        self._edges = np.hstack([scaled[:, forward], -scaled[:, reverse]])
        self.one_sided = bool((reverse != forward).any())

    def nearest(self, wrench: np.ndarray) -> np.ndarray | None:
        """
        Return the point of the cone that is nearest to a wrench, in the metric of the weights.

        :param wrench: f, (6,) [N, N*m].
        :return: (6,), outside D as it was; None if SciPy finds none.
        """
        from scipy.optimize import nnls  # takes longer to import than most vehicles' whole start

        try:
            shares, _ = nnls(self._edges, self._root * wrench[self._dofs])
        except RuntimeError:  # too many iterations
            return None
        nearest = wrench.copy()
        nearest[self._dofs] = self._edges @ shares / self._root
        return nearest
