"""What a fit found, and how far it can be trusted, as Markdown."""

import numpy as np
from thrust_allocator.fit.certainty import Certainty, CORRELATED
from thrust_allocator.fit.measurements import SENSES
from thrust_allocator.fit.solution import Solution
from thrust_allocator.markdown import table

_ODD = 0.05  # share of the largest thrust by which a law that fits is not off


def report(solution: Solution, certainty: Certainty, snippet: str, title: str,
           warnings: list[str]) -> str:
    """Return the report of the best fit; the snippet may be of a safe one."""
    rows = solution.problem.rows
    parts = [f'# {title}', f'```yaml\n{snippet}```']
    if warnings:
        parts.append('\n'.join(f'**WARN** {warning}.\n' for warning in warnings).rstrip())
    parts += ['## Coefficients', _coefficients(solution, certainty), _trust(certainty)]
    parts += ['## What the table cannot tell',
              '\n'.join(f'- {reason}' for reason in solution.problem.law.reasons)]
    parts += ['## Errors', 'Signed: + is optimistic, the law promises more than was measured.',
              figures(solution, certainty), _runs(solution, certainty)]
    parts += [f'Rows: {len(rows)}, of which {int(rows.at_rest.sum())} at rest. Fastest run: '
              f'{rows.top_speed:g} m/s; beyond it the law is a guess. '
              'A thrust above that at rest, or against its sense, is no law\'s: it is held '
              'against the nearest that is.']
    return '\n\n'.join(parts) + '\n'


def figures(solution: Solution, certainty: Certainty) -> str:
    """Return the figures to trust, with those of the fit itself beside them."""
    full, flow = solution.problem.rows.full, ~solution.problem.rows.at_rest
    lines = [('of the fit, rows in a flow', solution.error[flow])]
    if certainty.left_out:
        lines.append(('of runs that were left out',
                      np.concatenate([one.error for one in certainty.left_out])))
    return table(
        ('error', 'rows', 'RMS [N]', 'RMS [% of Bollard]', 'optimism, 95th percentile [N]',
         'worst optimism [N]'),
        [(name, str(len(error)), f'{np.sqrt((error**2).mean()):.3g}',
          f'{100.0 * np.sqrt((error**2).mean()) / full:.2f}',
          f'{np.percentile(error, 95.0):+.3g}', f'{error.max():+.3g}') for name, error in lines])


def labels(solution: Solution) -> list[str]:
    """Return the names of the coefficients and of the Bollard limits that there are."""
    return [*map(str, solution.problem.law.coefficients),
            *(f'bollard_thrust {SENSES[side]}' for side, place
              in enumerate(solution.problem.curves.top) if place is not None)]


def _coefficients(solution: Solution, certainty: Certainty) -> str:
    limits = [abs(one) for one in solution.problem.curves.limits(solution.x) if one]
    units = [*(one.unit for one in solution.problem.law.coefficients), *['N'] * len(limits)]
    values = [*solution.coefficients, *limits]
    intervals = [('not known', '')] * len(values) if certainty.interval is None else [
        (f'{low:.4g}', f'{high:.4g}') for low, high in certainty.interval]
    return table(('coefficient', 'unit', 'value', '95 % from', 'to'),
                 [(name, unit, f'{value:.4g}', *ends) for name, unit, value, ends in zip(
                     labels(solution), units, values, intervals)])


def _trust(certainty: Certainty) -> str:
    if certainty.interval is None:
        return 'No interval: the table has no row to spare. Measure more, or give sigma.'
    return ('Intervals: ' + ('the wider of a bootstrap over runs and ' if certainty.bootstrap
                             else 'there are too few runs for a bootstrap; ')
            + 'the Jacobian, which takes rows for independent.')


def findings(solution: Solution, certainty: Certainty) -> list[str]:
    """Return what is odd about the coefficients, a sentence each."""
    names = labels(solution)
    curves, full = solution.problem.curves, solution.problem.rows.full
    found = [f'bollard_thrust {SENSES[side]} comes out as {solution.x[place]:.4g} N where '
             f'{curves.start[place]:.4g} N were measured: the law does not describe these rows; '
             'are angles and speeds right?'
             for side, place in enumerate(curves.top) if place is not None
             and abs(solution.x[place] - curves.start[place]) > _ODD * full]
    rms = float(np.sqrt((solution.error**2).mean()))
    if rms > _ODD * full:
        found.append(f'the rows are {rms:.3g} N off the law on average, {100.0 * rms / full:.0f} % '
                     'of the largest thrust: it does not describe them')
    found += [f'{names[i]} is at an end of its range: the rows ask for more of it, or none'
              for i in certainty.at_limit]
    found += [f'{names[j]} and {names[i]} go together (correlation {value:+.2f}, above '
              f'{CORRELATED:g} in size): the rows tell their sum better than each'
              for i, j, value in certainty.correlated]
    if certainty.only:
        found.append(f'{len(certainty.only)} of the runs could not be left out: nothing else '
                     'tells a coefficient')
    return found


def _runs(solution: Solution, certainty: Certainty) -> str:
    """Return the error of each run that was left out."""
    if not certainty.left_out:
        return 'No run could be left out: the errors above are those of rows that made the fit.'
    rows = solution.problem.rows
    place = {line: i for i, line in enumerate(rows.line.tolist())}
    lines = []
    for one in sorted(certainty.left_out, key=lambda one: one.lines.min()):
        mine = [place[line] for line in one.lines.tolist()]
        lines.append((
            _lines(one.lines.tolist()), _range(rows.speed[mine]),
            _range(np.degrees(rows.angle[mine]).round()),
            f'{np.sqrt((one.error**2).mean()):.3g}', f'{one.error.max():+.3g}'))
    return table(('left out: lines', 'speed [m/s]', 'angle [deg]', 'RMS [N]', 'most [N]'), lines)


def _range(values: np.ndarray) -> str:
    low, high = f'{values.min():g}', f'{values.max():g}'
    return low if low == high else f'{low}–{high}'


def _lines(numbers: list[int]) -> str:
    if len(numbers) > 6:
        return f'{len(numbers)} from {min(numbers)} to {max(numbers)}'
    return ', '.join(map(str, numbers))
