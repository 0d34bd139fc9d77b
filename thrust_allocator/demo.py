"""The paper's test on real ROS 2 topics: the default vehicle gathers speed and holds a pitch."""

import argparse
from collections.abc import Sequence
import os
import sys
import time

from geometry_msgs.msg import Wrench
from nav_msgs.msg import Odometry
import numpy as np
import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray
from thrust_allocator.parameters.file import default_parameter_file, NODE_NAME
from thrust_allocator.physics.frames import DOFS, frd_signs
from thrust_allocator.ros.messages import wrench_components
from thrust_allocator.ros.node import ThrustAllocator
from thrust_allocator.ros.qos import INPUT, OUTPUT

NAMESPACE = f'/{NODE_NAME}_demo'
SPEEDS = (0.3, 0.5, 0.7, 0.9, 1.2, 1.5, 1.8)  # [m/s]
DRAG = 40.0  # surge force that holds a speed, per speed squared [N*s^2/m^2]
PITCH = 50.0  # commanded moment, nose up [N*m]
PATIENCE = 5.0  # longest wait for the allocator's answer to one command [s]


class Cruise(Node):
    """Stands for the rest of the vehicle: sends speed and command, and hears the answer."""

    def __init__(self, message_frame: str) -> None:
        """Listen to the allocator, whose topics are in the axes of `message_frame`."""
        super().__init__('cruise')
        self._signs = frd_signs(message_frame)
        self._odometry, self._command = Odometry(), Wrench()
        self._odometry_publisher = self.create_publisher(Odometry, 'odom', INPUT)
        self._command_publisher = self.create_publisher(Wrench, 'cmd_wrench', INPUT)
        self._heard: dict[str, np.ndarray] = {}  # newest message by topic, wrenches in frd axes
        self._ticks: list[dict[str, np.ndarray]] = []  # all that was heard of one command
        for topic in ('thrust_limits', 'thruster_setpoints'):
            self.create_subscription(
                Float64MultiArray, topic,
                lambda message, topic=topic: self._heard.update({topic: np.array(message.data)}),
                OUTPUT)
        for topic in ('achieved_wrench', 'unallocated_wrench'):
            self.create_subscription(
                Wrench, topic,
                lambda message, topic=topic: self._on_wrench(topic, message), OUTPUT)

    def cruise(self, speed: float) -> None:
        """Move straight ahead at `speed`; ask for the surge that holds it, and for pitch."""
        self._odometry.twist.twist.linear.x = speed
        self._command.force.x = DRAG * speed**2  # surge has the same sign in both frames
        self._command.torque.y = self._signs[DOFS.index('pitch')] * PITCH
        self._ticks.clear()
        self._send()

    def answer(self) -> dict[str, np.ndarray] | None:
        """Return the last tick by topic once two in a row answer the command alike, or None."""
        if len(self._ticks) < 2:
            return None
        before, last = self._ticks[-2:]
        alike = all(np.allclose(before[topic], last[topic], rtol=0.0, atol=1e-6) for topic in last)
        return last if alike else None

    def _send(self) -> None:
        self._odometry_publisher.publish(self._odometry)
        self._command_publisher.publish(self._command)

    def _on_wrench(self, topic: str, message: Wrench) -> None:
        self._heard[topic] = self._signs * wrench_components(message)
        if topic == 'unallocated_wrench' and len(self._heard) == 4:  # the last one of a tick
            answered = self._heard['achieved_wrench'] + self._heard['unallocated_wrench']
            command = self._signs * wrench_components(self._command)
            if np.allclose(answered, command, rtol=0.0, atol=1e-6):
                self._ticks.append(dict(self._heard))
            self._send()  # as a vehicle does all the time


def main(args: Sequence[str] | None = None) -> int:
    """
    Print a table of thrusts against speed, each row as the running node answers.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0, or 1 if the node gave no answer.
    """
    argparse.ArgumentParser(
        prog='demo', description="Drive MT-2012 through the paper's test: surge to hold a speed, "
        'and 50 N*m of pitch. No other process can hear it.').parse_args(args and args[1:])
    # No live motor may hear this, whatever its vehicle is called
    os.environ.pop('ROS_LOCALHOST_ONLY', None)  # would override the next line
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'OFF'
    rclpy.init(args=['demo', '--ros-args', '-r', f'__ns:={NAMESPACE}',
                     '--params-file', str(default_parameter_file())])
    try:
        return _drive()
    except (KeyboardInterrupt, ExternalShutdownException):
        return 1
    finally:
        rclpy.try_shutdown()


def _drive() -> int:
    allocator = ThrustAllocator()
    cruise = Cruise(allocator.get_parameter('message_frame').value)
    executor = SingleThreadedExecutor()
    executor.add_node(allocator)
    executor.add_node(cruise)
    names = [thruster.name for thruster in allocator.vehicle.thrusters]
    print(f'{"v":>5}' + ''.join(f'{name:>9}' for name in names) + f'{"limit of":>10}{"pitch":>9}')
    print(f'{"m/s":>5}' + f'{"N":>9}' * len(names) + f'{"tunnel N":>10}{"N*m":>9}')
    for speed in SPEEDS:
        cruise.cruise(speed)
        deadline = time.monotonic() + PATIENCE
        while (tick := cruise.answer()) is None:
            executor.spin_once(timeout_sec=0.1)
            if time.monotonic() > deadline:
                print(f'demo: the allocator did not answer within {PATIENCE} s', file=sys.stderr)
                return 1
        upper = tick['thrust_limits'][len(names):]
        print(f'{speed:5.1f}' + ''.join(f'{thrust:9.2f}' for thrust in tick['thruster_setpoints'])
              + f'{upper[names.index("tunnel")]:10.2f}'
              + f'{tick["achieved_wrench"][DOFS.index("pitch")]:9.2f}', flush=True)
    allocator.stop()
    return 0


if __name__ == '__main__':
    sys.exit(main())
