"""The process that stands for the rest of the vehicle while the node's cost is measured."""

from collections import deque
from collections.abc import Sequence
import json
import sys
import time

from geometry_msgs.msg import Wrench
from nav_msgs.msg import Odometry
import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray
from thrust_allocator.benchmark.ticks import mt2012, smooth_walk
from thrust_allocator.physics.frames import frd_signs
from thrust_allocator.ros.qos import INPUT, OUTPUT

DRIFT = 1.003  # from the period asked for, so that no phase of the node's own timer is kept
PATIENCE = 20.0  # longest wait for the first answer [s]
SETTLING = 0.5  # from the first answer to the measurement [s]
GAPS = {  # between one command and the next, in periods of the rate asked for
    'regular': (DRIFT, DRIFT), 'random': (0.5, 1.5), 'bursts': (0.0, 2.0)}
SAME = 1e-9  # of the command's surge, which tells one command from another [N]


class Driver(Node):
    """Sends odometry and command at a rate, and hears all that is published at every tick."""

    def __init__(self) -> None:
        super().__init__('driver')
        self._signs = frd_signs('flu')
        self._ticks = smooth_walk(mt2012(), 4000).ticks
        self._sent: deque[tuple[float, int]] = deque(maxlen=100)  # surge [N], system time [ns]
        self.count = 0  # commands sent
        self.delays: list[int] = []  # from a command to the setpoints that answer it [ns]
        self._arrival = 0  # of the newest setpoints, system time [ns]
        self._achieved = 0.0  # newest achieved surge [N]
        self._odometry, self._command = Odometry(), Wrench()
        self._odometry_publisher = self.create_publisher(Odometry, 'odom', INPUT)
        self._command_publisher = self.create_publisher(Wrench, 'cmd_wrench', INPUT)
        for kind, topic, callback in (
                (Float64MultiArray, 'thrust_limits', lambda message: None),
                (Float64MultiArray, 'thruster_setpoints', self._on_setpoints),
                (Wrench, 'achieved_wrench', self._on_achieved),
                (Wrench, 'unallocated_wrench', self._on_unallocated)):
            self.create_subscription(kind, topic, callback, OUTPUT)

    def send(self) -> None:
        """Send the next tick of the walk."""
        tick = self._ticks[self.count % len(self._ticks)]
        self.count += 1
        velocity = (self._signs * tick.velocity).tolist()
        linear, angular = self._odometry.twist.twist.linear, self._odometry.twist.twist.angular
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z = velocity
        wrench = (self._signs * tick.wrench).tolist()
        force, torque = self._command.force, self._command.torque
        force.x, force.y, force.z, torque.x, torque.y, torque.z = wrench
        self._odometry_publisher.publish(self._odometry)
        self._sent.append((force.x, time.time_ns()))
        self._command_publisher.publish(self._command)

    def _on_setpoints(self, message: Float64MultiArray, info: dict) -> None:
        self._arrival = info['received_timestamp']

    def _on_achieved(self, message: Wrench) -> None:
        self._achieved = message.force.x

    def _on_unallocated(self, message: Wrench) -> None:
        """Find the command that this tick answers, and note its delay the first time."""
        command = self._achieved + message.force.x
        for i, (surge, sent) in enumerate(self._sent):
            if abs(surge - command) < SAME:
                self.delays.append(self._arrival - sent)
                for _ in range(i + 1):  # what is older will not be answered any more
                    self._sent.popleft()
                return


def main(args: Sequence[str]) -> int:
    """
    Drive the node in this namespace; print the delays [ns].

    The command line has the rate [Hz], the time [s], and a key of GAPS.
    """
    rate, seconds, gaps = float(args[1]), float(args[2]), GAPS[args[3]]
    rclpy.init(args=[args[0], *args[4:]])
    driver, executor = Driver(), SingleThreadedExecutor()
    executor.add_node(driver)
    due = begin = time.monotonic()
    random = np.random.default_rng(1)

    def drive_until(enough: float) -> None:
        nonlocal due
        while time.monotonic() < enough:
            if time.monotonic() >= due:
                driver.send()
                due += random.uniform(*gaps) / rate
            else:
                executor.spin_once(timeout_sec=min(due, enough) - time.monotonic())

    while not driver.delays:
        if time.monotonic() - begin > PATIENCE:
            print('driver: no answer to any command', file=sys.stderr)
            return 1
        drive_until(time.monotonic() + 0.1)
    drive_until(time.monotonic() + SETTLING)
    print('measuring', flush=True)
    driver.delays.clear()
    drive_until(time.monotonic() + seconds)
    print(json.dumps(driver.delays), flush=True)
    rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv))
