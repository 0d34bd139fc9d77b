"""What an independent solver makes of the allocation problem."""

import daqp
import numpy as np
from thrust_allocator.physics.vehicle import Vehicle


def daqp_optimum(vehicle: Vehicle, wrench: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Return the optimum that daqp finds for the problem with the slack eliminated."""
    matrix, weights = vehicle.configuration_matrix, np.array(vehicle.wrench_weights)
    hessian = np.diag([t.weight for t in vehicle.thrusters]) + (matrix.T * weights) @ matrix
    optimum, _, flag, _ = daqp.solve(
        hessian, -(matrix.T * weights) @ wrench, np.zeros((0, matrix.shape[1])),
        limits[1].copy(), limits[0].copy(), np.zeros(matrix.shape[1], dtype=np.int32))
    assert flag == 1
    return optimum
