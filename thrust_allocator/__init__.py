"""
Thrust allocation for underwater vehicles, with thrust bounds that move with the vehicle's speed.

Data flows one way: YAML file -> `parameters` -> vehicle and bounds (`physics`) -> the quadratic
programme (`solve`) -> `tick` -> messages (`ros`). What stands here needs no ROS.
"""

from importlib import import_module
from typing import Any

# Imported when asked for, so that the command's table of programs needs none of it
_PLACES = {
    'AllocationProblem': 'thrust_allocator.solve.problem',
    'Allocator': 'thrust_allocator.tick',
    'load_vehicle': 'thrust_allocator.parameters.build',
    'ThrustBounds': 'thrust_allocator.physics.bounds',
}
__all__ = list(_PLACES)


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(import_module(_PLACES[name]), name)
