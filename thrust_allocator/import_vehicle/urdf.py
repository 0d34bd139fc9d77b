"""The tree of links and joints of a URDF."""

from xml.etree.ElementTree import Element

import numpy as np
from thrust_allocator.import_vehicle.configuration import SourceError
from thrust_allocator.import_vehicle.pose import numbers, pose_of_urdf, refuse_moving, Spin

BASE = 'base_link'  # REP 105's name of the body


class UrdfRobot:
    """A URDF; positions are measured from base_link, or else from the body's outermost link."""

    def __init__(self, root: Element) -> None:
        self._joints = {joint.get('name', ''): joint for joint in root.findall('joint')}
        self._above = {_end(joint, 'child'): joint for joint in self._joints.values()}
        self.origin = 'the outermost link of the body'

    def spin(self, joint: str | None, link: str | None) -> Spin:
        """
        Return where a thruster stands in the body, its axis there, and the body's link.

        :param joint: about which its propeller turns; None: +x of `link`.
        :raises SourceError: if it is not there, or on a joint that moves.
        """
        own = self._joints.get(joint) if joint else self._above.get(link)
        if own is None:
            raise SourceError(f'the {"joint" if joint else "link"} {joint or link} of a thruster '
                              'plugin is not in the file')
        name = own.get('name', '?')
        place = pose_of_urdf(own.find('origin'), f'the origin of joint {name}')
        axis = np.array([1.0, 0.0, 0.0])
        if joint and own.find('axis') is not None:
            axis = np.array(numbers(own.find('axis').get('xyz', '1 0 0'), 3,
                                    f'the axis of joint {name}'))
        if not np.linalg.norm(axis) > 1e-9:
            raise SourceError(f'the axis of joint {name} is 0, must have a direction')
        body = _end(own, 'parent')
        while body != BASE and not body.endswith('/' + BASE):
            above = self._above.get(body)
            if above is None or above.get('type') == 'floating' or _end(above, 'parent') == 'world':
                break
            limit = above.find('limit')
            ends = {None} if limit is None else {limit.get('lower'), limit.get('upper')}
            refuse_moving(above.get('name', '?'), above.get('type'), ends, name)
            place = pose_of_urdf(above.find('origin'),
                                 f'the origin of joint {above.get("name")}') @ place
            body = _end(above, 'parent')
        self.origin = f'link {body}'
        return Spin(place, place.rotation.apply(axis / np.linalg.norm(axis)), body)


def _end(joint: Element, tag: str) -> str:
    found = joint.find(tag)
    return '' if found is None else found.get('link', '')
