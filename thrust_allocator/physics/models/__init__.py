"""
The thruster models, one file each; this is their registry.

A model is found by the word that `model` has in a parameter file.
"""

from thrust_allocator.physics.models.constant import Constant
from thrust_allocator.physics.models.fin import Fin
from thrust_allocator.physics.models.model import Limits, LimitsLaw, ThrusterModel
from thrust_allocator.physics.models.propeller import Propeller
from thrust_allocator.physics.models.tunnel import Tunnel

__all__ = [
    'Constant', 'Fin', 'Limits', 'LimitsLaw', 'MODELS', 'Propeller', 'ThrusterModel', 'Tunnel']

# The one that changes most with the direction of the flow comes first
MODELS: dict[str, type[ThrusterModel]] = {
    kind.NAME: kind for kind in (Propeller, Tunnel, Fin, Constant)}
