"""The attainable set: against published values of physics, and linear programmes."""

from hypothesis import given, settings, strategies
import numpy as np
import pytest
from support.attainable import check, KINDS
from support.vehicles import described
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.solve.attainable import AttainableSet, TooManyFaces

HEAVE = 2


def scale(name, wrench, speed=0.0, off=(), without=()):
    """Return the scale of a wrench for a vehicle at a speed, thrusters off, DOFs not in D."""
    one = described(name)
    weights = np.array(one.wrench_weights)
    weights[list(without)] = 0.0
    enabled = np.array([float(thruster.name not in off) for thruster in one.thrusters])
    limits = ThrustBounds(one)(np.array([speed, 0.0, 0.0, 0.0, 0.0, 0.0])) * enabled
    return AttainableSet(one.configuration_matrix, weights, enabled).scale(
        np.array(wrench, dtype=float), limits)


@pytest.mark.parametrize('name, wrench, changes, expected', [
    ('bluerov2_heavy', (400, 0, 0, 0, 0, 0), {}, 0.3227942456),
    ('bluerov2_heavy', (0, 0, 400, 0, 0, 0), {}, 0.514),
    ('bluerov2_heavy', (100, 0, 0, 0, 0, 40), {}, 0.5168579525),
    ('bluerov2_heavy', (100, 50, 120, 10, 5, 10), {}, 0.8607846550),
    ('bluerov2_heavy', (100, 0, 0, 0, 0, 0), {'off': ('front_right',)}, 0.7269057711),
    ('mt2012', (600, 0, 0, 0, 0, 0), {}, 0.7397205721),
    ('mt2012', (0, 0, 0, 0, 300, 0), {}, 0.6064282166),
    ('mt2012', (32.4, 0, 0, 0, 50, 0), {'speed': 0.9}, 0.2122848378),
    ('mt2012', (32.4, 0, 0, 0, 50, 0), {'speed': 0.9, 'without': (HEAVE,)}, 1.0),
    ('mt2012', (0, 0, 0, 0, 0, 0), {}, 1.0),
    ('mt2012', (1e-12, 0, 0, 0, 1e-12, 0), {}, 1.0),
])
def test_scale_against_recorded_values(name, wrench, changes, expected):
    """The scale of a wrench, to 1e-9."""
    assert scale(name, wrench, **changes) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize('kind', KINDS)
def test_random_vehicles_against_linear_programmes(kind):
    """Scale and room agree with HiGHS, whose own tolerance is 1e-10, for vehicles of any kind."""
    for seed in range(60):
        assert max(check(np.random.default_rng([11, KINDS.index(kind), seed]), kind)) < 1e-7, seed


@pytest.mark.parametrize('name, faces', [('mt2012', 14), ('bluerov2_heavy', 24), ('delphin2', 10)])
def test_number_of_faces(name, faces):
    """Parallel thrusters and planes through several of them make one face, not many."""
    one = described(name)
    assert AttainableSet(one.configuration_matrix, one.wrench_weights).faces == faces


@pytest.mark.parametrize('thrusters, faces', [(12, 1584), (14, 4004)])
def test_number_of_faces_of_a_generic_vehicle(thrusters, faces):
    """Two for every five thrusters."""
    matrix = np.random.default_rng(1).normal(size=(6, thrusters))
    assert AttainableSet(matrix, np.ones(6)).faces == faces


@pytest.mark.parametrize('thrusters, faces', [(16, 8736), (64, 15_249_024)])
def test_too_many_faces_are_refused_with_the_number(thrusters, faces):
    """Also where to find them would take hours."""
    matrix = np.random.default_rng(1).normal(size=(6, thrusters))
    with pytest.raises(TooManyFaces, match='5000') as refusal:
        AttainableSet(matrix, np.ones(6))
    assert refusal.value.faces == faces


@settings(max_examples=60, deadline=None)
@given(strategies.integers(0, 2**32), strategies.floats(0.0, 4.0))
def test_a_scaled_wrench_has_the_scale_of_what_is_left(seed, factor):
    """scale(c f) = min(1, scale(f) / c): the boundary along a direction is one point."""
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(6, 8))
    limits = np.array([-rng.uniform(1.0, 9.0, 8), rng.uniform(1.0, 9.0, 8)])
    attainable = AttainableSet(matrix, np.ones(6))
    wrench = 1e3 * rng.normal(size=6)
    boundary = attainable.scale(wrench, limits) * wrench
    assert attainable.scale(factor * boundary, limits) == pytest.approx(
        min(1.0, 1.0 / factor) if factor else 1.0, rel=1e-9)
    room = attainable.room(boundary, wrench[np.newaxis], limits)
    assert room[0, 1] == pytest.approx(0.0, abs=1e-12)


def test_nothing_enabled_leaves_no_room():
    """A vehicle without thrusters has no faces: every wrench is beyond any thrust, none is left."""
    nothing = AttainableSet(np.ones((6, 3)), np.ones(6), np.zeros(3))
    assert nothing.faces == 0
    assert nothing.scale(np.ones(6), np.zeros((2, 3))) == 1.0
    assert not nothing.room(np.zeros(6), np.eye(6), np.zeros((2, 3))).any()
