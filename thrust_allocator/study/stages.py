"""
One thruster's limit through each stage that moves it, for doc/bounds.md.

`python -m thrust_allocator.study.stages OUTPUT` writes OUTPUT.png, .svg and .csv. The values of
wear, battery, cut-off and rate are an example's.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
import sys

import numpy as np
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.file import default_parameter_file
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Constant
from thrust_allocator.physics.rate import RateLimits
from thrust_allocator.physics.vehicle import Thruster, Vehicle
from thrust_allocator.supply import Rating

THRUSTER = 'tunnel'  # of MT-2012
EFFECTIVENESS, CUTOFF = 0.9, 0.1
RATING, VOLTAGE = Rating(16.0), 14.0
FALLBACK = 0.4  # [m/s]; odometry has been lost for longer than it takes to fade
MAX_RATE, PERIOD, STANDS = 500.0, 0.02, 10.0  # [N/s], [s] and [N]
SPEEDS = np.linspace(0.0, 1.2, 121)  # straight ahead [m/s]


def stages(thruster: Thruster, speeds: Sequence[float] = SPEEDS) -> Mapping[str, np.ndarray]:
    """
    Return the upper limit after each stage against the vehicle's speed, (n,), by what it is [N].

    :param speeds: (n,) straight ahead [m/s].
    """
    worn = replace(thruster, model=replace(thruster.model, strength=EFFECTIVENESS))
    share = RATING.share(VOLTAGE)

    def limits(one: Thruster, supply: float = 1.0) -> np.ndarray:
        bounds = ThrustBounds(Vehicle((one,), (1.0,) * 6))
        bounds.set_supply(supply)
        return np.array([bounds(np.array([speed] + [0.0] * 5)) for speed in speeds])

    def at_rest(one: Thruster, supply: float = 1.0) -> np.ndarray:
        return limits(replace(one, model=Constant(
            one.bollard_thrust, one.model.strength)), supply)

    cut = limits(replace(worn, cutoff=CUTOFF), share)
    fallback = cut[int(np.abs(np.asarray(speeds) - FALLBACK).argmin())]
    faded = np.stack([np.maximum(cut[:, 0], fallback[0]), np.minimum(cut[:, 1], fallback[1])], 1)
    rates = RateLimits([replace(worn, max_rate=MAX_RATE)])
    ramped = np.array([rates(pair, np.array([STANDS]), [(0.0, 0.0, 0.0)], PERIOD)
                       for pair in faded])
    return {name: found[:, 1, 0] for name, found in {
        '1 bollard_thrust': at_rest(thruster),
        f'2 effectiveness {EFFECTIVENESS:g}': at_rest(worn),
        f'3 battery at {VOLTAGE:g} of {RATING.nominal_voltage:g} V': at_rest(worn, share),
        '4 the model, in the flow': limits(worn, share),
        f'5 cutoff {CUTOFF:g}': cut,
        f'6 fallback_velocity {FALLBACK:g} m/s': faded,
        f'7 max_rate {MAX_RATE:g} N/s, from {STANDS:g} N': ramped}.items()}


def main(arguments: Sequence[str]) -> int:
    """Write picture and table; return the exit status."""
    if len(arguments) != 1:
        print('usage: python -m thrust_allocator.study.stages OUTPUT', file=sys.stderr)
        return 2
    from thrust_allocator.study.pictures import draw_stages  # needs matplotlib
    from thrust_allocator.study.tables import write_csv

    path = Path(arguments[0])
    vehicle = load_vehicle(default_parameter_file())
    found = stages(next(one for one in vehicle.thrusters if one.name == THRUSTER))
    draw_stages(path, f"The upper limit of MT-2012's {THRUSTER}, stage by stage", SPEEDS, found)
    write_csv(path.with_suffix('.csv'), ['speed [m/s]', *(f'{name} [N]' for name in found)],
              zip(SPEEDS, *found.values()))
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
