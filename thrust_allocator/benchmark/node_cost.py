"""What the node costs as a process, beside a bare relay with the same wiring."""

from collections.abc import Sequence
from importlib.util import find_spec
import json
import os
import subprocess
import sys
import tempfile
from threading import Timer
import time
from typing import NamedTuple
import uuid

import numpy as np
from thrust_allocator.markdown import table

RATES = (50.0, 100.0, 200.0)  # [Hz]
EXECUTORS = ('SingleThreadedExecutor', 'EventsExecutor')
SUBJECTS = ('thrust_allocator', 'relay')
SECONDS = 8.0  # of one run
REPEATS = 3  # node, relay, node, relay, ...
PATIENCE = 40.0  # longest time for the processes to start and stop [s]


class Run(NamedTuple):
    """What was measured of one process."""

    processor: float  # time per tick [us]
    load: float  # share of one core
    tick: np.ndarray  # from the timer's callback to the last publish [us]
    delay: np.ndarray  # from a command to the setpoints that answer it [us]


class NodeError(Exception):
    """A process that did not do what it was started for."""


def run(subject: str, executor: str, rate: float, seconds: float) -> Run:
    """Start a subject and a driver, on topics that nobody else hears, and measure the subject."""
    namespace = ['--ros-args', '-r', f'__ns:=/benchmark_{uuid.uuid4().hex}']
    with tempfile.TemporaryDirectory(prefix='thrust_allocator_benchmark_') as logs:
        environment = {**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
                       'ROS_DOMAIN_ID': str(1 + os.getpid() % 100), 'ROS_LOG_DIR': logs}
        environment.pop('ROS_LOCALHOST_ONLY', None)  # would override the range
        started: list[subprocess.Popen] = []
        watchdog = Timer(PATIENCE + seconds, lambda: [process.kill() for process in started])
        watchdog.start()

        def start(module: str, *arguments: str) -> subprocess.Popen:
            started.append(subprocess.Popen(
                [sys.executable, '-m', f'thrust_allocator.benchmark.{module}', *arguments,
                 *namespace], env=environment, text=True, stdout=subprocess.PIPE,
                stderr=subprocess.PIPE))
            return started[-1]

        try:
            node = start('subject', subject, executor, '-p', f'rate:={rate}')
            _check_wiring((executor, rate), set(json.loads(_line(node))))
            driver = start('driver', str(rate), str(seconds))
            _line(driver)
            begin, used = time.monotonic(), _processor_time(node.pid)
            delays = json.loads(_line(driver))
            seconds, used = time.monotonic() - begin, _processor_time(node.pid) - used
            node.terminate()
            ticks = np.array(json.loads(_line(node))[-round(seconds * rate):]) / 1e3
        finally:
            watchdog.cancel()
            for process in started:
                process.kill()
                process.communicate()
    return Run(used * 1e6 / (seconds * rate), used / seconds, ticks, np.array(delays) / 1e3)


_WIRING: dict[tuple[str, float], set[str]] = {}  # of the first subject, by executor and rate


def _check_wiring(key: tuple[str, float], wiring: set[str]) -> None:
    """Compare with the subject before: a relay that does less is none to compare with."""
    if differing := _WIRING.setdefault(key, wiring) ^ wiring:
        raise NodeError(f'only one of the node and its relay has: {", ".join(sorted(differing))}; '
                        'thrust_allocator/benchmark/subject.py must follow the node')


def _line(process: subprocess.Popen) -> str:
    line = process.stdout.readline()
    if not line:
        raise NodeError(process.communicate()[1].strip() or 'a process ended, or did not')
    return line


def _processor_time(pid: int) -> float:
    """Return what a process has used of all cores so far, user and system together [s]."""
    return time.clock_gettime((~pid << 3) | 2)  # its clock id, as clock_getcpuclockid(3) forms it


def compare(executor: str, rate: float, seconds: float, repeats: int) -> list[tuple[str, ...]]:
    """Measure node and relay in turn, and return a row of the table for each."""
    runs: dict[str, list[Run]] = {subject: [] for subject in SUBJECTS}
    for _ in range(repeats):
        for subject in SUBJECTS:
            runs[subject].append(run(subject, executor, rate, seconds))
    base = np.median([one.processor for one in runs['relay']])
    rows = []
    for subject, measured in runs.items():
        costs = [one.processor for one in measured]
        tick, delay = (np.concatenate([getattr(one, name) for one in measured])
                       for name in ('tick', 'delay'))
        rows.append((
            subject, executor, f'{rate:g}', f'{np.median(costs):.0f}',
            f'{min(costs):.0f} to {max(costs):.0f}', f'{np.median(costs) / base:.2f}',
            f'{np.median([one.load for one in measured]):.1%}',
            *(f'{np.quantile(tick, share):.0f}' for share in (0.5, 0.99)),
            *(f'{np.quantile(delay, share) / 1e3:.1f}' for share in (0.5, 0.99))))
    return rows


def report(quick: bool = False) -> None:
    """Measure, and print the table."""
    print('\n## The node as a process, MT-2012\n')
    if missing := [package for package in ('rclpy', 'nav_msgs') if find_spec(package) is None]:
        print(f'missing: {", ".join(missing)}; the extra is `jazzy`')
        return
    seconds, repeats = (1.0, 1) if quick else (SECONDS, REPEATS)
    print(f'Each {repeats} times {seconds:g} s, node and relay in turn. Odometry and command come\n'
          'from another process at the same rate, at every phase of the period alike. The tick is\n'
          "from the timer's callback to the last publish; the delay is from a command to the\n"
          'setpoints that answer it, and half a period of it on average is waiting for the tick.\n',
          flush=True)
    rows: list[Sequence[str]] = []
    try:
        for executor in EXECUTORS:
            for rate in RATES[1:2] if quick else RATES:
                rows += compare(executor, rate, seconds, repeats)
    except NodeError as error:
        print(f'failed: {error}')
    if rows:
        print(table(
            ('process', 'executor', 'rate, Hz', 'CPU per tick, µs', 'from, to', '/ relay',
             'of a core', 'tick p50, µs', 'p99', 'delay p50, ms', 'p99'), rows), flush=True)
