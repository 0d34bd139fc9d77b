"""The study in this process, and the tables that it writes."""

import csv
from pathlib import Path

from thrust_allocator.study.__main__ import main

SHORT = ['--speeds', '0:1.8:3']


def run(*args: object) -> int:
    """Run the study in this process and return its exit status."""
    return main(['study', *map(str, args)])


def rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file as a list of dicts."""
    with path.open(encoding='utf-8', newline='') as file:
        return list(csv.DictReader(file))
