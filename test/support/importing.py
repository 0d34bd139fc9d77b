"""Run the importer on a text, and write URDF and SDF that hold only what a test is about."""

from pathlib import Path

import numpy as np
from thrust_allocator import load_vehicle
from thrust_allocator.import_vehicle.__main__ import main
from thrust_allocator.physics.frames import frd_signs

GZ = '<plugin filename="gz-sim-thruster-system" name="gz::sim::systems::Thruster">{}</plugin>'


def run(*args) -> int:
    """Return the exit status of the command."""
    return main(['import_vehicle', *map(str, args)])


def matrix(file: Path, frame: str = 'flu') -> np.ndarray:
    """Return the configuration matrix (6, p) of a parameter file, in the axes of a frame."""
    return frd_signs(frame)[:, None] * load_vehicle(file).configuration_matrix


def gz_thruster(joint: str, more: str = '') -> str:
    """Return gz-sim's plugin for a joint."""
    return GZ.format(f'<joint_name>{joint}</joint_name>{more}')


def sdf(body: str, version: str = '1.9', plugins: str = '') -> str:
    """Return an SDF of a model `auv` with a base link."""
    return (f'<?xml version="1.0"?>\n<sdf version="{version}"><model name="auv">'
            f'<link name="base_link"/>{body}{plugins}</model></sdf>')


def sdf_thruster(name: str, pose: str, axis: str = '1 0 0', parent: str = 'base_link',
                 pose_attributes: str = '', joint: str = '', plugin: str = '') -> str:
    """Return link, joint and plugin of a thruster."""
    return (f'<link name="{name}"><pose {pose_attributes}>{pose}</pose></link>'
            f'<joint name="{name}_joint" type="revolute"><parent>{parent}</parent>'
            f'<child>{name}</child>{joint}<axis><xyz>{axis}</xyz></axis></joint>'
            + gz_thruster(f'{name}_joint', plugin))


def urdf_joint(name: str, parent: str, child: str, xyz: str = '0 0 0', rpy: str = '0 0 0',
               kind: str = 'fixed', axis: str = '1 0 0', more: str = '') -> str:
    """Return a joint and its child link."""
    return (f'<link name="{child}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{more}'
            '</joint>')


def urdf(body: str) -> str:
    """Return a URDF of a robot `auv` with a base link."""
    return f'<?xml version="1.0"?>\n<robot name="auv"><link name="base_link"/>{body}</robot>'
