"""What is known of a parameter before it has a value."""

from typing import Any, NamedTuple

from thrust_allocator.parameters.types import LARGEST, Real, Reals

REQUIRED = object()  # stands where a default would
BY_AUTHORITY = object()  # too: what follows from what the vehicle can give

POSITIVE = Real(0.0, LARGEST, above=True)
NOT_NEGATIVE = Real(0.0, LARGEST)
POWER = Real(0.0, 1e9)
ANY = Real()


class Definition(NamedTuple):
    """One parameter: `name` is relative to where it stands (the node, or a thruster)."""

    name: str
    type: Any  # from `types`: has read(name, value), and str() says what is allowed
    default: Any
    unit: str
    meaning: str
    live: bool = True  # whether it can be changed while the node runs


def pair(item: Real) -> Reals:
    """Return the type of a list with one value per sense of thrust."""
    return Reals((item, item), '[reverse, forward]')
