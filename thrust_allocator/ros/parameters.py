"""A vehicle's parameters as parameters of a ROS 2 node: taken, declared, and changed."""

from array import array
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.node import Node
from rclpy.parameter import Parameter
from thrust_allocator.parameters.build import describe, Description
from thrust_allocator.parameters.check import Parameters
from thrust_allocator.parameters.definition import Definition
from thrust_allocator.parameters.file import given_for, is_of_every_node
from thrust_allocator.parameters.grammar import Grammar
from thrust_allocator.parameters.types import as_real, ParameterError, Real, Reals
from thrust_allocator.ros.qos import check_overrides


@dataclass(frozen=True)
class Start:
    """What a node is started with: rcl reads it too, but does not say where a value comes from."""

    files: Grammar = field(default_factory=Grammar)  # as they were read beside rcl, if they were
    values: Mapping[str, Any] = field(default_factory=dict)  # of -p
    named: frozenset[str] = frozenset()  # in any -p

    @property
    def overrides(self) -> list[Parameter]:
        """Return the values of -p as parameters, which come before those of the files."""
        return [Parameter(name, value=value) for name, value in self.values.items()
                if value != []]


def take_overrides(node: Node, start: Start) -> Description:
    """
    Check what the command line and parameter files say for a node.

    :raises ParameterError: if it describes no vehicle, or a file has nothing for this node.
    """
    with node.handle:  # what rcl has read, declared or not
        overrides = node.handle.get_parameters(Parameter)
    given = {name: [] if one.value is None else plain(one.value)  # an empty list or map
             for name, one in overrides.items()} | dict(start.values)
    check_overrides(given)
    given = {name: value for name, value in given.items() if not is_of_every_node(name)}
    name = node.get_fully_qualified_name()
    read = given_for(name, start.files)
    if 'thruster_names' not in given:
        raise ParameterError(
            'thruster_names: is missing, must be a list of names; does the top key of the '
            f"parameter file match the node's name, {name}?")
    return describe(given, read.own | start.named, read.notes)


def declare(node: Node, parameters: Parameters) -> None:
    """Declare every parameter with its value in effect, described so that one can tune by it."""
    for name, value in parameters.values.items():
        node.declare_parameter(
            name, value, descriptor(parameters.definitions[name]), ignore_override=True)


def descriptor(definition: Definition) -> ParameterDescriptor:
    """Return the ROS description of a parameter: meaning, unit, range, whether it is live."""
    unit = f' [{definition.unit}]' if definition.unit else ''
    ranges = []
    if isinstance(definition.type, Real):
        low = 0.0 if definition.type.or_zero else definition.type.low
        ranges = [FloatingPointRange(from_value=low, to_value=definition.type.high)]
    return ParameterDescriptor(
        description=definition.meaning + unit, additional_constraints=str(definition.type),
        read_only=not definition.live, floating_point_range=ranges)


def coerced(changes: list[Parameter], parameters: Parameters) -> list[Parameter]:
    """
    Return changes with whole numbers, and words such as 1.0e4, made real where that is meant.

    :raises ParameterNotDeclaredException: as rclpy would, which forgets the first of the names.
    """
    unknown = [change.name for change in changes
               if change.name not in parameters.definitions and not is_of_every_node(change.name)]
    if unknown:
        raise ParameterNotDeclaredException(unknown)
    return [_coerced(change, parameters.definitions.get(change.name)) for change in changes]


def _coerced(change: Parameter, definition: Definition | None) -> Parameter:
    value = plain(change.value)
    try:
        if definition and isinstance(definition.type, Real):
            return Parameter(change.name, value=as_real(value))
        if definition and isinstance(definition.type, Reals) and isinstance(value, list):
            return Parameter(change.name, value=[as_real(item) for item in value])
    except ValueError:
        pass  # the check that follows says why not
    return change


def changes_of(changes: list[Parameter], parameters: Parameters) -> dict[str, Any]:
    """Return the changed values by name, those of the vehicle's parameters only."""
    return {change.name: plain(change.value) for change in changes
            if change.name in parameters.values}


def plain(value: Any) -> Any:
    """Return the value of a ROS parameter as Python reads it from a file."""
    return list(value) if isinstance(value, (array, tuple)) else value
