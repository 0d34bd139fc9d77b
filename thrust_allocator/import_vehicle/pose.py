"""Poses of links and joints: a rotation and a translation, as URDF and SDF write them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np
from scipy.spatial.transform import Rotation
from thrust_allocator.import_vehicle.configuration import SourceError


def _origin() -> np.ndarray:
    return np.zeros(3)


@dataclass(frozen=True)
class Pose:
    """Where a frame lies in another one."""

    translation: np.ndarray = field(default_factory=_origin)  # (3,) [m]
    rotation: Rotation = field(default_factory=Rotation.identity)

    def __matmul__(self, other: 'Pose') -> 'Pose':
        """Return the pose of a frame that `other` places in this one."""
        return Pose(self.translation + self.rotation.apply(other.translation),
                    self.rotation * other.rotation)

    def inverse(self) -> 'Pose':
        """Return where the other frame lies in this one."""
        back = self.rotation.inv()
        return Pose(-back.apply(self.translation), back)


def numbers(text: str | None, count: int, of: str) -> list[float]:
    """Return the numbers of an XML text, separated by blanks."""
    try:
        found = [float(word) for word in (text or '').split()]
    except ValueError:
        found = []
    if len(found) != count or not np.isfinite(found).all():
        raise SourceError(f'{of}: is {(text or "").strip()!r}, must be {count} numbers')
    return found


def pose_of_sdf(element: Element | None, of: str) -> Pose:
    """Return the pose that a <pose> of SDF gives; none or an empty one is the identity."""
    if element is None or not (element.text or '').strip():
        return Pose()
    if element.get('rotation_format', 'euler_rpy') == 'quat_xyzw':
        return pose(numbers(element.text, 7, of), of)
    return pose(numbers(element.text, 6, of), of, element.get('degrees') in ('true', '1'))


def pose_of_urdf(element: Element | None, of: str) -> Pose:
    """Return the pose that an <origin> of URDF gives; none is the identity."""
    if element is None:
        return Pose()
    return pose([*numbers(element.get('xyz', '0 0 0'), 3, of),
                 *numbers(element.get('rpy', '0 0 0'), 3, of)], of)


def pose(values: Sequence[float], of: str, degrees: bool = False) -> Pose:
    """Return the pose of x, y, z and roll, pitch, yaw about fixed axes, or a quaternion xyzw."""
    translation, turn = np.array(values[:3], dtype=float), values[3:]
    if len(turn) == 3:
        return Pose(translation, Rotation.from_euler('xyz', turn, degrees=degrees))
    if not abs(np.linalg.norm(turn) - 1.0) < 1e-2:
        raise SourceError(f'{of}: has the quaternion {list(turn)}, must have a norm of 1')
    return Pose(translation, Rotation.from_quat(turn))


class Spin(NamedTuple):
    """Where a thruster stands, and along which axis it pushes."""

    pose: Pose  # of the thruster's link in the body
    axis: np.ndarray  # (3,), unit vector in body axes
    body: str  # the link that all of it is fixed to


def refuse_moving(joint: str, kind: str | None, ends: set[str | None], thruster: str) -> None:
    """
    Raise SourceError unless a joint between thruster and body holds still.

    :param ends: of its range; where both are 0, a joint of any kind is as good as fixed.
    """
    try:
        locked = all(float(end) == 0.0 for end in ends)
    except (TypeError, ValueError):
        locked = False
    if kind != 'fixed' and not locked:
        raise SourceError(f'thruster {thruster} hangs on joint {joint}, which moves ({kind}): a '
                          'thruster must be fixed to the body')
