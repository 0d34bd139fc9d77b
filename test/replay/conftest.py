"""Shared by the tests of the replay."""

import json

import pytest
from thrust_allocator.replay.__main__ import main


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time, but for one name."""
    from thrust_allocator.replay import pictures

    monkeypatch.setattr(pictures, 'draw', lambda run, bag, folder, suffix: {
        f'setpoints{suffix}': 'left out'})


@pytest.fixture
def replay(tmp_path, capsys):
    """Return a function that replays a bag and returns what summary.json says."""
    def run(*args):
        status = main(['replay', *map(str, args), '--output', str(tmp_path / 'out')])
        assert status == 0, capsys.readouterr().err
        return json.loads((tmp_path / 'out' / 'summary.json').read_text('utf-8'))
    return run


@pytest.fixture
def refused(tmp_path, capsys):
    """Return a function that replays a bag and returns the one line that refuses it."""
    def run(*args):
        assert main(['replay', *map(str, args), '--output', str(tmp_path / 'out')]) == 1
        said = capsys.readouterr()
        assert said.out == '' and said.err.startswith('replay: ') and said.err.count('\n') == 1
        assert not (tmp_path / 'out').exists()
        return said.err
    return run
