"""The command `thrust_allocator`, or `python -m thrust_allocator`: one program by its name."""

from collections.abc import Sequence
import difflib
from importlib import import_module
import os
import signal
import sys

# Each module has a main(args) that takes the command line, its own name first
COMMANDS = {
    'node': 'thrust_allocator.ros.process',
    'demo': 'thrust_allocator.demo',
    'import_vehicle': 'thrust_allocator.import_vehicle.__main__',
    'fit': 'thrust_allocator.fit.__main__',
    'study': 'thrust_allocator.study.__main__',
    'replay': 'thrust_allocator.replay.__main__',
    'soak': 'thrust_allocator.soak',
    'benchmark': 'thrust_allocator.benchmark.__main__',
}


def main(args: Sequence[str] | None = None) -> int:
    """
    Run the program that the first argument names, or the node if it is an option or nothing.

    :param args: the command line, program name first; None for the process's own.
    :return: the program's exit status; 2 for a name that is none.
    """
    program, *rest = sys.argv if args is None else args
    name = 'node'
    if rest[:1] in (['-h'], ['--help']):
        print(f'thrust_allocator NAME [OPTION ...], NAME one of {", ".join(COMMANDS)}; without a '
              'name, the node:\n')
    if rest and rest[0].isidentifier():
        name, *rest = rest
    if name not in COMMANDS:
        close = difflib.get_close_matches(name, COMMANDS, n=1)
        return _refuse(f'{name}: is no command, must be one of {", ".join(COMMANDS)}'
                       + (f'; did you mean {close[0]}?' if close else ''))
    # An interrupt that falls into an import would end in somebody else's traceback
    usual = signal.signal(signal.SIGINT, _end)
    command = import_module(COMMANDS[name])
    signal.signal(signal.SIGINT, usual)
    return command.main([name, *rest])


def _refuse(message: str) -> int:
    print(f'thrust_allocator: {message}', file=sys.stderr)
    return 2


def _end(number: int, frame: object) -> None:
    os.write(sys.stderr.fileno(), b'thrust_allocator: interrupted\n')
    os._exit(128 + number)


if __name__ == '__main__':
    sys.exit(main())
