"""What a process and its machine did during a gap in its output, from Linux's /proc."""

from collections.abc import Sequence
import os
from typing import NamedTuple

WORST = 5  # gaps that are kept


class Facts(NamedTuple):
    """Counts since some beginning; times in ms, of the main thread where not said otherwise."""

    ran: float
    waited: float  # ready to run, but for a CPU
    switched: int  # times that it got a CPU
    faults: int  # pages that were found in memory
    major_faults: int  # pages that came from a disk
    observer_waited: float  # as `waited`, of this process
    busy: float  # of all CPUs together
    stolen: float  # by other virtual machines, of all CPUs together

    def since(self, before: 'Facts') -> 'Facts':
        """Return what was added to another reading."""
        return Facts(*(now - then for now, then in zip(self, before)))

    def __str__(self) -> str:
        return (f'the node ran {self.ran:.1f} ms and waited {self.waited:.1f} ms for a CPU, '
                f'{self.switched} switches, {self.faults} page faults and {self.major_faults} from '
                f'a disk; the soak waited {self.observer_waited:.1f} ms for a CPU; all CPUs worked '
                f'{self.busy:.0f} ms, {self.stolen:.0f} ms were stolen')


class Watch:
    """Reads the facts of a process, cheaply enough to do so at every message."""

    def __init__(self, process: int) -> None:
        """Open what is read."""
        self._files = [os.open(f'/proc/{name}', os.O_RDONLY) for name in (
            f'{process}/schedstat', f'{process}/stat', 'self/schedstat', 'stat')]
        self._tick = 1e3 / os.sysconf('SC_CLK_TCK')  # [ms]

    def read(self) -> Facts | None:
        """Return the facts so far; None if the process has ended."""
        try:
            scheduled, stat, own, machine = (os.pread(file, 4096, 0) for file in self._files)
        except ProcessLookupError:
            return None
        ran, waited, switched = map(int, scheduled.split())
        of_process = stat.rpartition(b')')[2].split()  # from field 3 on, see proc(5)
        cpu = [int(word) for word in machine.split(b'\n', 1)[0].split()[1:]]
        return Facts(1e-6 * ran, 1e-6 * waited, switched, int(of_process[7]), int(of_process[9]),
                     1e-6 * int(own.split()[1]), self._tick * (sum(cpu[:3]) + sum(cpu[5:7])),
                     self._tick * cpu[7])

    def close(self) -> None:
        """Close what was opened."""
        for file in self._files:
            os.close(file)


class Gaps:
    """The longest gaps between messages, and what happened meanwhile."""

    def __init__(self) -> None:
        self._worst: list[tuple[float, float, Facts]] = []  # (length [ms], when [min], facts)

    def note(self, length: float, when: float, facts: Facts) -> None:
        """Note a gap of so many ms that ended so many minutes after the start."""
        if len(self._worst) < WORST or length > self._worst[-1][0]:
            self._worst = sorted([*self._worst, (length, when, facts)], reverse=True)[:WORST]

    def lines(self) -> Sequence[str]:
        """Return a line for each, the longest first."""
        return [f'gap of {length:.1f} ms at {when:.2f} min: {facts}'
                for length, when, facts in self._worst]
