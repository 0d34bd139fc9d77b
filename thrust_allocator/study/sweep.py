"""Allocation against speed: three allocators, and what two kinds of motor driver make of it."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.flow import FlowAtThrusters
from thrust_allocator.physics.models import MODELS
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.solve.problem import AllocationProblem

ALLOCATORS = {'pseudo-inverse': 'pseudo-inverse, clamped',
              'fixed bounds': 'QP, bounds fixed at Bollard',
              'moving bounds': 'QP, moving bounds'}
DRIVERS = {'thrust as asked': 'a driver that delivers the thrust asked for wherever it can',
           'Bollard curve': 'a driver that goes by a Bollard curve measured at rest'}
# Singular values below this share of the largest are nothing but rounding
RANK_TOLERANCE = 1e-9
SHARED = 1e-3  # the least of a wrench of which shares are told [N, N*m]


class Sweep(NamedTuple):
    """What three allocators do at n velocities to a vehicle of p thrusters; frd axes."""

    commands: np.ndarray  # (n, 6) [N, N*m]
    limits: np.ndarray  # the moving bounds, (n, 2, p), lower and upper [N]
    thrusts: np.ndarray  # asked for by each of ALLOCATORS, (n, 3, p) [N]
    delivered: np.ndarray  # wrench by each of ALLOCATORS and of DRIVERS, (n, 3, 2, 6) [N, N*m]

    @property
    def errors(self) -> np.ndarray:
        """Delivered minus commanded wrench, (n, 3, 2, 6) [N, N*m]."""
        return self.delivered - self.commands[:, np.newaxis, np.newaxis]


def without(vehicle: Vehicle, failed: Iterable[str]) -> Vehicle:
    """Return the vehicle with some thrusters, by name, taken out; the allocators know of it."""
    gone = set(failed)
    return replace(vehicle, thrusters=tuple(
        replace(thruster, enabled=thruster.enabled and thruster.name not in gone)
        for thruster in vehicle.thrusters))


def pseudo_inverse(vehicle: Vehicle) -> np.ndarray:
    """
    Return the pseudo-inverse of B over the controlled DOFs and the thrusters in use.

    It is weighted by Q, as the quadratic programme is (Fossen, Handbook of Marine Craft
    Hydrodynamics and Motion Control, section 12.3); MT-2012's Q is the identity. What gives
    nothing at rest, a fin, is out of use: its limits are held at 0.

    :return: (p, 6), 0 for DOFs of no weight and thrusters out of use [N/N, N/(N*m)].
    """
    controlled = np.flatnonzero(vehicle.wrench_weights)
    ease = np.array([(thruster.enabled and any(thruster.bollard_thrust)) / np.sqrt(thruster.weight)
                     for thruster in vehicle.thrusters])
    inverse = np.zeros((len(vehicle.thrusters), 6))
    inverse[:, controlled] = ease[:, np.newaxis] * np.linalg.pinv(
        vehicle.configuration_matrix[controlled] * ease, rcond=RANK_TOLERANCE)
    return inverse


class Drivers:
    """The two kinds of motor driver: from setpoints to the thrust in the flow."""

    def __init__(self, vehicle: Vehicle) -> None:
        """Remember the thrusters; a cut-off limits what is asked for, not what is there."""
        self._thrusters = vehicle.thrusters
        self._flow = FlowAtThrusters(vehicle.thrusters)
        self._available = ThrustBounds(replace(vehicle, thrusters=tuple(
            replace(thruster, cutoff=0.0) for thruster in vehicle.thrusters)))

    def __call__(self, setpoints: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """
        Return the thrusts that each of DRIVERS delivers.

        One delivers what it is told within the limits at this velocity. The other takes newtons for
        Bollard thrust and turns the propeller at the speed that gives them at rest. Fins have no
        such curve: with either, a servo is told the angle at which the lift is as asked.

        :param setpoints: (p,), within the Bollard limits, 0 where a thruster is out of use [N].
        :param velocity: (6,) through the water, frd axes [m/s, rad/s].
        :return: (2, p) [N].
        """
        as_asked = np.clip(setpoints, *self._available(velocity))
        by_curve = [
            asked if thruster.model.DEFLECTS else thruster.model.thrust_in_flow(setpoint, *motion)
            for setpoint, asked, thruster, motion in zip(
                setpoints.tolist(), as_asked.tolist(), self._thrusters, self._flow(velocity))]
        return np.array([as_asked, by_curve])


def sweep(vehicle: Vehicle, velocities: Sequence[np.ndarray],
          commands: Sequence[np.ndarray]) -> Sweep:
    """
    Allocate at each velocity with each of ALLOCATORS, and deliver with each of DRIVERS.

    :param velocities: n of (6,), through the water, frd axes [m/s, rad/s].
    :param commands: n of (6,), frd axes [N, N*m].
    """
    bounds, drivers = ThrustBounds(vehicle), Drivers(vehicle)
    fixed, moving = AllocationProblem(vehicle), AllocationProblem(vehicle)
    inverse = pseudo_inverse(vehicle)
    bollard = vehicle.bollard_thrust * [thruster.enabled for thruster in vehicle.thrusters]
    all_limits, all_thrusts, all_delivered = [], [], []
    for velocity, command in zip(velocities, commands):
        limits = bounds(velocity)
        thrusts = np.array([np.clip(inverse @ command, *bollard),
                            fixed.solve(command, bollard).thrusts,
                            moving.solve(command, limits).thrusts])
        all_limits.append(limits)
        all_thrusts.append(thrusts)
        all_delivered.append([drivers(setpoints, velocity) @ vehicle.configuration_matrix.T
                              for setpoints in thrusts])
    return Sweep(np.array(commands), np.array(all_limits), np.array(all_thrusts),
                 np.array(all_delivered))


def shares(vehicle: Vehicle, thrusts: np.ndarray, dof: int) -> dict[str, np.ndarray]:
    """
    Return who gives what share of a component of the wrench.

    :param thrusts: (n, p) [N].
    :param dof: index into DOFS.
    :return: shares (n,), NaN where there is nothing to share [%]: of all thrusters of a model
        together, or, where only one model plays a part, of each thruster that does, those that
        give the same all the way under one name.
    """
    parts = vehicle.configuration_matrix[dof] * thrusts
    total = parts.sum(axis=1, keepdims=True)
    percent = 100.0 * np.divide(parts, total, out=np.full_like(parts, np.nan),
                                where=np.abs(total) > SHARED)
    acting = np.abs(parts).max(axis=0) > SHARED
    models = np.array([one.model.NAME for one in vehicle.thrusters])
    playing = [kind for name, kind in reversed(MODELS.items()) if name in models[acting]]
    if len(playing) > 1:
        return {kind.PLURAL: percent[:, models == kind.NAME].sum(axis=1) for kind in playing}
    groups: list[list[int]] = []
    for i in np.flatnonzero(acting):
        for group in groups:
            if np.allclose(percent[:, i], percent[:, group[0]], 0.0, 1e-3, equal_nan=True):
                group.append(i)
                break
        else:
            groups.append([i])
    return {_group_name([vehicle.thrusters[i].name for i in group]): percent[:, group[0]]
            for group in groups}


def _group_name(names: Sequence[str]) -> str:
    if len(names) > 2:
        return f'{names[0]} and {len(names) - 1} like it, each'
    return ', '.join(names) + ', each' * (len(names) > 1)
