"""OSQP in trouble on the running node: the setpoints stay sound, and the pilot is told."""

import numpy as np
from numpy.testing import assert_allclose
import pytest
from support.stepped_peer import assert_optimal, inside_limits, rest_of, SteppedPeer
from thrust_allocator.solve.osqp_solver import Solver
import thrust_allocator.solve.problem as allocation_module

WRENCH = [120.0, 0.0, 10.0, 0.0, 25.0, -15.0]  # frd axes
OTHER = [-60.0, 0.0, 5.0, 0.0, -10.0, 20.0]
TWIST = [0.3, 0.1, -0.1, 0.02, 0.05, -0.02]


class Troubled(Solver):
    """OSQP, which reports something else as long as `trouble` is set."""

    trouble = ''

    def solve(self, *vectors):
        """Solve, and lie about the status."""
        status, iterations = super().solve(*vectors)
        return self.trouble or status, iterations


@pytest.fixture
def troubled(monkeypatch):
    """Put Troubled in OSQP's place, and return it."""
    monkeypatch.setattr(allocation_module, 'Solver', Troubled)
    monkeypatch.setattr(Troubled, 'trouble', '')
    return Troubled


def assert_in_trouble(peer: SteppedPeer, status):
    """Check that ticks are sound all the same, and that the diagnostics tell OSQP's word."""
    for wrench in (OTHER, WRENCH):
        tick = peer.step(wrench)
        assert inside_limits(tick) and rest_of(wrench, tick) < 1e-9
    level, message, figures = peer.report()
    assert level == 'ERROR' and f'OSQP reports {status}' in message
    assert figures['solver status'] == status
    return tick


@pytest.mark.parametrize('status', [
    'primal infeasible', 'dual infeasible', 'run time limit reached', 'problem non convex',
    'unsolved'])
def test_osqp_does_not_report_solved(stepped, troubled, status):
    """Whatever OSQP says: finite, inside the limits, near the optimum, ERROR; then as before."""
    peer = stepped()
    before = peer.steps(3, WRENCH, TWIST)[-1]
    troubled.trouble = status
    assert_optimal(peer.node.vehicle, assert_in_trouble(peer, status), WRENCH)
    troubled.trouble = ''
    assert_allclose(peer.step()['thruster_setpoints'], before['thruster_setpoints'], atol=1e-9)
    assert 'OSQP' not in peer.report_later()[1]
    peer.steps(500)
    peer.report()
    peer.wait_until(lambda: peer.logged('no longer: OSQP'), 'word of the end of it')
    assert [line.split(':')[0] for line in peer.logged('OSQP')] == ['ERROR', 'INFO']


@pytest.mark.parametrize('status', ['maximum iterations reached', 'solved inaccurate'])
def test_osqp_is_not_sure(stepped, troubled, status):
    """Where rounding keeps OSQP from a verdict, the conditions of an optimum give one: OK."""
    peer = stepped()
    troubled.trouble = status
    assert_optimal(peer.node.vehicle, peer.steps(3, WRENCH, TWIST)[-1], WRENCH)
    assert peer.report()[:2] == ('OK', 'allocating')


def test_osqp_meets_its_limit_of_iterations(stepped, monkeypatch):
    """With a tolerance that cannot be met OSQP gives up; the thrusts are the optimum still."""
    monkeypatch.setattr(allocation_module, 'MAX_ITERATIONS', 1)
    monkeypatch.setattr(allocation_module, 'TOLERANCE', 1e-300)
    monkeypatch.setattr(allocation_module, 'ROUNDING', 0.0)
    peer = stepped()
    peer.step(WRENCH, TWIST)
    assert_optimal(peer.node.vehicle, assert_in_trouble(peer, 'maximum iterations reached'), WRENCH)


@pytest.mark.parametrize('broken', [np.nan, np.inf, -np.inf])
def test_the_start_of_osqp_is_broken(stepped, monkeypatch, broken):
    """A start that is not finite spoils at most OSQP's word, for as long as it lasts."""
    peer = stepped()
    before = peer.steps(3, WRENCH, TWIST)[-1]
    with monkeypatch.context() as patch:
        patch.setattr(allocation_module.ActiveSet, 'solve', lambda self, wrench, limits: (
            np.full(5, broken), np.full(5, broken), np.zeros(5, dtype=np.int8)))
        for wrench in (OTHER, WRENCH):
            tick = peer.step(wrench)
            assert inside_limits(tick) and rest_of(wrench, tick) < 1e-9
    assert_allclose(peer.step()['thruster_setpoints'], before['thruster_setpoints'], atol=1e-9)
    assert 'OSQP' not in peer.report_later()[1]


def test_switching_thrusters_keeps_the_solver(stepped, monkeypatch):
    """Taking a thruster out and back sets nothing up anew and costs OSQP no iteration."""
    setups = []

    class Counted(Solver):
        def __init__(self, *args, **settings):
            setups.append(args)
            super().__init__(*args, **settings)

    monkeypatch.setattr(allocation_module, 'Solver', Counted)
    peer = stepped()
    peer.steps(3, WRENCH, TWIST)
    known = len(setups)
    for on in (False, True):
        peer.switch(up=on)
        peer.steps(3)
    assert len(setups) == known > 0
    assert peer.report()[2]['iterations, worst'] == '1'
