"""Values of a parameter file that its own comments mark as guesses."""

from pathlib import Path
import re

GUESS = 'GUESS'  # in the comment behind a value; whoever measures it deletes the word
_MARK = re.compile(rf'[^#]*\S[^#]*#.*\b{GUESS}\b')
_KEY = re.compile(r'( *)["\']?([^\s#"\'{}\[\]:]+)["\']?\s*:(?:\s|$)')


def marked_guesses(path: str | Path) -> list[str]:
    """
    Return the dotted names of the values whose line ends in a comment with the word GUESS.

    The mark stands beside the value that it is about, so it goes where the value goes, and
    whoever replaces the value sees it. The keys above a line are told by their indentation: no
    parser of YAML keeps comments, or takes all that rcl does.

    :param path: a file that can be read.
    """
    names, above = [], []
    for line in Path(path).read_text('utf-8', errors='replace').splitlines():
        if key := _KEY.match(line):
            indent = len(key[1])
            above = [(depth, name) for depth, name in above if depth < indent] + [(indent, key[2])]
        if _MARK.match(line):
            full = '.'.join(name for _, name in above)
            names.append(full.partition('ros__parameters.')[2] or full)
    return names
