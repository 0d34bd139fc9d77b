"""Authority: the largest and the smallest wrench within reach."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import block_diag
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.attainable import AttainableSet, TooManyFaces
from thrust_allocator.study.errors import StudyError

HELD = {'heavier': 'DOFs of equal or larger weight hold', 'all': 'all controlled DOFs hold'}
# The smallest HiGHS takes; of thrusts relative to the largest Bollard thrust, and of rows of norm 1
TOLERANCE = 1e-10
OPTIMAL, INFEASIBLE = 0, 2  # of SciPy's linprog


class _Reach(NamedTuple):
    """One DOF, to be pushed both ways while some others hold the cruise wrench."""

    dof: int
    held: tuple[int, ...]


class Authority:
    """
    The range of every controlled DOF while others hold the cruise wrench.

    maximise and minimise  B_d tau  subject to  B_H tau = f_H,  tau_min <= tau <= tau_max

    where H are the controlled DOFs other than d: all of them, or those whose weight in R is not
    smaller than d's, the allocator's own priorities. Where the thrusters act on d and H
    independently, the faces of the attainable set over them answer that, in a hundredth of the
    time that SciPy's HiGHS takes. It solves the rest; all these programmes of a tick are handed
    over as one, in blocks, for most of a call's time is spent on the way in.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        """Set up the programmes of a vehicle."""
        self._matrix = vehicle.configuration_matrix
        self._largest = np.abs(vehicle.reference_limits).max()
        norms = np.linalg.norm(self._matrix, axis=1)
        self._norms = np.where(norms > 0.0, norms, 1.0)
        weights = vehicle.wrench_weights
        controlled = [i for i in range(6) if weights[i] > 0.0]
        self._wanted = []  # for each kind of holding, the programme of each controlled DOF
        for heavier in (True, False):
            self._wanted.append([_Reach(dof, tuple(
                i for i in controlled
                if i != dof and (not heavier or weights[i] >= weights[dof])))
                for dof in controlled])
        self._different = list(dict.fromkeys(sum(self._wanted, [])))
        enabled = np.array([float(thruster.enabled) for thruster in vehicle.thrusters])
        sets = {reach: self._attainable(reach, enabled) for reach in self._different}
        self._sets = {reach: one for reach, one in sets.items() if one is not None}
        rows = self._matrix / self._norms[:, np.newaxis]
        rest = [reach for reach in self._different if reach not in self._sets]
        self._together = _Programme(rows, rest) if rest else None
        self._alone = {reach: _Programme(rows, [reach]) for reach in rest}

    def _attainable(self, reach: _Reach, enabled: np.ndarray) -> AttainableSet | None:
        """Return the set over a DOF and those held; None if it is flat or has too many faces."""
        dofs = [reach.dof, *reach.held]
        weights = np.zeros(6)
        weights[dofs] = self._norms[dofs]**-2
        try:
            found = AttainableSet(self._matrix, weights, enabled)
        except TooManyFaces:
            return None
        return found if found.rank == len(dofs) else None

    def __call__(self, limits: np.ndarray, cruise: np.ndarray) -> np.ndarray:
        """
        Return the ranges.

        :param limits: (2, p), row 0 lower, row 1 upper [N].
        :param cruise: (6,) wrench to be held, frd axes [N, N*m].
        :return: (2, 6, 2): for each of HELD and each DOF the smallest and the largest component of
            the wrench, frd axes [N, N*m]; NaN where the cruise wrench cannot be held, and for DOFs
            that are not controlled.
        """
        found = {reach: cruise[reach.dof] + one.room(cruise, np.eye(6)[[reach.dof]], limits)[0]
                 for reach, one in self._sets.items()}
        found |= self._by_programmes(limits, cruise)
        ranges = np.full((2, 6, 2), np.nan)
        for kind, wanted in enumerate(self._wanted):
            for reach in wanted:
                if reach in found:
                    ranges[kind, reach.dof] = found[reach]
        return ranges

    def _by_programmes(self, limits: np.ndarray, cruise: np.ndarray) -> dict[_Reach, np.ndarray]:
        """Return the ranges (2,) that no attainable set tells, where there are any."""
        if self._together is None:
            return {}
        scaled_limits = limits / self._largest
        scaled_cruise = cruise / (self._norms * self._largest)
        found = self._together.solve(scaled_limits, scaled_cruise)
        if found is None:  # at least one of them has no solution
            found = {}
            for reach, programme in self._alone.items():
                found |= programme.solve(scaled_limits, scaled_cruise) or {}
        return {reach: self._matrix[reach.dof] @ (thrusts * self._largest).T
                for reach, thrusts in found.items()}


class _Programme:
    """The programmes of some DOFs, both ways, as blocks of a single one; rows of B of norm 1."""

    def __init__(self, rows: np.ndarray, reaches: Sequence[_Reach]) -> None:
        self._reaches = reaches
        self._blocks = 2 * len(reaches)
        # Each block keeps an (empty) row at least, for one of a DOF that is alone has none
        held = [rows[list(reach.held)] if reach.held else np.zeros((1, rows.shape[1]))
                for reach in reaches for _ in range(2)]
        self._matrix = block_diag(held, format='csc')
        self._costs = np.concatenate([sign * rows[reach.dof] for reach in reaches
                                      for sign in (1.0, -1.0)])

    def solve(self, limits: np.ndarray, cruise: np.ndarray) -> dict[_Reach, np.ndarray] | None:
        """Return the thrusts (2, p) of the smallest and the largest wrench, None if infeasible."""
        held = np.concatenate([cruise[list(reach.held)] if reach.held else np.zeros(1)
                               for reach in self._reaches for _ in range(2)])
        for presolve in (True, False):  # the other way, should the first meet difficulties
            result = linprog(
                self._costs, A_eq=self._matrix, b_eq=held,
                bounds=np.tile(limits.T, (self._blocks, 1)), method='highs-ds',
                options={'presolve': presolve, 'primal_feasibility_tolerance': TOLERANCE,
                         'dual_feasibility_tolerance': TOLERANCE})
            if result.status == OPTIMAL:
                thrusts = np.clip(result.x.reshape(len(self._reaches), 2, -1), *limits)
                return dict(zip(self._reaches, thrusts))
            if result.status == INFEASIBLE:
                return None
        raise StudyError(f'authority: HiGHS gave up: {result.message}')
