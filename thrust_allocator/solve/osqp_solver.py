"""OSQP for one tick after another: set up once, then new vectors, a start, and a verdict."""

from typing import Any

import numpy as np
import osqp
import scipy.sparse


COMPILED = '_solver'  # where osqp.OSQP keeps the compiled object
UNDECIDED = ('maximum iterations reached', 'solved inaccurate')  # OSQP's words for running out


class Solver:
    """
    OSQP on min 1/2 w^T w + q^T w subject to lower <= A w <= upper, where q and the bounds change.

    OSQP's Python interface spends three times as long on checking and on building its result as
    OSQP itself on a solve that starts from the optimum. The compiled object behind it is therefore
    called directly, if it has the methods it had in OSQP 1.1; otherwise the interface is.
    """

    def __init__(self, matrix: np.ndarray, direct: bool = True, **settings: Any) -> None:
        """
        Set up the problem.

        :param matrix: A, (n, n).
        :param direct: whether to call the compiled object, if it is as expected.
        :param settings: OSQP's settings.
        """
        n = len(matrix)
        self._osqp = osqp.OSQP()
        self._osqp.setup(
            scipy.sparse.identity(n, format='csc'), np.zeros(n),
            scipy.sparse.csc_matrix(matrix), np.zeros(n), np.zeros(n), **settings)
        self._compiled = getattr(self._osqp, COMPILED, None) if direct else None
        self._result: Any = None
        if self._compiled is not None:
            try:
                self.solve(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n))
                _ = self.optimum
            except (AttributeError, TypeError):  # another version of OSQP
                self._compiled = None

    @property
    def is_direct(self) -> bool:
        """Tell whether the compiled object is called, and not OSQP's Python interface."""
        return self._compiled is not None

    def solve(self, gradient: np.ndarray, lower: np.ndarray, upper: np.ndarray,
              start: np.ndarray, multipliers: np.ndarray) -> tuple[str, int]:
        """
        Solve for new vectors, all (n,), from a primal and dual start.

        :return: OSQP's status, and its iterations.
        """
        if self._compiled is None:
            self._osqp.update(q=gradient, l=lower, u=upper)
            self._osqp.warm_start(x=start, y=multipliers)
            self._result = self._osqp.solve(raise_error=False)
        else:
            self._compiled.update_data_vec(q=gradient, l=lower, u=upper)
            self._compiled.warm_start(start, multipliers)
            self._compiled.solve()
            self._result = self._compiled
        info = self._result.info
        return info.status, info.iter

    @property
    def optimum(self) -> tuple[np.ndarray, np.ndarray]:
        """Return OSQP's own w and the multipliers of the bounds, both (n,), of the last solve."""
        if self._compiled is None:
            return self._result.x, self._result.y
        solution = self._compiled.solution
        return np.array(solution.x), np.array(solution.y)
