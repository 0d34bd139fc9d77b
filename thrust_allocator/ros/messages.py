"""ROS messages from arrays, and arrays from ROS messages; axes stay as they are."""

from collections.abc import Mapping
import math

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import Wrench
import numpy as np
from std_msgs.msg import Float64MultiArray, MultiArrayDimension


def wrench_components(message: Wrench) -> np.ndarray:
    """Return force and torque, (6,) [N, N*m]."""
    force, torque = message.force, message.torque
    return np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])


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
