"""Python programs as processes of their own, which hear each other and nobody else."""

from collections.abc import Iterator
from contextlib import contextmanager
import os
import signal
import subprocess
import sys

import pytest
import rclpy
from support.paths import ROOT
from support.peer import ros_context

DOMAIN = 1 + os.getpid() % 100
AMONG_PROCESSES = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(DOMAIN)}
NODE = ('-m', 'thrust_allocator')
TIMEOUT = 30.0  # [s]


def start(*arguments: object, **environment: str) -> subprocess.Popen:
    """Start `python *arguments`; what it says is to be read from its pipes."""
    return subprocess.Popen(
        [sys.executable, *map(str, arguments)], cwd=ROOT, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, env={**os.environ, **AMONG_PROCESSES, **environment},
        preexec_fn=hear_hangups)


def hear_hangups() -> None:
    """Undo a SIGHUP that is ignored, as it is in what a CI or nohup has started."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def end(process: subprocess.Popen) -> None:
    """Kill a process, if it still runs, and forget what it had to say."""
    with process:
        process.kill()


def run(*arguments: object, **environment: str) -> subprocess.CompletedProcess:
    """Run `python *arguments` to its end."""
    process = start(*arguments, **environment)
    try:
        stdout, stderr = process.communicate(timeout=2.0 * TIMEOUT)
    finally:
        end(process)
    return subprocess.CompletedProcess(process.args, process.returncode, stdout, stderr)


@contextmanager
def context_among_processes(*arguments: str) -> Iterator[rclpy.Context]:
    """Open a Context in this process that the started ones can be heard from."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
        with ros_context(*arguments, domain_id=DOMAIN) as context:
            yield context
