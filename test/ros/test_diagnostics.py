"""What /diagnostics tells a pilot: levels, words and figures, once per second."""

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Wrench
import numpy as np
import pytest
from std_msgs.msg import Float64MultiArray
from support.peer import cruise
from support.stepped_peer import SECOND
import thrust_allocator.solve.problem as allocation_module

WRENCH = [60.0, 0.0, 10.0, 0.0, 20.0, -15.0]
STILL = [0.0] * 6
KEYS = {'age of wrench [s]', 'age of odometry [s]', 'thrusters off', 'thrusters at a bound',
        'unallocated force [N]', 'unallocated moment [N*m]', 'solver status', 'iterations, mean',
        'iterations, worst', 'tick time, mean [ms]', 'tick time, worst [ms]', 'ticks late'}


def test_healthy(stepped):
    """In the healthy state the level is OK, and all the figures are there and plausible."""
    peer = stepped()
    peer.steps(30, WRENCH, STILL)
    level, message, figures = peer.report()
    assert (level, message) == ('OK', 'allocating')
    assert KEYS <= set(figures)
    assert figures['solver status'] == 'solved'
    assert figures['thrusters off'] == figures['thrusters at a bound'] == ''
    assert float(figures['age of wrench [s]']) == float(figures['age of odometry [s]']) == 0.0
    assert float(figures['iterations, mean']) == float(figures['iterations, worst']) == 1.0
    assert 0.0 < float(figures['tick time, mean [ms]']) <= float(
        figures['tick time, worst [ms]']) < 1000.0
    assert (figures['ticks'], figures['ticks late']) == ('30', '0')


def test_figures_are_those_since_the_last_report(stepped):
    """Counts start again with every report."""
    peer = stepped()
    peer.steps(5, WRENCH, STILL)
    peer.report()
    peer.steps(3)
    assert peer.report()[2]['ticks'] == '3'


def test_ages(stepped):
    """The ages are those of the last accepted messages, 'none' before the first."""
    peer = stepped()
    peer.steps(2)
    figures = peer.report()[2]
    assert figures['age of wrench [s]'] == figures['age of odometry [s]'] == 'none'
    peer.step(None, STILL)
    peer.silence('twist')
    peer.step(WRENCH, period=SECOND)
    peer.silence('wrench')
    peer.send_wrench([np.nan] * 6)
    peer.step(period=SECOND)
    figures = peer.report()[2]
    assert (figures['age of wrench [s]'], figures['age of odometry [s]']) == ('1.0', '2.0')


@pytest.mark.parametrize('namespace', ['', '/alpha'])
def test_one_status_per_second(start, namespace):
    """By itself the node publishes one stamped status, named after the whole node, each second."""
    node, peer = start(remap=f'__ns:={namespace or "/"}')
    received = []
    peer.create_subscription(DiagnosticArray, '/diagnostics', received.append, 10)
    peer.settle(WRENCH, STILL)
    peer.wait_until(lambda: any(array.status[0].level == b'\x00' for array in received),
                    'a report of the healthy state')
    (status,), stamp = received[-1].status, received[-1].header.stamp
    assert status.name == f'{namespace}/thrust_allocator: allocation'.lstrip('/')
    assert (status.hardware_id, status.message) == (namespace.strip('/'), 'allocating')
    assert all(isinstance(pair.value, str) for pair in status.values)
    assert abs(stamp.sec - node.get_clock().now().nanoseconds * 1e-9) < 60.0
    known = len(received)
    peer.wait_until(lambda: len(received) > known + 1, 'two more')
    stamps = [array.header.stamp.sec * SECOND + array.header.stamp.nanosec for array in received]
    assert (np.diff(stamps[-3:]) > 0.9 * SECOND).all()


def test_no_tick_is_needed_for_a_report(start):
    """In simulated time without a /clock there are no ticks, but there are diagnostics."""
    _, peer = start('use_sim_time:=true')
    received = []
    peer.create_subscription(DiagnosticArray, '/diagnostics', received.append, 10)
    peer.wait_until(lambda: len(received) > 1, 'two reports')
    assert not peer.ticks


def test_saturation(stepped):
    """The paper's test at 0.9 m/s: the tunnel is at its limit and heave is off by 29.6 N."""
    peer = stepped()
    wrench, twist = cruise(0.9, side=1.0)
    peer.step(wrench, twist)
    level, message, figures = peer.report()
    assert level == 'WARN' and message.startswith(
        'heave is off by 29.6 N (commanded 0 N) in 100% of the ticks: tunnel at its limit')
    assert figures['thrusters at a bound'] == 'tunnel'
    assert figures['unallocated force [N]'] == '29.56'
    assert figures['unallocated moment [N*m]'] == '0.23'
    peer.step(*cruise(0.3, side=1.0))
    assert peer.report_later()[:2] == ('OK', 'allocating')


def test_a_command_without_weight(stepped):
    """A command in a DOF of weight 0 is a WARN that names the DOF."""
    peer = stepped()
    peer.step([0.0, 30.0, 0.0, -5.0, 0.0, 0.0], STILL)
    level, message, _ = peer.report()
    assert level == 'WARN' and 'at its limit' not in message
    assert all(f'{dof} is commanded but not controlled' in message for dof in ('sway', 'roll'))
    peer.step([10.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert peer.report_later()[0] == 'OK'


@pytest.mark.parametrize('topic, kind', [('cmd_wrench', Wrench),
                                         ('thruster_setpoints', Float64MultiArray)])
def test_two_publishers(stepped, topic, kind):
    """A second publisher on a command topic is a WARN as long as it is there."""
    peer = stepped()
    peer.steps(2, WRENCH, STILL)
    assert peer.report()[0] == 'OK'
    second = peer.create_publisher(kind, topic, 1)
    peer.wait_until(lambda: peer.count_publishers(topic) == 2, 'the second publisher')
    peer.step()
    level, message, _ = peer.report()
    assert level == 'WARN' and message.startswith(f'2 publishers on {topic}: /')
    peer.destroy_publisher(second)
    peer.wait_until(lambda: peer.count_publishers(topic) == 1, 'its end')
    assert peer.report_later()[0] == 'OK'


def test_several_findings(stepped):
    """All that is wrong stands in the one line, and is logged when it comes and when it goes."""
    peer = stepped()
    peer.steps(50)
    level, message, _ = peer.report()
    assert level == 'WARN' and 'no wrench: zero setpoints' in message
    assert 'no odometry yet: using fallback_velocity' in message
    peer.steps(500, WRENCH, STILL)
    assert peer.report_later()[:2] == ('OK', 'allocating')
    for text in ('no wrench', 'no odometry'):
        peer.wait_until(lambda: len(peer.logged(text)) >= 2, f'the log of {text}')
        assert [line.split(':')[0] for line in peer.logged(text)] == ['WARN', 'INFO']


def test_a_brief_failure_is_reported(stepped, monkeypatch):
    """A single tick that OSQP did not solve still stands in the next report."""
    peer = stepped()
    peer.steps(2, WRENCH, STILL)
    solve = allocation_module.Solver.solve
    with monkeypatch.context() as patch:
        patch.setattr(allocation_module.Solver, 'solve', lambda self, *vectors: (
            'primal infeasible', solve(self, *vectors)[1]))
        peer.step()
    peer.steps(3)
    level, message, _ = peer.report()
    assert level == 'ERROR' and 'primal infeasible' in message
    assert peer.report_later()[0] == 'OK'


def test_no_error_while_stopped(stepped, monkeypatch):
    """Once the node is stopped, nothing is said of a solver that is not called any more."""
    peer = stepped()
    peer.steps(2, WRENCH, STILL)
    with monkeypatch.context() as patch:
        patch.setattr(allocation_module.Solver, 'solve',
                      lambda self, *vectors: ('primal infeasible', 1))
        peer.step()
    peer.enable(False)
    peer.step()
    assert peer.report_later()[:2] == ('WARN', 'disabled: zero setpoints')
