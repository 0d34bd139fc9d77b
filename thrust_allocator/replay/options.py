"""The command line of a replay."""

import argparse
from pathlib import Path
from typing import Any, NoReturn

from thrust_allocator.parameters.entry import parse_value
from thrust_allocator.parameters.file import NODE_NAME
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.replay.topics import TYPES


class Parser(argparse.ArgumentParser):
    """A parser whose errors take one line."""

    def error(self, message: str) -> NoReturn:
        """Print the message and exit with status 2."""
        self.exit(2, f'{self.prog}: {" ".join(message.split())}\n')


def parser() -> Parser:
    """Return the parser of the command line."""
    one = Parser(prog='replay', description='Run a recorded mission once more through the tick of '
                 'the node: figures, events, pictures, and a bag of what it would have published.')
    one.add_argument('bag', metavar='BAG', type=Path,
                     help='rosbag2 recording: its folder, or one .mcap or .db3')
    one.add_argument('vehicles', metavar='VEHICLE.yaml', type=Path, nargs='+',
                     help="the node's parameter file; several are set side by side")
    one.add_argument('--output', required=True, metavar='DIR', type=Path,
                     help='folder for the results; made if it is not there')
    one.add_argument('--topic', action='append', default=[], type=_topic, metavar='NAME:=TOPIC',
                     help='where a topic of the node is in the bag: cmd_wrench:=/auv/wrench; '
                     'again for more')
    one.add_argument('--set', action='append', default=[], type=_setting, dest='settings',
                     metavar='PARAMETER:=VALUE',
                     help='set each vehicle beside itself with this changed: '
                     'wrench_weights.yaw:=1e6; again for more')
    one.add_argument('--node', default=f'/{NODE_NAME}', metavar='NAME',
                     help='full name of the node whose parameters and topics to read; %(default)s')
    return one


def _topic(text: str) -> tuple[str, str]:
    name, separator, topic = text.partition(':=')
    if not separator or name not in TYPES or not topic.startswith('/'):
        raise argparse.ArgumentTypeError(
            f'{text!r} must be NAME:=/TOPIC with a name of {", ".join(TYPES)}')
    return name, topic


def _setting(text: str) -> tuple[str, Any]:
    name, separator, value = text.partition(':=')
    if not separator or not name or not value:
        raise argparse.ArgumentTypeError(f'{text!r} must be PARAMETER:=VALUE')
    try:
        return name, parse_value(value, name)
    except ParameterError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
