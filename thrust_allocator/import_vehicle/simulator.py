"""URDF and SDF: read the XML, find the thruster plugins, and place their thrusters."""

from pathlib import Path
from typing import Protocol
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from thrust_allocator.import_vehicle.configuration import Configuration, Mount, SourceError
from thrust_allocator.import_vehicle.plugin import ThrusterPlugin, thruster_plugins
from thrust_allocator.import_vehicle.pose import Spin
from thrust_allocator.import_vehicle.sdf import SdfModel
from thrust_allocator.import_vehicle.template import refuse_template
from thrust_allocator.import_vehicle.urdf import UrdfRobot


class Model(Protocol):
    """What URDF and SDF have in common."""

    origin: str  # which point positions are measured from, in words

    def spin(self, joint: str | None, link: str | None) -> Spin:
        """Return the spin of a thruster; refuse one on a joint that moves."""


def read_simulator(path: Path, text: str) -> Configuration:
    """
    Return the vehicle that a URDF or SDF with thruster plugins describes, in flu axes.

    :raises SourceError: for a template, for XML without thrusters, and for thrusters that move.
    """
    refuse_template(text, path)
    root = parse_xml(text)
    if root.tag == 'robot':
        holder, model, kind = root, UrdfRobot(root), 'URDF'
    elif root.tag == 'sdf':
        holder = _model_with_thrusters(root, path)
        model, kind = SdfModel(holder, root.get('version', '1.6')), 'SDF'
    else:
        raise SourceError(f'is XML with the root <{root.tag}>, must be a URDF (<robot>) '
                          'or an SDF (<sdf>)')
    plugins = thruster_plugins(holder)
    if not plugins:
        others = sorted({one.get('filename') or one.get('name') or '?'
                         for one in holder.iter('plugin')})
        raise SourceError(f"{path}: has no thruster plugin (gz-sim's Thruster or uuv_simulator's); "
                          f'its plugins are {", ".join(others) or "none"}')
    mounts = [_mount(model, plugin) for plugin in plugins]
    bodies = {body: mount.name for mount, body in mounts}
    if len(bodies) > 1:
        raise SourceError('has thrusters on bodies that no fixed joint connects: '
                          + ', '.join(f'{name} on {body}' for body, name in bodies.items()))
    densities = {plugin.water_density for plugin in plugins}
    return Configuration(
        str(path), f'{kind} with {plugins[0].kind} thruster plugins', 'flu',
        tuple(mount for mount, _ in mounts), model.origin,
        densities.pop() if len(densities) == 1 else None)


def _mount(model: Model, plugin: ThrusterPlugin) -> tuple[Mount, str]:
    spin = model.spin(plugin.joint, plugin.link)
    return Mount(plugin.name, tuple(spin.pose.translation.tolist()), tuple(spin.axis.tolist()),
                 limits=plugin.limits, notes=plugin.notes), spin.body


def parse_xml(text: str) -> Element:
    """Return the root; prefixes stay as they are written, whether they are declared or not."""
    builder = TreeBuilder()
    parser = expat.ParserCreate()
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise SourceError(f'is no XML: {error}') from None
    return builder.close()


def _model_with_thrusters(root: Element, path: Path) -> Element:
    """Return the outermost model that has thruster plugins, in a world or not."""
    models = root.findall('model') + root.findall('world/model')
    found = [model for model in models if thruster_plugins(model)]
    if len(found) > 1:
        raise SourceError('has thrusters in several models: '
                          + ', '.join(model.get('name', '?') for model in found)
                          + '; leave only one of them in the file')
    if not found and not models:
        raise SourceError('has no model; if it includes one, expand it first with '
                          f'gz sdf -p {path} > vehicle.sdf')
    return (found or models)[0]
