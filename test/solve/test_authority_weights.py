"""Weights by authority."""

from dataclasses import replace

import numpy as np
import pytest
from support.vehicles import described, random_vehicle
from thrust_allocator.solve import authority as module
from thrust_allocator.solve.attainable import TooManyFaces
from thrust_allocator.solve.authority import authority, authority_weights

ALL = np.ones(6, bool)


def of(one, controlled=ALL):
    """Return the authority of a vehicle."""
    return authority(one.configuration_matrix, one.bollard_thrust, controlled)


def test_bluerov2_heavy():
    """Recorded authorities, and the weights that follow by hand."""
    reach = of(described('bluerov2_heavy'))
    assert reach == pytest.approx([129.1, 129.1, 159.6, 34.8, 19.2, 34.5], abs=0.06)
    assert authority_weights(reach) == pytest.approx(1e5 * (159.6 / reach)**2, rel=1e-3)


def test_linear_programmes_give_the_same(monkeypatch):
    """Where a set has too many faces to find, linear programmes give the same authority."""
    vehicles = [described(name) for name in ('mt2012', 'bluerov2_heavy', 'delphin2')]
    vehicles += [random_vehicle(np.random.default_rng(seed)) for seed in range(20)]
    expected = [of(one) for one in vehicles]

    def refuse(*_):
        raise TooManyFaces(5002)

    monkeypatch.setattr(module, 'AttainableSet', refuse)
    for one, found in zip(vehicles, expected):
        np.testing.assert_allclose(of(one), found, rtol=1e-8)


def test_a_coupled_dof_counts_a_fifth_of_what_it_has_while_others_are_free():
    """MT-2012 without its tunnel has no pitch while heave is 0."""
    one = described('mt2012')
    stern = replace(one, thrusters=one.thrusters[:4])
    controlled = np.array(one.wrench_weights) > 0.0
    arm = abs(stern.configuration_matrix[4, 0])
    assert of(stern, controlled)[4] == pytest.approx(0.2 * arm * (68.2 + 120.1), rel=1e-6)


def test_nothing_where_nothing_acts():
    """A DOF that no thruster acts on gets no weight; nor does one that is not controlled."""
    one = described('delphin2')
    reach = of(one)
    assert reach[3] == 0.0 and authority_weights(reach)[3] == 0.0
    assert of(one, np.array([True] + [False] * 5))[1:].max() == 0.0
    assert not authority_weights(np.zeros(6)).any()


def test_a_missing_sense_does_not_count():
    """A propeller that only pushes ahead has the authority of ahead."""
    one = described('delphin2')
    ahead = replace(one, thrusters=(*one.thrusters[:4], replace(
        one.thrusters[4], model=replace(one.thrusters[4].model, bollard_thrust=(0.0, 15.7)))))
    assert of(ahead)[0] == pytest.approx(15.7)


@pytest.mark.parametrize('spread, largest', [(2.0, 1e5), (30.0, 1e7 / 900.0), (1e4, 1e3)])
def test_weights_fit_between_their_ends(spread, largest):
    """The strongest DOF gets 1e5 or as much less, to 1e3, as keeps the weakest below 1e7."""
    weights = authority_weights(np.array([spread, 1.0, 0.0, spread, spread, spread]))
    assert weights[0] == pytest.approx(largest)
    assert weights[1] == pytest.approx(min(1e7, largest * spread**2))
    assert weights[2] == 0.0
