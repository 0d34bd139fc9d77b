"""Names of parameters that are to come: refused until they are built, so that none is ignored."""

from collections.abc import Iterable
from fnmatch import fnmatchcase

from thrust_allocator.parameters.types import ParameterError

# Whoever builds one deletes its line; * stands for any thruster
RESERVED = (
    'tick_on_wrench',
)


def refuse_reserved(names: Iterable[str]) -> None:
    """Raise ParameterError for the first name that is reserved."""
    for name in names:
        if any(fnmatchcase(name, pattern) for pattern in RESERVED):
            raise ParameterError(f'{name}: is not built yet, must be left out')
