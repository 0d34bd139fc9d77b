"""Which known name a wrong one was meant for."""

from collections.abc import Collection, Iterable
import difflib

LONG = 8  # letters from which on two may be wrong


def is_slip(name: str, known: Iterable[str]) -> bool:
    """Tell whether a name is one of the known ones but for one letter, or two of a long one."""
    return any(_within(name, one, 2 if len(one) >= LONG else 1) for one in known)


def nearest(name: str, known: Collection[str]) -> str:
    """Ask whether the most similar known name was meant: of the same group if there is one."""
    group, _, last = name.rpartition('.')
    siblings = {one.rpartition('.')[2]: one for one in known if one.rpartition('.')[0] == group}
    for candidate, names in ((last, siblings), (name, {one: one for one in known})):
        for close in difflib.get_close_matches(candidate, names, n=1):
            return f'; did you mean {names[close]}?'
    return ''


def _within(one: str, other: str, distance: int) -> bool:
    """Tell whether so many letters put in, taken out or exchanged lead from one to the other."""
    if abs(len(one) - len(other)) > distance:
        return False
    same = 0
    for a, b in zip(one, other):
        if a != b:
            break
        same += 1
    one, other = one[same:], other[same:]
    if not one or not other:
        return True  # the rest, which is short enough, is put in or taken out
    return distance > 0 and (_within(one[1:], other[1:], distance - 1)
                             or _within(one[1:], other, distance - 1)
                             or _within(one, other[1:], distance - 1))
