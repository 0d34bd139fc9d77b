"""Shared by the tests of the study."""

import pytest
from thrust_allocator.study import report


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the pictures, which take most of the time of a short study."""
    monkeypatch.setattr(report.Drawings, 'draw', lambda self, jobs: None)
