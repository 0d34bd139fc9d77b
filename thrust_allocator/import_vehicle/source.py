"""Read a description of a vehicle from a file of any kind."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from thrust_allocator.import_vehicle.configuration import Configuration, Mount, SourceError
from thrust_allocator.import_vehicle.document import frame_of, groups, load
from thrust_allocator.import_vehicle.layout import centre_of_mass, layouts
from thrust_allocator.import_vehicle.matrix import matrices, Matrix, mounts_of_matrix
from thrust_allocator.import_vehicle.simulator import read_simulator
from thrust_allocator.import_vehicle.template import refuse_template
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.types import ParameterError

PARAMETER_FILE = 'parameter file'  # of this package: nothing to import, but to compare with


def read_source(path: Path, frame: str | None = None,
                origin: Sequence[float] | None = None) -> Configuration:
    """
    Return the vehicle that a file describes.

    :param frame: axes of a matrix or layout that does not say its own; None: refuse such a file.
    :param origin: the point to measure positions from, in the file's axes and from its origin;
        None: the centre of mass where a layout gives one, else the file's origin [m].
    :raises SourceError: if it cannot be read, or describes no vehicle of fixed thrusters.
    """
    try:
        found, centre = _read(path, frame)
    except OSError as error:
        raise SourceError(f'{path}: cannot be read: {error.strerror}') from None
    except RecursionError:
        raise SourceError(f'{path}: is nested too deeply') from None
    except SourceError as error:
        raise SourceError(f'{path}: {error}') from None
    if origin is None and centre is None:
        return found
    if origin is None:
        return found.from_origin(centre, 'the centre of mass that it gives, ')
    return found.from_origin(origin)


def _read(path: Path, frame: str | None) -> tuple[Configuration, list[float] | None]:
    """Return the vehicle, and its centre of mass where a layout gives one."""
    try:
        text = path.read_bytes().decode('utf-8-sig')
    except UnicodeDecodeError:
        raise SourceError('is no text') from None
    if text.lstrip().startswith('<'):
        return read_simulator(path, text), None
    try:
        return _read_yaml(path, text, frame)
    except SourceError:
        refuse_template(text, path, '.yaml')  # if it is one, that is why
        raise


def _read_yaml(path: Path, text: str, frame: str | None
               ) -> tuple[Configuration, list[float] | None]:
    """Return the vehicle of a matrix, a layout or a parameter file, and its centre of mass."""
    document = load(text)
    if _is_parameter_file(document):
        return _read_parameter_file(path), None
    found = [(f'matrix {one.group.at(one.key)}', one) for one in matrices(document)]
    found += [(f'layout {one.path}', one) for one in layouts(document)]
    if len(found) > 1:
        raise SourceError('describes thrusters more than once: '
                          + ', '.join(kind for kind, _ in found) + '; leave one of them in')
    if not found:
        raise SourceError('has neither an allocation matrix (tam or another list of 6 rows) nor a '
                          'layout (positions and directions)')
    kind, one = found[0]
    mounts = mounts_of_matrix(one, document) if isinstance(one, Matrix) else one.mounts
    frame = frame_of(document) or frame
    if not frame:
        raise SourceError('does not say its axes: give --frame flu (x forward, y left, z up) or '
                          '--frame frd (x forward, y starboard, z down)')
    return (Configuration(str(path), kind, frame, mounts, "the source's own origin"),
            None if isinstance(one, Matrix) else centre_of_mass(document))


def _is_parameter_file(document: Any) -> bool:
    return any(isinstance(group.items.get('thrusters'), dict) and 'thruster_names' in group.items
               and any(isinstance(one, dict) and 'model' in one
                       for one in group.items['thrusters'].values())
               for group in groups(document))


def _read_parameter_file(path: Path) -> Configuration:
    """Return the vehicle of a parameter file of this package."""
    try:
        vehicle = load_vehicle(path)
    except ParameterError as error:
        raise SourceError(str(error).removeprefix(f'{path}: ')) from None
    return Configuration(
        str(path), PARAMETER_FILE, 'frd',
        tuple(Mount(one.name, one.position, one.direction, one.torque_ratio,
                    (None, None) if one.model.DEFLECTS else one.bollard_thrust)
              for one in vehicle.thrusters), 'the body origin')
