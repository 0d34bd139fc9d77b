"""The compiled OSQP that is called directly gives what OSQP's documented interface gives."""

import numpy as np
import osqp
import pytest
from thrust_allocator.solve.osqp_solver import Solver
import thrust_allocator.solve.osqp_solver

SETTINGS = {'verbose': False, 'scaling': 0, 'polishing': False, 'eps_abs': 1e-7, 'eps_rel': 1e-14,
            'max_iter': 4000, 'check_termination': 1, 'check_dualgap': False, 'adaptive_rho': 1}
MATRIX = np.linalg.inv(np.triu(np.random.default_rng(0).normal(size=(5, 5))) + 3.0 * np.eye(5))


def answers(solver: Solver) -> list[tuple]:
    """Return status, iterations and optimum of 200 problems in a row."""
    rng, found = np.random.default_rng(1), []
    for _ in range(200):
        lower, upper = np.sort(rng.normal(size=(2, 5)), axis=0)
        verdict = solver.solve(rng.normal(size=5) * 3.0, lower, upper, *rng.normal(size=(2, 5)))
        found.append((*verdict, *(array.tobytes() for array in solver.optimum)))
    return found


def test_compiled_object_gives_the_bits_of_the_interface():
    """Status, iterations, optimum and multipliers agree to the last bit, problem by problem."""
    direct, documented = Solver(MATRIX, **SETTINGS), Solver(MATRIX, direct=False, **SETTINGS)
    assert direct.is_direct and not documented.is_direct
    assert answers(direct) == answers(documented)


class LacksOneThing:
    """The compiled object of a version of OSQP that has changed."""

    def __init__(self, compiled: object, missing: str) -> None:
        self._compiled, self._missing = compiled, missing

    def __getattr__(self, name: str) -> object:
        if name == self._missing:
            raise AttributeError(name)
        return getattr(self._compiled, name)


@pytest.mark.parametrize('missing', [
    'update_data_vec', 'warm_start', 'solve', 'info', 'solution'])
def test_another_osqp_is_used_through_its_interface(monkeypatch, missing):
    """Where the compiled object lacks what is expected of it, the interface serves."""
    monkeypatch.setattr(osqp.OSQP, 'compiled', property(
        lambda self: LacksOneThing(self._solver, missing)), raising=False)
    monkeypatch.setattr(thrust_allocator.solve.osqp_solver, 'COMPILED', 'compiled')
    solver = Solver(MATRIX, **SETTINGS)
    assert not solver.is_direct
    assert answers(solver) == answers(Solver(MATRIX, direct=False, **SETTINGS))


def test_osqp_without_the_compiled_object_is_used_through_its_interface(monkeypatch):
    """Where OSQP keeps no such object, the interface serves."""
    monkeypatch.setattr(thrust_allocator.solve.osqp_solver, 'COMPILED', 'elsewhere')
    assert not Solver(MATRIX, **SETTINGS).is_direct
