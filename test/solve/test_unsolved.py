"""A problem whose OSQP is in trouble: the thrusts stay sound, and nothing of it lasts."""

import numpy as np
import pytest
from support.optimum import daqp_optimum
from support.vehicles import mt2012, paper_test
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.solve.active_set import ActiveSet
from thrust_allocator.solve.osqp_solver import Solver
from thrust_allocator.solve.problem import AllocationProblem
import thrust_allocator.solve.problem as problem_module

WRENCH, VELOCITY = paper_test(0.9)


class GivesUp(Solver):
    """An OSQP that gives up after several iterations, with an iterate that is no good."""

    status, iterate = 'maximum iterations reached', np.nan

    def solve(self, *vectors):
        """Give up."""
        super().solve(*vectors)
        return self.status, 7

    @property
    def optimum(self):
        """Return what must not be taken for the optimum."""
        return tuple(np.full_like(one, self.iterate) for one in super().optimum)


class FallsIll(Solver):
    """An OSQP that, once it is told to fail, does nothing else."""

    failing = False

    def __init__(self, *args, **settings):
        """Be well, whatever the trial solve of the set-up came to."""
        super().__init__(*args, **settings)
        self.ill = False

    def solve(self, *vectors):
        """Solve, or report a failure and keep to it."""
        self.ill = self.failing or getattr(self, 'ill', False)
        status, iterations = super().solve(*vectors)
        return 'problem non convex' if self.ill else status, iterations


@pytest.mark.parametrize('iterate', [np.nan, np.inf, 1e6, 0.0])
@pytest.mark.parametrize('status', ['maximum iterations reached', 'solved inaccurate', 'unsolved'])
def test_what_osqp_gave_up_on_is_not_used(monkeypatch, status, iterate):
    """After several iterations without a solution the active set's optimum stands."""
    monkeypatch.setattr(problem_module, 'Solver', GivesUp)
    monkeypatch.setattr(GivesUp, 'status', status)
    monkeypatch.setattr(GivesUp, 'iterate', iterate)
    vehicle = mt2012()
    limits = ThrustBounds(vehicle)(VELOCITY)
    allocation = AllocationProblem(vehicle).solve(WRENCH, limits)
    np.testing.assert_allclose(
        allocation.thrusts, daqp_optimum(vehicle, WRENCH, limits), atol=1e-4)
    assert allocation.at_bound.tolist() == [0, 0, 0, 0, -1]


@pytest.mark.parametrize('wanted', [np.nan, np.inf, -np.inf, [np.inf, -np.inf, 0.0, 0.0, 0.0]])
def test_a_start_that_is_not_finite(monkeypatch, wanted):
    """Whatever the active set comes to: finite, inside the limits, and adding up."""
    monkeypatch.setattr(ActiveSet, 'solve', lambda self, wrench, limits: (
        np.full(5, wanted), np.full(5, wanted), np.zeros(5, dtype=np.int8)))
    vehicle = mt2012()
    limits = ThrustBounds(vehicle)(VELOCITY)
    allocation = AllocationProblem(vehicle).solve(WRENCH, limits)
    assert (limits[0] <= allocation.thrusts).all() and (allocation.thrusts <= limits[1]).all()
    np.testing.assert_allclose(allocation.achieved + allocation.unallocated, WRENCH)


def test_an_osqp_that_has_failed_is_not_asked_again(monkeypatch):
    """The tick after a failure has a fresh OSQP, as sound as one that never failed."""
    monkeypatch.setattr(problem_module, 'Solver', FallsIll)
    vehicle = mt2012()
    limits, problem = ThrustBounds(vehicle)(VELOCITY), AllocationProblem(vehicle)
    assert problem.solve(WRENCH, limits).solved
    monkeypatch.setattr(FallsIll, 'failing', True)
    failed = problem.solve(2.0 * WRENCH, limits)
    assert failed.status == 'problem non convex' and not failed.solved
    monkeypatch.setattr(FallsIll, 'failing', False)
    assert problem.solve(WRENCH, limits).status == 'solved'


def test_without_start_and_without_osqp_there_is_no_thrust(monkeypatch):
    """Where the active set and OSQP fail at once, nothing is known: zeros, or the nearest limit."""
    monkeypatch.setattr(problem_module, 'Solver', GivesUp)
    monkeypatch.setattr(ActiveSet, 'solve', lambda self, wrench, limits: (
        np.full(5, np.nan), np.full(5, np.nan), np.zeros(5, dtype=np.int8)))
    monkeypatch.setattr(ActiveSet, 'refine', lambda self, wrench, limits, thrusts, at_bound, *_: (
        thrusts, at_bound, False))
    vehicle = mt2012()
    limits = vehicle.bollard_thrust.copy()
    limits[0, 1], limits[1, 2] = 3.0, -4.0  # as a rate limit may leave them
    allocation = AllocationProblem(vehicle).solve(WRENCH, limits)
    assert not allocation.solved
    assert allocation.thrusts.tolist() == [0.0, 3.0, -4.0, 0.0, 0.0]
