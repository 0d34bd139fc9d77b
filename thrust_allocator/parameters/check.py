"""The rules for a vehicle's parameters: what is missing, unknown, impossible or contradictory."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from thrust_allocator.parameters.definition import Definition, REQUIRED
from thrust_allocator.parameters.models import MODEL_PARAMETERS
from thrust_allocator.parameters.spelling import is_slip, nearest
from thrust_allocator.parameters.table import NODE, THRUSTER, THRUSTER_NAMES
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.physics.models import MODELS

LONGEST_PERIOD = 2.0**63  # that a clock can hold [ns]
GROUPS = ('thrusters', 'wrench_weights')  # that no other node has


@dataclass(frozen=True)
class Parameters:
    """A vehicle's parameters, checked: no missing, unknown or impossible value among them."""

    values: Mapping[str, Any]  # by full name, e.g. 'thrusters.up.weight'; defaults filled in
    definitions: Mapping[str, Definition]  # of the same names
    warnings: tuple[str, ...]

    def of_thruster(self, name: str) -> dict[str, Any]:
        """Return the values under `thrusters.<name>`, by the name that follows it."""
        prefix = f'thrusters.{name}.'
        return {key.removeprefix(prefix): value for key, value in self.values.items()
                if key.startswith(prefix)}


def read_parameters(given: Mapping[str, Any], own: Collection[str] = (),
                    notes: Iterable[str] = ()) -> Parameters:
    """
    Check a vehicle's parameters and fill in the defaults.

    :param given: values by full dotted name, as `parameters.file` or ROS 2 gives them.
    :param own: the names that were given for this node alone, so that an unknown one among them is
        a mistake and not another node's.
    :param notes: what is to be said of the values beside the check's own warnings.
    :raises ParameterError: for the first value that is missing, unknown, of the wrong type or out
        of range, and for values that contradict each other.
    """
    thrusters = _read(given, 'thruster_names', THRUSTER_NAMES)
    definitions = {definition.name: definition for definition in (THRUSTER_NAMES, *NODE)}
    if _read(given, 'velocity_type', definitions['velocity_type']) != 'odometry':
        if 'current_timeout' in given:
            raise ParameterError('current_timeout: is given, must be left out where velocity_type '
                                 'is not odometry: no orientation, no current')
        del definitions['current_timeout']
    _check_thruster_names(given, thrusters)
    for thruster in thrusters:
        prefix = f'thrusters.{thruster}.'
        for definition in (*THRUSTER, *_coefficients(given, prefix)):
            definitions[prefix + definition.name] = definition

    foreign = _foreign(given, definitions, own)
    values = {name: _read(given, name, definition) for name, definition in definitions.items()}
    _check_together(values, thrusters)
    warnings = (*notes, *foreign, *_scaled_losses(values, thrusters))
    return Parameters(MappingProxyType(values), MappingProxyType(definitions), warnings)


def _foreign(given: Mapping[str, Any], definitions: Collection[str],
             own: Collection[str]) -> tuple[str, ...]:
    """Return what to say of names that other nodes may have; refuse those meant for this one."""
    unknown = sorted(name for name in given if name not in definitions)
    groups = {name.partition('.')[0] for name in given}
    free = [name for name in definitions if name not in given]
    free += {name.partition('.')[0] for name in definitions} - groups
    for name in unknown:
        if name in own or name.partition('.')[0] in GROUPS or is_slip(name, free):
            raise ParameterError(f'{name}: is no parameter here{nearest(name, definitions)}')
    if not unknown:
        return ()
    listed = ', '.join(' '.join(name.split()) for name in unknown[:12])
    return (f'{listed}{", ..." if len(unknown) > 12 else ""}: no parameter of this node, ignored',)


def _read(given: Mapping[str, Any], name: str, definition: Definition) -> Any:
    if name in given:
        return definition.type.read(name, given[name])
    if definition.default is REQUIRED:
        raise ParameterError(f'{name}: is missing, must be {definition.type}')
    return definition.default


def _check_thruster_names(given: Mapping[str, Any], thrusters: tuple[str, ...]) -> None:
    described = {name.split('.')[1] for name in given if name.startswith('thrusters.')}
    for name in sorted(described - set(thrusters)):
        raise ParameterError(f'thrusters.{name}: is not in thruster_names, must be one of '
                             f'{", ".join(thrusters)}{nearest(name, thrusters)}')
    for name in thrusters:
        if name not in described:
            raise ParameterError(f'thrusters.{name}: is missing, must describe the thruster '
                                 'that thruster_names lists')


def _coefficients(given: Mapping[str, Any], prefix: str) -> tuple[Definition, ...]:
    """Return the model's own parameters; of the groups that exclude each other the one given."""
    name = prefix + 'model'
    model = _read(given, name, next(one for one in THRUSTER if one.name == 'model'))
    parameters = MODEL_PARAMETERS[MODELS[model]]
    for other, why in parameters.instead.items():
        if prefix + other in given:
            raise ParameterError(f'{prefix}{other}: is given, must be left out: a {model} {why}')
    if not parameters.either:
        return parameters.always
    groups = {prefix + group[0].name.partition('.')[0]: group for group in parameters.either}
    present = [name for name, group in groups.items()
               if any(prefix + one.name in given for one in group)]
    first, *others = groups
    if not present:
        raise ParameterError(f'{first}: is missing, must be {groups[first][0].type}; or give '
                             f'{" or ".join(others)} instead')
    if len(present) > 1:
        raise ParameterError(f'{present[0]}: is given together with {present[1]}, must stand alone')
    return parameters.always + groups[present[0]]


def _check_together(values: Mapping[str, Any], thrusters: tuple[str, ...]) -> None:
    if 1e9 / values['rate'] >= LONGEST_PERIOD:
        raise ParameterError.wrong('rate', values['rate'],
                                   'large enough for its period to fit a clock')
    if not any(values[f'wrench_weights.{dof}'] for dof in DOFS):
        raise ParameterError('wrench_weights: are all 0, must leave at least one DOF controlled')
    for prefix in (f'thrusters.{thruster}.' for thruster in thrusters):
        MODEL_PARAMETERS[MODELS[values[f'{prefix}model']]].check(values, prefix)
        if values['power_limit'] and f'{prefix}bollard_thrust' in values:
            _check_power(values, prefix)


def _check_power(values: Mapping[str, Any], prefix: str) -> None:
    """Refuse a thruster whose power cannot be predicted while there is a limit to it."""
    power = values[f'{prefix}bollard_power']
    if any(thrust and not watts
           for thrust, watts in zip(values[f'{prefix}bollard_thrust'], power)):
        raise ParameterError.wrong(
            f'{prefix}bollard_power', list(power),
            '[reverse, forward], each > 0 where bollard_thrust is not 0, for there is a '
            'power_limit')


def _scaled_losses(values: Mapping[str, Any], thrusters: tuple[str, ...]) -> list[str]:
    """Say whose loss in reverse nobody has measured: it is scaled from the forward one."""
    scaled = [name for name in thrusters if f'thrusters.{name}.propeller.diameter' in values
              and values[f'thrusters.{name}.bollard_thrust'][0]]
    return [f'the speed loss of {", ".join(scaled)} in reverse is scaled from the forward one, '
            'which is optimistic: measure it, and give speed_loss instead of propeller'
            ] if scaled else []
