"""One tick: from what was received last to limits, setpoints, and the wrench they add up to."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from thrust_allocator.inputs import Inputs, Motion, Timeouts
from thrust_allocator.parameters.build import Description
from thrust_allocator.physics.bounds import rate_limited, ThrustBounds
from thrust_allocator.physics.flow import Flow
from thrust_allocator.physics.frames import frd_signs
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import Allocation, AllocationProblem


@dataclass(frozen=True)
class Settings:
    """What a tick goes by, beside the vehicle; defaults are those of the parameters."""

    rate: float = 50.0  # ticks per second [Hz]
    message_frame: str = 'flu'  # axes of all wrenches and velocities that come and go
    fallback_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)  # in those axes [m/s]
    timeouts: Timeouts = Timeouts(wrench=500_000_000, velocity=500_000_000, current=10 * 10**9)

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'Settings':
        """Take them from checked parameters by name."""
        return cls(values['rate'], values['message_frame'], values['fallback_velocity'], Timeouts(
            *(round(values.get(f'{name}_timeout', 0.0) * 1e9)
              for name in ('wrench', 'odometry', 'current'))))


@dataclass(frozen=True)
class Tick:
    """All that one tick decided; wrenches in the axes of the messages, p thrusters."""

    limits: np.ndarray  # (2, p), row 0 lower, row 1 upper [N]
    thrusts: np.ndarray  # (p,) in the flow, inside the limits; zeros if the vehicle is stopped [N]
    achieved: np.ndarray  # B tau, (6,) [N, N*m]
    unallocated: np.ndarray  # commanded minus achieved, (6,) [N, N*m]
    flow: Flow  # how each thruster moves through the water that the limits were computed for
    enabled: bool
    wrench: np.ndarray | None  # the command, (6,) [N, N*m]; None: none that counts
    motion: Motion  # what was known of the velocity
    allocation: Allocation | None = None  # None: the vehicle is stopped


class Allocator:
    """Decides ticks, one after another; what came last is in `Inputs`, times are in ns."""

    def __init__(self, vehicle: Vehicle, settings: Settings = Settings(),
                 problem: AllocationProblem | None = None,
                 last: np.ndarray | None = None) -> None:
        """
        Set up.

        :param problem: of this vehicle, if there is one already.
        :param last: setpoints of the tick before, (p,) [N]; zeros unless given.
        :raises IllConditioned: as the allocation problem does.
        """
        self.vehicle, self.settings = vehicle, settings
        self._problem = AllocationProblem(vehicle) if problem is None else problem
        self._last = np.zeros(len(vehicle.thrusters)) if last is None else last
        self._bounds = ThrustBounds(vehicle)
        self.signs = frd_signs(settings.message_frame)
        max_rates = np.array([thruster.max_rate for thruster in vehicle.thrusters])
        self._step = np.where(max_rates > 0.0, max_rates / settings.rate, np.inf)  # [N]
        self._fallback_flow = self._bounds.flow(
            self.signs * (*settings.fallback_velocity, 0.0, 0.0, 0.0))
        self._fallback_limits = self._bounds.in_flow(self._fallback_flow)

    @classmethod
    def of(cls, description: Description, before: 'Allocator | None' = None) -> 'Allocator':
        """Return the allocator that parameters describe, which goes on from the one `before`."""
        return cls(description.vehicle, Settings.from_values(description.parameters.values),
                   description.problem, before and before._last)

    def tick(self, inputs: Inputs, now: int, enabled: bool = True) -> Tick:
        """
        Decide one tick.

        :param inputs: what was received, in the axes of the messages.
        :param now: on the clock of `inputs` [ns].
        :param enabled: whether the thrusters may push at all.
        """
        motion = inputs.motion(now, self.settings.timeouts)
        wrench = inputs.live_wrench(now, self.settings.timeouts)
        flow, limits = self._limits(motion)
        if wrench is None or not enabled:
            self._last = np.zeros_like(self._last)
            return Tick(limits, self._last, np.zeros(6),
                        np.zeros(6) if wrench is None else wrench, flow, enabled,
                        wrench, motion)
        limits = rate_limited(limits, self._last, self._step)
        allocation = self._problem.solve(self.signs * wrench, limits)
        self._last = allocation.thrusts
        return Tick(limits, allocation.thrusts, self.signs * allocation.achieved,
                    self.signs * allocation.unallocated, flow, enabled, wrench, motion,
                    allocation)

    def _limits(self, motion: Motion) -> tuple[Flow, np.ndarray]:
        """
        Return the flow at the thrusters and the limits there.

        A stale velocity is believed where it gives tighter limits than the fallback velocity does.
        """
        if motion.twist is None:
            return self._fallback_flow, self._fallback_limits.copy()
        flow = self._bounds.flow(self.signs * motion.twist)
        limits = self._bounds.in_flow(flow)
        if motion.stale:
            limits[0] = np.maximum(limits[0], self._fallback_limits[0])
            limits[1] = np.minimum(limits[1], self._fallback_limits[1])
        return flow, limits
