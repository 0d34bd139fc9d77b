"""How the process ends: signals, crashes and a lost context, as another process hears it."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time
import uuid

from geometry_msgs.msg import Wrench
from nav_msgs.msg import Odometry
import pytest
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64MultiArray
from support.paths import ROOT
from support.peer import ros_context

DOMAIN = 1 + os.getpid() % 100
TIMEOUT = 30.0  # [s]
SIGNALS = (signal.SIGINT, signal.SIGTERM)
STOPS, TOGETHER = 20, 5  # nodes in all, and at a time
NODE = ('-m', 'thrust_allocator')

# A program that runs the node until the test sends SIGUSR1, and then breaks what is named
BREAKING = """
import os, signal, sys, threading
import rclpy
from thrust_allocator import inputs
from thrust_allocator.physics import bounds
from thrust_allocator.ros import node, process
from thrust_allocator.solve import osqp_solver as solver, problem as allocation

broken = threading.Event()
signal.signal(signal.SIGUSR1, lambda *_: broken.set())

def patch(owner, name, replacement):
    # Once the node is to break, replacement(original, *arguments) is called
    original = getattr(owner, name)
    setattr(owner, name, lambda *arguments: replacement(original, *arguments)
            if broken.is_set() else original(*arguments))

def fail(original, *arguments):
    raise ArithmeticError('broken on purpose')

%s
sys.exit(process.main())
"""


class Mission(Node):
    """Commands several allocators 100 times per second, and records their setpoints."""

    def __init__(self, context):
        """Command nobody yet."""
        super().__init__('mission', context=context)
        self.setpoints = {}  # lists of tuples [N], as received, by namespace
        self._inputs = []  # (publisher, message)
        self._wrench, self._odometry = Wrench(), Odometry()
        self._wrench.force.x, self._wrench.torque.y = 40.0, 50.0
        self._odometry.twist.twist.linear.x = 0.5
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self)
        self.create_timer(0.01, self._send, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def add(self, namespace):
        """Command the allocator in a namespace too, and listen to it reliably."""
        heard = self.setpoints[namespace] = []
        for topic, message in (('cmd_wrench', self._wrench), ('odom', self._odometry)):
            self._inputs.append((
                self.create_publisher(type(message), f'{namespace}/{topic}', 1), message))
        self.create_subscription(
            Float64MultiArray, f'{namespace}/thruster_setpoints',
            lambda message: heard.append(tuple(message.data)),
            QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE))

    def _send(self):
        for publisher, message in self._inputs:
            publisher.publish(message)

    def wait_until(self, condition, what):
        """Spin until a condition holds; `what` is said if it does not within TIMEOUT."""
        deadline = time.monotonic() + TIMEOUT
        while not condition():
            assert time.monotonic() < deadline, f'not within {TIMEOUT} s: {what}'
            self._executor.spin_once(timeout_sec=0.02)

    def close(self):
        """End the executor and this node."""
        self._executor.shutdown()
        self.destroy_node()


class Run:
    """One process with a node in a namespace of its own."""

    def __init__(self, mission, program):
        """Start it; `program` is what follows `python` on the command line."""
        self.mission = mission
        self._namespace = f'/stop_{uuid.uuid4().hex}'
        mission.add(self._namespace)
        environment = {**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
                       'ROS_DOMAIN_ID': str(DOMAIN)}
        self.process = subprocess.Popen(
            [sys.executable, *program, '--ros-args', '-r', f'__ns:={self._namespace}',
             '-p', 'wrench_timeout:=600.0'],  # so that nothing but the end can bring zeros
            cwd=ROOT, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    @property
    def setpoints(self):
        """Return all setpoints that were heard."""
        return self.mission.setpoints[self._namespace]

    def wait_until_allocating(self):
        """Wait until setpoints other than zero arrive."""
        def allocating():
            assert self.process.poll() is None, self.process.communicate()
            return self.setpoints and any(self.setpoints[-1])

        self.mission.wait_until(allocating, 'setpoints other than zero')

    def end(self, zeros=True):
        """
        Wait for the end of the process and of its publishers, and check the last setpoints.

        :param zeros: whether zeros must come last, and came only then.
        :return: exit status and the text on stderr.
        """
        self.mission.wait_until(lambda: self.process.poll() is not None, 'the end')
        _, stderr = self.process.communicate()
        self.mission.wait_until(
            lambda: not self.mission.count_publishers(f'{self._namespace}/thruster_setpoints'),
            'the end of its publishers')
        if zeros:
            self.mission.wait_until(lambda: not any(self.setpoints[-1]), 'zeros as the last ones')
            assert any(self.setpoints[-2]), 'there were zeros before the end'
        return self.process.returncode, stderr


@pytest.fixture
def mission(monkeypatch):
    """Return a mission in this process, heard on this machine only."""
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    with ros_context(domain_id=DOMAIN) as context:
        mission = Mission(context)
        yield mission
        mission.close()


@pytest.fixture
def launch(mission):
    """Return a function that starts a program as a Run; what still runs at the end is killed."""
    runs = []

    def run(*program):
        runs.append(Run(mission, program))
        return runs[-1]

    yield run
    for each in runs:
        each.process.kill()
        each.process.communicate()


@pytest.fixture
def breaking(launch):
    """Return a function that starts a node and has it broken in the middle of its work."""
    def run(change):
        run = launch('-c', BREAKING % change)
        run.wait_until_allocating()
        run.process.send_signal(signal.SIGUSR1)
        return run

    return run


def test_twenty_stops_in_a_row(launch):
    """Each of 20 nodes, stopped in full action by either signal, has zeros last and status 0."""
    for first in range(0, STOPS, TOGETHER):
        runs = [launch(*NODE) for _ in range(TOGETHER)]
        for run in runs:
            run.wait_until_allocating()
        for i, run in enumerate(runs, first):
            run.process.send_signal(SIGNALS[i % 2])
        for run in runs:
            status, stderr = run.end()
            assert (status, stderr.count('[ERROR]'), stderr.count('Traceback')) == (0, 0, 0), stderr


def test_the_last_zeros_are_waited_for(launch):
    """After the zeros the node waits for acknowledgement, gets it, and lingers for the others."""
    run = launch('-c', """
from rclpy.publisher import Publisher
import sys
from thrust_allocator.ros import node, process

def told(owner, name, word):
    original = getattr(owner, name)
    def call(*arguments):
        result = original(*arguments)
        print(word(arguments, result), file=sys.stderr)
        return result
    setattr(owner, name, call)

class Time:  # the module time as the node sees it
    perf_counter, sleep = node.time.perf_counter, node.time.sleep

told(Publisher, 'wait_for_all_acked',
     lambda own, result: f'acknowledged {own[0].topic.split("/")[-1]} {result}')
node.time = Time()
told(node.time, 'sleep', lambda own, result: f'lingered {own}')
sys.exit(process.main())
""")
    run.wait_until_allocating()
    run.process.send_signal(signal.SIGTERM)
    status, stderr = run.end()
    said = [line for line in stderr.splitlines() if not line.startswith(('[WARN]', '[INFO]'))]
    assert (status, said) == (0, ['acknowledged thruster_setpoints True', 'lingered (0.1,)'])


def test_more_signals_during_the_stop(launch):
    """Signals that come again and again until the process has ended change nothing."""
    run = launch(*NODE)
    run.wait_until_allocating()

    def ended_by_now():
        for number in SIGNALS:
            run.process.send_signal(number)
        return run.process.poll() is not None

    run.mission.wait_until(ended_by_now, 'the end')
    status, stderr = run.end()
    assert status == 0 and 'Traceback' not in stderr


def test_an_interrupt_that_osqp_keeps_to_itself(breaking):
    """When OSQP reports a SIGINT as its status, zeros come last and the exit status is 0."""
    run = breaking('patch(solver.Solver, "solve", lambda *_: ("interrupted", 1))')
    status, stderr = run.end()
    assert status == 0 and 'Traceback' not in stderr


def test_an_interrupt_in_the_middle_of_a_solve(breaking):
    """A SIGINT while OSQP really works, on what it cannot finish, stops like any other."""
    run = breaking("""
def endless(original, self, *arguments):
    broken.clear()
    self._osqp.update_settings(max_iter=2**31 - 1, check_termination=0)
    print("in OSQP", file=sys.stderr)
    return original(self, *arguments)
patch(solver.Solver, "solve", endless)""")
    while (line := run.process.stderr.readline()) != 'in OSQP\n':
        assert line, 'the process has ended'
    stat = Path(f'/proc/{run.process.pid}/stat')

    def cpu():
        """Return the CPU time of the process in user mode, in ticks."""
        return int(stat.read_text().rsplit(')', 1)[1].split()[11])

    before = cpu()
    run.mission.wait_until(lambda: cpu() > before + 5, 'work')
    run.process.send_signal(signal.SIGINT)
    status, stderr = run.end()
    assert status == 0 and 'Traceback' not in stderr


@pytest.mark.parametrize('place', [
    'allocation.AllocationProblem, "solve"', 'bounds.ThrustBounds, "__call__"',
    'inputs.Inputs, "accept_wrench"', 'node.ThrustAllocator, "_report"',
    'node.ThrustAllocator, "_publish"'])
def test_an_exception_in_a_callback(breaking, place):
    """After an exception, wherever it comes from, zeros come last and the status is not 0."""
    status, stderr = breaking(f'patch({place}, fail)').end()
    assert status == 1
    assert 'Traceback' in stderr
    assert stderr.rstrip().endswith('ArithmeticError: broken on purpose')


@pytest.mark.parametrize('change', [
    'threading.Thread(target=lambda: broken.wait() and rclpy.shutdown(), daemon=True).start()',
    'patch(inputs.Inputs, "accept_wrench", lambda *_: rclpy.try_shutdown())',
    'patch(allocation.AllocationProblem, "solve",'
    ' lambda original, *arguments: (rclpy.try_shutdown(), original(*arguments))[1])',
    'patch(node.ThrustAllocator, "_report",'
    ' lambda original, *arguments: (rclpy.try_shutdown(), original(*arguments))[1])',
], ids=['in a thread', 'between ticks', 'in a tick', 'in a report'])
def test_a_context_shut_down_from_outside(breaking, change):
    """Without a context no zeros can go out: one line says so and the exit status is 1."""
    status, stderr = breaking(change).end(zeros=False)
    said = [line for line in stderr.splitlines() if not line.startswith(('[WARN]', '[INFO]'))]
    assert status == 1
    assert said == ['thrust_allocator: the ROS context was shut down from outside: '
                    'the last setpoints stand'], stderr


@pytest.mark.parametrize('number', SIGNALS)
@pytest.mark.parametrize('place', [
    'process, "default_parameter_file"', 'rclpy, "init"',
    'allocation.AllocationProblem, "__init__"', 'node.ThrustAllocator, "create_service"',
    'process, "SingleThreadedExecutor"'])
def test_signals_during_the_start(launch, place, number):
    """A signal before the first tick ends the start without a word too much, with status 0."""
    run = launch('-c', BREAKING % f"""
def signalled(original, *arguments, **options):
    os.kill(os.getpid(), {int(number)})
    return original(*arguments, **options)
def patch_always(owner, name):
    original = getattr(owner, name)
    setattr(owner, name, lambda *a, **b: signalled(original, *a, **b))
patch_always({place})""")
    status, stderr = run.end(zeros=False)
    assert status == 0
    assert all(line.startswith('[WARN]') for line in stderr.splitlines()), stderr
    assert not any(map(any, run.setpoints))
