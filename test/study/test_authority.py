"""Authority: against vertex enumeration, and that the allocator reaches what it promises."""

from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest
from support.paths import CONFIG
from support.vehicles import mt2012, PITCH, random_vehicle, thruster
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import AllocationProblem
from thrust_allocator.study import findings
from thrust_allocator.study.authority import Authority, HELD
from thrust_allocator.study.authority_picture import telling
from thrust_allocator.study.grid import Case, evaluate
from thrust_allocator.study.manoeuvre import Manoeuvre
from thrust_allocator.study.sweep import without

SURGE, HEAVE, YAW = 0, 2, 5
HEAVIER, ALL = range(2)


def held_dofs(vehicle, dof, kind):
    """Return which DOFs hold the cruise wrench, as the definition says."""
    weights = vehicle.wrench_weights
    return [i for i in range(6) if i != dof and weights[i] > 0.0
            and (kind == ALL or weights[i] >= weights[dof])]


def vertices(matrix, wrench, limits):
    """
    Return every vertex of {tau: matrix tau = wrench, inside limits}, by trying all of them.

    A vertex has a solution that is unique once the thrusters at a bound are taken away: as many
    free thrusters as the matrix has independent rows, at most.
    """
    count = limits.shape[1]
    rank = np.linalg.matrix_rank(matrix, tol=1e-9) if len(matrix) else 0
    found = []
    for free in combinations(range(count), rank):
        bound = [i for i in range(count) if i not in free]
        if rank and np.linalg.matrix_rank(matrix[:, free], tol=1e-9) < rank:
            continue
        for sides in product((0, 1), repeat=len(bound)):
            thrusts = np.zeros(count)
            thrusts[bound] = limits[sides, bound]
            if rank:
                rest = wrench - matrix @ thrusts
                thrusts[list(free)] = np.linalg.lstsq(matrix[:, free], rest, rcond=None)[0]
            if np.abs(matrix @ thrusts - wrench).max(initial=0.0) < 1e-7 \
                    and (thrusts >= limits[0] - 1e-7).all() and (thrusts <= limits[1] + 1e-7).all():
                found.append(thrusts)
    return found


def check_against_vertices(vehicle, limits, cruise):
    """Compare every range of a vehicle with the extremes over all vertices; count the gaps."""
    ranges = Authority(vehicle)(limits, cruise)
    matrix, gaps = vehicle.configuration_matrix, 0
    for kind in range(len(HELD)):
        for dof in range(6):
            if not vehicle.wrench_weights[dof]:
                assert np.isnan(ranges[kind, dof]).all()
                continue
            held = held_dofs(vehicle, dof, kind)
            values = [matrix[dof] @ one for one in vertices(matrix[held], cruise[held], limits)]
            if not values:
                assert np.isnan(ranges[kind, dof]).all()
                gaps += 1
                continue
            scale = np.abs(matrix[dof]) @ np.abs(limits).max(axis=0)
            assert ranges[kind, dof] == pytest.approx(
                [min(values), max(values)], rel=1e-6, abs=1e-7 * scale)
    return gaps


@pytest.mark.parametrize('speed', [0.0, 0.5, 0.9, 1.8])
@pytest.mark.parametrize('failed', [(), ('tunnel',), ('left',), ('up', 'down')])
def test_paper_vehicle_against_vertices(speed, failed):
    """Trying every vertex of MT-2012's feasible thrusts gives the same ranges."""
    vehicle, manoeuvre = without(mt2012(), failed), Manoeuvre()
    velocity = manoeuvre.velocity(speed, 0.0)
    check_against_vertices(vehicle, ThrustBounds(vehicle)(velocity), manoeuvre.cruise(velocity))


def test_random_vehicles_against_vertices():
    """So it does for random small vehicles and cruise wrenches, within reach or not."""
    gaps = 0
    for seed in range(25):
        rng = np.random.default_rng(seed)
        vehicle = random_vehicle(rng, 4)
        weights = tuple(weight * (rng.random() < 0.5) for weight in vehicle.wrench_weights)
        vehicle = replace(vehicle, wrench_weights=weights if any(weights) else (1.0,) * 6)
        limits = ThrustBounds(vehicle)(0.3 * rng.normal(size=6))
        cruise = vehicle.configuration_matrix @ rng.uniform(*(1.3 * limits))
        gaps += check_against_vertices(vehicle, limits, cruise)
    assert gaps > 10


@pytest.mark.parametrize('name', ['mt2012', 'bluerov2_heavy', 'delphin2'])
@pytest.mark.parametrize('kind', [HEAVIER, ALL])
@pytest.mark.parametrize('speed', [0.0, 0.5, 1.0])
def test_the_allocator_reaches_each_end(name, kind, speed):
    """With R large for what holds and what is wanted, and 0 for the rest, it gets within 1 %."""
    vehicle = load_vehicle(CONFIG / f'{name}.yaml')
    manoeuvre = Manoeuvre(drag=(0.17 if name == 'delphin2' else 18.0, 0.0, 0.0))
    velocity = manoeuvre.velocity(speed, 0.0)
    limits, cruise = ThrustBounds(vehicle)(velocity), manoeuvre.cruise(velocity)
    ranges = Authority(vehicle)(limits, cruise)[kind]
    checked = 0
    for dof in np.flatnonzero(vehicle.wrench_weights):
        held = held_dofs(vehicle, dof, kind)
        problem = AllocationProblem(replace(vehicle, wrench_weights=tuple(
            1e6 if i == dof or i in held else 0.0 for i in range(6))))
        for end in ranges[dof]:
            assert np.isfinite(end)
            command = np.where(np.isin(range(6), held), cruise, 0.0)
            command[dof] = end
            achieved = problem.solve(command, limits).achieved
            assert achieved[dof] == pytest.approx(end, rel=0.01, abs=1e-3)
            assert achieved[held] == pytest.approx(command[held], abs=0.01 * abs(end) + 1e-3)
            checked += 1
    assert checked >= 8


def test_free_dofs_only_add():
    """What can be reached while all hold can be reached while the lighter ones are free."""
    vehicle, manoeuvre = mt2012(), Manoeuvre()
    for speed in np.linspace(0.0, 1.8, 10):
        velocity = manoeuvre.velocity(speed, 0.0)
        ranges = Authority(vehicle)(ThrustBounds(vehicle)(velocity), manoeuvre.cruise(velocity))
        smallest, largest = np.moveaxis(ranges[:, [SURGE, HEAVE, PITCH, YAW]], -1, 0)
        assert (smallest[HEAVIER] <= smallest[ALL] + 1e-6).all()
        assert (largest[HEAVIER] >= largest[ALL] - 1e-6).all()
        assert ranges[HEAVIER, HEAVE] == pytest.approx(ranges[ALL, HEAVE])  # the lightest


def test_without_its_tunnel_pitch_needs_heave():
    """The stern couples pitch and heave: no pitch while heave holds, 60 N*m and more otherwise."""
    vehicle, manoeuvre = without(mt2012(), ['tunnel']), Manoeuvre()
    velocity = manoeuvre.velocity(1.0, 0.0)
    ranges = Authority(vehicle)(ThrustBounds(vehicle)(velocity), manoeuvre.cruise(velocity))
    assert ranges[ALL, PITCH] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert ranges[HEAVIER, PITCH, 1] > 60.0


def test_a_single_thruster():
    """One thruster, one DOF: its limits, with nothing to hold."""
    vehicle = Vehicle((thruster(model=Constant((-3.0, 7.0))),), (1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    ranges = Authority(vehicle)(vehicle.bollard_thrust, np.zeros(6))
    assert ranges[:, 0] == pytest.approx(np.array([[-3.0, 7.0]] * 2))
    assert np.isnan(ranges[:, 1:]).all()


def test_a_cruise_out_of_reach_is_a_gap_and_a_sentence():
    """Where the speed cannot be held there is no number, and the report says where and when."""
    case = Case('mt2012', mt2012(), (), 0.0)
    speeds = [0.0, 1.0, 1.5]
    outcome = evaluate(case, Manoeuvre(drag=(300.0, 0.0, 0.0)), speeds)  # 675 N at 1.5 m/s
    assert np.isnan(outcome.authority[2, :, [HEAVE, PITCH, YAW]]).all()
    assert np.isfinite(outcome.authority[:, :, SURGE]).all()  # it is not held for itself
    assert np.isfinite(outcome.authority[:2, HEAVIER, PITCH]).all()
    assert findings.gaps([case], [outcome], speeds) == [
        'A gap for heave, pitch, yaw at 1.5 m/s, where the cruise wrench cannot be held: intact.']


def test_authority_in_words():
    """The verdict names the manoeuvre and the failure that costs most."""
    cases = [Case('mt2012', mt2012(), failed, 0.0) for failed in ((), ('left',), ('up',))]
    speeds = [0.0, 0.5, 0.9, 1.8]
    outcomes = [evaluate(case, Manoeuvre(), speeds) for case in cases]
    assert findings.authority(cases, outcomes, Manoeuvre(), speeds) == (
        '50 N*m of pitch beside the cruise wrench',
        [('mt2012, intact', 'at every speed', 'at 0 to 0.5 m/s'),
         ('mt2012, without up', 'at 0 to 0.5 m/s', 'at 0 to 0.5 m/s')])


def test_which_failures_are_drawn():
    """Alike ones once, those that change nothing never, those that cost most first."""
    span = np.array([[-1.0, 1.0]])

    def ranges(*factors):
        return np.array([factor * np.repeat(span, 2, 0) for factor in factors])

    intact = ranges(10.0, 8.0)
    cases = [intact, ranges(10.0, 6.0), intact.copy(), ranges(2.0, 1.0), ranges(10.0, 6.0),
             np.full_like(intact, np.nan)]
    assert telling(cases) == [[5], [3], [1, 4]]
