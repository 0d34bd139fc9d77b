"""Numbers from recorded messages; axes stay as they are."""

from typing import Any

import numpy as np

LONG = 3600 * 10**9  # [ns]; a stamp so far from the recorder's time is on another clock

_FIELDS = {1: 'bool_value', 2: 'integer_value', 3: 'double_value', 4: 'string_value',
           5: 'byte_array_value', 6: 'bool_array_value', 7: 'integer_array_value',
           8: 'double_array_value', 9: 'string_array_value'}


def vector(message: Any) -> np.ndarray:
    """Return x, y, z, (3,)."""
    return np.array([message.x, message.y, message.z])


def wrench(message: Any) -> np.ndarray:
    """Return force and torque, (6,) [N, N*m], of a Wrench or a WrenchStamped."""
    message = getattr(message, 'wrench', message)
    force, torque = message.force, message.torque
    return np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])


def twist(message: Any) -> np.ndarray:
    """Return linear and angular velocity, (6,) [m/s, rad/s], of any message with a twist."""
    while hasattr(message, 'twist'):
        message = message.twist
    linear, angular = message.linear, message.angular
    return np.array([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z])


def orientation(message: Any) -> np.ndarray:
    """Return the quaternion x, y, z, w of an Odometry, (4,)."""
    turn = message.pose.pose.orientation
    return np.array([turn.x, turn.y, turn.z, turn.w])


def age(message: Any, time: int) -> int:
    """Return how old a message is by its stamp, if it has one on the recorder's clock [ns]."""
    header = getattr(message, 'header', None)
    stamp = 0 if header is None else header.stamp.sec * 10**9 + header.stamp.nanosec
    return time - stamp if stamp and abs(time - stamp) < LONG else 0


def parameter_changes(event: Any) -> dict[str, Any]:
    """Return the values that a ParameterEvent says were changed, by full name."""
    changes = {}
    for parameter in event.changed_parameters:
        field = _FIELDS.get(parameter.value.type)
        if field:
            value = getattr(parameter.value, field)
            changes[parameter.name] = value.tolist() if isinstance(value, np.ndarray) else value
    return changes
