"""A table of measurements as a spreadsheet writes it: columns, units, and each row's numbers."""

import csv
from dataclasses import dataclass
import difflib
import math
from pathlib import Path

from thrust_allocator.fit.errors import FitError

NEWTONS = {'thrust': 1.0, 'thrust_kgf': 9.80665, 'thrust_lbf': 4.4482216152605}  # [N] in each
REQUIRED = ('command', 'speed', 'angle')
OPTIONAL = ('run', 'sigma')
FASTEST = 15.0  # no thruster was towed faster: such a speed is in another unit [m/s]
LARGEST = 1e6  # of a thrust [N]


@dataclass(frozen=True)
class Row:
    """One line of a table: a steady point."""

    line: int  # of the file
    command: float  # as it stands there: rev/min, PWM, V, ...
    speed: float  # through the water [m/s]
    angle: float  # between thrust and motion, 0: moving along positive thrust [rad]
    thrust: float  # signed [N]
    run: str  # empty: none given
    sigma: float  # standard deviation of the thrust; 0: not given [N]


def read_table(path: Path) -> tuple[list[Row], list[str]]:
    """
    Return the rows of a CSV file, and what a user should know about its columns.

    The delimiter may be a comma, a semicolon or a tab; beside the latter two, decimals may have a
    comma. Lines that begin with # and empty ones are passed over.

    :raises FitError: for a file that cannot be read, missing or unknown columns, and a cell that
        is no number or cannot be what its column says.
    """
    lines = [(number, line) for number, line in enumerate(_text(path).splitlines(), 1)
             if line.strip(' \t,;"\r') and not line.lstrip(' "').startswith('#')]
    if not lines:
        raise FitError(f'{path}: is empty, must have a line of column names and rows of numbers')
    delimiter = max(',;\t', key=lines[0][1].count)
    header, *body = ([cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
                     for _, line in lines)
    header = [name.lower() for name in header]
    notes = _check_header(path, header)
    thrust = next(name for name in header if name in NEWTONS)
    rows = []
    for (line, _), cells in zip(lines[1:], body):
        if len(cells) != len(header):
            raise FitError(f'{path}, line {line}: has {len(cells)} cells, must have {len(header)}, '
                           'one for each column')
        rows.append(_row(f'{path}, line {line}', line, dict(zip(header, cells)), thrust,
                         delimiter != ','))
    _check_angles(path, rows)
    return rows, notes


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode('utf-8-sig')
    except OSError as error:
        raise FitError(f'{path}: cannot be read: {error.strerror}') from None
    except UnicodeDecodeError:
        raise FitError(f'{path}: is no text in UTF-8, must be saved as CSV in UTF-8') from None


def _check_header(path: Path, header: list[str]) -> list[str]:
    known = (*REQUIRED, *NEWTONS, *OPTIONAL)
    for name in header:
        if name and header.count(name) > 1:
            raise FitError(f'{path}: has the column {name!r} twice')
    for name in [name for name in header if name not in known]:
        for close in difflib.get_close_matches(name, [one for one in known if one not in header],
                                               n=1, cutoff=0.75):
            raise FitError(f'{path}: has a column {name!r}; did you mean {close!r}?')
    for name in REQUIRED:
        if name not in header:
            raise FitError(f'{path}: has no column {name!r}; its columns are '
                           f'{", ".join(map(repr, header))}')
    given = [name for name in header if name in NEWTONS]
    if len(given) != 1:
        raise FitError(f'{path}: has {" and ".join(map(repr, given)) or "no column of thrust"}, '
                       f'must have just one of {", ".join(map(repr, NEWTONS))}')
    unused = [name for name in header if name not in known and name]
    return [f'columns that are not used: {", ".join(unused)}'] if unused else []


def _row(where: str, line: int, cells: dict[str, str], thrust: str, decimal_comma: bool) -> Row:
    def number(name: str, low: float, high: float, allowed: str) -> float:
        text = cells[name].replace(',', '.') if decimal_comma else cells[name]
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise FitError(f'{where}: {name} is {cells[name]!r}, must be {allowed}')
        return value

    speed = number('speed', 0.0, FASTEST, f'a number in [0, {FASTEST:g}] m/s: astern is an angle')
    angle = 0.0 if speed == 0.0 and not cells['angle'] else number(
        'angle', -360.0, 360.0, 'a number in [-360, 360] degrees')
    unit = NEWTONS[thrust]
    sigma = 0.0
    if 'sigma' in cells:
        sigma = unit * number('sigma', 1e-12, LARGEST / unit, 'a number above 0, in the unit of '
                              'the thrust')
    return Row(line, number('command', -1e9, 1e9, 'a number'), speed,
               abs(math.remainder(math.radians(angle), 2.0 * math.pi)),
               unit * number(thrust, -LARGEST / unit, LARGEST / unit, 'a number'),
               cells.get('run', ''), sigma)


def _check_angles(path: Path, rows: list[Row]) -> None:
    """Refuse a table in radians: no flow but straight ahead is within 3.2 degrees of the axis."""
    angles = [(one.angle, one.line) for one in rows if one.speed and one.angle]
    if angles and max(angles)[0] <= math.radians(3.2) and len({angle for angle, _ in angles}) > 1:
        raise FitError(f'{path}, line {max(angles)[1]}: angle is '
                       f'{math.degrees(max(angles)[0]):.4g}, the largest of all: must be degrees, '
                       'these look like radians; write 0 for straight ahead')
