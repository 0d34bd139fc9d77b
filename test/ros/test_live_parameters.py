"""Parameters changed on the running node, over its services: in force at the next tick."""

import numpy as np
from numpy.testing import assert_allclose
import pytest
from rclpy.parameter import Parameter
from support.live_parameters import AHEAD, ASTERN, change, expected, GENTLE, TWIST, UP
from support.stepped_peer import is_stopped, PERIOD
from support.vehicles import mt2012
from thrust_allocator.physics.rate import rate_limited
from thrust_allocator.solve.problem import AllocationProblem

STILL = np.zeros(6)
TUNNEL = 'thrusters.tunnel.'
MILLISECOND = 10**6  # [ns]


@pytest.mark.parametrize('name, value, wrench', [
    ('water_density', 600.0, AHEAD),
    ('wrench_weights.heave', 20000.0, AHEAD),
    ('wrench_weights.sway', 20000.0, GENTLE + [0.0, 8.0, 0.0, 0.0, 0.0, 0.0]),
    ('wrench_weights.pitch', 0.0, GENTLE),
    (UP + 'weight', 5.0, GENTLE),
    (UP + 'bollard_thrust', [-50.0, 90.0], AHEAD),
    (UP + 'bollard_thrust', [-200.0, 0.0], AHEAD),
    (UP + 'speed_loss', [10.0, 60.0], AHEAD),
    (UP + 'speed_loss_quadratic', [10.0, 20.0], AHEAD),
    (UP + 'angle_law', 'cosine', AHEAD),
    (UP + 'critical_angle_slope', 0.5, AHEAD),
    (UP + 'critical_angle_min', 1.5, AHEAD),
    (UP + 'second_critical_angle_offset', -0.3, ASTERN),
    (UP + 'second_critical_angle_slope', -0.3, ASTERN),
    (UP + 'opposed_loss', [1.0, 0.0], ASTERN),
    (UP + 'opposed_floor', 0.999, ASTERN),
    (UP + 'cutoff', 0.5, AHEAD),
    (UP + 'enabled', False, AHEAD),
    (UP + 'effectiveness', 0.5, AHEAD),
    (UP + 'effectiveness', 0.0, AHEAD),
    ('wrench_origin', [0.2, -0.1, 0.05], GENTLE),
    (TUNNEL + 'area', 0.02, AHEAD),
    (TUNNEL + 'decay', 2.0, AHEAD),
    (TUNNEL + 'cutoff', 0.9, AHEAD),
    (TUNNEL + 'bollard_thrust', [-20.0, 10.0], AHEAD)])
def test_the_next_tick_is_the_changed_vehicles(stepped, variant, name, value, wrench):
    """Limits and setpoints of the tick after a change are those of a file that says so."""
    one = stepped()
    before = one.step(wrench, TWIST)
    assert change(one, {name: value}) == [(True, '')]
    after = one.step()
    limits, setpoints = expected(variant({name: value}), wrench, TWIST)
    assert_allclose(after['thrust_limits'], limits, atol=1e-12)
    assert_allclose(after['thruster_setpoints'], setpoints, atol=1e-6)
    assert np.abs(after['thruster_setpoints'] - before['thruster_setpoints']).max() > 0.05
    if name == UP + 'enabled':
        assert after['thrust_limits'][[2, 7]].tolist() == [0.0, 0.0]
        assert after['thruster_setpoints'][2] == 0.0


def test_propeller_data(stepped, variant):
    """A propeller that is described by its data can be changed by them."""
    data = {'diameter': 0.2, 'max_revolutions': 15.13, 'thrust_slope': 0.34}
    up = {'model': 'propeller', 'position': [-1.88, 0.0, -0.23], 'direction': [0.92, 0.0, 0.38],
          'bollard_thrust': [-68.2, 120.1], 'propeller': data}
    one = stepped(file=variant({'thrusters.up': up}))
    one.step(AHEAD, TWIST)
    for name, value in (('diameter', 0.25), ('max_revolutions', 20.0), ('thrust_slope', 0.5)):
        data[name] = value
        assert change(one, {f'{UP}propeller.{name}': value}) == [(True, '')]
        limits, setpoints = expected(variant({'thrusters.up': up}), AHEAD, TWIST)
        assert_allclose(one.step()['thrust_limits'], limits, atol=1e-12)
    assert_allclose(one.step()['thruster_setpoints'], setpoints, atol=1e-6)


def test_max_rate(stepped):
    """A rate limit set while running holds from the next tick on, and goes with rate's period."""
    one = stepped()
    start = one.step(STILL, STILL)['thruster_setpoints']
    assert change(one, {UP + 'max_rate': 100.0}) == [(True, '')]
    first = one.step(AHEAD)
    step = np.array([np.inf, np.inf, 2.0, np.inf, np.inf])  # 100 N/s at 50 Hz
    assert_allclose(first['thrust_limits'], rate_limited(
        one.limits_at(0.0).reshape(2, 5), start, step).ravel(), atol=1e-12)
    assert_allclose(first['thruster_setpoints'][2], 2.0, atol=1e-9)
    assert change(one, {'rate': 100.0}) == [(True, '')]
    assert_allclose(one.step(period=PERIOD // 2)['thruster_setpoints'][2], 3.0, atol=1e-9)
    assert change(one, {UP + 'max_rate': 0.0}) == [(True, '')]
    assert one.step(period=PERIOD // 2)['thruster_setpoints'][2] > 50.0


def test_a_faster_rate(stepped):
    """A rate raised from one tick in 100 s to 100 Hz does not wait for the old period's end."""
    one = stepped('rate:=0.01', 'wrench_timeout:=1000.0')
    one.step(GENTLE, STILL, period=100_000 * MILLISECOND)
    one.time += 50_000 * MILLISECOND
    one.pulse()
    assert change(one, {'rate': 100.0}) == [(True, '')]
    for _ in range(3):
        one.step(period=10 * MILLISECOND)
    assert one.report()[2]['ticks late'] == '0'  # the first came when it could


def test_a_slower_rate(stepped):
    """After the tick that was due, ticks come at the lower rate; none of them is called late."""
    one = stepped('rate:=100.0')
    one.step(GENTLE, STILL, period=10 * MILLISECOND)
    assert change(one, {'rate': 10.0}) == [(True, '')]
    one.step(period=10 * MILLISECOND)
    for _ in range(3):
        one.step(period=100 * MILLISECOND)
    one.time += 90 * MILLISECOND
    seen = one.ticks_seen
    one.pulse()
    assert change(one, {'wrench_timeout': 0.5}) == [(True, '')]  # an answer later still none
    assert one.ticks_seen == seen
    assert one.report()[2]['ticks late'] == '0'


def test_wrench_timeout(stepped):
    """A time-out made shorter than the wrench's age stops; made longer again, it goes on."""
    one = stepped()
    answer = one.step(GENTLE, STILL)
    one.silence('wrench')
    one.steps(2)
    for timeout, stopped in ((0.05, True), (0.5, False)):
        assert change(one, {'wrench_timeout': timeout}) == [(True, '')]
        tick = one.step()
        assert is_stopped(tick) is stopped
    assert_allclose(tick['thruster_setpoints'], answer['thruster_setpoints'], atol=1e-6)


def test_odometry_timeout_and_fallback_velocity(stepped):
    """Both count at the next tick: no velocity, one too old, and none expected."""
    one = stepped()
    still, moving, fast = (one.limits_at(speed) for speed in (0.0, 1.0, 1.5))
    assert_allclose(one.step(GENTLE)['thrust_limits'], still, atol=1e-12)
    assert change(one, {'fallback_velocity': [1.5, 0.0, 0.0]}) == [(True, '')]
    assert_allclose(one.step()['thrust_limits'], fast, atol=1e-12)
    one.step(GENTLE, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    one.silence('twist')
    assert_allclose(one.step()['thrust_limits'], moving, atol=1e-12)
    assert change(one, {'odometry_timeout': 0.03}) == [(True, '')]
    tighter = np.where(np.arange(10) < 5, np.maximum(moving, fast), np.minimum(moving, fast))
    one.step()  # 40 ms after the last odometry: a third of the way
    assert_allclose(one.step()['thrust_limits'], tighter, atol=1e-12)
    assert 'no odometry' in one.report()[1]
    assert change(one, {'odometry_timeout': 0.0}) == [(True, '')]
    assert 'no odometry' not in one.report_later()[1]


def test_current_timeout(stepped):
    """A current counts for as long as the time-out says now."""
    one = stepped()
    one.current = [-0.5, 0.0, 0.0]
    with_current = one.step(GENTLE, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])['thrust_limits']
    assert_allclose(with_current, one.limits_at(1.5), atol=1e-12)
    one.silence('current')
    one.step()
    for timeout, speed in ((0.03, 1.0), (10.0, 1.5)):
        assert change(one, {'current_timeout': timeout}) == [(True, '')]
        assert_allclose(one.step()['thrust_limits'], one.limits_at(speed), atol=1e-12)


@pytest.mark.parametrize('name, given, value', [
    ('rate', 25, 25.0), ('rate', '2.5e1', 25.0), ('odometry_timeout', 0, 0.0),
    ('wrench_weights.heave', '1.0e4', 1e4), (UP + 'weight', 3, 3.0), (UP + 'weight', '3e0', 3.0),
    ('fallback_velocity', [1, 0, 0], [1.0, 0.0, 0.0]),
    (UP + 'bollard_thrust', [-50, 90], [-50.0, 90.0]),
    (UP + 'bollard_thrust', ['-5.0e1', '9.0e1'], [-50.0, 90.0])])
@pytest.mark.parametrize('atomically', [False, True])
def test_whole_numbers_and_words_are_reals(stepped, name, given, value, atomically):
    """A whole number, and 1.0e4 as `ros2 param set` reads it, are set as the real number."""
    one = stepped()
    assert change(one, {name: given}, atomically) == [(True, '')]
    found = one.node.get_parameter(name)
    assert found.type_ == Parameter(name, value=value).type_
    assert (list(found.value) if isinstance(value, list) else found.value) == value


@pytest.mark.parametrize('changes', [
    {'wrench_weights.heave': 5000.0}, {'wrench_weights.heave': 0.0}, {UP + 'weight': 3.0},
    {UP + 'bollard_thrust': [-500.0, 500.0]}, {TUNNEL + 'decay': 1.0}, {UP + 'cutoff': 0.1},
    {'rate': 50.5}], ids=str)
def test_the_warm_start_is_kept(stepped, changes):
    """After a change OSQP still starts from the optimum, and needs one iteration."""
    one = stepped()
    one.steps(3, AHEAD, TWIST)
    one.report()
    assert change(one, changes) == [(True, '')]
    one.steps(3)
    figures = one.report()[2]
    assert figures['iterations, worst'] == '1' and figures['solver status'] == 'solved'


def test_the_problem_is_set_up_anew_only_for_new_weights():
    """What changes no more than the bounds leaves OSQP as it is."""
    problem = AllocationProblem(mt2012())
    assert problem.for_vehicle(mt2012(wrench_weights__heave=200.0)) is not problem
    assert problem.for_vehicle(mt2012(thrusters__up__enabled=False)) is problem
