"""What direction keeping and a power limit cost: the time of a solve beside the plain one."""

from collections.abc import Callable
import math
import time

import numpy as np
from thrust_allocator.markdown import table
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.file import default_parameter_file
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.power import PredictedPower
from thrust_allocator.solve.compromise import Compromise
from thrust_allocator.solve.problem import AllocationProblem
from thrust_allocator.study.saturation import reach_of

TICKS = 300
POWER_LIMIT = 400.0  # [W], of the 3,100 W that eight thrusters can take
WALKS = {'within reach': 0.1, 'beyond reach': 1.5}  # largest command, times the authority
RULES = {'by weights': (0.0, 0.0), 'direction kept': (1.0, 0.0),
         'direction kept, power limited': (1.0, POWER_LIMIT)}


def report(repeats: int = 15) -> None:
    """Print the times of BlueROV2 Heavy's eight thrusters, each solve's median of some runs."""
    vehicle = load_vehicle(default_parameter_file().with_name('bluerov2_heavy.yaml'))
    bounds, predicted = ThrustBounds(vehicle), PredictedPower(vehicle.thrusters)
    flows = [bounds.flow(np.array([0.5 + 0.3 * math.sin(0.01 * i), 0.1 * math.sin(0.013 * i),
                                   0.0, 0.0, 0.0, 0.1 * math.sin(0.017 * i)]))
             for i in range(TICKS)]
    limits = [bounds.in_flow(flow) for flow in flows]
    reach, rows = reach_of(vehicle), []
    for walk, size in WALKS.items():
        commands = [size * reach * np.sin(0.02 * i + np.arange(6)) for i in range(TICKS)]
        times: dict[str, list[list[float]]] = {name: [] for name in ('plain', *RULES)}
        acted = dict.fromkeys(RULES, 0)
        for _ in range(repeats):
            plain = AllocationProblem(vehicle)
            times['plain'].append([_timed(lambda: plain.solve(command, limit))[0]
                                   for command, limit in zip(commands, limits)])
            for name, (k, power_limit) in RULES.items():
                rule = Compromise(vehicle, AllocationProblem(vehicle), k, range(6), power_limit)
                solved = [_timed(lambda: rule.solve(command, limit, limit,
                                                    lambda: predicted.in_flow(flow, bounds.models)))
                          for command, limit, flow in zip(commands, limits, flows)]
                times[name].append([seconds for seconds, _ in solved])
                acted[name] = sum(found.power_scale < 1.0 for _, found in solved)
        medians = {name: 1e6 * np.median(runs, axis=0).mean() for name, runs in times.items()}
        rows += [(f'{walk}, {name}', f'{medians[name]:.1f}',
                  f'{medians[name] / medians["plain"]:.2f}', str(acted.get(name, 0)))
                 for name in times]
    print('### Time of a solve, eight thrusters, a smooth walk\n')
    print(table(('', 'µs', 'ratio', f'power acts, of {TICKS}'), rows), end='\n\n')


def _timed(solve: Callable) -> tuple:
    """Return how long a call takes [s], and what it returns."""
    start = time.perf_counter()
    found = solve()
    return time.perf_counter() - start, found
