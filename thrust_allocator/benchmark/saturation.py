"""What gives way beyond reach, beside a published table and for the vehicles of this package."""

import numpy as np
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.file import default_parameter_file
from thrust_allocator.physics.models import Constant
from thrust_allocator.physics.vehicle import Thruster, Vehicle
from thrust_allocator.solve.authority import authority_weights
from thrust_allocator.study.saturation import reach_of, saturation, saturation_table

COMMANDS = 20_000  # as many as were published

# An eight-thruster competition AUV: repository AUV-Thruster-Allocation of Tiburon.
# Rows surge ... yaw, columns its thrusters; its limits are +-1
MATRIX = np.array([
    [0, 0, 0, 0, 0.7070, -0.7070, 0.7070, 0.7070],
    [0, 0, 0, 0, -0.7070, 0.7070, 0.7070, -0.7070],
    [1, 1, 1, 1, 0, 0, 0, 0],
    [0.17, -0.12, 0.12, -0.12, -0.014, 0.014, -0.014, 0.014],
    [-0.12, -0.12, 0.15, 0.15, -0.014, -0.014, -0.014, -0.014],
    [0, 0, 0, 0, 0.0346, 0.0346, -0.325, 0.325]])
AUTHORITY = np.array([1.414, 1.198, 3.268, 0.488, 0.492, 0.336])  # by its own pseudo-inverse
PUBLISHED = (  # direction error mean, 95 % of the commands, worst [deg]; lost [%]
    ('published: its flown allocator', 17.1, 39.1, 67.7, 37.8),
    ('published: clipping each thruster', 18.0, 42.6, 80.3, 32.7),
    ('published: uniform scaling', 0.0, 0.0, 0.0, 45.2),
    ('published: the limit with the direction kept', 0.0, 0.0, 0.0, 38.2))


def competition_vehicle() -> Vehicle:
    """Return the vehicle of the published table, with weights by authority."""
    thrusters = []
    for i, column in enumerate(MATRIX.T):
        size = float(np.linalg.norm(column[:3]))
        along, moment = column[:3] / size, column[3:] / size
        thrusters.append(Thruster(
            f't{i + 1}', tuple(np.cross(along, moment).tolist()), tuple(along.tolist()),
            Constant((-size, size)), torque_ratio=float(along @ moment)))
    bare = Vehicle(tuple(thrusters), (1.0,) * 6)
    return Vehicle(bare.thrusters, tuple(authority_weights(reach_of(bare)).tolist()))


def report(commands: int = COMMANDS) -> None:
    """Print the tables."""
    print('### An eight-thruster competition AUV, published and ours\n')
    found = saturation(competition_vehicle(), AUTHORITY, commands)
    print(saturation_table(found, PUBLISHED), end='\n\n')
    folder = default_parameter_file().parent
    for file in sorted(folder.glob('*.yaml')):
        vehicle = load_vehicle(file)
        print(f'### {file.stem}\n')
        found = saturation(vehicle, reach_of(vehicle), commands)
        print(saturation_table(found), end='\n\n', flush=True)
