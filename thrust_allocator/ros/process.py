"""The node's process: command line, signals and exit status."""

from collections.abc import Sequence
from contextlib import ExitStack
import gc
from pathlib import Path
import re
import signal
import sys
import tempfile
import warnings

import rclpy
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from thrust_allocator.parameters.file import default_parameter_file, NODE_NAME, read_files
from thrust_allocator.parameters.grammar import Grammar
from thrust_allocator.parameters.guesses import marked_guesses
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.ros.command_line import CommandLine, read_command_line, unknown_option, USAGE
from thrust_allocator.ros.console import unblocked
from thrust_allocator.ros.ending import ending_signals
from thrust_allocator.ros.node import ThrustAllocator
from thrust_allocator.ros.parameters import Start

PATIENCE = 5  # [s] with a middleware that does not end, then SIGALRM ends the process


def main(args: Sequence[str] | None = None) -> int:
    """
    Run the node until SIGINT, SIGTERM, SIGHUP or SIGQUIT.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0 after a signal, 1 for a mistake in the parameters or on the command
        line, or if the context was shut down from outside, so that no last zeros could be
        published. A middleware that does not end is given PATIENCE, then SIGALRM ends the process.
    """
    args = list(sys.argv if args is None else args)
    with ending_signals() as signals, unblocked() as consoles:
        try:
            line = read_command_line(args)
            if line.help:
                print(USAGE, flush=True)
                return 0
            default = '' if line.files else str(default_parameter_file())
            if default:
                args[1:1] = ['--ros-args', '--params-file', default, '--']
            node = _start(args, line, line.files or [default])
        except (ParameterError, ParameterException, NameValidationException,
                RuntimeError) as error:
            print(f'{NODE_NAME}: {_sentence(error)}', file=sys.stderr)
            rclpy.try_shutdown()
            return 1
        if default:
            node.get_logger().warning(f'no parameter file given: running MT-2012 from {default}')
        node.reporter.lost_lines = lambda: sum(console.lost for console in consoles)
        return _run(node, signals)


def _run(node: ThrustAllocator, signals: Sequence[int]) -> int:
    """Spin until a signal has come, publish the last zeros, and return the exit status."""
    # What the start has left is not looked through again when live changes call for a collection
    gc.collect()
    gc.freeze()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        while not signals and not node.interrupted:
            executor.spin_once()  # the node's timers wake it several times per second
    except Exception:  # of nearly any type if the context is gone: even a publisher complains
        if rclpy.ok():
            raise
    finally:
        if alive := rclpy.ok():
            node.stop()
        # Some builds of Fast DDS 2.14 wait for ever if others leave at that moment (its issue 6513)
        signal.alarm(PATIENCE)
        node.destroy_node()
        signal.alarm(0)
        rclpy.try_shutdown()
    if not alive:
        print(f'{NODE_NAME}: the ROS context was shut down from outside: the last setpoints stand',
              file=sys.stderr)
    return 0 if alive else 1


def _start(args: list[str], line: CommandLine, files: Sequence[str]) -> ThrustAllocator:
    """Return the node; what rcl reads of the files counts, our own reading explains it."""
    with ExitStack() as stack:
        copies = _copies(files, stack)
        try:
            grammar, mistake = read_files(files, copies), None
        except ParameterError as error:
            grammar, mistake = Grammar(), error
        _initialise([copies.get(word, word) for word in args], line, mistake)
        guesses = {file: marked_guesses(copies.get(file, file)) for file in files}
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')  # of rclpy, about what a node that cannot start leaves
        # rcl drops a value from the command line if a file gives one of another type
        node = ThrustAllocator(start=Start(grammar, line.values, frozenset(line.named)))
    for file, names in guesses.items():
        if names:
            node.get_logger().warning(
                f'{file} marks as a guess, so measure it and delete the mark: {", ".join(names)}')
    return node


def _copies(files: Sequence[str], stack: ExitStack) -> dict[str, str]:
    """Copy what can be read only once, such as a pipe, into files that two can read."""
    once = [file for file in dict.fromkeys(files)
            if Path(file).exists() and not Path(file).is_file() and not Path(file).is_dir()]
    if not once:
        return {}
    folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
    copies = {}
    for i, file in enumerate(once):
        copies[file] = str(folder / f'{i}.yaml')
        Path(copies[file]).write_bytes(Path(file).read_bytes())
    return copies


def _initialise(args: list[str], line: CommandLine, mistake: ParameterError | None) -> None:
    """Let ROS read the command line; if it refuses, say why in our words if we know them."""
    # What rcl logs of a mistake in the arguments stands in its exception too
    rclpy.logging.set_logger_level('rcl', rclpy.logging.LoggingSeverity.FATAL)
    try:
        # rclpy's own handlers would end the context before the last zeros are out
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError:
        if line.unknown:
            raise unknown_option(line.unknown[0]) from None
        if mistake:
            raise mistake from None
        raise
    finally:
        rclpy.logging.set_logger_level('rcl', rclpy.logging.LoggingSeverity.UNSET)


def _sentence(error: Exception) -> str:
    """Return an exception's message on one line, without rcl's source lines and rclpy's arrow."""
    text = str(error).rstrip('^ \n') if isinstance(error, NameValidationException) else str(error)
    return ' '.join(re.sub(r', at /\S+:\d+', '', text).split())
