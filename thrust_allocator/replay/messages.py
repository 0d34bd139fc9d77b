"""What a replay needs of each recorded message, as plain numbers; axes stay as they are."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from rosbags.typesys import get_typestore, Stores

_TYPES = get_typestore(Stores.ROS2_JAZZY)
_LITTLE = 1  # the second byte of a message whose numbers are little-endian
_FIELDS = {1: 'bool_value', 2: 'integer_value', 3: 'double_value', 4: 'string_value',
           5: 'byte_array_value', 6: 'bool_array_value', 7: 'integer_array_value',
           8: 'double_array_value', 9: 'string_array_value'}


class Command(NamedTuple):
    """A commanded wrench."""

    wrench: np.ndarray  # (6,) [N, N*m]
    stamp: int = 0  # 0: none [ns]


class Velocity(NamedTuple):
    """A velocity of the body origin in body axes."""

    twist: np.ndarray  # (6,) [m/s, rad/s]
    frame: str = ''  # the parent frame of an odometry
    orientation: np.ndarray | None = None  # quaternion x, y, z, w


class Current(NamedTuple):
    """A velocity of the water."""

    velocity: np.ndarray  # (3,) [m/s]
    frame: str


class Changes(NamedTuple):
    """Parameters that were changed while a node ran."""

    node: str  # full name
    values: dict[str, Any]


def read(raw: bytes, kind: str) -> Any:
    """
    Return what a serialised message of a type holds.

    Those that come in by the hundred thousand are read without a detour over the whole message;
    their layout is that of CDR: strings with their length before them, numbers aligned to their
    size.
    """
    if raw[1] == _LITTLE and kind in _AT_ONCE:
        return _AT_ONCE[kind](raw)
    return _READERS[kind](_TYPES.deserialize_cdr(raw, kind))


def _wrench(raw: bytes) -> Command:
    return Command(np.frombuffer(raw, '<f8', 6, 4))


def _odometry(raw: bytes) -> Velocity:
    length = int.from_bytes(raw[12:16], 'little')
    frame = raw[16:15 + length].decode()
    child = 16 + length + -length % 4  # where the length of the child's name stands
    end = child + 4 + int.from_bytes(raw[child:child + 4], 'little')
    numbers = end + (4 - end) % 8  # position, quaternion, 36 covariances, twist
    return Velocity(np.frombuffer(raw, '<f8', 6, numbers + 344), frame,
                    np.frombuffer(raw, '<f8', 4, numbers + 24))


def _vector(message: Any) -> np.ndarray:
    return np.array([message.x, message.y, message.z])


def _pair(first: Any, second: Any) -> np.ndarray:
    return np.concatenate([_vector(first), _vector(second)])


def _twist(message: Any) -> Velocity:
    while hasattr(message, 'twist'):  # with a stamp, with a covariance
        message = message.twist
    return Velocity(_pair(message.linear, message.angular))


def _whole_odometry(message: Any) -> Velocity:
    turn = message.pose.pose.orientation
    return Velocity(_twist(message).twist, message.header.frame_id,
                    np.array([turn.x, turn.y, turn.z, turn.w]))


def _changes(message: Any) -> Changes:
    values = {}
    for parameter in message.changed_parameters:
        if field := _FIELDS.get(parameter.value.type):
            value = getattr(parameter.value, field)
            values[parameter.name] = value.tolist() if isinstance(value, np.ndarray) else value
    return Changes(message.node, values)


_AT_ONCE: dict[str, Callable[[bytes], Any]] = {
    'geometry_msgs/msg/Wrench': _wrench, 'nav_msgs/msg/Odometry': _odometry}
_READERS: dict[str, Callable[[Any], Any]] = {
    'geometry_msgs/msg/Wrench': lambda one: Command(_pair(one.force, one.torque)),
    'geometry_msgs/msg/WrenchStamped': lambda one: Command(
        _pair(one.wrench.force, one.wrench.torque),
        one.header.stamp.sec * 10**9 + one.header.stamp.nanosec),
    'nav_msgs/msg/Odometry': _whole_odometry,
    'geometry_msgs/msg/TwistStamped': _twist,
    'geometry_msgs/msg/TwistWithCovarianceStamped': _twist,
    'geometry_msgs/msg/Vector3Stamped': lambda one: Current(_vector(one.vector),
                                                            one.header.frame_id),
    'sensor_msgs/msg/BatteryState': lambda one: one.voltage,
    'std_msgs/msg/Float64MultiArray': lambda one: np.asarray(one.data, dtype=float),
    'rcl_interfaces/msg/ParameterEvent': _changes}
