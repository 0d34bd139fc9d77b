"""Tow tests of a thruster whose coefficients are known: tables for the fit to find them in."""

from collections.abc import Sequence
import csv
from io import StringIO
import math
from pathlib import Path

import numpy as np
from support.vehicles import propeller
from thrust_allocator.fit import law, measurements
from thrust_allocator.fit.bollard import bollard_curves
from thrust_allocator.fit.certainty import intervals
from thrust_allocator.fit.solution import Problem, Solution, solve
from thrust_allocator.fit.table import Row
from thrust_allocator.physics.models import ThrusterModel, Tunnel

FASTEST = 2000.0  # rev/min at full thrust
COSINE = propeller(bollard_thrust=(-40.0, 51.0), speed_loss=(12.0, 15.6), opposed_loss=(3.0, 4.0),
                   angle_law='cosine')
QUADRATIC = propeller(bollard_thrust=(-40.0, 51.0), speed_loss=(12.0, 15.6),
                      speed_loss_quadratic=(2.0, 3.0), opposed_loss=(3.0, 4.0), angle_law='cosine')
PAPER = propeller(bollard_thrust=(-40.0, 51.0), speed_loss=(12.0, 15.6), opposed_loss=(3.0, 4.0),
                  critical_angle_slope=0.25)
TUNNEL = Tunnel((-40.0, 45.0), decay=1.76, jet_mass=7.7)


def tow(model: ThrusterModel, noise: float = 0.0, seed: int = 0,
        speeds: Sequence[float] = (0.5, 1.0, 1.5),
        angles: Sequence[float] = (0.0, 30.0, 45.0, 60.0, 150.0, 180.0),
        commands: Sequence[float] = (0.7, 1.0), sides: Sequence[int] = (0, 1)) -> list[Row]:
    """
    Return a Bollard table and one run per sense, speed and incoming angle [deg] at each command.

    :param commands: shares of the largest one.
    :param noise: standard deviation of a thrust, as a share of the largest.
    """
    rng = np.random.default_rng(seed)
    rows: list[Row] = []

    def add(side: int, share: float, speed: float, angle: float, run: str) -> None:
        sign = 1.0 if side else -1.0
        told = sign * abs(model.bollard_thrust[side]) * share**2
        thrust = model.thrust_in_flow(told, speed * math.cos(angle), speed * math.sin(angle))
        thrust += rng.normal(0.0, noise * max(map(abs, model.bollard_thrust))) if noise else 0.0
        rows.append(Row(len(rows) + 2, sign * share * FASTEST, speed, angle, thrust, run, 0.0))

    for side in sides:
        for share in (0.3, 0.5, 0.7, 0.85, 1.0):
            add(side, share, 0.0, 0.0, '')
        for speed in speeds:
            for incoming in angles:
                angle = math.radians(incoming if side else 180.0 - incoming)
                for share in commands:
                    add(side, share, speed, angle, f'{side} {speed} {incoming}')
    return rows


def written(rows: Sequence[Row], path: Path, unit: float = 1.0, column: str = 'thrust',
            neutral: float = 0.0, scale: float = 1.0) -> Path:
    """Write rows as a CSV file, commands scaled and moved by `neutral`, thrust in a unit [N]."""
    text = StringIO()
    table = csv.writer(text)
    table.writerow(['command', 'speed', 'angle', column, 'run'])
    for row in rows:
        table.writerow([neutral + scale * row.command, row.speed, math.degrees(row.angle),
                        row.thrust / unit, row.run])
    path.write_text(text.getvalue(), encoding='utf-8')
    return path


def fitted(rows: Sequence[Row], model: str = 'cosine', quadratic: bool = False) -> Solution:
    """Return the fit of the angle law, or of a tunnel of 0.00385 m^2 in water of 1000 kg/m^3."""
    sorted_out = measurements.sort_out(rows, Path('tow.csv'), None)
    chosen = (law.tunnel_law(sorted_out, 0.00385, 1000.0) if model == 'tunnel'
              else law.propeller_law(sorted_out, model, quadratic))
    return solve(Problem(sorted_out, chosen, bollard_curves(sorted_out)))


def truths(solution: Solution, model: ThrusterModel) -> dict[str, float]:
    """Return what a fit should find: the model's own coefficients by the fit's names."""
    found = {}
    for one in solution.problem.law.coefficients:
        if isinstance(model, Tunnel):
            value = model.decay * model.jet_mass / (1000.0 * 0.00385)
        else:
            value = getattr(model, one.name)
        found[str(one)] = value if one.side is None else value[one.side]
    reverse, forward = model.bollard_thrust
    return found | {'bollard reverse': -reverse, 'bollard forward': forward}


def covered(model: ThrusterModel, kind: str, quadratic: bool, tables: int,
            noise: float = 0.01) -> tuple[dict[str, int], dict[str, float]]:
    """
    Fit noisy tables; count by coefficient how many intervals hold the truth, and the worst error.

    The error is relative to the truth.
    """
    angles = (90.0,) if kind == 'tunnel' else (0.0, 30.0, 45.0, 60.0, 150.0, 180.0)
    hits: dict[str, int] = {}
    worst: dict[str, float] = {}
    for seed in range(tables):
        solution = fitted(tow(model, noise, seed, angles=angles), kind, quadratic)
        ends, _ = intervals(solution)
        values = [*solution.coefficients, *map(abs, solution.problem.curves.limits(solution.x))]
        for (name, truth), (low, high), value in zip(
                truths(solution, model).items(), ends, values):
            hits[name] = hits.get(name, 0) + int(low <= truth <= high)
            worst[name] = max(worst.get(name, 0.0), abs(value / truth - 1.0))
    return hits, worst
