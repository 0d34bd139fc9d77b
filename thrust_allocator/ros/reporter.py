"""What the node says of itself: findings as they come and go, and diagnostics once a second."""

from collections.abc import Callable, Iterator

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from std_msgs.msg import Header
from thrust_allocator.diagnosis.findings import Findings
from thrust_allocator.diagnosis.shortfall import Yardstick
from thrust_allocator.diagnosis.tally import note_tick, Tally, thrusters_off
from thrust_allocator.inputs import age_in_seconds, Inputs
from thrust_allocator.physics.vehicle import Vehicle
from thrust_allocator.ros.graph import mismatches, publishers
from thrust_allocator.ros.messages import status_message
from thrust_allocator.ros.qos import OVERRIDABLE
from thrust_allocator.tick import Tick

ALONE = ('cmd_wrench', 'thruster_setpoints')  # topics that one node should publish on


class Reporter:
    """Counts ticks, looks for what no tick can see, and tells it."""

    def __init__(self, node: Node, inputs: Inputs, vehicle: Vehicle, hints: dict[str, str]) -> None:
        """
        Set up.

        :param inputs: that the node's ticks are made of.
        :param hints: by relative topic name, what to do where others use another type.
        """
        self._node, self._inputs = node, inputs
        self._hints = {node.resolve_topic_name(topic): hint for topic, hint in hints.items()}
        self._findings = Findings(node.get_logger())
        self._tally = Tally()
        self._yardstick = Yardstick(vehicle)
        self._publisher = node.create_publisher(
            DiagnosticArray, '/diagnostics', 10, qos_overriding_options=OVERRIDABLE)
        self._last_report: int | None = None  # [ns]
        self._known_dropped = inputs.dropped.copy()
        self._mismatches: dict[str, str] = {}
        self.lost_lines: Callable[[], int] = lambda: 0  # of the log, which nobody has read

    def tick(self, tick: Tick, now: int, seconds: float, late: bool) -> None:
        """Take a tick into account that took so long [s], and may have come too late."""
        self._tally.count(tick, seconds)
        self._tally.late += late
        note_tick(self._findings, tick, now)
        if tick.wrench is not None:
            self._findings.note('wrench', '', now)
        elif not self._findings.present('wrench'):
            self._note_no_wrench(now)

    def note(self, kind: str, text: str, now: int) -> None:
        """Note what is wrong beside the ticks, or with an empty text that nothing is."""
        self._findings.note(kind, text, now)

    def present(self, kind: str) -> str:
        """Return the words of a finding that is there, or ''."""
        return self._findings.present(kind)

    def report(self, vehicle: Vehicle, now: int, ticks_by_clock: bool) -> Iterator[None]:
        """
        Publish the diagnostics since the last report, in steps, lest a wrench wait for all of it.

        :param now: on the clock of the ticks [ns].
        :param ticks_by_clock: whether that is /clock, which may stand.
        """
        tally, self._tally = self._tally, Tally()
        note, inputs = self._findings.note, self._inputs
        stands = ticks_by_clock and now == self._last_report
        self._last_report = now
        note('clock', 'the clock stands: no ticks' if stands else '', now)
        fresh = inputs.dropped - self._known_dropped
        self._known_dropped = inputs.dropped.copy()
        note('dropped', f'messages dropped: {", ".join(sorted(fresh))}' if fresh else '', now)
        note('thrusters off', thrusters_off(vehicle), now)
        note('frames', self._frames(), now)
        if not self._yardstick.measures(vehicle):
            self._yardstick = Yardstick(vehicle)
        note('shortfall', tally.shortfall(vehicle, self._yardstick), now)
        yield
        self._look_at_the_graph(now)
        if self._findings.present('wrench'):
            self._note_no_wrench(now)
        yield
        node = self._node
        level, text = self._findings.overall(now)
        self._publisher.publish(DiagnosticArray(
            header=Header(stamp=node.get_clock().now().to_msg()),
            status=[status_message(
                f'{node.get_fully_qualified_name().lstrip("/")}: allocation',
                node.get_namespace().strip('/'), level, text, {
                    'age of wrench [s]': age_in_seconds(inputs.wrench, now),
                    'age of odometry [s]': age_in_seconds(inputs.velocity, now),
                    **tally.figures(vehicle),
                    **{f'dropped: {cause}': str(n) for cause, n in sorted(inputs.dropped.items())},
                    'log lines lost': str(self.lost_lines()),
                })]))

    def _look_at_the_graph(self, now: int) -> None:
        """Note who else publishes where one node should, and who cannot hear or be heard."""
        for topic in ALONE:
            several = self._node.count_publishers(self._node.resolve_topic_name(topic)) > 1
            names = publishers(self._node, topic) if several else []
            self._findings.note(
                f'publishers of {topic}',
                f'{len(names)} publishers on {topic}: {", ".join(sorted(names))}'
                if len(names) > 1 else '', now)
        before, self._mismatches = self._mismatches, mismatches(self._node, self._hints)
        for topic in {**before, **self._mismatches}:
            twice = topic in before and topic in self._mismatches  # the first has no name yet
            self._findings.note(f'ends of {topic}', self._mismatches[topic] if twice else '', now)

    def _frames(self) -> str:
        velocity = self._inputs.velocity
        if velocity is None or not velocity.frame or velocity.frame != velocity.child_frame:
            return ''
        return (f"odometry has child_frame_id '{velocity.child_frame}', the same as frame_id: "
                'is its twist in body axes?')

    def _note_no_wrench(self, now: int) -> None:
        self._findings.note('wrench', f'no wrench: zero setpoints: {self._why_no_wrench(now)}', now)

    def _why_no_wrench(self, now: int) -> str:
        """Say why no wrench counts, as far as the node can know."""
        received, topic = self._inputs.wrench, self._node.resolve_topic_name('cmd_wrench')
        if received is not None:
            if received.old > now - received.time:
                return (f'by its stamp it was {received.old * 1e-9:.1f} s old when it came: does '
                        "the sender's clock agree with this one?")
            return f'the last one came {age_in_seconds(received, now)} s ago'
        if topic in self._mismatches:
            return 'those who publish cannot be heard'
        if not (names := publishers(self._node, 'cmd_wrench')):
            return f'nobody publishes {topic}'
        dropped = [cause for cause in self._inputs.dropped if cause.startswith('cmd_wrench')]
        if dropped:
            return f'dropped: {", ".join(sorted(dropped))}'
        return f'none has come from {", ".join(sorted(names))} since start, enabling or clock jump'
