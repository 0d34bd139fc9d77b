"""The soak command: a short run of it, and what it says of figures that are too bad."""

import os
from pathlib import Path
import re
import signal

import pytest
from support.processes import run, TIMEOUT

SOAK = ('-m', 'thrust_allocator.soak')
FIGURES = re.compile(
    r' +([0-9.]+) min: memory ([0-9.]+) MiB, growth since the first minute n/a; (\d+) setpoints, '
    r'worst gap ([0-9.]+) ms, \d+ above 50 ms; (\d+) ticks, \d+ late \([0-9.]+ %\), '
    r'worst tick ([0-9.]+) ms')


def test_a_short_soak_prints_its_figures():
    """Three seconds give a line of sensible figures, a verdict and the exit status to it."""
    done = run(*SOAK, '--rate', '20', '--minutes', '0.05')
    figures, *gaps, verdict = done.stdout.splitlines()
    assert len(gaps) == 5
    lengths = [float(re.match(r'gap of (\S+) ms at \S+ min: the node ran \d+\.\d ms', gap)[1])
               for gap in gaps]
    assert lengths == sorted(lengths, reverse=True)
    match = FIGURES.fullmatch(figures)
    assert match, figures
    assert all(float(figure) > 0.0 for figure in match.groups()), figures
    assert float(match[1]) == 0.05
    # 50 ms between ticks at 20 Hz: whether some are longer is left to the machine
    assert verdict == 'soak: passed' if done.returncode == 0 else (
        done.returncode == 1 and re.fullmatch('soak: failed: .*', verdict)), done
    assert done.stderr == ''


@pytest.mark.parametrize('arguments, said', [
    (('--rate', 'fast'), 'argument --rate: '), (('--rate', '0'), 'must be a number above 0'),
    (('--minutes', '-1'), 'must be a number above 0'), (('--hours', '1'), 'unrecognized')])
def test_mistakes_on_the_command_line(arguments, said):
    """A wrong option is refused before anything starts."""
    done = run(*SOAK, *arguments)
    assert (done.returncode, done.stdout) == (2, '')
    assert said in done.stderr and 'Traceback' not in done.stderr


def test_a_node_that_cannot_start_fails_the_soak():
    """A rate that the node refuses ends the soak with the node's own line and status 1."""
    done = run(*SOAK, '--rate', '2000')
    assert done.returncode == 1
    assert done.stderr.startswith('thrust_allocator: rate: is 2000.0, must be')
    assert done.stdout == ('soak: failed: the node was not heard; the node ended with '
                           'status 1\n')


def test_an_interrupted_soak_leaves_no_node_behind(launch):
    """SIGINT ends the soak and its node, with a sentence and status 1."""
    soak = launch(*SOAK, '--minutes', '0.05', '--rate', '20')
    children = Path(f'/proc/{soak.pid}/task/{soak.pid}/children')
    while not children.read_text():
        assert soak.poll() is None, soak.communicate()
    node = int(children.read_text())
    soak.send_signal(signal.SIGINT)
    stdout, stderr = soak.communicate(timeout=TIMEOUT)
    assert (soak.returncode, 'it was interrupted' in stdout) == (1, True), (stdout, stderr)
    with pytest.raises(ProcessLookupError):
        os.kill(node, 0)
