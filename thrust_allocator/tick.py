"""One tick: from what was received last to limits, setpoints, and the wrench they add up to."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
import math
from typing import Any

import numpy as np
from thrust_allocator.inputs import Inputs, Motion, Smoothing, Timeouts
from thrust_allocator.parameters.build import Description
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.flow import Flow
from thrust_allocator.physics.frames import frd_signs
from thrust_allocator.physics.models import ThrusterModel
from thrust_allocator.physics.power import PredictedPower
from thrust_allocator.physics.rate import RateLimits
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.attainable import AttainableSet, TooManyFaces
from thrust_allocator.solve.compromise import Compromise
from thrust_allocator.solve.problem import Allocation, AllocationProblem
from thrust_allocator.supply import Rating, Supply


@dataclass(frozen=True)
class Settings:
    """What a tick goes by, beside the vehicle; defaults are those of the parameters."""

    rate: float = 50.0  # ticks per second [Hz]
    message_frame: str = 'flu'  # axes of all wrenches and velocities that come and go
    fallback_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)  # in those axes [m/s]
    timeouts: Timeouts = Timeouts(wrench=500_000_000, velocity=500_000_000, current=10 * 10**9)
    velocity_time_constant: float = 0.0  # of the filter on the velocity, 0: none [s]
    rating: Rating = Rating()

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> 'Settings':
        """Take them from checked parameters by name."""
        return cls(
            values['rate'], values['message_frame'], values['fallback_velocity'],
            Timeouts(*(round(values.get(f'{name}_timeout', 0.0) * 1e9)
                       for name in ('wrench', 'odometry', 'current'))),
            values['velocity_time_constant'],
            Rating(values['nominal_voltage'], values['voltage_exponent']))


@dataclass(frozen=True)
class Tick:
    """All that one tick decided; wrenches in the axes of the messages, p thrusters."""

    limits: np.ndarray  # (2, p), row 0 lower, row 1 upper [N]
    speed_limits: np.ndarray  # those of the velocity alone, (2, p) [N]
    thrusts: np.ndarray  # (p,) in the flow, inside the limits; zeros if the vehicle is stopped [N]
    achieved: np.ndarray  # B tau, (6,) [N, N*m]
    unallocated: np.ndarray  # commanded minus achieved, (6,) [N, N*m]
    flow: Flow  # how each thruster moves through the water that the limits were computed for
    enabled: bool
    wrench: np.ndarray | None  # the command, (6,) [N, N*m]; None: none that counts
    motion: Motion  # what was known of the velocity
    supply: Supply  # and of the supply
    models: tuple[ThrusterModel, ...]  # of the thrusters at that supply
    allocation: Allocation | None = None  # None: the vehicle is stopped


@dataclass
class Past:
    """What one tick leaves to the next, whatever is changed between them."""

    stand: np.ndarray  # where each thruster is: its thrust, or a fin's deflection, (p,) [N, rad]
    time: int | None = None  # of the last tick [ns]
    fade: float = 0.0  # how far the limits have gone over to the fallback's, [0, 1]

    def elapsed(self, now: int, nominal: float, longest: float) -> float:
        """Return the time since the last tick, `nominal` if it is not known [s]."""
        if self.time is None or now < self.time:
            return nominal
        return min(1e-9 * (now - self.time), longest)


class Allocator:
    """Decides ticks, one after another; what came last is in `Inputs`, times are in ns."""

    def __init__(self, vehicle: Vehicle, settings: Settings = Settings(),
                 compromise: Compromise | None = None, past: Past | None = None) -> None:
        """
        Set up.

        :param compromise: what gives way beyond reach; the weights decide unless it is given.
        :param past: what the tick before has left, if there was one.
        :raises IllConditioned: as the allocation problem does.
        """
        self.vehicle, self.settings = vehicle, settings
        self._compromise = compromise or Compromise(vehicle, AllocationProblem(vehicle))
        self._power = PredictedPower(vehicle.thrusters)
        self._past = Past(np.zeros(len(vehicle.thrusters))) if past is None else past
        self._bounds = ThrustBounds(vehicle)
        self.signs = frd_signs(settings.message_frame)
        self._rates = RateLimits(vehicle.thrusters)
        self._smoothing = Smoothing(
            settings.velocity_time_constant * 1e9, settings.timeouts.velocity or math.inf)
        self._fallback_flow = self._bounds.flow(
            self.signs * (*settings.fallback_velocity, 0.0, 0.0, 0.0))
        self._fallback_limits = self._bounds.in_flow(self._fallback_flow)

    @classmethod
    def of(cls, description: Description, before: 'Allocator | None' = None) -> 'Allocator':
        """Return the allocator that parameters describe, which goes on from the one `before`."""
        return cls(description.vehicle, Settings.from_values(description.parameters.values),
                   description.compromise, before and before._past)

    def tick(self, inputs: Inputs, now: int, enabled: bool = True) -> Tick:
        """
        Decide one tick.

        :param inputs: what was received, in the axes of the messages.
        :param now: on the clock of `inputs` [ns].
        :param enabled: whether the thrusters may push at all.
        """
        past, period = self._past, 1.0 / self.settings.rate
        elapsed = past.elapsed(now, nominal=period, longest=2.0 * period)
        inputs.smoothing = self._smoothing  # of what comes from now on
        motion = inputs.motion(now, self.settings.timeouts)
        wrench = inputs.live_wrench(now, self.settings.timeouts)
        supply = inputs.supply(now, self.settings.rating)
        if supply.share != self._bounds.supply:
            self._bounds.set_supply(supply.share)
            self._fallback_limits = self._bounds.in_flow(self._fallback_flow)
        flow, limits = self._limits(motion, now)
        past.time = now
        if wrench is None or not enabled:
            past.stand = np.zeros_like(past.stand)
            return Tick(limits, limits, past.stand, np.zeros(6),
                        np.zeros(6) if wrench is None else wrench, flow, enabled,
                        wrench, motion, supply, self._bounds.models)
        allocation = self._compromise.solve(
            self.signs * wrench, limits, self._rates(limits, past.stand, flow, elapsed),
            lambda: self._power.in_flow(flow, self._bounds.models, supply.share))
        past.stand = self._rates.stand(allocation.thrusts, flow)
        return Tick(allocation.limits, limits, allocation.thrusts,
                    self.signs * allocation.achieved, self.signs * allocation.unallocated, flow,
                    enabled, wrench, motion, supply, self._bounds.models, allocation)

    def wrench_limits(self, tick: Tick) -> np.ndarray | None:
        """
        Return the range that each component of the wrench could be given at a tick's speed limits.

        The other controlled ones stay as achieved; `max_rate` and power do not count.

        :return: (2, 6), smallest and largest, in the axes of the messages [N, N*m]; None for a
            vehicle with too many faces.
        """
        if self._attainable is None:
            return None
        achieved = self.signs * tick.achieved
        room = self._attainable.room(achieved, np.eye(6), tick.speed_limits)
        ends = np.sort(self.signs[:, np.newaxis] * (achieved[:, np.newaxis] + room), axis=1)
        return ends.T.copy()

    @cached_property
    def _attainable(self) -> AttainableSet | None:
        in_use = np.array([float(thruster.in_use) for thruster in self.vehicle.thrusters])
        try:
            return AttainableSet(self.vehicle.configuration_matrix,
                                 np.array(self.vehicle.wrench_weights), in_use)
        except TooManyFaces:
            return None

    def _limits(self, motion: Motion, now: int) -> tuple[Flow, np.ndarray]:
        """
        Return the flow at the thrusters and the limits there.

        A stale velocity is believed where it gives tighter limits than the fallback velocity does.
        """
        if motion.twist is None:
            return self._fallback_flow, self._fallback_limits.copy()
        flow = self._bounds.flow(self.signs * motion.twist)
        limits = self._bounds.in_flow(flow)
        fade = self._past.fade = self._faded(motion, now)
        if fade:
            tighter = np.array((np.maximum(limits[0], self._fallback_limits[0]),
                                np.minimum(limits[1], self._fallback_limits[1])))
            limits = tighter if fade == 1.0 else (1.0 - fade) * limits + fade * tighter
        return flow, limits

    def _faded(self, motion: Motion, now: int) -> float:
        """Return how far the limits have gone over to the fallback's, without a step either way."""
        timeout, past = self.settings.timeouts.velocity, self._past
        if not timeout:
            return float(motion.stale)
        since = math.inf if past.time is None else max(now - past.time, 0)  # [ns]
        if motion.stale:
            return min(past.fade + min(since, motion.overdue) / timeout, 1.0)
        return max(past.fade - since / timeout, 0.0)
