"""Parameters of the running node: how to change them, and what must come of it."""

import numpy as np
from rclpy.parameter import Parameter
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.solve.problem import AllocationProblem

AHEAD = np.array([600.0, 0.0, 30.0, 0.0, 40.0, 10.0])  # frd axes: out of reach, so bounds count
ASTERN = -AHEAD
GENTLE = np.array([40.0, 0.0, 5.0, 0.0, 20.0, 3.0])  # within reach
TWIST = np.array([1.0, 0.3, -0.2, 0.05, 0.1, -0.1])
UP = 'thrusters.up.'


def change(one, changes, atomically=False):
    """Set parameters by name over the service; return (successful, reason) of each result."""
    results = one.set_parameters_of_node(
        [Parameter(name, value=value) for name, value in changes.items()], atomically)
    return [(result.successful, result.reason) for result in results]


def expected(file, wrench, twist):
    """Return limits and setpoints that the package's mathematics gives for a file's vehicle."""
    vehicle = load_vehicle(file)
    limits = ThrustBounds(vehicle)(twist)
    return limits.ravel(), AllocationProblem(vehicle).solve(wrench, limits).thrusts
