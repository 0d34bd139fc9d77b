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
SUBJECTS = ('thrust_allocator', 'relay', 'relay, same tricks')
CONTROLLERS = (0.2, 0.5, 0.66, 1.0, 1.5)  # times the node's rate
SECONDS = 4.0  # of one run
REPEATS = 5  # node, relays, node, relays, ...
PATIENCE = 40.0  # longest time for the processes to start and stop [s]


class Run(NamedTuple):
    """What was measured of one process."""

    load: float  # share of one core
    delay: np.ndarray  # from a command to the setpoints that answer it [ms]


class NodeError(Exception):
    """A process that did not do what it was started for."""


def run(subject: str, rate: float, seconds: float, commands: float,
        manner: str = 'regular') -> Run:
    """
    Start a subject and a driver, on topics that nobody else hears, and measure the subject.

    :param rate: of the subject [Hz].
    :param commands: per second; `manner` is a key of the driver's GAPS.
    """
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
            node = start('subject', subject, '--ros-args', '-p', f'rate:={rate}')
            _check_wiring(set(json.loads(_line(node))))
            driver = start('driver', str(commands), str(seconds), manner)
            _line(driver)
            begin, used = time.monotonic(), _processor_time(node.pid)
            delays = json.loads(_line(driver))
            seconds, used = time.monotonic() - begin, _processor_time(node.pid) - used
        finally:
            watchdog.cancel()
            for process in started:
                process.kill()
                process.communicate()
    return Run(used / seconds, np.array(delays) / 1e6)


_WIRING: set[str] = set()  # of the first subject


def _check_wiring(wiring: set[str]) -> None:
    """Compare with the first subject: a relay that does less is none to compare with."""
    if not _WIRING:
        _WIRING.update(wiring)
    if differing := _WIRING ^ wiring:
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


def compare(rate: float, seconds: float, repeats: int) -> list[Sequence[str]]:
    """Measure node and relays in turn, and return a row of the table for each."""
    runs: dict[str, list[Run]] = {subject: [] for subject in SUBJECTS}
    for _ in range(repeats):
        for subject in SUBJECTS:
            runs[subject].append(run(subject, rate, seconds, rate))
    base = np.array([one.load for one in runs['relay']])
    rows = []
    for subject, measured in runs.items():
        loads = np.array([one.load for one in measured])
        rows.append((subject, f'{rate:g}', f'{np.median(loads):.1%}',
                     f'{loads.min():.1%} to {loads.max():.1%}', f'{np.median(loads / base):.2f}',
                     *_quantiles(measured)))
    return rows


def answers(rate: float, seconds: float) -> list[Sequence[str]]:
    """Measure how fast the node answers controllers of other rates, a row of the table for each."""
    rows = [(f'{share:g} of the rate', f'{rate:g}', *_quantiles([
        run('thrust_allocator', rate, seconds, share * rate)])) for share in CONTROLLERS]
    return rows + [(words, f'{rate:g}', *_quantiles([
        run('thrust_allocator', rate, seconds, rate, manner)])) for words, manner in (
            ('at random times, half a period apart or more', 'random'),
            ('at random times', 'bursts'))]


def _quantiles(measured: Sequence[Run]) -> tuple[str, str]:
    """Return p50 and p99 of the delay, medians over the runs [ms]."""
    return tuple(f'{np.median([np.quantile(one.delay, share) for one in measured]):.2f}'
                 for share in (0.5, 0.99))


def report(quick: bool = False) -> None:
    """Measure, and print the tables."""
    print('\n## The node as a process, MT-2012\n')
    if missing := [package for package in ('rclpy', 'nav_msgs') if find_spec(package) is None]:
        print(f'missing: {", ".join(missing)}; the extra is `jazzy`')
        return
    seconds, repeats = (1.5, 1) if quick else (SECONDS, REPEATS)
    rates = RATES[1:2] if quick else RATES
    print(f'Each {repeats} times {seconds:g} s, in turn; medians. The driver is another process.\n'
          'The delay is from publishing a command to receiving the setpoints that answer it.\n',
          flush=True)
    try:
        rows = [row for rate in rates for row in compare(rate, seconds, repeats)]
        print(table(('process', 'rate, Hz', 'CPU, of a core', 'from, to', '/ relay',
                     'delay p50, ms', 'p99'), rows), flush=True)
        print('\nThe node with controllers of other rates than its own, once each. A command '
              'within\nhalf a period of the last that was answered waits until that is over.\n')
        rows = [row for rate in rates for row in answers(rate, seconds)]
        print(table(('commands', 'rate, Hz', 'delay p50, ms', 'p99'), rows), flush=True)
    except NodeError as error:
        print(f'failed: {error}')
