"""One vehicle through a recorded mission, by the very tick of the node."""

from collections import Counter, deque
from collections.abc import Mapping
import re
from typing import Any, NamedTuple

import numpy as np
from thrust_allocator.inputs import Inputs
from thrust_allocator.parameters.build import Description
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.replay.bag import Message
from thrust_allocator.replay.ticks import Ticks
from thrust_allocator.schedule import Schedule
from thrust_allocator.setpoints import SETPOINTS
from thrust_allocator.tick import Allocator

ANOTHER_CLOCK = 3600 * 10**9  # [ns]; a stamp so far from the recorder's time is on another one
SILENCE = 60 * 10**9  # [ns], after which ticks, which are all alike then, are made no more
LATENCY = 10**6  # [ns], which a tick takes from its inputs to its setpoints
SAMPLE = 200 * 10**6  # [ns] between two looks at the power


class Event(NamedTuple):
    """Something that happened at a time."""

    time: int  # [ns]
    text: str


class Run:
    """A vehicle, and all that its ticks came to."""

    def __init__(self, name: str, description: Description, settings: Mapping[str, Any],
                 start: int, as_recorded: bool) -> None:
        """
        Set up.

        :param name: under which the vehicle is reported.
        :param settings: values by full name that hold whatever was changed when it was recorded.
        :param start: of the recording [ns].
        :param as_recorded: whether ticks come when setpoints were recorded, and not by schedule.
        """
        self.name, self.start = name, start
        self.first = self.description = description  # before, and after what was changed
        self._fixed = settings
        self._inputs = Inputs()
        self._allocator = Allocator.of(description)
        self._schedule = None if as_recorded else Schedule(description.parameters.values, start)
        self._heard = start  # of a message [ns]
        self._enabled = description.parameters.values['start_enabled']
        self._has_fins = any(one.model.DEFLECTS for one in description.vehicle.thrusters)
        self._velocity = ('odom' if description.parameters.values['velocity_type'] == 'odometry'
                          else 'twist')
        self.ticks = Ticks(len(description.vehicle.thrusters))
        self.events: list[Event] = []
        # Power (e / T0)^1.5 of all thrusters, e of Bollard-equivalent thrust, and when [ns, -]
        self.power: list[tuple[int, float]] = []
        self._sampled = -SAMPLE
        self.voltages: list[tuple[int, float]] = []  # of the supply, when received [ns, V]
        self._waiting: deque[Message] = deque()  # for the tick whose setpoints come next
        self._known_dropped: Counter[str] = Counter()

    @property
    def topic(self) -> str:
        """Return the name as a word of a topic."""
        return re.sub(r'[^A-Za-z0-9_]+', '_', self.name).strip('_')

    @property
    def dropped(self) -> Counter[str]:
        """Return the messages that the node drops, by topic and cause."""
        return self._inputs.dropped

    def take(self, message: Message) -> None:
        """Take one recorded message, after the ticks that come before it."""
        if self._schedule:
            self._tick_until(message.time)
            self._use(message)
        elif message.name == 'thruster_setpoints':
            self._tick_as_recorded(message)
        else:
            self._waiting.append(message)

    def _use(self, message: Message) -> None:
        if message.name == 'parameter_events':
            self._change(message)
        elif message.name != 'thruster_setpoints':
            self._accept(message)

    def finish(self, time: int) -> None:
        """Tick until the end of the recording [ns], and take what came after the last tick."""
        if self._schedule:
            self._tick_until(time)
        while self._waiting:
            self._use(self._waiting.popleft())

    def _tick_until(self, time: int) -> None:
        """Make the ticks that come before a time, when the next message does [ns]."""
        silent, self._heard = self._heard + SILENCE, time
        while (due := self._schedule.due) < time:
            if due > silent:
                self._schedule.forget(time)
                return
            self._schedule.tick(due)
            self._tick(due)

    def _accept(self, message: Message) -> None:
        content, now, inputs = message.content, message.time, self._inputs
        if message.name == 'cmd_wrench':
            old = now - content.stamp if content.stamp else 0
            counts = inputs.accept_wrench(
                content.wrench, now, old if abs(old) < ANOTHER_CLOCK else 0)
            if counts and self._schedule:
                self._schedule.wrench_accepted(now)
        elif message.name == self._velocity:
            inputs.accept_velocity(content.twist, now, message.name, content.frame,
                                   content.orientation)
        elif message.name == 'current' and self._velocity == 'odom':
            inputs.accept_current(content.velocity, content.frame, now)
        elif message.name == 'battery':
            self.voltages.append((now, content))
            if self._allocator.settings.rating.nominal_voltage:
                inputs.accept_voltage(content, now, self._allocator.settings.rating)
        if inputs.dropped != self._known_dropped:
            for cause in inputs.dropped - self._known_dropped:
                self.events.append(Event(now, f'message dropped: {cause}'))
            self._known_dropped = inputs.dropped.copy()

    def _change(self, message: Message) -> None:
        """Change what was changed while it was recorded, but for what was set by hand."""
        known = self.description.parameters.values
        changes = {name: value for name, value in message.content.values.items()
                   if name in known and name not in self._fixed}
        if not changes:
            return
        told = ', '.join(f'{name} {known[name]} to {value}' for name, value in changes.items())
        try:
            self.description = self.description.changed(changes)
        except ParameterError as error:
            self.events.append(Event(message.time, f'change of {told} not followed: {error}'))
            return
        self._allocator = Allocator.of(self.description, self._allocator)
        if self._schedule:
            self._schedule.change(self.description.parameters.values)
        self.events.append(Event(message.time, f'parameter changed: {told}'))

    def _tick_as_recorded(self, message: Message) -> None:
        """
        Tick when setpoints were recorded; zeros in spite of a wrench are a node that stopped.

        What came while the node was at work on them counts for the next tick. But where a wrench
        makes the ticks, the newest one made this.
        """
        begun = message.time - LATENCY
        if self.description.parameters.values['tick_on_wrench']:
            begun = max([begun, *(one.time for one in self._waiting if one.name == 'cmd_wrench')])
        while self._waiting and self._waiting[0].time <= begun:
            self._use(self._waiting.popleft())
        recorded = message.content
        wrench = self._inputs.live_wrench(message.time, self._allocator.settings.timeouts)
        stopped = (len(recorded) > 0 and not recorded.any()
                   and wrench is not None and bool(wrench.any()))
        self._tick(message.time, recorded, stopped)

    def _tick(self, time: int, recorded: np.ndarray | None = None, stopped: bool = False) -> None:
        tick = self._allocator.tick(self._inputs, time, self._enabled and not stopped)
        thrusts = tick.thrusts.tolist()
        unit = self.description.parameters.values['setpoint_unit']
        setpoints = SETPOINTS[unit](thrusts, tick.models, tick.flow)
        deflections = [model.deflection(thrust, *motion) if model.DEFLECTS else 0.0
                       for thrust, model, motion in zip(thrusts, tick.models, tick.flow)
                       ] if self._has_fins else None
        if time >= self._sampled + SAMPLE:
            fractions = SETPOINTS['bollard_fraction'](thrusts, tick.models, tick.flow)
            self.power.append((time, sum(
                abs(fraction)**1.5 for fraction, model in zip(fractions, tick.models)
                if not model.DEFLECTS)))
            self._sampled = time
        velocity = tick.motion.twist
        if velocity is None:
            velocity = (*self._allocator.settings.fallback_velocity, 0.0, 0.0, 0.0)
        self.ticks.add(time, tick, velocity, setpoints, deflections, recorded, stopped)
