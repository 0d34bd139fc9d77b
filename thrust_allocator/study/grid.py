"""Many cases at once, on one core, the cores of a machine or a Dask cluster, through joblib."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import logging
from typing import NamedTuple

import joblib
import numpy as np
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.study.authority import Authority
from thrust_allocator.study.errors import missing, StudyError
from thrust_allocator.study.manoeuvre import Manoeuvre
from thrust_allocator.study.sweep import Sweep, sweep, without

# Speeds in a row that are evaluated together. It does not depend on the number of workers: the
# allocator starts from its last optimum, so the numbers repeat to the last bit whatever runs them.
PIECE = 25
CONNECT_TIMEOUT = 10.0  # of a Dask cluster [s]


class Case(NamedTuple):
    """A vehicle, and what it meets at every speed."""

    layout: str  # name of the vehicle
    vehicle: Vehicle
    failed: tuple[str, ...]  # thrusters
    heading: float  # to the current [deg]


class Outcome(NamedTuple):
    """What was found for one case at n speeds."""

    allocation: Sweep
    authority: np.ndarray  # (n, 2, 6, 2), as Authority returns it [N, N*m]


def evaluate(case: Case, manoeuvre: Manoeuvre, speeds: Sequence[float]) -> Outcome:
    """
    Allocate, deliver and find the authority at each speed.

    :param speeds: (n,) through the water [m/s].
    :raises StudyError: if HiGHS cannot tell the authority.
    """
    vehicle = without(case.vehicle, case.failed)
    velocities = [manoeuvre.velocity(speed, case.heading) for speed in speeds]
    allocation = sweep(vehicle, velocities, [manoeuvre.command(one) for one in velocities])
    authority = Authority(vehicle)
    return Outcome(allocation, np.array([
        authority(limits, manoeuvre.cruise(velocity))
        for limits, velocity in zip(allocation.limits, velocities)]))


def evaluate_all(cases: Sequence[Case], manoeuvre: Manoeuvre, speeds: Sequence[float],
                 jobs: int = 1, dask: str | None = None,
                 progress: Callable[[int, int], None] = lambda done, total: None) -> list[Outcome]:
    """
    Evaluate every case at every speed; the numbers are the same whatever does it.

    :param speeds: (n,) through the water [m/s].
    :param jobs: processes on this machine; not used on a cluster.
    :param dask: address of a Dask scheduler, such as 'tcp://10.0.0.1:8786'; its workers need this
        package installed.
    :param progress: called with the points done and their total.
    :return: the outcomes in the order of the cases.
    :raises StudyError: if the cluster cannot be reached or fails.
    """
    pieces = [speeds[start:start + PIECE] for start in range(0, len(speeds), PIECE)]
    outcomes: list[Outcome] = []
    with _workers(dask):
        run = joblib.Parallel(n_jobs=None if dask else jobs, return_as='generator')
        for outcome in run(joblib.delayed(evaluate)(case, manoeuvre, piece)
                           for case in cases for piece in pieces):
            outcomes.append(outcome)
            complete, rest = divmod(len(outcomes), len(pieces))
            progress(complete * len(speeds) + rest * PIECE, len(cases) * len(speeds))
    return [_joined(outcomes[start:start + len(pieces)])
            for start in range(0, len(outcomes), len(pieces))]


def _joined(pieces: Sequence[Outcome]) -> Outcome:
    allocations = [piece.allocation for piece in pieces]
    return Outcome(Sweep(*map(np.concatenate, zip(*allocations))),
                   np.concatenate([piece.authority for piece in pieces]))


@contextmanager
def _workers(dask: str | None) -> Iterator[None]:
    """Let joblib's work run on a Dask cluster, if there is one."""
    if dask is None:
        yield
        return
    try:
        import distributed
    except ImportError:
        raise StudyError(missing('Dask, which --dask runs on', 'cluster')) from None
    logging.getLogger('distributed').setLevel(logging.CRITICAL)  # says what the error says
    try:
        client = distributed.Client(dask, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise StudyError(f'--dask {dask}: cannot be reached: {error}') from None
    with client:
        try:
            with joblib.parallel_config('dask', client=client):
                yield
        except Exception as error:  # whatever a worker raised, an import that fails among it
            raise StudyError(f'--dask {dask}: {type(error).__name__}: {error}') from error
