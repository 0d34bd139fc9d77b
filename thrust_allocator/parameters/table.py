"""Every parameter of a vehicle: name, type, default, unit and meaning; and how they are read."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
import difflib
import math
from types import MappingProxyType
from typing import Any, NamedTuple

from thrust_allocator.physics.frames import DOFS, FRAMES
from thrust_allocator.parameters.types import (
    BollardThrust, Choice, Direction, Flag, LARGEST, Names, ParameterError, Real, Reals,
    Word)

REQUIRED = object()  # stands where a default would

_POSITIVE = Real(0.0, LARGEST, above=True)
_NOT_NEGATIVE = Real(0.0, LARGEST)
_ANY = Real()


class Parameter(NamedTuple):
    """One parameter: `name` is relative to where it stands (the node, or a thruster)."""

    name: str
    type: Any  # from parameter_types: has read(name, value), and str() says what is allowed
    default: Any
    unit: str
    meaning: str
    live: bool = True  # whether it can be changed while the node runs


def _pair(item: Real) -> Reals:
    return Reals((item, item), '[reverse, forward]')


NODE = (
    Parameter('rate', Real(0.0, 1000.0, above=True), 50.0, 'Hz', 'ticks per second'),
    Parameter('water_density', _POSITIVE, 1025.0, 'kg/m^3', 'density of the water'),
    Parameter('vehicle_frame', Choice(FRAMES), 'frd', '', 'axes of positions and directions',
              live=False),
    Parameter('message_frame', Choice(FRAMES), 'flu', '', 'axes of all wrenches and the twist',
              live=False),
    Parameter('start_enabled', Flag(), True, '',
              'whether the node allocates before ~/enable is called', live=False),
    Parameter('wrench_timeout', _POSITIVE, 0.5, 's', 'age at which a wrench counts no more'),
    Parameter('odometry_timeout', _NOT_NEGATIVE, 0.5, 's',
              'age at which a velocity counts no more; 0: no odometry is expected'),
    Parameter('current_timeout', _POSITIVE, 10.0, 's', 'age at which a current counts no more'),
    Parameter('fallback_velocity', Reals((_ANY,) * 3, '[x, y, z]'), (0.0, 0.0, 0.0), 'm/s',
              'velocity through the water while no odometry comes, in message_frame axes'),
    Parameter('stamped_wrench', Flag(), False, '', 'whether cmd_wrench is a WrenchStamped',
              live=False),
    Parameter('velocity_type', Choice(('odometry', 'twist', 'twist_with_covariance')), 'odometry',
              '', 'Odometry on odom, or TwistStamped or TwistWithCovarianceStamped on twist',
              live=False),
    Parameter('setpoint_unit', Choice(('newton', 'bollard_newton', 'bollard_fraction')), 'newton',
              '', 'of thruster_setpoints: thrust in the flow, or what gives it at rest',
              live=False),
    Parameter('publish_individual', Flag(), False, '',
              'whether each thrust in the flow, in N, goes out on thrusters/<name>/thrust too'),
    Parameter('marker_frame', Word(), 'base_link', '', 'frame id of thruster_markers'),
) + tuple(
    Parameter(f'wrench_weights.{dof}', Real(1e-3, 1e7, or_zero=True), 10000.0, '',
              f'R of {dof}: cost of its error squared; 0: not controlled')
    for dof in DOFS
)

THRUSTER = (
    Parameter('position', Reals((_ANY,) * 3, '[x, y, z]'), REQUIRED, 'm',
              'from the body origin, in vehicle_frame axes', live=False),
    Parameter('direction', Direction(), REQUIRED, '', 'of positive thrust on the vehicle',
              live=False),
    Parameter('bollard_thrust', BollardThrust(), REQUIRED, 'N',
              'greatest thrust at rest [reverse, forward]'),
    Parameter('enabled', Flag(), True, '',
              'whether the thruster may be used'),
    Parameter('weight', _POSITIVE, 1.0, '', 'Q: cost of its thrust squared'),
    Parameter('max_rate', _NOT_NEGATIVE, 0.0, 'N/s',
              'greatest change of thrust; 0: unlimited'),
    Parameter('cutoff', Real(0.0, 1.0, below=True), 0.0, '',
              'share of Bollard thrust below which a limit is not worth using'),
    Parameter('torque_ratio', _ANY, 0.0, 'm', 'k: reaction torque about direction per N',
              live=False),
)

_PROPELLER = (
    Parameter('critical_angle_slope', _NOT_NEGATIVE, 0.20, 'rad*s/m',
              'a*: slope of the first critical angle'),
    Parameter('critical_angle_min', Real(0.0, math.pi / 2, above=True), math.pi / 3, 'rad',
              'lower limit of the first critical angle'),
    Parameter('second_critical_angle_offset', _ANY, 0.0, 'rad',
              'c2: offset of the second critical angle from pi/2'),
    Parameter('second_critical_angle_slope', _ANY, 0.20, 'rad*s/m',
              'b*: slope of the second critical angle'),
    Parameter('opposed_loss', _pair(_NOT_NEGATIVE), (0.0, 0.0), 'N*s/m',
              'Ca: thrust lost per unit of speed in opposed flow [reverse, forward]'),
    Parameter('opposed_floor', Real(0.0, 1.0), 0.85, '',
              'share of Bollard thrust that opposed flow cannot take'),
)
_SPEED_LOSS = Parameter('speed_loss', _pair(_NOT_NEGATIVE), REQUIRED, 'N*s/m',
                        'C: thrust lost per unit of axial speed [reverse, forward]')
_PROPELLER_DATA = (
    Parameter('propeller.diameter', _POSITIVE, REQUIRED, 'm', 'D'),
    Parameter('propeller.max_revolutions', _POSITIVE, REQUIRED, 'rev/s', 'greatest speed'),
    Parameter('propeller.thrust_slope', _POSITIVE, REQUIRED, '',
              'a1: fall of the thrust coefficient per unit of advance ratio'),
)

# The coefficients of each model. A propeller has speed_loss, or the data to compute it from.
MODELS = {
    'propeller': _PROPELLER + (_SPEED_LOSS,) + _PROPELLER_DATA,
    'tunnel': (Parameter('area', _POSITIVE, REQUIRED, 'm^2', 'S: cross-section of the jet'),
               Parameter('decay', _NOT_NEGATIVE, REQUIRED, '', 'c: decay of thrust with speed')),
    'constant': (),
}
_MODEL = Parameter('model', Choice(tuple(MODELS)), REQUIRED, '', 'how speed changes the limits',
                   live=False)
_THRUSTER_NAMES = Parameter('thruster_names', Names(), REQUIRED, '', 'the order of every array',
                            live=False)


@dataclass(frozen=True)
class Parameters:
    """A vehicle's parameters, checked: no missing, unknown or impossible value among them."""

    values: Mapping[str, Any]  # by full name, e.g. 'thrusters.up.weight'; defaults filled in
    definitions: Mapping[str, Parameter]  # of the same names
    warnings: tuple[str, ...]

    def of_thruster(self, name: str) -> dict[str, Any]:
        """Return the values under `thrusters.<name>`, by the name that follows it."""
        prefix = f'thrusters.{name}.'
        return {key.removeprefix(prefix): value for key, value in self.values.items()
                if key.startswith(prefix)}


def read_parameters(given: Mapping[str, Any]) -> Parameters:
    """
    Check a vehicle's parameters and fill in the defaults.

    :param given: values by full dotted name, as `parameter_file` or ROS 2 gives them.
    :raises ParameterError: for the first value that is missing, unknown, of the wrong type or out
        of range, and for values that contradict each other.
    """
    thrusters = _read(given, 'thruster_names', _THRUSTER_NAMES)
    definitions = {'thruster_names': _THRUSTER_NAMES}
    definitions.update((parameter.name, parameter) for parameter in NODE)
    if _read(given, 'velocity_type', definitions['velocity_type']) != 'odometry':
        if 'current_timeout' in given:
            raise ParameterError('current_timeout: is given, must be left out where velocity_type '
                                 'is not odometry: no orientation, no current')
        del definitions['current_timeout']
    _check_thruster_names(given, thrusters)
    for thruster in thrusters:
        prefix = f'thrusters.{thruster}.'
        model = _read(given, prefix + 'model', _MODEL)
        for parameter in (_MODEL, *THRUSTER, *_coefficients(given, prefix, model)):
            definitions[prefix + parameter.name] = parameter

    warnings = []
    for name in [name for name in given if name not in definitions]:
        mistake = ParameterError(f'{name}: is no parameter here{_nearest(name, definitions)}')
        if name.split('.')[0] in ('thrusters', 'wrench_weights'):
            raise mistake
        warnings.append(f'{mistake}; it is ignored')
    values = {name: _read(given, name, parameter) for name, parameter in definitions.items()}
    _check_together(values, thrusters)
    return Parameters(MappingProxyType(values), MappingProxyType(definitions),
                      tuple(sorted(warnings)))


def _read(given: Mapping[str, Any], name: str, parameter: Parameter) -> Any:
    if name in given:
        return parameter.type.read(name, given[name])
    if parameter.default is REQUIRED:
        raise ParameterError(f'{name}: is missing, must be {parameter.type}')
    return parameter.default


def _check_thruster_names(given: Mapping[str, Any], thrusters: tuple[str, ...]) -> None:
    described = {name.split('.')[1] for name in given if name.startswith('thrusters.')}
    for name in sorted(described - set(thrusters)):
        raise ParameterError(f'thrusters.{name}: is not in thruster_names, must be one of '
                             f'{", ".join(thrusters)}{_nearest(name, thrusters)}')
    for name in thrusters:
        if name not in described:
            raise ParameterError(f'thrusters.{name}: is missing, must describe the thruster '
                                 'that thruster_names lists')


def _coefficients(given: Mapping[str, Any], prefix: str, model: str) -> tuple[Parameter, ...]:
    """Return the model's own parameters; of speed_loss and propeller the one that was given."""
    if model != 'propeller':
        return MODELS[model]
    if not any(name.startswith(f'{prefix}propeller.') for name in given):
        if prefix + 'speed_loss' not in given:
            raise ParameterError(f'{prefix}speed_loss: is missing, must be {_SPEED_LOSS.type}; '
                                 f'or give {prefix}propeller instead')
        return _PROPELLER + (_SPEED_LOSS,)
    if prefix + 'speed_loss' in given:
        raise ParameterError(f'{prefix}speed_loss: is given together with {prefix}propeller, '
                             'must stand alone')
    return _PROPELLER + _PROPELLER_DATA


def _check_together(values: Mapping[str, Any], thrusters: tuple[str, ...]) -> None:
    if not any(values[f'wrench_weights.{dof}'] for dof in DOFS):
        raise ParameterError('wrench_weights: are all 0, must leave at least one DOF controlled')
    for thruster in thrusters:
        bollard_thrust = values[f'thrusters.{thruster}.bollard_thrust']
        if f'thrusters.{thruster}.propeller.diameter' in values and bollard_thrust[1] == 0.0:
            raise ParameterError.wrong(
                f'thrusters.{thruster}.bollard_thrust', list(bollard_thrust),
                '[reverse, forward] with forward > 0 where propeller is given; or give speed_loss')


def _nearest(name: str, known: Iterable[str]) -> str:
    """Ask whether the most similar known name was meant: of the same group if there is one."""
    group, _, last = name.rpartition('.')
    siblings = {one.rpartition('.')[2]: one for one in known if one.rpartition('.')[0] == group}
    for candidate, names in ((last, siblings), (name, {one: one for one in known})):
        for close in difflib.get_close_matches(candidate, names, n=1):
            return f'; did you mean {names[close]}?'
    return ''
