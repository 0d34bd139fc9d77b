"""Compare two descriptions of one vehicle, DOF by DOF and thruster by thruster, in words."""

from pathlib import Path
import re

import numpy as np
from scipy.optimize import linear_sum_assignment
from thrust_allocator.import_vehicle.configuration import Configuration
from thrust_allocator.physics.frames import DOFS, frd_signs

SAME = 0.01  # share of a DOF's largest entry up to which two entries are the same
SCALED = 0.05  # and up to which they are one row that is scaled
NOTHING = 1e-6  # [-, m], a row that no thruster acts on


def compare(one: Configuration, other: Configuration) -> tuple[list[str], list[str]]:
    """
    Return in what two descriptions agree, and in what they do not, one sentence each.

    Thrusters are paired by name where all have one in common, else by their order. Where one of a
    pair pushes the other way, that is said once, and left out of the rest. Numbers are in the
    axes of the first.
    """
    pairs, by_name = _pairs(one, other)
    files = [Path(each.source).name for each in (one, other)]
    if files[0] == files[1]:
        files = [one.source, other.source]
    unpaired = [f'{len(one.mounts)} thrusters in {files[0]}, {len(other.mounts)} in {files[1]}'
                ] if len(one.mounts) != len(other.mounts) else []
    signs = frd_signs(one.frame)[:, np.newaxis]
    a = signs * one.matrix[:, [i for i, _ in pairs]]
    b = signs * other.matrix[:, [j for _, j in pairs]]
    names = [one.mounts[i].name for i, _ in pairs]
    agreed = [] if by_name else ['the thrusters have different names and are compared in their '
                                 'order: ' + ', '.join(
                                     f'{one.mounts[i].name} with {other.mounts[j].name}'
                                     for i, j in pairs)]
    if unpaired and not by_name:
        return [], unpaired
    if not _same(a, b).all():
        hint = _whole(a, b, one, other)
        if hint:
            return agreed, [*unpaired, hint, *_limits(one, other, pairs)]
    senses = np.where(np.sum(a[:3] * b[:3], axis=0) < -0.5, -1.0, 1.0)
    turned = [name for name, sense in zip(names, senses) if sense < 0.0]
    differences = [*unpaired]
    if turned:
        differences.append(f'{", ".join(turned)}: positive thrust pushes the other way')
    for dof, p, q in zip(DOFS, a, b * senses):
        found = _row(dof, p, q, names, *files)
        (differences if found else agreed).append(found or f'{dof} agrees')
    differences += _thrusters(a, b * senses, names)
    turned_over = frd_signs('flu')[:, None] * a
    if not _same(a, b).all() and np.abs(turned_over - b).sum() < 0.5 * np.abs(a - b).sum():
        differences.append('more than half of this goes away if one of the two is in flu axes and '
                           'the other in frd: is --frame right?')
    return agreed, differences + _limits(one, other, pairs)


def _pairs(one: Configuration, other: Configuration) -> tuple[list[tuple[int, int]], bool]:
    """Return pairs of indices, and whether they are paired by name."""
    plain = [[re.sub(r'[^a-z0-9]', '', mount.name.lower()) for mount in each.mounts]
             for each in (one, other)]
    common = [(i, plain[1].index(name)) for i, name in enumerate(plain[0]) if name in plain[1]]
    if len(common) == min(map(len, plain)) and len(set(plain[0])) == len(plain[0]):
        return common, True
    return list(zip(range(len(plain[0])), range(len(plain[1])))), False


def _same(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Tell which DOFs (6,) are the same in two matrices (6, p)."""
    largest = np.maximum(np.abs(a), np.abs(b)).max(axis=1)
    return np.abs(a - b).max(axis=1) <= np.maximum(SAME * largest, NOTHING)


def _whole(a: np.ndarray, b: np.ndarray, one: Configuration, other: Configuration) -> str:
    """Return the one reason that explains all of the difference, or ''."""
    if _same(frd_signs('flu')[:, None] * a, b).all():
        return ('sway, heave, pitch and yaw have the other sign throughout: one of the two is in '
                'flu axes, the other in frd')
    if a.shape == b.shape:
        cost = np.abs(a[:, :, None] - b[:, None, :]).max(axis=0)
        rows, columns = linear_sum_assignment(cost)
        if _same(a, b[:, columns]).all():
            return ('the thrusters come in another order: ' + ', '.join(
                f'{one.mounts[i].name} is {other.mounts[j].name}' for i, j in zip(rows, columns)))
    return ''


def _row(dof: str, a: np.ndarray, b: np.ndarray, names: list[str], one: str, other: str) -> str:
    """Return in words how a row (p,) differs from another, or '' if it does not."""
    largest = max(np.abs(a).max(), np.abs(b).max())
    if np.abs(a - b).max() <= max(SAME * largest, NOTHING):
        return ''
    for row, has, has_not in ((a, other, one), (b, one, other)):
        if np.abs(row).max() <= NOTHING:
            return f'{dof}: thrusters act on it in {has}, none in {has_not}'
    scale = float(a @ b / (b @ b))
    if np.abs(a - scale * b).max() <= SCALED * largest:
        sign = 'the other sign throughout' if scale < 0.0 else ''
        if abs(abs(scale) - 1.0) <= SAME:
            return f'{dof}: {sign}'
        what = 'arms' if DOFS.index(dof) > 2 else 'components'
        apart = (f'{what} {abs(abs(scale) - 1.0):.0%} '
                 f'{"longer" if abs(scale) > 1.0 else "shorter"} in {one}').replace('%', ' %')
        return f'{dof}: {", and ".join(part for part in (sign, apart) if part)}'
    differ = [name for name, p, q in zip(names, a, b) if abs(p - q) > SAME * largest]
    return f'{dof}: differs at {", ".join(differ)}'


def _thrusters(a: np.ndarray, b: np.ndarray, names: list[str]) -> list[str]:
    """Return one line for each thruster whose columns differ, with the numbers."""
    largest = np.maximum(np.abs(a), np.abs(b)).max(axis=1)
    lines = []
    for i, name in enumerate(names):
        differ = np.abs(a[:, i] - b[:, i]) > np.maximum(SAME * largest, NOTHING)
        parts = []
        angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(a[:3, i], b[:3, i])),
                                      a[:3, i] @ b[:3, i]))
        if differ[:3].any():
            parts.append(f'directions {angle:.3g} degrees apart')
        parts += [f'{dof} {x:+.3f} against {y:+.3f} m'
                  for dof, x, y, far in zip(DOFS[3:], a[3:, i], b[3:, i], differ[3:]) if far]
        if parts:
            lines.append(f'{name}: {", ".join(parts)}')
    return lines


def _limits(one: Configuration, other: Configuration, pairs: list[tuple[int, int]]) -> list[str]:
    """Return one line for each thruster whose limits both give, and give differently."""
    lines = []
    for i, j in pairs:
        p, q = one.mounts[i].limits, other.mounts[j].limits
        known = [(x, y) for x, y in zip(p, q) if x is not None and y is not None]
        if any(abs(x - y) > SAME * max(abs(x), abs(y)) for x, y in known):
            lines.append(f'{one.mounts[i].name}: limits {_interval(p)} against {_interval(q)} N')
    return lines


def _interval(limits: tuple[float | None, float | None]) -> str:
    return '[' + ', '.join('?' if end is None else f'{end:g}' for end in limits) + ']'
