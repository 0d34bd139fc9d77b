"""Long studies: several processes, a cluster, and progress; the same numbers to the last bit."""

import numpy as np
import pytest
from support.study import run, SHORT
from thrust_allocator.study import grid, report


def test_a_cluster_that_is_not_there(tmp_path, capsys, monkeypatch):
    """An address where nobody answers, or that is none, ends in one line."""
    monkeypatch.setattr(grid, 'CONNECT_TIMEOUT', 0.3)
    for address in ('tcp://127.0.0.1:1', 'nonsense://x'):
        assert run('--output', tmp_path / 'out', *SHORT, '--dask', address) == 1
        error = capsys.readouterr().err
        assert error.startswith(f'study: --dask {address}: ') and error.count('\n') == 1


@pytest.fixture(scope='module')
def cluster():
    """Return a local Dask cluster of two worker processes, on the loopback interface alone."""
    from distributed import LocalCluster  # of extra `test`; its absence is no reason to skip

    with LocalCluster(n_workers=2, threads_per_worker=1, host='127.0.0.1',
                      dashboard_address=None) as cluster:
        yield cluster


@pytest.fixture(scope='module')
def grid_of_one_core(tmp_path_factory):
    """Return the options of a grid, and all its numbers from one process, as bytes."""
    folder = tmp_path_factory.mktemp('one_core')
    options = ['--speeds', '0:1.8:31', '--headings', '0,20']
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report.Drawings, 'draw', lambda self, jobs: None)
        assert run('--output', folder, *options) == 0
    return options, (folder / 'grid.csv').read_bytes()


def test_the_same_numbers_with_two_jobs(undrawn, grid_of_one_core, tmp_path):
    """Two processes give the same grid to the last bit."""
    options, expected = grid_of_one_core
    assert run('--output', tmp_path, *options, '--jobs', 2) == 0
    assert (tmp_path / 'grid.csv').read_bytes() == expected


def test_the_same_numbers_on_a_cluster(undrawn, grid_of_one_core, cluster, tmp_path):
    """A Dask cluster of two processes gives them, too."""
    options, expected = grid_of_one_core
    assert run('--output', tmp_path, *options, '--dask', cluster.scheduler_address) == 0
    assert (tmp_path / 'grid.csv').read_bytes() == expected


def test_a_failure_on_the_cluster_ends_in_one_line(undrawn, cluster, tmp_path, capsys, monkeypatch):
    """Whatever a worker raises is told by its kind, without a traceback."""
    def fail(case, manoeuvre, speeds):  # in here, so that it is sent and not looked for there
        raise ZeroDivisionError('at sea')

    monkeypatch.setattr(grid, 'evaluate', fail)
    assert run('--output', tmp_path / 'out', *SHORT, '--dask', cluster.scheduler_address) == 1
    error = capsys.readouterr().err
    assert error == f'study: --dask {cluster.scheduler_address}: ZeroDivisionError: at sea\n'


def test_long_runs_show_progress(undrawn, tmp_path, capsys, monkeypatch):
    """Points done and the time left go to stderr."""
    from thrust_allocator.study import progress

    monkeypatch.setattr(progress, 'SILENCE', 0.0)
    monkeypatch.setattr(progress, 'INTERVAL', {True: 0.0, False: 0.0})
    assert run('--output', tmp_path, '--speeds', '0:1:30', '--failed', 'up') == 0
    notes = capsys.readouterr().err.splitlines()
    assert len(notes) == 10 and notes[-1].startswith('study: 150 of 150 points, ')
    assert np.all(['s to go' in note for note in notes])
