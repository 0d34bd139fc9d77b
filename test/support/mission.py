"""A mission of several nodes, each a process of its own: how each of them ends, as heard here."""

import time
import uuid

from geometry_msgs.msg import Wrench
from nav_msgs.msg import Odometry
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64MultiArray
from support.processes import TIMEOUT

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

    def __init__(self, mission, launch, program):
        """Launch it; `program` is what follows `python` on the command line."""
        self.mission = mission
        self.namespace = f'/stop_{uuid.uuid4().hex}'
        mission.add(self.namespace)
        self.process = launch(
            *program, '--ros-args', '-r', f'__ns:={self.namespace}',
            '-p', 'wrench_timeout:=600.0')  # so that nothing but the end can bring zeros

    @property
    def setpoints(self):
        """Return all setpoints that were heard."""
        return self.mission.setpoints[self.namespace]

    def wait_until_allocating(self):
        """Wait until setpoints other than zero arrive."""
        def allocating():
            assert self.process.poll() is None, self.process.communicate()
            return self.setpoints and any(self.setpoints[-1])

        self.mission.wait_until(allocating, 'setpoints other than zero')

    def end(self, zeros=True, gone=True):
        """
        Wait for the end of the process and of its publishers, and check the last setpoints.

        :param zeros: whether zeros must come last, and came only then.
        :param gone: whether the process takes leave of the others.
        :return: exit status and the text on stderr.
        """
        self.mission.wait_until(lambda: self.process.poll() is not None, 'the end')
        _, stderr = self.process.communicate()
        if gone:
            self.mission.wait_until(
                lambda: not self.mission.count_publishers(f'{self.namespace}/thruster_setpoints'),
                'the end of its publishers')
        if zeros:
            self.mission.wait_until(lambda: not any(self.setpoints[-1]), 'zeros as the last ones')
            assert any(self.setpoints[-2]), 'there were zeros before the end'
        return self.process.returncode, stderr
