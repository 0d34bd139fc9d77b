"""What gives way beyond reach: the study's numbers, and a table that a third party published."""

import csv

import numpy as np
from numpy.testing import assert_allclose
import pytest
from support.vehicles import described
from thrust_allocator.benchmark.saturation import AUTHORITY, competition_vehicle, MATRIX
from thrust_allocator.solve.attainable import AttainableSet
from thrust_allocator.study.saturation import (
    ALLOCATORS, KEEPING, reach_of, saturation, saturation_table)
from thrust_allocator.study.sweep import pseudo_inverse, without
from thrust_allocator.study.tables import write_giving_way

CLAMPED, SCALED = ALLOCATORS[:2]
KEPT = dict(zip(KEEPING, ALLOCATORS[2:]))


@pytest.fixture(scope='module')
def published():
    """Return what becomes of 4,000 commands on the vehicle of the published table."""
    return saturation(competition_vehicle(), AUTHORITY, 4000)


def test_the_vehicle_of_the_published_table():
    """Its matrix and its authority by pseudo-inverse come out of positions and directions."""
    vehicle = competition_vehicle()
    sizes = vehicle.bollard_thrust[1]
    assert_allclose(vehicle.configuration_matrix * sizes, MATRIX, atol=1e-15)
    assert_allclose(1.0 / np.abs(np.linalg.pinv(MATRIX)).max(axis=0), AUTHORITY, atol=5e-4)


def test_the_published_rows_are_reproduced(published):
    """Clipping and uniform scaling come to what was published for them: 18.0, 32.7 % and 45.2 %."""
    assert published.angles[CLAMPED].mean() == pytest.approx(18.0, abs=0.6)
    assert np.quantile(published.angles[CLAMPED], 0.95) == pytest.approx(42.6, abs=1.5)
    assert published.lost[CLAMPED].mean() == pytest.approx(0.327, abs=0.01)
    assert published.angles[SCALED].max() < 1e-5
    assert published.lost[SCALED].mean() == pytest.approx(0.452, abs=0.012)


def test_ours_beside_it(published):
    """The direction within 0.3 degrees at the limit of what can be had; by weights within 13."""
    assert published.angles[KEPT[1.0]].mean() <= 0.1 and published.angles[KEPT[1.0]].max() <= 0.3
    assert published.lost[KEPT[1.0]].mean() <= 0.388  # 0.385 of all 20,000 commands
    assert published.angles[KEPT[0.0]].mean() <= 13.2  # 13
    assert published.lost[KEPT[0.0]].mean() <= 0.27  # 0.268


@pytest.mark.parametrize('k', KEEPING)
def test_weights_left_out_lose_less_direction_than_clamping(k):
    """BlueROV2 Heavy, whose weights follow from its authority, at any k."""
    vehicle = described('bluerov2_heavy')
    found = saturation(vehicle, reach_of(vehicle), 800)
    assert found.angles[KEPT[k]].mean() < found.angles[CLAMPED].mean()


def test_commands_are_beyond_the_pseudo_inverse_and_of_every_length():
    """What is lost when the direction is kept is what the attainable set says of each command."""
    vehicle = without(described('bluerov2_heavy'), ['rear_left'])
    limits = vehicle.bollard_thrust * [one.enabled for one in vehicle.thrusters]
    found = saturation(vehicle, reach_of(vehicle), 300)
    lost = found.lost[KEPT[1.0]]
    assert 0.0 <= lost.min() + 1e-3 and lost.max() > 0.5
    assert (found.lost[SCALED] > lost - 1e-3).all()
    assert not pseudo_inverse(vehicle)[3].any() and not limits[:, 3].any()
    room = AttainableSet(vehicle.configuration_matrix, vehicle.wrench_weights,
                         [one.enabled for one in vehicle.thrusters]).room(
        np.zeros(6), np.eye(6), limits)
    assert_allclose(np.abs(room).min(axis=1), reach_of(vehicle), rtol=1e-9)


def test_table_and_csv(published, tmp_path):
    """Each allocator has its row, and each command its line."""
    write_giving_way(tmp_path / 'giving_way.csv', published)
    with (tmp_path / 'giving_way.csv').open(encoding='utf-8', newline='') as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4000 * len(ALLOCATORS)
    assert [float(row['direction error [deg]']) for row in rows[:4000]] \
        == list(published.angles[CLAMPED])
    lines = saturation_table(published, [('theirs', 1.0, 2.0, 3.0, 4.0)]).splitlines()
    assert lines[2].split('|')[1:6] == [' theirs' + ' ' * 22, *(
        f'{value:.2f}'.rjust(len(cell) - 2).center(len(cell)) for value, cell in zip(
            (1.0, 2.0, 3.0, 4.0), lines[0].split('|')[2:6]))]
    assert len(lines) == 2 + 1 + len(ALLOCATORS)
