"""Shared by the tests of the node: processes on a mission."""

import signal

import pytest


@pytest.fixture
def mission():
    """Return a mission in this process, heard on this machine only."""
    from support.mission import Mission  # not before the environment of conftest.py
    from support.processes import context_among_processes

    with context_among_processes() as context:
        mission = Mission(context)
        yield mission
        mission.close()


@pytest.fixture
def send_out(mission, launch):
    """Return a function that starts a program, with a node in it, as a Run of the mission."""
    from support.mission import Run

    return lambda *program: Run(mission, launch, program)


@pytest.fixture
def breaking(send_out):
    """Return a function that starts a node and has it broken in the middle of its work."""
    from support.mission import BREAKING

    def run(change):
        run = send_out('-c', BREAKING % change)
        run.wait_until_allocating()
        run.process.send_signal(signal.SIGUSR1)
        return run

    return run
