"""The fit's process: `ros2 run thrust_allocator fit TABLE.csv --thruster NAME --output DIR`."""

import argparse
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
import sys

from thrust_allocator.fit.bollard import bollard_curves
from thrust_allocator.fit.certainty import certainty
from thrust_allocator.fit.errors import FitError
from thrust_allocator.fit.law import propeller_law, tunnel_law
from thrust_allocator.fit.measurements import Measurements, sort_out
from thrust_allocator.fit.options import parse
from thrust_allocator.fit.report import findings, report
from thrust_allocator.fit.safe import safe
from thrust_allocator.fit.snippet import snippet
from thrust_allocator.fit.solution import Problem, solve, Solution
from thrust_allocator.fit.table import read_table
from thrust_allocator.study.progress import Progress


def main(args: Sequence[str] | None = None) -> int:
    """
    Fit coefficients to a table, write them with a report, and print the snippet.

    :param args: the command line, program name first; None for the process's own.
    :return: the exit status: 0, or 1 for a table that cannot be used. A mistake on the command
        line exits with status 2.
    """
    options = parse(list(sys.argv if args is None else args)[1:])
    try:
        _fit(options)
    except FitError as error:
        print(f'fit: {error}', file=sys.stderr)
        return 1
    return 0


def _fit(options: argparse.Namespace) -> None:
    table, notes = read_table(options.table)
    rows = sort_out(table, options.table, options.neutral)
    if len(rows) < len(table):
        notes.append(f'{len(table) - len(rows)} rows at the neutral command are not used')
    law = (tunnel_law(rows, options.area, options.water_density) if options.model == 'tunnel'
           else propeller_law(rows, options.law, options.quadratic))
    found = solve(Problem(rows, law, bollard_curves(rows)))
    judged = certainty(found, Progress('fit', 'runs left out'))
    warnings = [*notes, *_doubts(rows, options.top_speed), *findings(found, judged)]
    chosen = found
    if options.safe:
        chosen, above = safe(found)
        warnings.append('the snippet has the safe coefficients (--safe), the report beside it '
                        'those of the best fit')
        if len(above):
            warnings.append('no coefficients bring these lines within their sigma: '
                            + ', '.join(map(str, above)))
    text = snippet(chosen, options.thruster, options.table, options.area is not None)
    for warning in warnings:
        print(f'fit: WARN: {warning}', file=sys.stderr)
    title = f'{options.thruster}, fitted to {options.table.name}'
    page = report(found, judged, text, title, warnings)
    if options.safe:
        page += (f'\nWith the safe coefficients the most optimistic row is '
                 f'{chosen.error.max():+.3g} N off, the most pessimistic '
                 f'{chosen.error.min():+.3g} N.\n')
    drawn = _write(options.output, text, page, chosen, title)
    print(text, end='')
    print(f'{options.output}: fit.yaml, report.md' + (', fit.png, fit.svg' if drawn else ''),
          file=sys.stderr)


def _doubts(rows: Measurements, top_speed: float | None) -> list[str]:
    found = []
    if top_speed and top_speed > rows.top_speed:
        found.append(f'the vehicle does {top_speed:g} m/s, the fastest run is '
                     f'{rows.top_speed:g} m/s: beyond it nothing was measured')
    speeds = set(rows.speed[~rows.at_rest].tolist())
    if len(speeds) == 1:
        found.append(f'all runs are at {speeds.pop():g} m/s: whether the loss grows faster than '
                     'in proportion nothing tells; do not go faster by it')
    return found


def _write(folder: Path, text: str, page: str, chosen: Solution, title: str) -> bool:
    """Write the files; return whether there are pictures among them."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / 'fit.yaml').write_text(text, encoding='utf-8')
        drawn = find_spec('matplotlib') is not None
        if drawn:
            from thrust_allocator.fit.picture import draw
            draw(chosen, title, folder / 'fit')
            page += '\n![measured and law](fit.svg)\n'
        else:
            print("fit: WARN: no picture, which needs matplotlib: pip install '.[plot]'",
                  file=sys.stderr)
        (folder / 'report.md').write_text(page, encoding='utf-8')
    except OSError as error:
        raise FitError(f'--output: {folder} cannot be written: {error.strerror}') from None
    return drawn


if __name__ == '__main__':
    sys.exit(main())
