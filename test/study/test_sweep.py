"""The study's sweep: three allocators, two motor drivers, and sentences about them."""

from dataclasses import replace

import numpy as np
import pytest
from support.vehicles import HEAVE, mt2012, paper_test as tick, PITCH, propeller, thruster
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.flow import FlowAtThrusters
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.study import findings
from thrust_allocator.study.directions import directions, most_telling
from thrust_allocator.study.errors import StudyError
from thrust_allocator.study.grid import Case, evaluate, evaluate_all
from thrust_allocator.study.manoeuvre import Manoeuvre, paper_test
from thrust_allocator.study.sweep import (
    ALLOCATORS, Drivers, pseudo_inverse, shares, sweep, without)

# What the vehicle gets in the paper's test, recomputed: speed; pitch short by [N*m] and heave
# reached [N] with moving bounds, with Bollard bounds, and by clamped pseudo-inverse
WORTH = (
    (0.7, (0.062, 7.39), (4.817, 3.80), (4.679, 3.90)),
    (0.9, (0.232, 29.56), (18.857, 15.50), (18.720, 15.60)),
    (1.2, (0.288, 36.94), (23.535, 19.39), (23.397, 19.50)),
    (1.5, (0.293, 37.50), (23.890, 19.69), (23.752, 19.79)),
    (1.8, (0.294, 37.52), (23.902, 19.70), (23.765, 19.80)),
)
SPEEDS = [row[0] for row in WORTH]
AS_ASKED, BOLLARD_CURVE = range(2)
PSEUDO_INVERSE, FIXED, MOVING = range(3)


@pytest.fixture(scope='module')
def allocation():
    """Return the sweep of the paper's test over SPEEDS."""
    return evaluate(Case('mt2012', mt2012(), (), 0.0), Manoeuvre(), SPEEDS).allocation


@pytest.mark.parametrize('allocator, column', [
    ('moving bounds', 1), ('fixed bounds', 2), ('pseudo-inverse', 3)])
def test_the_table_of_what_it_is_worth(allocator, column, allocation):
    """A driver that delivers what is asked gives the published table, every cell of it."""
    delivered = allocation.delivered[:, list(ALLOCATORS).index(allocator), AS_ASKED]
    expected = np.array([row[column] for row in WORTH])
    assert 50.0 - delivered[:, PITCH] == pytest.approx(expected[:, 0], abs=0.02)
    assert delivered[:, HEAVE] == pytest.approx(expected[:, 1], abs=0.02)


def test_both_sides_of_the_trade(allocation):
    """At 0.9 m/s 18.857 N*m of pitch go missing with fixed bounds and 0.232 with moving ones."""
    errors = allocation.errors[SPEEDS.index(0.9), :, AS_ASKED]
    assert errors[FIXED, PITCH] == pytest.approx(-18.857, abs=5e-4)
    assert errors[MOVING, PITCH] == pytest.approx(-0.232, abs=5e-4)
    assert errors[FIXED, HEAVE] == pytest.approx(15.50, abs=5e-3)
    assert errors[MOVING, HEAVE] == pytest.approx(29.56, abs=5e-3)


def test_a_bollard_curve_delivers_less(allocation):
    """At 0.9 m/s a driver calibrated at rest makes 36 of 50 N*m out of the same setpoints."""
    delivered = allocation.delivered[SPEEDS.index(0.9), MOVING, BOLLARD_CURVE]
    assert delivered[PITCH] == pytest.approx(36.0, abs=0.5)


def test_a_bollard_curve_told_the_equivalent_thrust_delivers_it():
    """The Bollard-equivalent thrust is what makes the second driver like the first."""
    vehicle, (command, velocity) = mt2012(), tick(0.9)
    setpoints = sweep(vehicle, [velocity], [command]).thrusts[0, MOVING]
    told = [one.model.bollard_equivalent(setpoint, *flow)
            for setpoint, one, flow in zip(setpoints, vehicle.thrusters,
                                           FlowAtThrusters(vehicle.thrusters)(velocity))]
    by_curve = Drivers(vehicle)(np.array(told), velocity)[BOLLARD_CURVE]
    assert by_curve == pytest.approx(setpoints, abs=1e-6)


def test_a_driver_delivers_what_it_can():
    """What is asked for inside the limits is delivered as asked; more than that, the limit."""
    vehicle, (_, velocity) = mt2012(), tick(1.2)
    lower, upper = ThrustBounds(vehicle)(velocity)
    drivers = Drivers(vehicle)
    for asked, delivered in ((0.5 * upper, 0.5 * upper), (0.5 * lower, 0.5 * lower),
                             (vehicle.bollard_thrust[1], upper),
                             (vehicle.bollard_thrust[0], lower)):
        assert drivers(asked, velocity)[AS_ASKED] == pytest.approx(delivered, abs=1e-12)


def test_a_cutoff_limits_what_is_asked_for_and_not_what_is_there():
    """A driver still delivers the little that the allocator would rather not use."""
    vehicle, (_, velocity) = mt2012(thrusters__tunnel__cutoff=0.1), tick(0.9)
    assert ThrustBounds(vehicle)(velocity)[1, 4] == 0.0
    assert Drivers(vehicle)(np.array([0, 0, 0, 0, 50.0]), velocity)[AS_ASKED, 4] \
        == pytest.approx(4.2, abs=0.05)


def test_at_rest_all_deliver_the_same_with_either_driver():
    """Without flow nothing is lost: fixed and moving bounds agree, and both drivers."""
    one = evaluate(Case('mt2012', mt2012(), (), 0.0), Manoeuvre(), [0.0]).allocation
    assert one.delivered[0, FIXED] == pytest.approx(one.delivered[0, MOVING], abs=1e-9)
    assert one.delivered[0, :, AS_ASKED] \
        == pytest.approx(one.delivered[0, :, BOLLARD_CURVE], abs=1e-9)


def test_pseudo_inverse_leaves_out_what_failed_and_what_is_not_controlled():
    """It meets every wrench that the remaining thrusters can make, with the least thrust."""
    vehicle = without(mt2012(), ['left'])
    inverse = pseudo_inverse(vehicle)
    assert not inverse[1].any() and not inverse[:, [1, 3]].any()
    command = vehicle.configuration_matrix @ [3.0, 0.0, 5.0, 0.0, -2.0]
    assert vehicle.configuration_matrix @ inverse @ command == pytest.approx(command, abs=1e-9)


def test_pseudo_inverse_weighs_thrusters_by_q():
    """A thruster that costs four times as much gives a quarter of what its twin gives."""
    vehicle = Vehicle((thruster('a'), thruster('b', weight=4.0)), (1.0, 0, 0, 0, 0, 0))
    assert pseudo_inverse(vehicle)[:, 0] == pytest.approx([0.8, 0.2])


def test_a_failed_thruster_gives_nothing(allocation):
    """None of the allocators asks a failed thruster for anything, and none delivers from it."""
    one = evaluate(Case('mt2012', mt2012(), ('tunnel', 'up'), 0.0), Manoeuvre(), SPEEDS)
    assert not one.allocation.thrusts[:, :, [2, 4]].any()
    assert np.isfinite(one.allocation.delivered).all()


def test_pitch_moves_from_tunnel_to_stern():
    """The tunnel gives half of the pitch at rest and none at 1.8 m/s; the rest is the stern's."""
    one = evaluate(Case('mt2012', mt2012(), (), 0.0), Manoeuvre(), [0.0, 0.9, 1.8]).allocation
    found = shares(mt2012(), one.thrusts[:, MOVING], PITCH)
    assert list(found) == ['tunnels', 'propellers']
    assert found['tunnels'] == pytest.approx([47.8, 10.1, 0.0], abs=0.1)
    assert found['tunnels'] + found['propellers'] == pytest.approx(100.0)


def test_shares_of_thrusters_of_one_kind():
    """Where only propellers act each has its share, and those that agree stand together."""
    vehicle = Vehicle(tuple(thruster(name, model=propeller()) for name in 'abc'),
                      (1.0, 0, 0, 0, 0, 0))
    found = shares(vehicle, np.array([[1.0, 1.0, 2.0], [2.0, 2.0, 4.0], [0.0, 0.0, 0.0]]), 0)
    assert list(found) == ['a, b, each', 'c']
    assert found['c'] == pytest.approx([50.0, 50.0, np.nan], nan_ok=True)


def test_heading_to_the_current():
    """With the current from port the vehicle moves to port through the water; drag opposes it."""
    manoeuvre = Manoeuvre(drag=(40.0, 100.0, 0.0))
    velocity = manoeuvre.velocity(2.0, 90.0)  # bow to starboard of straight into the current
    assert velocity == pytest.approx([0.0, -2.0, 0.0, 0.0, 0.0, 0.0], abs=1e-12)
    assert manoeuvre.cruise(velocity)[:2] == pytest.approx([0.0, -400.0], abs=1e-9)


def test_pieces_of_a_long_sweep_are_put_together_again():
    """More speeds than one piece holds come back in order, point for point."""
    speeds = np.linspace(0.0, 1.8, 60).tolist()
    case = Case('mt2012', mt2012(), (), 0.0)
    whole, notes = evaluate(case, Manoeuvre(), speeds), []
    pieces, = evaluate_all([case], Manoeuvre(), speeds,
                           progress=lambda done, total: notes.append((done, total)))
    for one, other in zip(whole.allocation, pieces.allocation):
        assert one == pytest.approx(other, abs=1e-9)
    assert np.array_equal(whole.authority, pieces.authority, equal_nan=True)
    assert notes == [(25, 60), (50, 60), (60, 60)]


def test_bounds_in_every_direction():
    """The map holds the law's own values: Bollard at rest, and the rise between 1 and 2.5 m/s."""
    up = mt2012().thrusters[2]
    found = directions(up, 2.5)
    assert np.all(found.limits[0] == up.bollard_thrust)
    at = found.angles.tolist().index(54.0)
    for speed, forward in ((1.0, 115.2), (2.5, 118.5)):
        limit = np.interp(speed, found.speeds, found.limits[:, at, 1])
        assert limit == pytest.approx(forward, abs=0.3)
    assert found.limits[-1, 0, 1] == pytest.approx(120.1 - 42.2 * 2.5)
    assert most_telling(mt2012()).name == 'down'


def test_default_manoeuvre():
    """The paper's test where the vehicle can follow it; less pitch, or another DOF, otherwise."""
    assert paper_test([mt2012()], 1.8) == Manoeuvre()
    weak = without(replace(mt2012(), thrusters=tuple(
        replace(one, model=replace(one.model, bollard_thrust=(-30.0, 40.0)))
        for one in mt2012().thrusters)), ['tunnel'])
    chosen = paper_test([mt2012(), weak], 1.2)
    assert 0.0 < chosen.wrench[PITCH] < 50.0 and 0.0 < chosen.drag[0] < 40.0
    no_pitch = mt2012(wrench_weights__pitch=0.0)
    assert paper_test([mt2012(), no_pitch], 1.8).wrench.index(47.0) == 5  # yaw: half of 95.5
    with pytest.raises(StudyError, match='--wrench: must be given'):
        paper_test([without(mt2012(), [one.name for one in mt2012().thrusters])], 1.8)


def test_a_verdict_names_driver_gain_and_price(allocation):
    """The rows tell both sides of the trade, signed, and whose driver it is."""
    weights = mt2012().wrench_weights
    assert findings.worth(allocation, SPEEDS, weights, AS_ASKED) == [
        ('thrust as asked', '1.8', 'pitch, N*m', '-0.29', '-23.90', '-23.76', 'smaller'),
        ('thrust as asked', '1.8', 'heave, N', '+37.52', '+19.70', '+19.80', 'larger')]
    rows = findings.worth(allocation, SPEEDS, weights, BOLLARD_CURVE)
    assert [(row[0], row[2], row[-1]) for row in rows] == [
        ('Bollard curve', 'pitch, N*m', 'smaller'), ('Bollard curve', 'heave, N', 'larger')]
    assert all(len(row) == len(findings.WORTH) for row in rows)


def test_a_verdict_says_so_if_there_is_no_difference():
    """Thrusters of model constant lose nothing, so moving bounds bring nothing."""
    vehicle = Vehicle((thruster('a'), thruster('b')), (1.0, 0, 0, 0, 0, 0))
    one = evaluate(Case('x', vehicle, (), 0.0), Manoeuvre((0.0,) * 6), SPEEDS).allocation
    row, = findings.worth(one, SPEEDS, vehicle.wrench_weights, AS_ASKED)
    assert row == ('thrust as asked', 'any', 'all', *('the same',) * 4)


@pytest.mark.parametrize('mask, said', [
    ([1, 1, 1, 1, 1], 'at every speed'), ([0] * 5, 'at no speed'),
    ([1, 1, 0, 0, 1], 'at 0.7 to 0.9, 1.8 m/s'), ([0, 0, 1, 1, 0], 'at 1.2 to 1.5 m/s')])
def test_speeds_in_words(mask, said):
    """Runs of speeds are told by their ends."""
    assert findings.at_speeds(np.array(mask, dtype=bool), SPEEDS) == said
