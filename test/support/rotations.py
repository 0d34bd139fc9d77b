"""Rotations from Euler angles, by matrices and by quaternions."""

import numpy as np

ANGLES = [(0.0, 0.0, 0.0), (np.pi / 2, 0.0, 0.0), (0.0, 0.4, 0.0), (0.0, 0.0, -0.8),
          (2.5, -0.6, 0.3), (-1.2, 1.4, 3.0)]  # yaw, pitch, roll [rad]


def rotation(yaw, pitch, roll):
    """Return the matrix (3, 3) that turns body axes into the parent frame's, Rz Ry Rx."""
    (cz, cy, cx), (sz, sy, sx) = np.cos([yaw, pitch, roll]), np.sin([yaw, pitch, roll])
    return (np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
            @ np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
            @ np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]]))


def quaternion(yaw, pitch, roll):
    """Return the same rotation as a quaternion x, y, z, w, by the formula for Euler angles."""
    (cz, cy, cx), (sz, sy, sx) = (np.cos(np.array([yaw, pitch, roll]) / 2.0),
                                  np.sin(np.array([yaw, pitch, roll]) / 2.0))
    return np.array([sx * cy * cz - cx * sy * sz, cx * sy * cz + sx * cy * sz,
                     cx * cy * sz - sx * sy * cz, cx * cy * cz + sx * sy * sz])
