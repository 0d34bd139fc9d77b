"""ROS messages from arrays, and arrays from ROS messages; axes stay as they are."""

from collections.abc import Mapping
import math

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import Quaternion, Twist, Vector3, Wrench
import numpy as np
from std_msgs.msg import Float64MultiArray, MultiArrayDimension


def vector_components(message: Vector3) -> np.ndarray:
    """Return x, y, z, (3,)."""
    return np.array([message.x, message.y, message.z])


def quaternion_components(message: Quaternion) -> np.ndarray:
    """Return x, y, z, w, (4,)."""
    return np.array([message.x, message.y, message.z, message.w])


def wrench_components(message: Wrench) -> np.ndarray:
    """Return force and torque, (6,) [N, N*m]."""
    force, torque = message.force, message.torque
    return np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])


def twist_components(message: Twist) -> np.ndarray:
    """Return linear and angular velocity, (6,) [m/s, rad/s]."""
    linear, angular = message.linear, message.angular
    return np.array([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z])


def fill_wrench(message: Wrench, wrench: np.ndarray) -> None:
    """Put force and torque, (6,) [N, N*m], into a message that is used again at every tick."""
    force, torque = message.force, message.torque
    force.x, force.y, force.z, torque.x, torque.y, torque.z = (
        wrench + 0.0).tolist()  # + 0.0 turns -0.0 into 0.0


def array_message(dimensions: list[tuple[str, int]]) -> Float64MultiArray:
    """Return an empty array message laid out in dimensions (label, size), row by row."""
    message = Float64MultiArray()
    sizes = [size for _, size in dimensions]
    message.layout.dim = [
        MultiArrayDimension(label=label, size=size, stride=math.prod(sizes[i:]))
        for i, (label, size) in enumerate(dimensions)]
    return message


def status_message(name: str, hardware: str, level: int, text: str,
                   figures: Mapping[str, str]) -> DiagnosticStatus:
    """Return a diagnostic status."""
    return DiagnosticStatus(
        name=name, hardware_id=hardware, level=bytes([level]), message=text,
        values=[KeyValue(key=key, value=value) for key, value in figures.items()])
