"""Every parameter of a vehicle: name, type, default, unit and meaning."""

from thrust_allocator.parameters.definition import (
    ANY, BY_AUTHORITY, Definition, NOT_NEGATIVE, POSITIVE, POWER, REQUIRED)
from thrust_allocator.parameters.types import (
    Choice, Choices, Direction, Flag, Names, Real, Reals, Word)
from thrust_allocator.physics.frames import DOFS, FRAMES
from thrust_allocator.physics.models import MODELS

THRUSTER_NAMES = Definition('thruster_names', Names(), REQUIRED, '', 'the order of every array',
                            live=False)

NODE = (
    Definition('rate', Real(0.0, 1000.0, above=True), 50.0, 'Hz',
               'ticks per second; with tick_on_wrench 2/3 of it, if no wrench comes, to twice it'),
    Definition('tick_on_wrench', Flag(), True, '',
               'whether a wrench makes a tick at once, and the timer one only where none comes'),
    Definition('water_density', POSITIVE, 1025.0, 'kg/m^3', 'density of the water'),
    Definition('vehicle_frame', Choice(FRAMES), 'frd', '', 'axes of positions and directions',
               live=False),
    Definition('message_frame', Choice(FRAMES), 'flu', '', 'axes of all wrenches and the twist',
               live=False),
    Definition('wrench_origin', Reals((ANY,) * 3, '[x, y, z]'), (0.0, 0.0, 0.0), 'm',
               'where all wrenches act, e.g. the centre of gravity, in vehicle_frame axes'),
    Definition('start_enabled', Flag(), True, '',
               'whether the node allocates before ~/enable is called', live=False),
    Definition('wrench_timeout', POSITIVE, 0.5, 's', 'age at which a wrench counts no more'),
    Definition('odometry_timeout', NOT_NEGATIVE, 0.5, 's',
               'age at which a velocity counts no more; 0: no odometry is expected'),
    Definition('current_timeout', POSITIVE, 10.0, 's', 'age at which a current counts no more'),
    Definition('velocity_time_constant', NOT_NEGATIVE, 0.0, 's',
               'of the first-order filter on the velocity that moves the limits; 0: none'),
    Definition('fallback_velocity', Reals((ANY,) * 3, '[x, y, z]'), (0.0, 0.0, 0.0), 'm/s',
               'velocity through the water while no odometry comes, in message_frame axes'),
    Definition('nominal_voltage', NOT_NEGATIVE, 0.0, 'V',
               'at which bollard_thrust holds; 0: the battery is not considered'),
    Definition('voltage_exponent', Real(0.0, 3.0), 1.2, '',
               'n: the limits at rest go with (voltage / nominal_voltage)^n'),
    Definition('stamped_wrench', Flag(), False, '', 'whether cmd_wrench is a WrenchStamped',
               live=False),
    Definition('velocity_type', Choice(('odometry', 'twist', 'twist_with_covariance')), 'odometry',
               '', 'Odometry on odom, or TwistStamped or TwistWithCovarianceStamped on twist',
               live=False),
    Definition('setpoint_unit', Choice(('newton', 'bollard_newton', 'bollard_fraction')), 'newton',
               '', 'of thruster_setpoints: thrust in the flow, or what gives it at rest',
               live=False),
    Definition('publish_individual', Flag(), False, '',
               'whether each thrust in the flow, in N, goes out on thrusters/<name>/thrust too'),
    Definition('marker_frame', Word(), 'base_link', '', 'frame id of thruster_markers'),
) + tuple(
    Definition(f'wrench_weights.{dof}', Real(1e-3, 1e7, or_zero=True), BY_AUTHORITY, '',
               f'R of {dof}: cost of its error squared; 0: not controlled')
    for dof in DOFS
) + (
    Definition('direction_keeping', Real(0.0, 1.0), 0.0, '',
               'beyond reach: 0: the weights decide what gives way, 1: the wrench keeps its '
               'direction'),
    Definition('direction_keeping_dofs', Choices(DOFS), DOFS, '',
               'which DOFs are scaled together to keep the direction'),
    Definition('power_limit', POWER, 0.0, 'W', 'of all thrusters together; 0: none'),
)

THRUSTER = (
    Definition('model', Choice(tuple(MODELS)), REQUIRED, '', 'how speed changes the limits',
               live=False),
    Definition('position', Reals((ANY,) * 3, '[x, y, z]'), REQUIRED, 'm',
               'from the body origin, in vehicle_frame axes', live=False),
    Definition('direction', Direction(), REQUIRED, '', 'of positive thrust on the vehicle',
               live=False),
    Definition('enabled', Flag(), True, '',
               'whether the thruster may be used'),
    Definition('effectiveness', Real(0.0, 1.0), 1.0, '',
               'share of its thrust limits that a worn, fouled or damaged thruster has left'),
    Definition('weight', POSITIVE, 1.0, '', 'Q: cost of its thrust squared'),
    Definition('max_rate', NOT_NEGATIVE, 0.0, 'N/s or rad/s',
               "greatest change of thrust, or of a fin's deflection; 0: unlimited"),
)
