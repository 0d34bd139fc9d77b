"""The values of a good vehicle's parameters, changed, and what a refusal says."""

from functools import cache

import pytest
from thrust_allocator.parameters.check import read_parameters
from thrust_allocator.parameters.file import default_parameter_file, read_parameter_file
from thrust_allocator.parameters.types import ParameterError

UP, DOWN, TUNNEL = 'thrusters.up.', 'thrusters.down.', 'thrusters.tunnel.'
PROPELLER = {DOWN + 'propeller.diameter': 0.2, DOWN + 'propeller.max_revolutions': 15.13,
             DOWN + 'propeller.thrust_slope': 0.34}


@cache
def good_vehicle():
    """Return MT-2012, but C of the lower thruster from propeller data, the right one constant."""
    values = read_parameter_file(default_parameter_file())
    for name in ('down.speed_loss', 'right.speed_loss', 'right.opposed_loss'):
        del values[f'thrusters.{name}']
    return values | PROPELLER | {'thrusters.right.model': 'constant'}


def vehicle(changes=(), without=()):
    """Return a good vehicle's values with some changed and some left out."""
    values = good_vehicle() | dict(changes)
    return {name: value for name, value in values.items() if name not in without}


def message(changes=(), without=()):
    """Return the message with which the changed vehicle is refused."""
    with pytest.raises(ParameterError) as caught:
        read_parameters(vehicle(changes, without))
    return str(caught.value)
