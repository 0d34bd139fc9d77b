"""A command scaled down until the thrusts that it takes need no more power than there is."""

from collections.abc import Callable

import numpy as np
from thrust_allocator.solve.problem import Allocation, AllocationProblem

TOLERANCE = 1e-6  # of power^(2/3), relative to the limit: how far below it is near enough
NARROW = 1e-9  # width of a bracket in which predicted power has a step
FALSE_POSITIONS = 10  # before the bracket is halved
MOST_SOLVES = 60


def within_power(problem: AllocationProblem, command: np.ndarray, allocation: Allocation,
                 power: Callable[[np.ndarray], float], limit: float,
                 beyond: float) -> Allocation:
    """
    Return the allocation of the largest share of a command that the power limit allows.

    Power grows with thrust^1.5, so power^(2/3) is nearly linear in the share: false position
    (Illinois) finds it in a few solves. Along a command beyond reach power need not grow with the
    share, hence the bracket, whose end below the limit is returned.

    :param command: (6,) [N, N*m].
    :param allocation: of the whole command.
    :param power: predicts what thrusts (p,) take [W].
    :param limit: [W], > 0.
    :param beyond: about how many times what the vehicle can give the command is.
    :return: with the predicted power and the share. Where even the thrusts nearest to 0 take too
        much, the share is 0 and limits that exclude 0 are moved towards it.
    """
    limits, beyond = allocation.limits, max(1.0, beyond)
    whole = allocation._replace(power=power(allocation.thrusts))
    if whole.power <= limit:
        return whole

    def at(place: float) -> Allocation:
        """
        Allocate at a place in [0, 1] on the way to the command, or in [-1, 0] on that to 0.

        What is within reach is the first half of the way to the command, for all that happens to
        the thrusts may happen below a millionth of it.
        """
        if place >= 0.0:
            share, within = place / (beyond - (beyond - 1.0) * place), limits
        else:
            share, within = 0.0, np.array((np.minimum(limits[0], (1.0 + place) * limits[0]),
                                           np.maximum(limits[1], (1.0 + place) * limits[1])))
        found = problem.solve(share * command, within)
        return found._replace(power_scale=share, power=power(found.thrusts))

    def excess(found: Allocation) -> float:
        """Return how far the power is above a target half the tolerance below the limit."""
        return (found.power / limit)**(2.0 / 3.0) - 1.0 + 0.5 * TOLERANCE

    low, below, best = 0.0, -1.0, None  # at rest no power is needed
    high, above = 1.0, excess(whole)
    if (limits[0] > 0.0).any() or (limits[1] < 0.0).any():
        nearest = at(0.0)
        if nearest.power > limit:
            low, high, above = -1.0, 0.0, excess(nearest)
        else:
            below, best = excess(nearest), nearest
    last = 0  # which end was moved
    for count in range(MOST_SOLVES):
        if high - low < NARROW:
            break
        share = below / (below - above) if count < FALSE_POSITIONS else 0.5
        place = low + (high - low) * share
        found = at(place)
        value = excess(found)
        if found.power > limit:
            high, above, below = place, value, below * (0.5 if last > 0 else 1.0)
            last = 1
        else:
            best = found
            if value > -0.5 * TOLERANCE:
                break
            low, below, above = place, value, above * (0.5 if last < 0 else 1.0)
            last = -1
    return best or at(low)
