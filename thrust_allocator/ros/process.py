"""The node's process: command line, signals and exit status."""

from collections.abc import Sequence
import signal
import sys

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from thrust_allocator.ros.node import ThrustAllocator
from thrust_allocator.parameters.file import (
    check_parameter_file, command_line_values, default_parameter_file, NODE_NAME)
from thrust_allocator.parameters.guesses import marked_guesses
from thrust_allocator.parameters.types import ParameterError


def main(args: Sequence[str] | None = None) -> int:
    """
    Run the node until SIGINT or SIGTERM.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0 after a signal, 1 for a mistake in the parameters, or if the
        context was shut down from outside, so that no last zeros could be published.
    """
    args = list(sys.argv if args is None else args)
    signals: list[int] = []  # received so far
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: signals.append(number))
    try:
        files = [file for option, file in zip(args, args[1:]) if option == '--params-file']
        for file in files:
            check_parameter_file(file)
        if not files:
            default = str(default_parameter_file())
            args[1:1] = ['--ros-args', '--params-file', default, '--']
        # What rcl logs of a mistake in the arguments stands in its exception too
        rclpy.logging.set_logger_level('rcl', rclpy.logging.LoggingSeverity.FATAL)
        # rclpy's own handlers would end the context before the last zeros are out
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        rclpy.logging.set_logger_level('rcl', rclpy.logging.LoggingSeverity.UNSET)
        # rcl drops a value from the command line if a file gives one of another type
        node = ThrustAllocator(parameter_overrides=[
            Parameter(name, value=value) for name, value in command_line_values(args).items()])
    except (ParameterError, ParameterException, RuntimeError) as error:
        print(f'{NODE_NAME}: {" ".join(str(error).split())}', file=sys.stderr)
        rclpy.try_shutdown()
        return 1
    if not files:
        node.get_logger().warning(f'no parameter file given: running MT-2012 from {default}')
    for file in files:
        if guesses := marked_guesses(file):
            node.get_logger().warning(
                f'{file} marks as a guess, so measure it and delete the mark: {", ".join(guesses)}')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        while not signals and not node.interrupted:
            executor.spin_once(timeout_sec=0.1)
    except Exception:  # of nearly any type if the context is gone: even a publisher complains
        if rclpy.ok():
            raise
    finally:
        if alive := rclpy.ok():
            node.stop()
        rclpy.try_shutdown()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)  # Python, on its way out, would let them kill it
    if not alive:
        print(f'{NODE_NAME}: the ROS context was shut down from outside: the last setpoints stand',
              file=sys.stderr)
    return 0 if alive else 1
