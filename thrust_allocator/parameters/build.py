"""What parameters describe: the vehicle, and its allocation problem set up."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from thrust_allocator.parameters.check import Parameters, read_parameters
from thrust_allocator.parameters.definition import BY_AUTHORITY
from thrust_allocator.parameters.file import given_for, NODE_NAME, read_files
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.frames import DOFS, frd_signs
from thrust_allocator.physics.models import MODELS
from thrust_allocator.physics.vehicle import Thruster, Vehicle
from thrust_allocator.solve.attainable import TooManyFaces
from thrust_allocator.solve.authority import authority, authority_weights
from thrust_allocator.solve.compromise import Compromise
from thrust_allocator.solve.conditioning import IllConditioned
from thrust_allocator.solve.problem import AllocationProblem

# Of a thruster; what one of its model does not have keeps its default
WHATEVER_THE_MODEL = ('weight', 'torque_ratio', 'max_rate', 'cutoff', 'enabled', 'bollard_power')


@dataclass(frozen=True)
class Description:
    """Checked parameters, and all that was built of them to check them."""

    parameters: Parameters
    vehicle: Vehicle
    problem: AllocationProblem
    compromise: Compromise
    remarks: tuple[str, ...] = ()  # what was chosen for the user, for the log

    @property
    def warnings(self) -> list[str]:
        """Return what a user should know of a description that is valid all the same."""
        return [*self.parameters.warnings, *self.vehicle.warnings()]

    def changed(self, changes: Mapping[str, Any]) -> 'Description':
        """
        Return the description with some values changed; the problem is kept where it serves still.

        :param changes: by full dotted name.
        :raises ParameterError: if the whole would describe no vehicle.
        """
        return _build(read_parameters({**self.parameters.values, **changes}), self.problem)


def describe(given: Mapping[str, Any], own: Collection[str] = (),
             notes: Iterable[str] = ()) -> Description:
    """
    Check parameters and build what they describe.

    :param given: values by full dotted name, as `parameters.file` or ROS 2 gives them.
    :param own: the names that were given for this node alone.
    :param notes: what is to be said of the values beside the check's own warnings.
    :raises ParameterError: if they describe no vehicle.
    """
    parameters, remarks = _weighted(read_parameters(given, own, notes))
    return replace(_build(parameters), remarks=remarks)


def load_description(path: str | Path, node: str = f'/{NODE_NAME}') -> Description:
    """
    Return what a ROS 2 parameter file describes, as the node would take it; no ROS is needed.

    :param path: the YAML file.
    :param node: full name of the node whose parameters count, e.g. '/my_auv/thrust_allocator'.
    :raises ParameterError: if the file cannot be read or describes no vehicle.
    """
    given = given_for(node, read_files([path]))
    return describe(given.values, given.own, given.notes)


def load_vehicle(path: str | Path, node: str = f'/{NODE_NAME}') -> Vehicle:
    """
    Return the vehicle that a ROS 2 parameter file describes; no ROS is needed.

    :param path: the YAML file.
    :param node: full name of the node whose parameters count, e.g. '/my_auv/thrust_allocator'.
    :raises ParameterError: if the file cannot be read or describes no vehicle.
    """
    return load_description(path, node).vehicle


def _build(parameters: Parameters, problem: AllocationProblem | None = None) -> Description:
    vehicle = _vehicle(parameters)
    try:
        problem = problem.for_vehicle(vehicle) if problem else AllocationProblem(vehicle)
    except IllConditioned as error:
        raise ParameterError(f'wrench_weights: {error}') from None
    values = parameters.values
    try:
        compromise = Compromise(
            vehicle, problem, values['direction_keeping'],
            [DOFS.index(dof) for dof in values['direction_keeping_dofs']], values['power_limit'])
    except TooManyFaces as error:
        raise ParameterError(f'direction_keeping: is {values["direction_keeping"]:g}, must be 0 '
                             f'for this vehicle: {error}') from None
    return Description(parameters, vehicle, problem, compromise)


def _weighted(parameters: Parameters) -> tuple[Parameters, tuple[str, ...]]:
    """
    Return parameters with a number for every weight, and what to log of those that were chosen.

    A DOF that was left out is weighted by what the vehicle, as described and with all thrusters
    enabled, can give there at rest.
    """
    names = [f'wrench_weights.{dof}' for dof in DOFS]
    left_out = [name for name in names if parameters.values[name] is BY_AUTHORITY]
    if not left_out:
        return parameters, ()
    values = dict(parameters.values) | dict.fromkeys(left_out, 1.0)
    vehicle = _vehicle(replace(parameters, values=values))
    chosen = authority_weights(authority(
        vehicle.configuration_matrix, vehicle.reference_limits,
        np.array(vehicle.wrench_weights) > 0.0))
    values |= {name: weight for name, weight in zip(names, chosen.tolist()) if name in left_out}
    warnings = [f'{name}: is left out and comes to 0, for no thruster can act there'
                for name in left_out if not values[name]]
    if not any(values[name] for name in names):
        raise ParameterError(f'{left_out[0]}: is left out, must be given: no thruster can act in '
                             'any DOF')
    said = ('wrench_weights by authority: '
            + ', '.join(f'{dof} {values[name]:.4g}' for dof, name in zip(DOFS, names)))
    if len(left_out) < len(DOFS):
        missing = ', '.join(name.partition('.')[2] for name in left_out)
        warnings.append(f'wrench_weights: leaves out {missing}; {said}')
    return (replace(parameters, values=MappingProxyType(values),
                    warnings=(*parameters.warnings, *warnings)),
            (said,) if len(left_out) == len(DOFS) else ())


def _vehicle(parameters: Parameters) -> Vehicle:
    """Return the vehicle, turned into frd axes."""
    values = parameters.values
    return Vehicle(
        tuple(_thruster(name, {**values, **parameters.of_thruster(name)})
              for name in values['thruster_names']),
        tuple(values[f'wrench_weights.{dof}'] for dof in DOFS),
        tuple((frd_signs(values['vehicle_frame'])[:3] * values['wrench_origin']).tolist()))


def _thruster(name: str, values: Mapping[str, Any]) -> Thruster:
    """Build a thruster from its own parameters and those of the node."""
    signs = frd_signs(values['vehicle_frame'])[:3]
    direction = np.array(values['direction'])
    direction = signs * direction / np.linalg.norm(direction)
    return Thruster(
        name, tuple((signs * values['position']).tolist()), tuple(direction.tolist()),
        MODELS[values['model']].from_values(values),
        **{name: values[name] for name in WHATEVER_THE_MODEL if name in values})
