"""The frames of an SDF model: links, joints, frames, nested models; what is fixed to what."""

from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np
from thrust_allocator.import_vehicle.configuration import SourceError
from thrust_allocator.import_vehicle.pose import (
    numbers, Pose, pose_of_sdf, refuse_moving, Spin)

MODEL = '__model__'


class _Frame(NamedTuple):
    """Where a frame stands, and the link or frame that it moves with."""

    relative_to: str  # full name
    pose: Pose
    attached_to: str  # full name
    placement: str = ''  # a nested model's frame that the pose is for, instead of its own


class SdfModel:
    """A model; positions are measured from its own frame, and nested names hold '::'."""

    def __init__(self, root: Element, version: str) -> None:
        self.origin = f'the frame of model {root.get("name", "?")}'
        self._old_axes = version in ('1.0', '1.2', '1.3', '1.4')  # in the model's frame
        self._frames: dict[str, _Frame] = {}
        self._joints: dict[str, tuple[str, Element]] = {}  # by full name: scope, element
        self._read(root, '')

    def _read(self, model: Element, scope: str) -> None:
        for link in model.findall('link'):
            name = scope + link.get('name', '')
            self._add(name, link, scope, scope + MODEL, name)
        for frame in model.findall('frame'):
            base = scope + (frame.get('attached_to') or MODEL)
            self._add(scope + frame.get('name', ''), frame, scope, base, base)
        for joint in model.findall('joint'):
            name, child = scope + joint.get('name', ''), scope + _text(joint, 'child')
            self._add(name, joint, scope, child, child)
            self._joints[name] = scope, joint
        first = model.find('link')
        canonical = model.get('canonical_link') or (first is not None and first.get('name'))
        for nested in model.findall('model'):
            name = scope + nested.get('name', '')
            self._read(nested, f'{name}::')
            placement = nested.get('placement_frame')
            self._add(f'{name}::{MODEL}', nested, scope, scope + MODEL,
                      self._frames[f'{name}::{MODEL}'].attached_to,
                      f'{name}::{placement}' if placement else '')
            self._frames[name] = _Frame(f'{name}::{MODEL}', Pose(), f'{name}::{MODEL}')
            canonical = canonical or nested.get('name')
        # Its pose in the model around it follows there
        self._frames[scope + MODEL] = _Frame('', Pose(), scope + (canonical or MODEL))

    def _add(self, name: str, element: Element, scope: str, default: str, attached: str,
             placement: str = '') -> None:
        pose = element.find('pose')
        relative_to = None if pose is None else pose.get('relative_to')
        self._frames[name] = _Frame(scope + relative_to if relative_to else default,
                                    pose_of_sdf(pose, f'the pose of {name}'), attached, placement)

    def pose(self, name: str, within: str = MODEL, _on_the_way: tuple[str, ...] = ()) -> Pose:
        """Return where a frame stands in the model's, or in another one that it hangs on."""
        if name == within:
            return Pose()
        if name in _on_the_way:
            raise SourceError(f'the pose of {name} is relative to itself, by way of '
                              + ', '.join(_on_the_way))
        frame = self._frames.get(name)
        if frame is None or not frame.relative_to:
            raise SourceError(f'the frame {name} is not in the file')
        place = self.pose(frame.relative_to, within, (*_on_the_way, name)) @ frame.pose
        if frame.placement:
            place = place @ self.pose(frame.placement, name).inverse()
        return place

    def spin(self, joint: str | None, link: str | None) -> Spin:
        """
        Return where the thruster of a joint stands, its axis, and the link that it is fixed to.

        The thrust acts at the origin of the joint's child link, along the joint's axis.

        :param link: of a plugin that names no joint: +x of it.
        :raises SourceError: if it is not there, or on a joint that moves.
        """
        name, scope, own = self._joint(joint, link)
        child = scope + _text(own, 'child')
        place = self.pose(child)
        axis = place.rotation.apply([1.0, 0.0, 0.0]) if not joint else self._axis(name, scope, own)
        return Spin(place, axis, self._body(scope + _text(own, 'parent'), name))

    def _joint(self, joint: str | None, link: str | None) -> tuple[str, str, Element]:
        if joint:
            found = [(name, *entry) for name, entry in self._joints.items()
                     if name == joint or name.endswith('::' + joint)]
        else:
            found = [(name, scope, one) for name, (scope, one) in self._joints.items()
                     if scope + _text(one, 'child') == link]
        if len(found) != 1:
            raise SourceError(
                f'the {"joint" if joint else "link"} {joint or link} of a thruster plugin is '
                + ('not in the file; if an <include> brings it, expand the file first with '
                   'gz sdf -p' if not found else
                   'there more than once: ' + ', '.join(name for name, *_ in found)))
        return found[0]

    def _axis(self, name: str, scope: str, joint: Element) -> np.ndarray:
        element = joint.find('axis/xyz')
        axis = np.array([0.0, 0.0, 1.0] if element is None else
                        numbers(element.text, 3, f'the axis of joint {name}'))
        if not np.linalg.norm(axis) > 1e-9:
            raise SourceError(f'the axis of joint {name} is 0, must have a direction')
        of_model = joint.findtext('axis/use_parent_model_frame')
        frame = None if element is None else element.get('expressed_in')
        if frame:
            frame = scope + frame
        elif of_model is None and self._old_axes or of_model and of_model.strip() in ('1', 'true'):
            frame = scope + MODEL
        return self.pose(frame or name).rotation.apply(axis / np.linalg.norm(axis))

    def _body(self, link: str, thruster: str) -> str:
        """Return the outermost link that the thruster's parent is fixed to."""
        for _ in range(len(self._frames) + 1):
            link = self._link(link)
            above = [(name, scope, one) for name, (scope, one) in self._joints.items()
                     if self._link(scope + _text(one, 'child')) == link]
            if not above or _text(above[0][2], 'parent') == 'world':
                return link
            name, scope, joint = above[0]
            ends = {joint.findtext('axis/limit/lower'), joint.findtext('axis/limit/upper')}
            refuse_moving(name, joint.get('type'), ends, thruster)
            link = scope + _text(joint, 'parent')
        raise SourceError(f'the joints above thruster {thruster} go round in a circle')

    def _link(self, name: str) -> str:
        """Return the link that a frame moves with."""
        for _ in range(len(self._frames) + 1):
            frame = self._frames.get(name)
            if frame is None or frame.attached_to == name:
                return name
            name = frame.attached_to
        raise SourceError(f'the frame {name} is attached to itself')


def _text(element: Element, tag: str) -> str:
    return (element.findtext(tag) or '').strip()
