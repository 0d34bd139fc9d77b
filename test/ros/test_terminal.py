"""A terminal that does not read, and one that is gone: the ticks go on, and zeros come last."""

import fcntl
import os
import pty
import signal
import subprocess
import sys
import termios

from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from support.paths import ROOT
from support.processes import AMONG_PROCESSES, hear_hangups, NODE

SMALLEST_PIPE = 4096  # [bytes]
CHANGES = 120  # of a parameter, each a line of the log: more than the pipe holds


def test_nobody_reads_the_log(send_out, mission):
    """A pipe that nobody empties is full of log, and the setpoints come as before."""
    run = send_out(*NODE)
    fcntl.fcntl(run.process.stderr.fileno(), fcntl.F_SETPIPE_SZ, SMALLEST_PIPE)
    run.wait_until_allocating()
    client = AsyncParameterClient(mission, f'{run.namespace}/thrust_allocator')
    mission.wait_until(client.services_are_ready, 'the services')
    for i in range(CHANGES):
        answer = client.set_parameters([Parameter('wrench_timeout', value=600.0 + i)])
        mission.wait_until(answer.done, f'change {i}')
    heard = len(run.setpoints)
    mission.wait_until(lambda: len(run.setpoints) > heard + 50, 'setpoints as before')
    run.process.send_signal(signal.SIGTERM)
    status, stderr = run.end()
    assert status == 0
    assert 0 < stderr.count('wrench_timeout: ') < CHANGES - 1  # it really was full


def test_the_terminal_is_gone(mission, launch):
    """A lost SSH session: SIGHUP to a node whose terminal can be written to no more."""
    from support.mission import Run

    def take_terminal():
        hear_hangups()
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    ours, theirs = pty.openpty()
    processes = []

    def on_terminal(*arguments):
        processes.append(subprocess.Popen(
            [sys.executable, *map(str, arguments)], cwd=ROOT, env={**os.environ, **AMONG_PROCESSES},
            stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True,
            preexec_fn=take_terminal))
        return processes[-1]

    try:
        run = Run(mission, on_terminal, NODE)
        os.close(theirs)
        run.wait_until_allocating()
        os.close(ours)
        assert run.end()[0] == 0
    finally:
        processes[0].kill()
        processes[0].wait()
