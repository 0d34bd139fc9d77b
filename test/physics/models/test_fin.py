"""A fin: nothing at rest, more with speed, by a table and by closed forms."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
import numpy as np
import pytest
from support.vehicles import described, fin, HEAVE, limits_of, PITCH, thruster
from thrust_allocator.parameters.build import describe
from thrust_allocator.physics.flow import FlowAtThrusters
from thrust_allocator.physics.rate import RateLimits
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import AllocationProblem

MAX = math.radians(30.0)
FINS = st.builds(
    fin, gain=st.floats(1e-3, 1e3), max_deflection=st.floats(0.01, math.pi / 2),
    cut_in_speed=st.floats(0.01, 5.0), astern_share=st.floats(0.0, 1.0))


@pytest.mark.parametrize('speed, lift, degrees', [
    (0.0, 0.0, 0.0), (0.25, 0.0, 0.0), (-0.25, 0.0, 0.0), (0.375, 0.342385, 15.0),
    (0.5, 1.217367, 30.0), (1.0, 4.869469, 30.0), (2.5, 30.434179, 30.0),
    (-0.375, 0.171192, -15.0), (-1.0, 2.434734, -30.0)])
def test_the_table(speed, lift, degrees):
    """Limits, and the deflection at the upper one, of a fin whose numbers were worked out apart."""
    lower, upper = fin().limits(0.4, speed, -0.3)
    assert (-lower, upper) == pytest.approx((lift, lift), abs=1e-5)
    assert math.degrees(fin().deflection(upper, 0.4, speed, -0.3)) == pytest.approx(
        degrees, abs=1e-5)


@given(FINS, st.floats(-4.0, 4.0), st.floats(-1.0, 1.0))
def test_what_a_servo_is_told(model, speed, share):
    """The deflection gives the lift back, is within the largest, and astern turns the other way."""
    lift = share * model.limits(0.0, speed)[1]
    told = model.bollard_equivalent(lift, 0.0, speed)
    assert model.thrust_in_flow(told, 0.0, speed) == pytest.approx(lift, rel=1e-9, abs=1e-300)
    assert abs(told) <= model.max_deflection
    assert told * lift * speed >= 0.0
    assert model.bollard_fraction(lift, 0.0, speed) == told / model.max_deflection


@given(FINS, st.floats(-6.0, 6.0), st.floats(-1e-3, 1e-3))
def test_limits_have_no_jump(model, speed, change):
    """1 mm/s changes a limit by no more than the steepest slope of e s delta_max allows."""
    fast = abs(speed) + 1e-3
    steepest = model.gain * model.max_deflection * (2.0 * fast + 2.0 * fast**2 / model.cut_in_speed)
    before, after = (model.limits(0.0, one)[1] for one in (speed, speed + change))
    assert abs(after - before) <= steepest * abs(change) * (1.0 + 1e-9) + 1e-12 * steepest


@given(FINS, st.floats(0.0, 4.0), st.sampled_from([1.0, -1.0]))
def test_where_the_limit_binds_a_deflection_is_slow(model, speed, sign):
    """There 1 mm/s moves the deflection by 2 delta_max / V_c per m/s at most."""
    model = replace(model, astern_share=1.0)
    told = [model.deflection(model.limits(0.0, sign * one)[1], 0.0, sign * one)
            for one in (speed, speed + 1e-3)]
    assert abs(told[1] - told[0]) <= (
        2.0 * model.max_deflection / model.cut_in_speed * 1e-3 * (1.0 + 1e-6) + 1e-12)


def test_a_chord_is_met_by_the_speed_of_the_place():
    """Only V = chord . (v + omega x r) counts, whichever way the fin is turned."""
    rng = np.random.default_rng(14)
    for _ in range(20):
        direction, chord = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        position, velocity = rng.normal(size=3), rng.normal(size=6)
        one = thruster(position=tuple(position), direction=tuple(direction),
                       model=fin(chord=tuple(chord)))
        speed = chord @ (velocity[:3] + np.cross(velocity[3:], position))
        (along, chordwise, _), = FlowAtThrusters([one])(velocity)
        assert chordwise == pytest.approx(speed, abs=1e-12)
        assert along == pytest.approx(
            direction @ (velocity[:3] + np.cross(velocity[3:], position)), abs=1e-12)
        assert limits_of(one, velocity=velocity)[:, 0] == pytest.approx(
            fin().limits(0.0, speed), abs=1e-9)


def test_a_step_of_the_rate_limit():
    """60 deg/s at 50 Hz and 1 m/s is 0.19478 N, from the lift of the deflection where it stands."""
    one = thruster(direction=(0.0, 1.0, 0.0), model=fin())
    rates = RateLimits([replace(one, max_rate=math.radians(60.0))])
    flow, period = [(0.0, 1.0, 0.0)], 0.02
    limits = np.array([[-4.0], [4.0]])
    assert rates(limits, np.zeros(1), flow, period)[:, 0] == pytest.approx(
        (-0.19478, 0.19478), abs=1e-5)
    # What stands at 10 degrees at 1 m/s gives four times the lift at 2 m/s, and steps from there
    lift = 9.3 * math.radians(10.0)
    stand = rates.stand(np.array([lift]), flow)
    assert stand == pytest.approx([math.radians(10.0)])
    faster = rates(np.array([[-19.0], [19.0]]), stand, [(0.0, 2.0, 0.0)], period)[:, 0]
    assert faster == pytest.approx((4 * (lift - 0.194779), 4 * (lift + 0.194779)), abs=1e-5)
    # At rest, with or without a rate, there is nothing, and no NaN
    for max_rate in (0.0, 1.0):
        still = RateLimits([replace(one, max_rate=max_rate)])
        assert (still(np.zeros((2, 1)), stand, [(0.0, 0.0, 0.0)], period) == 0.0).all()


@pytest.mark.parametrize('weight, lift', [(1.0, 2.568260), (0.1, 3.071934), (0.01, 3.133385)])
def test_fins_beside_tunnels(weight, lift):
    """Two fins share 4 N*m of pitch with Delphin2's tunnels as the closed form for R -> oo says."""
    tunnels = described('delphin2').thrusters[:2]
    fins = [thruster(name, (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), fin(), weight) for name in 'ab']
    vehicle = Vehicle((*tunnels, *fins), (0.0, 0.0, 1e7, 0.0, 1e7, 0.0))
    command = np.zeros(6)
    command[PITCH] = 4.0
    limits = limits_of(*vehicle.thrusters, velocity=[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    found = AllocationProblem(vehicle).solve(command, limits)
    assert found.thrusts[2:].sum() == pytest.approx(lift, abs=1e-5)
    assert found.achieved[[HEAVE, PITCH]] == pytest.approx((0.0, 4.0), abs=1e-5)


def test_a_file_in_either_frame():
    """Position, direction and chord of a flu file are turned; lengths of the two do not count."""
    given = {'thruster_names': ['f'], **{f'thrusters.f.{name}': value for name, value in {
        'model': 'fin', 'fin_area': 0.0062, 'lift_slope': 3.0, 'max_deflection': 0.5,
        'cut_in_speed': 0.5}.items()}}
    vehicles = [describe(given | {
        'vehicle_frame': frame, 'thrusters.f.position': [-1.0, 0.2 * side, 0.1 * side],
        'thrusters.f.direction': [0.0, 3.0 * side, 4.0 * side],
        'thrusters.f.chord': [5.0, -4.0 * side, 3.0 * side]}).vehicle
        for frame, side in (('frd', 1.0), ('flu', -1.0))]
    assert vehicles[0].thrusters == vehicles[1].thrusters
    assert vehicles[0].thrusters[0].model.chord == pytest.approx(
        np.array([5.0, -4.0, 3.0]) / math.sqrt(50.0))
    assert vehicles[0].thrusters[0].model.gain == pytest.approx(0.5 * 1025.0 * 0.0062 * 3.0)


def test_a_vehicle_of_fins_alone():
    """Nothing at rest, and at speed what is asked for, certified like any other vehicle."""
    vehicle = Vehicle(tuple(thruster(f'f{i}', (-1.0, 0.2 * y, 0.2 * z), direction, fin(), 0.1)
                            for i, (y, z, direction) in enumerate([
                                (0, -1, (0.0, 1.0, 0.0)), (0, 1, (0.0, 1.0, 0.0)),
                                (-1, 0, (0.0, 0.0, 1.0)), (1, 0, (0.0, 0.0, 1.0))])),
                      (0.0, 0.0, 0.0, 1e4, 1e4, 1e4))
    problem, command = AllocationProblem(vehicle), np.array([0.0, 0.0, 0.0, 0.1, 5.0, -4.0])
    still = problem.solve(command, limits_of(*vehicle.thrusters, velocity=np.zeros(6)))
    assert still.solved and not still.thrusts.any()
    cruising = problem.solve(command, limits_of(*vehicle.thrusters, velocity=[1.5, 0, 0, 0, 0, 0]))
    assert cruising.solved and cruising.achieved[3:] == pytest.approx(command[3:], abs=0.01)
