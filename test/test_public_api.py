"""What `from thrust_allocator import ...` gives: the node's mathematics where there is no ROS."""

import re
import subprocess
import sys

import numpy as np
from support.paths import ROOT
from support.vehicles import PAPER_TEST, paper_test
import thrust_allocator

ROS = ('rclpy', 'rcl_interfaces', 'ament_index_python', 'geometry_msgs', 'nav_msgs', 'std_msgs')


def test_four_lines_of_the_readme():
    """With ROS hidden, the block of the README computes the thrusts of the paper's test."""
    block, = re.findall(
        r'^```python\n(.*?)^```$', (ROOT / 'README.md').read_text('utf-8'), re.M | re.S)
    assert block.count('\n') == 4
    speed, expected = PAPER_TEST[4][:2]
    wrench, velocity = paper_test(speed)
    program = (f'import sys\nsys.modules.update(dict.fromkeys({ROS}))\nfrom numpy import array\n'
               f'wrench, velocity = {wrench!r}, {velocity!r}\n{block}print(*thrusts)')
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, cwd=ROOT)
    assert not done.stderr
    np.testing.assert_allclose([float(one) for one in done.stdout.split()], expected, atol=0.006)


def test_names():
    """The package offers the four names that the README explains, and they are documented."""
    assert sorted(thrust_allocator.__all__) == [
        'AllocationProblem', 'Allocator', 'ThrustBounds', 'load_vehicle']
    assert all(getattr(thrust_allocator, name).__doc__ for name in thrust_allocator.__all__)
