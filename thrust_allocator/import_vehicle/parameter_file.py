"""Write a parameter file of a description, with what is known, guessed and missing beside it."""

from collections.abc import Iterator
from pathlib import Path
import re
import textwrap

from thrust_allocator.import_vehicle.configuration import Configuration, Mount
from thrust_allocator.parameters.guesses import GUESS

GUESSED = 40.0  # [N] in either sense, of the order of a small electric thruster
# What rcl, or PyYAML, would not take for a name
_NO_WORDS = {'y', 'n', 'yes', 'no', 'on', 'off', 'true', 'false', 'null', 'nan', 'inf', 'infinity'}
_AXES = {'flu': 'x forward, y left, z up', 'frd': 'x forward, y starboard, z down'}


def parameter_file(found: Configuration) -> str:
    """Return the text of a parameter file that starts the node for a vehicle."""
    names = legal_names([mount.name for mount in found.mounts])
    lines = [*_head(found), '/**:', '  ros__parameters:']
    if found.water_density:
        lines.append(f'    water_density: {_real(found.water_density)}'
                     "   # kg/m^3, the simulator's")
    lines += [f'    vehicle_frame: {found.frame}   # axes of this file',
              '    message_frame: flu   # axes of the topics: REP 103',
              *textwrap.wrap(f'thruster_names: [{", ".join(names)}]', 98, initial_indent='    ',
                             subsequent_indent=' ' * 21),
              '    thrusters:']
    for name, mount in zip(names, found.mounts):
        lines += _thruster(name, mount)
    return '\n'.join(lines) + '\n'


def legal_names(names: list[str]) -> list[str]:
    """Return names of letters, digits and underscores that begin with a letter, each once."""
    legal: list[str] = []
    for name in names:
        word = re.sub(r'[^A-Za-z0-9_]+', '_', name).strip('_')
        if not re.match('[A-Za-z]', word) or word.lower() in _NO_WORDS:
            word = f'thruster_{word}'.rstrip('_')
        candidates = (word if i == 1 else f'{word}_{i}' for i in range(1, len(names) + 2))
        legal.append(next(one for one in candidates if one not in legal))
    return legal


def _head(found: Configuration) -> Iterator[str]:
    yield from _comment(
        f'Written by import_vehicle from {Path(found.source).name} ({found.kind}). '
        f'Axes: {_AXES[found.frame]}. Origin, where wrenches act and odometry must be '
        f'measured unless wrench_origin says otherwise: {found.origin}.')
    yield '#'
    yield '# What is missing, and where it comes from:'
    guessed = sum(None in mount.limits for mount in found.mounts)
    if guessed:
        yield from _item(
            f'Limits of {guessed} of {len(found.mounts)} thrusters, marked {GUESS}; the node '
            'warns of them at each start. Measure them at a bollard, or take them from the '
            "maker's table at your voltage (doc/tutorial.md), then delete the mark.")
    yield from _item(
        'What speed takes: "model: constant" keeps the limits at every speed. Fit speed_loss to '
        'measurements (doc/fit.md), or take the data of your propeller or tunnel '
        '(doc/parameters.md); the propeller of a simulator is no such data.')
    yield from _item(
        'Weights: a DOF left out of wrench_weights is weighted by authority (doc/parameters.md).')


def _item(text: str) -> list[str]:
    return textwrap.wrap(text, 98, initial_indent='# - ', subsequent_indent='#   ')


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text, 98, initial_indent='# ', subsequent_indent='# ')


def _thruster(name: str, mount: Mount) -> Iterator[str]:
    notes = [*([f'"{_plain(mount.name)}" in the source'] if mount.name != name else []),
             *map(_plain, mount.notes)]
    yield f'      {name}:' + (f'   # {"; ".join(notes)}' if notes else '')
    yield '        model: constant   # speed costs nothing: see above'
    yield f'        position: {_list(mount.position)}   # m'
    yield f'        direction: {_list(mount.direction)}   # of positive thrust on the vehicle'
    reverse, forward = mount.limits
    guess = {(True, True): 'the source has no limits',
             (True, False): 'reverse is not in the source, taken as forward',
             (False, True): 'forward is not in the source, taken as reverse',
             (False, False): ''}[reverse is None, forward is None]
    if forward is None:
        forward = -reverse if reverse else GUESSED
    if reverse is None:
        reverse = -forward if forward else -GUESSED
    yield (f'        bollard_thrust: {_list((reverse, forward))}   # N [reverse, forward]'
           + (f', {GUESS}: {guess}' if guess else ''))
    if mount.torque_ratio:
        yield (f'        torque_ratio: {_real(mount.torque_ratio)}   # m, the part of its moment '
               'along its axis')


def _list(values: tuple[float, ...]) -> str:
    return f'[{", ".join(map(_real, values))}]'


def _real(value: float) -> str:
    """Return a number with a decimal point and no exponent, to nine places."""
    text = f'{value:.9f}'.rstrip('0')
    text = text + '0' if text.endswith('.') else text
    return '0.0' if text == '-0.0' else text


def _plain(text: str) -> str:
    return ' '.join(''.join(c if c.isprintable() else ' ' for c in text).split())
