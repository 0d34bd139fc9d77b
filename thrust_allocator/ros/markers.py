"""Arrows that show the thrusters at work, for RViz and Foxglove."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
import numpy as np
from std_msgs.msg import ColorRGBA
from thrust_allocator.physics.vehicle import Thruster
from visualization_msgs.msg import Marker, MarkerArray

LONGEST = 0.5  # length of the largest Bollard thrust, or lift at 1 m/s, in spans of the vehicle
SHAFT = 0.02  # width of an arrow, likewise
IDLE = 1e-3  # share of Bollard thrust below which an arrow would be a point
FAINT = ColorRGBA(r=0.6, g=0.6, b=0.6, a=0.5)
OFF = ColorRGBA(r=0.0, g=0.0, b=0.0, a=1.0)
UNUSED = np.array([0.94, 0.89, 0.26])  # yellow
USED = np.array([0.84, 0.37, 0.0])  # vermilion


def thruster_markers(thrusters: Sequence[Thruster], thrusts: np.ndarray, limits: np.ndarray,
                     signs: np.ndarray, frame: str, stamp: Time) -> MarkerArray:
    """
    Return three markers per thruster: its thrust, its bounds, and a cross if it is off.

    An arrow points along the force on the vehicle. Its colour goes from yellow to vermilion with
    the share of the bound that is used.

    :param thrusts: (p,) [N].
    :param limits: (2, p), row 0 lower, row 1 upper [N].
    :param signs: (3,) that turn frd axes into those of `frame`.
    :param frame: id of the body frame.
    """
    positions = np.array([signs * one.position for one in thrusters])
    largest = max(max(map(abs, one.model.reference_limits)) for one in thrusters)  # [N]
    span = float(np.linalg.norm(np.ptp(positions, axis=0))) or 1.0  # [m]
    markers = []
    for i, (one, position, thrust) in enumerate(zip(thrusters, positions, thrusts.tolist())):
        axis = signs * one.direction * LONGEST * span / largest  # [m/N]

        def marker(kind: str, shape: int, points: list[np.ndarray], color: ColorRGBA,
                   width: float) -> Marker:
            message = Marker(ns=kind, id=i, type=shape, color=color)
            message.header.frame_id, message.header.stamp = frame, stamp
            message.action = Marker.ADD if points else Marker.DELETE
            message.points = [Point(x=x, y=y, z=z) for x, y, z in map(np.ndarray.tolist, points)]
            message.scale.x, message.scale.y = width, 2.0 * width
            message.pose.orientation.w = 1.0
            return message

        bound = limits[1 if thrust > 0.0 else 0, i]
        share = min(thrust / bound, 1.0) if bound else 0.0
        red, green, blue = ((1.0 - share) * UNUSED + share * USED).tolist()
        arrow = [position, position + thrust * axis] if abs(thrust) > IDLE * largest else []
        lower, upper = limits[:, i]
        size = 2.0 * SHAFT * span * np.eye(3)
        cross = [] if one.enabled else [
            position + end for side in size for end in (side, -side)]
        markers += [
            marker('thrust', Marker.ARROW, arrow, ColorRGBA(r=red, g=green, b=blue, a=1.0),
                   SHAFT * span),
            marker('bounds', Marker.LINE_LIST,
                   [position + lower * axis, position + upper * axis] if one.enabled else [],
                   FAINT, 0.25 * SHAFT * span),
            marker('off', Marker.LINE_LIST, cross, OFF, 0.5 * SHAFT * span)]
    return MarkerArray(markers=markers)
