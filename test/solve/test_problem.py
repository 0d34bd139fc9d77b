"""The allocation problem: known answers, a second solver, and the conditions of an optimum."""

from dataclasses import replace
import gc
import weakref

import numpy as np
import pytest
from support.optimum import daqp_optimum
from support.vehicles import HEAVE, mt2012, PAPER_TEST, paper_test, PITCH, random_vehicle, thruster
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.active_set import ActiveSet
from thrust_allocator.solve.problem import AllocationProblem
import thrust_allocator.solve.problem as allocation_module


def random_ticks(seed: int, vehicles: int, ticks: int):
    """Yield (problem, vehicle, wrench, limits): random motion, up to five times the reachable."""
    rng = np.random.default_rng(seed)
    for _ in range(vehicles):
        vehicle = random_vehicle(rng, fins=0.3)
        problem, bounds = AllocationProblem(vehicle), ThrustBounds(vehicle)
        reverse, forward = vehicle.reference_limits
        for _ in range(ticks):
            limits = bounds(rng.normal(size=6) * rng.choice([0.0, 0.3, 1.5]))
            limits[:, rng.random(limits.shape[1]) < 0.1] = 0.0
            reachable = vehicle.configuration_matrix @ rng.uniform(reverse, forward)
            yield problem, vehicle, reachable * rng.uniform(0.0, 5.0), limits


@pytest.mark.parametrize('row', PAPER_TEST, ids=lambda row: f'{row[0]} m/s')
def test_paper_test_gives_the_tables_thrusts(row):
    """MT-2012 answers the paper's test with the exact optimum of the table."""
    speed, thrusts, _, _, pitch, heave = row
    vehicle = mt2012()
    wrench, velocity = paper_test(speed)
    allocation = AllocationProblem(vehicle).solve(wrench, ThrustBounds(vehicle)(velocity))
    assert allocation.solved
    assert allocation.thrusts == pytest.approx(thrusts, abs=0.006)
    assert allocation.achieved[[PITCH, HEAVE]] == pytest.approx((pitch, heave), abs=0.006)
    assert allocation.achieved + allocation.unallocated == pytest.approx(wrench)
    assert (allocation.reach, allocation.direction_scale, allocation.power_scale) == (1.0,) * 3


def test_bollard_bounds_leave_the_tunnel_its_share():
    """With bounds held at Bollard the tunnel gets 19.92 N at every speed: the paper's contrast."""
    vehicle = mt2012()
    problem = AllocationProblem(vehicle)
    for speed, *_ in PAPER_TEST:
        allocation = problem.solve(paper_test(speed)[0], vehicle.bollard_thrust)
        assert allocation.thrusts[4] == pytest.approx(-19.92, abs=0.006)


def test_large_weights_approach_the_exact_wrench():
    """For R to infinity the thrusts at rest are those of the minimum norm that gives f exactly."""
    vehicle = replace(mt2012(), wrench_weights=(1e7, 0.0, 1e7, 0.0, 1e7, 1e7))
    allocation = AllocationProblem(vehicle).solve(paper_test(0.0)[0], vehicle.bollard_thrust)
    assert allocation.thrusts == pytest.approx((-25.875, 0, 25.875, 0, -19.804), abs=0.001)


def planar_vehicle(columns) -> Vehicle:
    """Return a vehicle whose B over surge, sway and yaw has these columns, R = 1e6, Q = 1."""
    def one(i, surge, sway, yaw):
        direction = (surge, sway, 0.0) if surge or sway else (0.0, 0.0, 1.0)
        return thruster(f't{i}', (yaw * sway, -yaw * surge, 0.0), direction,
                        Constant((-1e4, 1e4)))
    return Vehicle(tuple(one(i, *column) for i, column in enumerate(columns)),
                   (1e6, 1e6, 0.0, 0.0, 0.0, 1e6))


FOUR_FIXED = ((1, 0, -5), (0, 1, -20), (1, 0, 5), (0, 1, -20))
ONE_LOCKED = ((1, 0, 0), (0, 1, -20), (0, 0, 0), (0, 1, 20))


@pytest.mark.parametrize('columns, largest, command, expected', [
    (FOUR_FIXED, (1e4, 1e4, 1e4, 1e4), (0, 500, 8000), (-1800, 250, 1800, 250)),
    (FOUR_FIXED, (1e4, 1e4, 1e4, 1e4), (25000, 0, 0), (1e4, 0, 1e4, 0)),
    (ONE_LOCKED, (1e4, 1e4, 0, 1e3), (0, 500, 8000), (0, 50, 0, 450)),
    (ONE_LOCKED, (1e4, 1e4, 0, 1e3), (0, 2002, 0), (0, 1000, 0, 1000)),
])
def test_answers_of_another_allocation_library(columns, largest, command, expected):
    """Four answers from the tests of an independent thrust allocation library hold."""
    wrench = np.array([command[0], command[1], 0.0, 0.0, 0.0, command[2]], dtype=float)
    limits = np.array([-1.0, 1.0])[:, np.newaxis] * np.array(largest)
    allocation = AllocationProblem(planar_vehicle(columns)).solve(wrench, limits)
    assert allocation.thrusts == pytest.approx(expected, abs=0.1)


def test_equals_a_second_solver_on_random_vehicles():
    """2,000 random ticks: inside the bounds exactly, daqp's optimum, solved in one iteration."""
    worst = 0.0
    for problem, vehicle, wrench, limits in random_ticks(seed=1, vehicles=400, ticks=5):
        allocation = problem.solve(wrench, limits)
        assert allocation.solved and allocation.iterations == 1
        assert (limits[0] <= allocation.thrusts).all() and (allocation.thrusts <= limits[1]).all()
        error = np.abs(allocation.thrusts - daqp_optimum(vehicle, wrench, limits)).max()
        worst = max(worst, error / np.abs(vehicle.reference_limits).max())
    assert worst <= 1e-6


def test_satisfies_the_conditions_of_an_optimum():
    """The cost falls with no thruster's motion that its bounds allow (Karush, Kuhn, Tucker)."""
    for problem, vehicle, wrench, limits in random_ticks(seed=2, vehicles=60, ticks=3):
        allocation = problem.solve(wrench, limits)
        weights = np.array([one.weight for one in vehicle.thrusters])
        wrench_weights = np.array(vehicle.wrench_weights)
        columns = vehicle.configuration_matrix
        gradient = weights * allocation.thrusts - columns.T @ (
            wrench_weights * allocation.unallocated)
        rounding = 1e-9 * np.abs(columns.T @ (wrench_weights * wrench)).max() + 1e-3
        assert (gradient[allocation.thrusts < limits[1]] >= -rounding).all()
        assert (gradient[allocation.thrusts > limits[0]] <= rounding).all()


def test_reports_which_thrusters_are_at_which_bound():
    """A thruster that the optimum presses against a limit is reported there, and lies on it."""
    vehicle = mt2012()
    wrench, velocity = paper_test(1.8)
    allocation = AllocationProblem(vehicle).solve(wrench, ThrustBounds(vehicle)(velocity))
    assert allocation.at_bound.tolist() == [0, 0, 1, 0, -1]
    assert allocation.thrusts[2] == allocation.limits[1, 2]
    assert allocation.thrusts[4] == allocation.limits[0, 4]


def test_same_sequence_gives_the_same_bits():
    """Two problems fed the same ticks from the start agree to the last bit."""
    first, second = (
        [problem.solve(wrench, limits).thrusts.tobytes()
         for problem, _, wrench, limits in random_ticks(seed=3, vehicles=10, ticks=20)]
        for _ in range(2))
    assert first == second


def test_mirrored_command_swaps_left_and_right():
    """Yaw to the other side exchanges the left and the right stern thruster."""
    vehicle = mt2012()
    problem, bounds = AllocationProblem(vehicle), ThrustBounds(vehicle)(paper_test(1.0)[1])
    one = problem.solve(np.array([30.0, 0, 0, 0, 10.0, 25.0]), bounds).thrusts
    other = problem.solve(np.array([30.0, 0, 0, 0, 10.0, -25.0]), bounds).thrusts
    assert other == pytest.approx(one[[0, 3, 2, 1, 4]], abs=1e-6)


def start_from(monkeypatch, thrust: float):
    """Have the active set give the same thrust for all thrusters, and no better on asking."""
    monkeypatch.setattr(ActiveSet, 'solve', lambda self, wrench, limits: (
        thrust + 0.0 * limits[0], np.clip(thrust, *limits),
        np.zeros(limits.shape[1], dtype=np.int8)))
    monkeypatch.setattr(ActiveSet, 'refine', lambda self, wrench, limits, thrusts, at_bound, _: (
        thrusts, at_bound, False))


def test_osqp_finds_the_optimum_by_itself(monkeypatch):
    """Started from zero instead of from the optimum, OSQP arrives at the same thrusts."""
    start_from(monkeypatch, 0.0)
    vehicle = mt2012()
    problem, bounds = AllocationProblem(vehicle), ThrustBounds(vehicle)
    for speed, thrusts, *_ in PAPER_TEST:
        wrench, velocity = paper_test(speed)
        allocation = problem.solve(wrench, bounds(velocity))
        assert allocation.solved and allocation.iterations > 1
        assert allocation.thrusts == pytest.approx(thrusts, abs=0.006)


def test_unsolved_tick_stays_inside_the_bounds_and_says_so(monkeypatch):
    """If OSQP runs out of iterations, the answer is finite, inside the bounds and marked."""
    monkeypatch.setattr(allocation_module, 'MAX_ITERATIONS', 1)
    start_from(monkeypatch, -50.0)
    vehicle = mt2012()
    wrench, velocity = paper_test(0.9)
    limits = ThrustBounds(vehicle)(velocity)
    allocation = AllocationProblem(vehicle).solve(wrench, limits)
    assert not allocation.solved
    assert allocation.status == 'maximum iterations reached'
    assert (limits[0] <= allocation.thrusts).all() and (allocation.thrusts <= limits[1]).all()
    assert allocation.achieved + allocation.unallocated == pytest.approx(wrench)


def test_unsolved_tick_still_gives_the_optimum_that_osqp_was_started_from(monkeypatch):
    """A tolerance that cannot be met costs OSQP's word for it, but not the thrusts."""
    monkeypatch.setattr(allocation_module, 'TOLERANCE', 1e-300)
    monkeypatch.setattr(allocation_module, 'ROUNDING', 0.0)
    vehicle = mt2012()
    wrench, velocity = paper_test(0.9)
    allocation = AllocationProblem(vehicle).solve(wrench, ThrustBounds(vehicle)(velocity))
    assert not allocation.solved
    assert allocation.thrusts == pytest.approx(PAPER_TEST[4][1], abs=0.006)


def test_a_replaced_problem_is_freed_at_once():
    """With the garbage collector off, none of 30 replaced problems and active sets stays alive."""
    vehicle = mt2012()
    problem = AllocationProblem(vehicle)
    gone: list[weakref.ref] = []
    gc.disable()
    try:
        for i in range(30):
            problem.solve(np.ones(6), vehicle.bollard_thrust)
            gone += [weakref.ref(problem), weakref.ref(problem._active_set)]
            vehicle = replace(vehicle, wrench_weights=(1e3 + i,) * 6)
            problem = problem.for_vehicle(vehicle)
        assert [one() for one in gone] == [None] * 60
    finally:
        gc.enable()
