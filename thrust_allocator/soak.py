"""A soak: the node as its own process at a high rate for as long as asked, and what it cost."""

import argparse
from collections.abc import Sequence
import math
import os
from pathlib import Path
import signal
import subprocess
import sys
import time
import uuid

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Wrench
from nav_msgs.msg import Odometry
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray
from thrust_allocator.benchmark.stalls import Gaps, Watch
from thrust_allocator.parameters.file import NODE_NAME
from thrust_allocator.ros.qos import INPUT, OUTPUT

MINUTE = 60.0  # [s]
PATIENCE = 20.0  # longest wait for the first messages, and for the end of the process [s]
LARGEST_GROWTH = 1.0  # of memory after the first minute [MiB]
LARGEST_LATE = 0.1  # share of late ticks [%]
LONGEST_GAP = 50.0  # between setpoints [ms]


class Soak(Node):
    """Drives the allocator with a changing wrench and velocity, and keeps count of its answers."""

    def __init__(self, rate: float, process: int) -> None:
        """Send wrench and odometry `rate` times per second [Hz] to a node that is a process."""
        super().__init__('soak')
        self.setpoints = 0  # received
        self.gaps = 0  # of them longer than LONGEST_GAP after the one before
        self.worst_gap = 0.0  # [ms]
        self.ticks = self.late = 0  # as the node counts them
        self.worst_tick = 0.0  # as the node measures it [ms]
        self._last: float | None = None  # when setpoints came last [s]
        self.worst = Gaps()
        self._watch = Watch(process)
        self._facts = self._watch.read()  # when setpoints came last
        self._begun = time.monotonic()
        self._wrench, self._odometry = Wrench(), Odometry()
        self._wrench_publisher = self.create_publisher(Wrench, 'cmd_wrench', INPUT)
        self._odometry_publisher = self.create_publisher(Odometry, 'odom', INPUT)
        self.create_subscription(
            Float64MultiArray, 'thruster_setpoints', self._on_setpoints, OUTPUT)
        self.create_subscription(DiagnosticArray, '/diagnostics', self._on_diagnostics, 10)
        self.create_timer(1.0 / rate, self._send, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _send(self) -> None:
        """Send a wrench partly out of reach, and a velocity at which the bounds move."""
        now = time.monotonic()
        force, torque = self._wrench.force, self._wrench.torque
        force.x, force.z = 150.0 * math.sin(now), 60.0 * math.sin(0.7 * now)
        torque.y, torque.z = 80.0 * math.sin(1.3 * now), 40.0 * math.sin(0.3 * now)
        velocity = self._odometry.twist.twist
        velocity.linear.x, velocity.linear.z = 1.0 + math.sin(0.2 * now), 0.3 * math.sin(0.5 * now)
        velocity.angular.y = 0.2 * math.sin(0.9 * now)
        self._odometry_publisher.publish(self._odometry)
        self._wrench_publisher.publish(self._wrench)

    def _on_setpoints(self, message: Float64MultiArray) -> None:
        now = time.monotonic()
        if self._last is not None:
            gap = 1e3 * (now - self._last)
            self.worst_gap = max(self.worst_gap, gap)
            self.gaps += gap > LONGEST_GAP
        facts = self._watch.read()
        if self._last is not None and facts and self._facts:
            self.worst.note(gap, (now - self._begun) / MINUTE, facts.since(self._facts))
        self._last, self._facts = now, facts
        self.setpoints += 1

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            figures = {pair.key: pair.value for pair in status.values}
            self.ticks += int(figures['ticks'])
            self.late += int(figures['ticks late'])
            self.worst_tick = max(self.worst_tick, float(figures['tick time, worst [ms]']))

    def report(self, minutes: float, memory: float, growth: float | None) -> str:
        """Return a line of figures so far; `minutes` since the start, memory in MiB."""
        grown = 'n/a' if growth is None else f'{growth:+.2f} MiB'
        return (f'{minutes:6.2f} min: memory {memory:.2f} MiB, growth since the first minute '
                f'{grown}; {self.setpoints} setpoints, worst gap {self.worst_gap:.1f} ms, '
                f'{self.gaps} above {LONGEST_GAP:g} ms; {self.ticks} ticks, {self.late} late '
                f'({self.late_share:.3f} %), worst tick {self.worst_tick:.2f} ms')

    @property
    def late_share(self) -> float:
        """Return the late ticks' share [%]."""
        return 100.0 * self.late / max(self.ticks, 1)


def main(args: Sequence[str] | None = None) -> int:
    """
    Run the soak and print its figures.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0 if memory, late ticks and gaps stay within their limits, else 1.
    """
    parser = argparse.ArgumentParser(
        prog='soak', description='Run the node for a long time, and report its memory, its gaps '
        'and its late ticks. MT-2012; on this machine only.')
    parser.add_argument('--rate', type=_positive, default=200.0, help='ticks per second (200)')
    parser.add_argument('--minutes', type=_positive, default=10.0, help='how long (10)')
    options = parser.parse_args(None if args is None else args[1:])
    os.environ.pop('ROS_LOCALHOST_ONLY', None)  # would override the next line
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)
    ros = ['--ros-args', '-r', f'__ns:=/soak_{uuid.uuid4().hex}', '-r', '/diagnostics:=diagnostics']
    interrupts: list[int] = []  # a flag, so that no moment is bad for leaving no node behind
    signal.signal(signal.SIGINT, lambda number, _: interrupts.append(number))
    rclpy.init(args=['soak', *ros], signal_handler_options=SignalHandlerOptions.NO)
    child = subprocess.Popen([sys.executable, '-m', NODE_NAME, *ros, '--log-level', 'error',
                              '-p', f'rate:={options.rate}'])
    try:
        complaints = _run(Soak(options.rate, child.pid), child, options.minutes, interrupts)
    finally:
        child.terminate()
        try:
            status = child.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            child.kill()
            status = child.wait()
        rclpy.try_shutdown()
    complaints += [f'the node ended with status {status}'] if status else []
    print(f'soak: failed: {"; ".join(complaints)}' if complaints else 'soak: passed')
    return 1 if complaints else 0


def _run(soak: Soak, child: subprocess.Popen, minutes: float,
         interrupts: list[int]) -> list[str]:
    """Drive the node, report every minute and at the end, and return what was wrong."""
    executor = SingleThreadedExecutor()
    executor.add_node(soak)
    begun = time.monotonic()
    while not (soak.setpoints and soak.ticks):
        executor.spin_once(timeout_sec=0.1)
        if interrupts:
            return ['it was interrupted']
        if child.poll() is not None or time.monotonic() > begun + PATIENCE:
            return ['the node was not heard']
    begun = time.monotonic()
    first: float | None = None  # memory after the first minute [MiB]
    growth: float | None = None
    for end in [*(minute * MINUTE for minute in range(1, math.ceil(minutes))), minutes * MINUTE]:
        while time.monotonic() < begun + end:
            executor.spin_once(timeout_sec=0.1)
            if interrupts:
                return ['it was interrupted']
            if child.poll() is not None:
                return ['the node ended by itself']
        memory = _memory(child.pid)
        growth = None if first is None else memory - first
        print(soak.report(end / MINUTE, memory, growth), flush=True)
        first = memory if first is None else first
    print(*soak.worst.lines(), sep='\n', flush=True)
    complaints = []
    if growth is not None and growth >= LARGEST_GROWTH:
        complaints.append(f'memory grew by {growth:.2f} MiB after the first minute')
    if not soak.ticks or soak.late_share > LARGEST_LATE:
        complaints.append(f'{soak.late} of {soak.ticks} ticks were late')
    if soak.gaps:
        complaints.append(f'{soak.gaps} gaps between setpoints above {LONGEST_GAP:g} ms')
    return complaints


def _memory(process: int) -> float:
    """Return the resident memory of a process [MiB]."""
    pages = int(Path(f'/proc/{process}/statm').read_text().split()[1])
    return pages * os.sysconf('SC_PAGE_SIZE') / 2**20


def _positive(text: str) -> float:
    number = float(text)
    if not 0.0 < number < math.inf:
        raise argparse.ArgumentTypeError(f'is {text}, must be a number above 0')
    return number


if __name__ == '__main__':
    sys.exit(main())
