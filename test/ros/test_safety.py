"""Stops, starts and lost thrusters, provoked on the running node."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from support.stepped_peer import assert_optimal, is_stopped, rest_of
from support.vehicles import NAMES

WRENCH = [120.0, 0.0, 10.0, 0.0, 25.0, -15.0]  # frd axes; without sway and roll: not controlled
TWIST = [0.3, 0.1, -0.1, 0.02, 0.05, -0.02]
RATE_LIMIT = [f'thrusters.{name}.max_rate:=100.0' for name in NAMES]  # [N/s]
STEP = 100.0 / 50.0  # what it allows per tick [N]


def test_the_wrench_times_out(stepped):
    """Old wrench: exact zeros at once whatever max_rate, speed bounds, nothing unallocated."""
    peer = stepped('wrench_timeout:=0.2', *RATE_LIMIT)
    assert np.abs(peer.steps(40, WRENCH, TWIST)[-1]['thruster_setpoints']).max() > 10.0 * STEP
    peer.silence('wrench')
    ticks = peer.steps(15)
    stopped = [is_stopped(tick) for tick in ticks]
    assert stopped == sorted(stopped)  # once stopped, stopped
    assert 8 <= stopped.index(True) <= 11  # 0.2 s are 10 ticks
    for tick in ticks[stopped.index(True):]:
        assert not tick['unallocated_wrench'].any()
        assert_array_equal(tick['thrust_limits'], peer.limits_at(*TWIST))
    level, message, _ = peer.report()
    assert level == 'WARN' and 'no wrench: zero setpoints' in message


def test_disabled(stepped):
    """~/enable false: exact zeros from the next tick, the whole of a live wrench unallocated."""
    peer = stepped(*RATE_LIMIT)
    peer.steps(40, WRENCH, TWIST)
    answer = peer.enable(False)
    assert answer.success and answer.message
    for tick in peer.steps(10):
        assert is_stopped(tick)
        assert_array_equal(tick['unallocated_wrench'], WRENCH)
        assert_array_equal(tick['thrust_limits'], peer.limits_at(*TWIST))
    peer.report()
    assert peer.report_later()[:2] == ('WARN', 'disabled: zero setpoints')
    peer.silence('wrench')
    last = peer.steps(30)[-1]
    assert is_stopped(last) and not last['unallocated_wrench'].any()


def test_start_enabled_false(stepped):
    """With start_enabled false the node stays stopped until ~/enable and a wrench since."""
    peer = stepped('start_enabled:=false')
    for tick in peer.steps(5, WRENCH, TWIST):
        assert is_stopped(tick)
        assert_array_equal(tick['unallocated_wrench'], WRENCH)
    assert peer.report()[:2] == ('WARN', 'disabled: zero setpoints')
    peer.enable(True)
    assert rest_of(WRENCH, peer.step()) < 1e-9
    assert not is_stopped(peer.step())
    assert 'disabled' not in peer.report_later()[1]


def test_enabling_forgets_the_wrench(stepped):
    """After enabling, a wrench from before counts no more, not even to be told as unallocated."""
    peer = stepped('wrench_timeout:=60.0', 'start_enabled:=false')
    peer.steps(5, WRENCH)
    peer.silence('wrench')
    peer.enable(True)
    for tick in peer.steps(5):
        assert is_stopped(tick) and not tick['unallocated_wrench'].any()
    assert not is_stopped(peer.step(WRENCH))


def test_enabling_twice_changes_nothing(stepped):
    """While the node is enabled, ~/enable true does not interrupt it."""
    peer = stepped('wrench_timeout:=60.0')
    before = peer.steps(3, WRENCH)[-1]
    peer.silence('wrench')
    peer.enable(True)
    assert_array_equal(peer.step()['thruster_setpoints'], before['thruster_setpoints'])


def test_starting_ramps_from_zero(stepped):
    """A start after a stop ramps at max_rate from zero, the last published."""
    peer = stepped(*RATE_LIMIT)
    peer.steps(40, WRENCH)
    peer.enable(False)
    peer.step()
    peer.enable(True)
    for number, tick in enumerate(peer.steps(5, WRENCH), start=1):
        assert np.abs(tick['thruster_setpoints']).max() == pytest.approx(number * STEP)


def test_a_thruster_is_switched_off_and_on(stepped):
    """Switched off: exact zeros from the next tick, the others take over; on: as before."""
    peer = stepped()
    before = peer.steps(3, WRENCH, TWIST)[-1]
    assert abs(before['thruster_setpoints'][1]) > 10.0
    peer.report()
    assert peer.switch(left=False)[0].successful
    for tick in peer.steps(5):
        assert tick['thrust_limits'][[1, 6]].tolist() == [0.0, 0.0]
        assert tick['thruster_setpoints'][1] == 0.0
        assert_array_equal(np.delete(tick['thrust_limits'], [1, 6]),
                           np.delete(before['thrust_limits'], [1, 6]))
        assert_optimal(peer.node.vehicle, tick, WRENCH)
    assert np.abs(tick['thruster_setpoints'] - before['thruster_setpoints'])[[0, 2, 3]].min() > 0.1
    figures = peer.report()[2]
    assert (figures['thrusters off'], figures['iterations, worst']) == ('left', '1')
    assert peer.switch(left=True)[0].successful
    assert_allclose(peer.step()['thruster_setpoints'], before['thruster_setpoints'], atol=1e-9)
    assert peer.report()[2]['thrusters off'] == ''


def test_a_thruster_that_is_off_at_start(stepped, variant):
    """`enabled: false` in the file keeps a thruster at zero from the first tick."""
    peer = stepped(file=variant({'thrusters.up.enabled': False}))
    tick = peer.step(WRENCH)
    assert (tick['thruster_setpoints'][2], *tick['thrust_limits'][[2, 7]]) == (0.0, 0.0, 0.0)
    assert_optimal(peer.node.vehicle, tick, WRENCH)


def test_all_thrusters_off(stepped):
    """Without any thruster there are zeros, and the whole wrench is unallocated."""
    peer = stepped(*RATE_LIMIT)
    peer.steps(20, WRENCH)
    assert all(one.successful for one in peer.switch(**dict.fromkeys(NAMES, False)))
    for tick in peer.steps(5):
        assert is_stopped(tick) and not tick['thrust_limits'].any()
        assert_array_equal(tick['unallocated_wrench'], WRENCH)
    level, _, figures = peer.report()
    assert level == 'WARN' and figures['solver status'] == 'solved'
    assert figures['thrusters off'] == ', '.join(NAMES)
    peer.switch(**dict.fromkeys(NAMES, True))
    most = [np.abs(tick['thruster_setpoints']).max() for tick in peer.steps(3)]
    assert_allclose(most, [STEP, 2.0 * STEP, 3.0 * STEP])


def test_a_switched_thruster_ramps(stepped):
    """A thruster that is switched on again starts from zero at max_rate."""
    peer = stepped(*RATE_LIMIT)
    peer.steps(40, WRENCH)
    peer.switch(up=False)
    assert peer.step()['thruster_setpoints'][2] == 0.0
    peer.switch(up=True)
    tick = peer.step()
    assert_array_equal(tick['thrust_limits'][[2, 7]], [-STEP, STEP])
    assert 0.0 < abs(tick['thruster_setpoints'][2]) <= STEP
