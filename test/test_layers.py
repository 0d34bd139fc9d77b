"""The mathematics stands on its own: data flows one way, and ROS stays in one place."""

from pathlib import Path
import subprocess
import sys

import pytest
import thrust_allocator

PACKAGE = Path(thrust_allocator.__file__).parent
WITH_ROS = {'demo', 'soak', '__main__'}
FOLDERS = ('physics', 'physics.models', 'solve', 'parameters')
MODULES = sorted({file.stem for file in PACKAGE.glob('*.py')} - WITH_ROS - {'__init__'}) + [
    f'{folder}.{file.stem}' for folder in FOLDERS
    for file in sorted((PACKAGE / folder.replace('.', '/')).glob('[a-z]*.py'))]


@pytest.mark.parametrize('module', MODULES)
def test_mathematics_needs_no_ros(module):
    """Every module but the node and the demo can be imported where no ROS is installed."""
    hidden = ('rclpy', 'ament_index_python', 'geometry_msgs', 'nav_msgs', 'std_msgs')
    program = ('import sys\n'
               f'sys.modules.update(dict.fromkeys({hidden}))\n'
               f'import thrust_allocator.{module}\n')
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True,
                          cwd=PACKAGE.parent)
    assert done.returncode == 0, done.stderr
