"""The walls between the folders: imports lead downwards only, and ROS stays on the upper floors."""

import ast
from pathlib import Path
import re

import pytest
from support.paths import MT2012, ROOT
from support.processes import run
from support.vehicles import PAPER_TEST
from support.without_ros import HIDE, ROS

PACKAGE = ROOT / 'thrust_allocator'
# A module imports nothing that stands after its own folder, or its own name where it lies flat
ORDER = ('markdown', 'physics', 'solve', 'parameters', 'supply', 'inputs', 'setpoints', 'schedule',
         'tick', 'diagnosis', '__init__', 'ros', 'import_vehicle', 'study', 'fit', 'replay',
         'benchmark', 'soak', 'demo', '__main__')
WITH_ROS = {'ros', 'benchmark', 'soak', 'demo', '__main__'}
FILES = sorted(PACKAGE.rglob('*.py'))


def place(file: Path) -> str:
    """Return the name in ORDER that a file of the package stands under."""
    inside = file.relative_to(PACKAGE)
    return inside.parts[0] if len(inside.parts) > 1 else inside.stem


def imports(file: Path) -> set[str]:
    """Return the full names that a file imports, those inside its functions too."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text('utf-8'))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, f'{file}: a relative import'
            found.update(f'{node.module}.{alias.name}' for alias in node.names)
    return found


def places_imported(file: Path) -> set[str]:
    """Return the places in the package that a file imports from."""
    names = [name.split('.') for name in imports(file)]
    found = {parts[1] for parts in names if parts[0] == PACKAGE.name and len(parts) > 1}
    return {name if name in map(place, FILES) else '__init__' for name in found}


@pytest.mark.parametrize('file', FILES, ids=lambda file: str(file.relative_to(PACKAGE)))
def test_imports_lead_downwards(file):
    """A module takes from its own folder and from those below it alone."""
    assert place(file) in ORDER, f'{place(file)} has no place in ORDER yet'
    below = ORDER[:ORDER.index(place(file)) + 1]
    assert places_imported(file) <= set(below)


def test_ros_stays_on_the_upper_floors():
    """Nothing but those in WITH_ROS imports ROS, not inside a function either; `ros` does."""
    with_ros = {place(file) for file in FILES for name in imports(file)
                if ROS.fullmatch(name) or name.startswith('thrust_allocator.ros')}
    assert 'ros' in with_ros
    assert with_ros <= WITH_ROS


def test_everything_else_runs_without_ros():
    """All other modules can be imported, and the study started, where no ROS is installed."""
    modules = ['.'.join(file.relative_to(ROOT).with_suffix('').parts) for file in FILES
               if place(file) not in WITH_ROS]
    assert 'thrust_allocator.solve.problem' in modules
    done = run('-c', HIDE + f"""
for module in {modules}:
    importlib.import_module(module)
from thrust_allocator.study.__main__ import main
main(['study', '--help'])
""")
    assert done.returncode == 0 and '--output DIR' in done.stdout, done.stderr


def test_the_public_api_allocates_without_ros():
    """Four names from a YAML file to thrusts; the vehicle of the paper at 0.9 m/s."""
    done = run('-c', HIDE + f"""
import numpy as np
from thrust_allocator import AllocationProblem, Allocator, load_vehicle, ThrustBounds
from thrust_allocator.inputs import Inputs

vehicle = load_vehicle({str(MT2012)!r})
wrench, velocity = np.array([32.4, 0, 0, 0, 50.0, 0]), np.array([0.9, 0, 0, 0, 0, 0])
print(*AllocationProblem(vehicle).solve(wrench, ThrustBounds(vehicle)(velocity)).thrusts)
inputs = Inputs()
inputs.accept_wrench(wrench * [1, -1, -1, 1, -1, -1], 0)
inputs.accept_velocity(velocity, 0, 'odom')
print(*Allocator(vehicle).tick(inputs, 0).thrusts)
""")
    assert done.returncode == 0, done.stderr
    for line in done.stdout.splitlines():
        assert [*map(float, line.split())] == pytest.approx(PAPER_TEST[4][1], abs=0.006)
    assert done.stdout.count('\n') == 2


def test_the_four_lines_of_the_readme():
    """They run without ROS, in a clone, and give the thrusts of the paper's test."""
    block, = re.findall(
        r'^```python\n(.*?)^```$', (ROOT / 'README.md').read_text('utf-8'), re.M | re.S)
    assert block.count('\n') == 4
    done = run('-c', HIDE + f"""
from numpy import array
wrench, velocity = array([32.4, 0, 0, 0, 50.0, 0]), array([0.9, 0, 0, 0, 0, 0])
{block}
print(*thrusts)
""")
    assert done.returncode == 0, done.stderr
    assert [*map(float, done.stdout.split())] == pytest.approx(PAPER_TEST[4][1], abs=0.006)
