"""What a fit says as a piece of a parameter file."""

from pathlib import Path

from thrust_allocator.fit.law import Law
from thrust_allocator.fit.solution import Solution
from thrust_allocator.parameters.guesses import GUESS
from thrust_allocator.physics.models import Propeller, Tunnel

UNITS = {'bollard_thrust': 'N [reverse, forward]', 'speed_loss': 'N*s/m',
         'speed_loss_quadratic': 'N*s^2/m^2', 'critical_angle_slope': 'rad*s/m',
         'opposed_loss': 'N*s/m', 'area': 'm^2'}


def snippet(solution: Solution, name: str, table: Path, area_given: bool) -> str:
    """Return the lines under `thrusters: NAME:`."""
    law = solution.problem.law
    limits = solution.problem.curves.limits(solution.x)
    model = law.thruster(limits, solution.coefficients)
    lines = [f'# Fitted to {table.name} up to {solution.problem.rows.top_speed:g} m/s. Add '
             "the thruster's position and direction.",
             'thrusters:', f'  {name}:', f'    model: {law.model}',
             _line('bollard_thrust', model.bollard_thrust)]
    if isinstance(model, Tunnel):
        lines += [_line('area', law.values['area'], '' if area_given else 'assumed: only its '
                        'product with decay counts'),
                  _line('decay', model.jet_mass * model.decay / (
                      law.values['water_density'] * law.values['area']),
                      f'at water_density {law.values["water_density"]:g}')]
        return '\n'.join(lines) + '\n'
    assert isinstance(model, Propeller)
    lines.append(f'    angle_law: {model.angle_law}')
    lines.append(_line('speed_loss', *_with_scaled(law, 'speed_loss', model)))
    if 'speed_loss_quadratic' in law.names:
        lines.append(_line('speed_loss_quadratic',
                           *_with_scaled(law, 'speed_loss_quadratic', model)))
    lines += [_line(one, getattr(model, one)) for one in ('critical_angle_slope', 'opposed_loss')
              if one in law.names]
    return '\n'.join(lines) + '\n'


def _with_scaled(law: Law, name: str, model: Propeller) -> tuple[tuple[float, float], str]:
    """
    Return the value of each sense, and a comment.

    Of a sense that no run has told, it is scaled from the other one with the Bollard limits.
    """
    pair = list(getattr(model, name))
    fitted = [one.side for one in law.coefficients if one.name == name]
    for side, sense in enumerate(('reverse', 'forward')):
        if side not in fitted and model.bollard_thrust[side]:
            ratio = abs(model.bollard_thrust[side] / model.bollard_thrust[1 - side])
            pair[side] = pair[1 - side] * ratio
            return (pair[0], pair[1]), f'{GUESS}: {sense} is scaled, which is optimistic'
    return (pair[0], pair[1]), ''


def _line(name: str, value: object, comment: str = '') -> str:
    text = f'[{", ".join(map(_number, value))}]' if isinstance(value, tuple) else _number(value)
    notes = ', '.join(filter(None, (UNITS.get(name, ''), comment)))
    return f'    {name}: {text}' + (f'    # {notes}' if notes else '')


def _number(value: object) -> str:
    """
    Write a number with six digits and a decimal point, which ROS 2 wants in lists.

    A fit deserves three, but safe coefficients are not to be rounded to the wrong side.
    """
    text = f'{float(value):.6g}'  # type: ignore[arg-type]
    text = f'{float(text):.12f}'.rstrip('0') if 'e' in text else text
    return text + ('' if '.' in text else '.0') + ('0' if text.endswith('.') else '')
