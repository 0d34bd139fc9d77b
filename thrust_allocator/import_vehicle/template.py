"""Refuse files that are made into a vehicle's description only by another program."""

from pathlib import Path
import re
import shlex

from thrust_allocator.import_vehicle.configuration import SourceError

# What a template of each kind looks like, and the command that expands it
_KINDS = (
    (re.compile(r'<xacro:\w+|\$\{[^}\n]*\}|\$\(\s*(?:find|arg|env|eval|optenv|anon|dirname)\b'),
     'xacro', 'xacro {file} > {stem}.urdf'),
    (re.compile(r'<%.*?%>', re.S), 'an ERB template', 'erb {file} > {stem}{suffix}'),
    (re.compile(r'\{\{.*?\}\}|\{%.*?%\}', re.S), 'a Jinja template',
     'jinja2 {file} > {stem}{suffix}'),
    (re.compile(r'@\(.*?\)|@\{.*?\}@|@\[.*?\]', re.S), 'an EmPy template',
     'empy3 {file} > {stem}{suffix}'),
    (re.compile(r'@[A-Za-z_]\w*@?'), 'a template with placeholders',
     "the script of its package that fills them in, or sed 's/{match}/VALUE/' {file} > "
     '{stem}{suffix}'))
_COMMENT = {'.sdf': re.compile(r'<!--.*?-->', re.S), '.yaml': re.compile(r'#.*')}


def refuse_template(text: str, path: Path, suffix: str = '.sdf') -> None:
    """
    Raise SourceError with the command that expands a file, if it has anything to expand.

    :param suffix: of what comes of it, .sdf or .yaml.
    """
    text = _COMMENT[suffix].sub(lambda match: re.sub(r'[^\n]', ' ', match[0]), text)
    for pattern, kind, command in _KINDS:
        for match in pattern.finditer(text):
            if text[match.start() - 1:match.start()].isalnum():
                continue  # an address such as somebody@example.org
            line = text.count('\n', 0, match.start()) + 1
            found = ' '.join(match[0].split())
            raise SourceError(
                f'is {kind} (line {line}: {found[:40]}): expand it first with '
                + command.format(file=shlex.quote(str(path)), stem=path.name.split('.')[0],
                                 suffix=suffix, match=found))
