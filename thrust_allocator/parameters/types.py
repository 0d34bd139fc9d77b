"""Types of parameters: each reads a value from a file or from ROS, or says what is wrong."""

from collections.abc import Sequence
from dataclasses import dataclass
import math
import re
import reprlib

LARGEST = 1e6  # of any magnitude in a vehicle's description, in the unit of its parameter
LARGEST_FORCE = 1e9  # of forces, moments and powers [N, N*m, W]
_NAME = re.compile(r'[A-Za-z][A-Za-z0-9_]*')


class ParameterError(ValueError):
    """A mistake in a vehicle's description; the message is one line and names the parameter."""

    def __init__(self, message: str) -> None:
        """Keep the message, on one line even if what it quotes is not."""
        super().__init__(' '.join(message.split()))

    @classmethod
    def wrong(cls, name: str, value: object, allowed: object) -> 'ParameterError':
        """Build the usual message: which parameter, what it is, what it must be."""
        return cls(f'{name}: is {shown(value)}, must be {allowed}')


def shown(value: object) -> str:
    """Return `value` as an error shows it: as Python writes it, but never long."""
    try:
        return _short.repr(value)
    except ValueError:  # a whole number of thousands of digits, which Python refuses to write
        return 'a very large number'


_short = reprlib.Repr()
_short.maxstring = _short.maxother = 80
_short.maxlist = _short.maxarray = 12


@dataclass(frozen=True)
class Real:
    """A finite real number between two ends; a whole number will do."""

    low: float = -LARGEST
    high: float = LARGEST
    above: bool = False  # the lower end itself is excluded
    below: bool = False  # the upper end itself is excluded
    or_zero: bool = False  # zero is allowed too

    def __str__(self) -> str:
        ends = ('(' if self.above else '[') + f'{self.low:.7g}, {self.high:.7g}'
        return f'{"0 or " if self.or_zero else ""}a number in {ends}{")" if self.below else "]"}'

    def read(self, name: str, value: object) -> float:
        """Return `value` as a float; raise ParameterError unless it is one and in range."""
        try:
            number = as_real(value)
        except (ValueError, OverflowError):
            raise ParameterError.wrong(name, value, self) from None
        inside = self.low <= number <= self.high
        if self.above and number == self.low or self.below and number == self.high:
            inside = False
        if not (inside or self.or_zero and number == 0.0):
            raise ParameterError.wrong(name, value, self)
        return number


def is_exponent(value: object) -> bool:
    """Tell a number such as 1.0e4, which PyYAML and `ros2 param set` take for a word."""
    return isinstance(value, str) and bool(re.fullmatch(
        r'[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)[eE][-+]?[0-9]+', value))


def as_real(value: object) -> float:
    """Return a number as a float, whole or as a word such as 1.0e4; else raise an error."""
    if isinstance(value, bool) or not (isinstance(value, (int, float)) or is_exponent(value)):
        raise ValueError
    return float(value)


@dataclass(frozen=True)
class Reals:
    """A list of real numbers, each of a type of its own."""

    items: tuple[Real, ...]
    layout: str  # e.g. '[x, y, z]'
    besides: str = ''  # what else must hold

    def __str__(self) -> str:
        different = list(dict.fromkeys(str(item) for item in self.items))
        each = f', each {different[0]}' if len(different) == 1 else ': ' + ' and '.join(different)
        return self.layout + each + self.besides

    def read(self, name: str, value: object) -> tuple[float, ...]:
        """Return `value` as floats; raise ParameterError unless length and items are right."""
        if isinstance(value, str) or not isinstance(value, Sequence) \
                or len(value) != len(self.items):
            raise ParameterError.wrong(name, value, self)
        try:
            return tuple(item.read(name, number) for item, number in zip(self.items, value))
        except ParameterError:
            raise ParameterError.wrong(name, list(value), self) from None


@dataclass(frozen=True)
class BollardThrust(Reals):
    """The greatest thrust at rest in reverse (<= 0) and forward (>= 0), not both zero."""

    items: tuple[Real, ...] = (Real(-LARGEST_FORCE, 0.0), Real(0.0, LARGEST_FORCE))
    layout: str = '[reverse, forward]'
    besides: str = ', not both 0'

    def read(self, name: str, value: object) -> tuple[float, ...]:
        """Return (reverse, forward); raise ParameterError if a limit has the wrong sign."""
        limits = super().read(name, value)
        if limits == (0.0, 0.0):
            raise ParameterError.wrong(name, list(value), self)
        return limits


@dataclass(frozen=True)
class Direction(Reals):
    """Three components of a direction, of any length but zero."""

    items: tuple[Real, ...] = (Real(),) * 3
    layout: str = '[x, y, z]'
    besides: str = ', not all 0'

    def read(self, name: str, value: object) -> tuple[float, ...]:
        """Return the vector as it is; raise ParameterError for one without a direction."""
        vector = super().read(name, value)
        if math.hypot(*vector) < 1e-9:
            raise ParameterError.wrong(name, list(value), self)
        return vector


@dataclass(frozen=True)
class Flag:
    """True or false."""

    def __str__(self) -> str:
        return 'true or false'

    def read(self, name: str, value: object) -> bool:
        """Return `value`; raise ParameterError unless it is a bool."""
        if not isinstance(value, bool):
            raise ParameterError.wrong(name, value, self)
        return value


@dataclass(frozen=True)
class Choice:
    """One of a few words."""

    words: tuple[str, ...]

    def __str__(self) -> str:
        return 'one of ' + ', '.join(self.words)

    def read(self, name: str, value: object) -> str:
        """Return `value`; raise ParameterError unless it is one of the words."""
        if value not in self.words:
            raise ParameterError.wrong(name, value, self)
        return value


@dataclass(frozen=True)
class Choices:
    """A list of different words out of a few, at least one."""

    words: tuple[str, ...]

    def __str__(self) -> str:
        return 'a list of one or more of ' + ', '.join(self.words)

    def read(self, name: str, value: object) -> tuple[str, ...]:
        """Return the words; raise ParameterError if one is none of them or stands twice."""
        if isinstance(value, str) or not isinstance(value, Sequence) or not value:
            raise ParameterError.wrong(name, value, self)
        for item in value:
            if item not in self.words:
                raise ParameterError(f'{name}: has the entry {shown(item)}, must be {self}')
            if list(value).count(item) > 1:
                raise ParameterError(f'{name}: has {item!r} twice, must be {self}')
        return tuple(value)


@dataclass(frozen=True)
class Word:
    """A word that is not empty."""

    def __str__(self) -> str:
        return 'a word'

    def read(self, name: str, value: object) -> str:
        """Return `value`; raise ParameterError unless it is a word."""
        if not isinstance(value, str) or not value or value.split() != [value]:
            raise ParameterError.wrong(name, value, self)
        return value


@dataclass(frozen=True)
class Names:
    """A list of different names, at least one."""

    def __str__(self) -> str:
        return ('a list of one or more different names such as tunnel or FL_2 '
                '([A-Za-z][A-Za-z0-9_]*)')

    def read(self, name: str, value: object) -> tuple[str, ...]:
        """Return the names; raise ParameterError if one is malformed or stands twice."""
        if isinstance(value, str) or not isinstance(value, Sequence) or not value:
            raise ParameterError.wrong(name, value, self)
        if all(isinstance(item, bool) for item in value):
            raise ParameterError(
                f'{name}: is {shown(list(value))}, must be {self}; ROS 2 takes y, n, yes, no, on '
                "and off for true and false: they must be quoted, as in 'n'")
        for item in value:
            if not isinstance(item, str) or not _NAME.fullmatch(item):
                raise ParameterError(
                    f'{name}: has the entry {shown(item)}, must be {self}')
        for item in value:
            if list(value).count(item) > 1:
                raise ParameterError(f'{name}: has {item!r} twice, must be {self}')
        return tuple(value)
