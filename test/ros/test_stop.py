"""How the process ends by a signal, whenever it comes, as another process hears it."""

from pathlib import Path
import signal

import pytest
from support.mission import BREAKING
from support.processes import NODE

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
STOPS, TOGETHER = 20, 5  # nodes in all, and at a time


def test_twenty_stops_in_a_row(send_out):
    """
    Each of 20 nodes, stopped in full action by any signal, has zeros last and status 0.

    SIGALRM may end one after its zeros: Fast DDS 2.14 as built for PyPI waits for ever, now and
    then, if other nodes leave at the same time.
    """
    statuses = []
    for first in range(0, STOPS, TOGETHER):
        runs = [send_out(*NODE) for _ in range(TOGETHER)]
        for run in runs:
            run.wait_until_allocating()
        for i, run in enumerate(runs, first):
            run.process.send_signal(SIGNALS[i % len(SIGNALS)])
        for run in runs:
            status, stderr = run.end()
            assert (stderr.count('[ERROR]'), stderr.count('Traceback')) == (0, 0), stderr
            statuses.append(status)
    assert statuses.count(0) >= STOPS - 1
    assert set(statuses) <= {0, -signal.SIGALRM}


def test_the_last_zeros_are_waited_for(send_out):
    """After the zeros the node waits for acknowledgement, gets it, and lingers for the others."""
    run = send_out('-c', """
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
    perf_counter, monotonic_ns = node.time.perf_counter, node.time.monotonic_ns
    sleep = node.time.sleep

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


def test_a_middleware_that_does_not_end(send_out):
    """After the zeros, what hangs below Python has its time, and is then ended by SIGALRM."""
    run = send_out('-c', """
import ctypes, sys
from thrust_allocator.ros import node, process

process.PATIENCE = 1
node.ThrustAllocator.destroy_node = lambda _: ctypes.PyDLL(None).pause()
sys.exit(process.main())
""")
    run.wait_until_allocating()
    run.process.send_signal(signal.SIGTERM)
    assert run.end(gone=False)[0] == -signal.SIGALRM


def test_more_signals_during_the_stop(send_out):
    """Signals that come again and again until the process has ended change nothing."""
    run = send_out(*NODE)
    run.wait_until_allocating()

    def ended_by_now():
        for number in SIGNALS[:3]:  # a second SIGQUIT ends it as it does any process
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


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGHUP])
@pytest.mark.parametrize('place', [
    'process, "default_parameter_file"', 'rclpy, "init"',
    'allocation.AllocationProblem, "__init__"', 'node.ThrustAllocator, "create_service"',
    'process, "SingleThreadedExecutor"'])
def test_signals_during_the_start(send_out, place, number):
    """A signal before the first tick ends the start without a word too much, with status 0."""
    run = send_out('-c', BREAKING % f"""
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
