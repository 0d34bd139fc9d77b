"""Values of a parameter file that its own comments mark as guesses."""

from collections.abc import Iterator
from pathlib import Path
import re

import yaml

GUESS = 'GUESS'  # in the comment behind a value; whoever measures it deletes the word
_MARK = re.compile(rf'\s*#.*\b{GUESS}\b')


def marked_guesses(path: str | Path) -> list[str]:
    """
    Return the dotted names of the values whose line ends in a comment with the word GUESS.

    The mark stands beside the value that it is about, so it goes where the value goes, and
    whoever replaces the value sees it.

    :param path: a file that `parameters.file` has read already.
    """
    text = Path(path).read_text('utf-8')
    if GUESS not in text:
        return []
    return list(_guesses(yaml.compose(text, yaml.SafeLoader), text.splitlines(), ()))


def _guesses(node: yaml.Node | None, lines: list[str], above: tuple[str, ...]) -> Iterator[str]:
    if not isinstance(node, yaml.MappingNode):
        return
    for key, value in node.value:
        name = (*above, str(key.value))
        if isinstance(value, yaml.MappingNode):
            yield from _guesses(value, lines, name)
        elif _MARK.match(lines[value.end_mark.line][value.end_mark.column:]):
            yield '.'.join(name).partition('ros__parameters.')[2]
