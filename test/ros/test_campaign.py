"""A long, seeded campaign of faults against the running node, in simulated time."""

from collections import Counter

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import BatteryState
from support.stepped_peer import inside_limits, is_stopped, SECOND
from support.vehicles import NAMES as THRUSTERS, RUDDER

TICKS = 1500
NAMES = [*THRUSTERS, 'rudder']
RULES = ['fallback_velocity:=[0.5, 0.0, 0.1]', 'thrusters.up.max_rate:=200.0',
         'thrusters.left.max_rate:=20.0', 'thrusters.tunnel.max_rate:=1000.0',
         'thrusters.tunnel.cutoff:=0.1', 'thrusters.right.cutoff:=0.7', 'nominal_voltage:=16.0']
HIGHEST = 17.0  # of the battery [V]
POWER_LIMIT = 200.0  # [W]
GIVING_WAY = [Parameter('direction_keeping', value=1.0),
              Parameter('power_limit', value=POWER_LIMIT), *(
                  Parameter(f'thrusters.{name}.bollard_power', value=[100.0, 200.0])
                  for name in THRUSTERS)]
NONSENSE = [np.nan, np.inf, -np.inf, 1e308, -1e308, 1.1e9]
FLU = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])


class Campaign:
    """Random faults for a node that is stepped, and the count of each."""

    def __init__(self, peer, seed):
        self.peer = peer
        self.random = np.random.default_rng(seed)
        self.counts = Counter()
        self.enabled = True
        self.off = set()  # indices of thrusters
        self.battery = peer.create_publisher(BatteryState, 'battery', 1)

    def happens(self, what, probability):
        """Tell whether something happens in this tick, and count it."""
        yes = self.random.random() < probability
        self.counts[what] += yes
        return yes

    def spoil(self, values):
        """Return values of which one or more are nonsense."""
        broken = self.random.random(len(values)) < 0.3
        broken[self.random.integers(len(values))] = True
        return np.where(broken, self.random.choice(NONSENSE), values)

    def command(self):
        """Start, change or stop the streams of messages."""
        peer, random = self.peer, self.random
        if self.happens('new wrenches', 0.1):
            reverse, forward = peer.node.vehicle.reference_limits
            reachable = peer.node.vehicle.configuration_matrix @ random.uniform(reverse, forward)
            peer.wrench = FLU * reachable * random.uniform(0.0, 10.0)
        if self.happens('new twists', 0.1):
            peer.twist = random.normal(size=6) * random.choice([0.1, 1.0, 10.0])
            peer.twist = np.clip(peer.twist, -50.0, 50.0)
            peer.orientation = random.normal(size=4)
            if random.random() < 0.8:
                peer.orientation /= np.linalg.norm(peer.orientation)
        if self.happens('new currents', 0.05):
            peer.current = random.normal(size=3)
        if self.happens('wrenches stop', 0.02):
            peer.silence('wrench')
        if self.happens('odometry stops', 0.02):
            peer.silence('twist')
        if self.happens('currents stop', 0.01):
            peer.silence('current')
        if self.happens('currents from elsewhere', 0.01):
            peer.silence('current')
            peer.send_current(np.ones(3), frame='map')

        if self.happens('voltages', 0.05):
            self.battery.publish(BatteryState(voltage=random.uniform(9.0, HIGHEST)))
        # Not so late that the report that counts them could come before it
        if self.counts['ticks'] % 50 < 40 and self.happens('nonsense for battery', 0.03):
            self.battery.publish(BatteryState(
                voltage=float(random.choice([0.0, -1.0, 33.0, np.nan, np.inf]))))

    def step(self, period):
        """Let a tick pass, in which messages may be nonsense, and return it."""
        peer, kept = self.peer, {}
        for name, size, probability in (('wrench', 6, 0.05), ('twist', 6, 0.05),
                                        ('current', 3, 0.02)):
            if self.happens(f'nonsense for {name}', probability):
                kept[name] = getattr(peer, name)
                setattr(peer, name, self.spoil(np.zeros(size)))
        tick = peer.step(period=period)
        for name, values in kept.items():
            setattr(peer, name, values)
        return tick

    def switch(self):
        """Switch thrusters and the node off and on."""
        if self.happens('thrusters switched', 0.04):
            index = int(self.random.integers(6))
            self.off ^= {index}
            self.peer.node.set_parameters([Parameter(
                f'thrusters.{NAMES[index]}.enabled', value=index not in self.off)])
        if self.happens('wear', 0.03):
            left = float(self.random.choice([0.0, 1.0, self.random.random()]))
            self.peer.node.set_parameters([Parameter(
                f'thrusters.{self.random.choice(NAMES)}.effectiveness', value=left)])
        if self.happens('refused changes', 0.01):
            result, = self.peer.node.set_parameters([Parameter('thrusters.up.enabled', value=2)])
            assert not result.successful
        if self.happens('enabled or disabled', 0.02 if self.enabled else 0.1):
            self.enabled = not self.enabled
            self.peer.enable(self.enabled)

    def period(self):
        """Return how long this tick lasts [ns], after a jump back of the clock, perhaps."""
        if self.happens('jumps backward', 0.01):
            self.peer.time -= round(self.random.uniform(0.001, 20.0) * SECOND)
            self.peer.pulse()
        elif self.happens('jumps forward', 0.01):
            return round(self.random.uniform(0.02, 20.0) * SECOND)
        return SECOND // 50

    def tick(self):
        """Let a tick pass and check what came of it."""
        self.command()
        self.switch()
        tick = self.step(self.period())
        assert inside_limits(tick), tick
        assert all(np.isfinite(values).all() for values in tick.values())
        limits = tick['thrust_limits'].reshape(2, 6)
        most = (HIGHEST / 16.0)**1.2 * self.peer.node.vehicle.bollard_thrust[:, :5]
        assert (most[0] <= limits[0, :5]).all() and (limits[1, :5] <= most[1]).all()
        assert not limits[:, list(self.off)].any()
        assert self.enabled or is_stopped(tick)
        np.testing.assert_allclose(
            FLU * tick['achieved_wrench'],
            self.peer.node.vehicle.configuration_matrix @ tick['thruster_setpoints'], atol=1e-9)
        self.counts['ticks'] += 1
        self.counts['ticks that allocated'] += not is_stopped(tick)
        self.counts['setpoints at a limit'] += int((tick['thruster_setpoints'] == limits).sum())


def test_fault_campaign(stepped, variant):
    """Through thousands of ticks of faults each is sound, none is left out, and all ends well."""
    peer = stepped('message_frame:=flu', *RULES, file=variant(RUDDER))
    campaign = Campaign(peer, seed=20170923)
    reports, limited, kept = Counter(), 0, 0
    for number in range(TICKS):
        if number == TICKS // 2:  # from here on with what gives way beyond reach
            assert peer.node.set_parameters_atomically(GIVING_WAY).successful
        campaign.tick()
        allocation = peer.node._last_tick.allocation
        if number >= TICKS // 2 and allocation is not None:
            assert allocation.power <= POWER_LIMIT and allocation.solved
            limited += allocation.power_scale < 1.0
            kept += allocation.direction_scale < 1.0
        if number % 50 == 49:
            level, _, figures = peer.report()
            reports[level] += 1
            assert figures['solver status'] in ('solved', 'not called')
            assert int(figures['iterations, worst']) <= 1
    counts = campaign.counts
    dropped = {key: int(value) for key, value in figures.items() if key.startswith('dropped')}
    print(f'\n{dict(counts)}, reports {dict(reports)}, {dropped}')
    assert counts['ticks'] == TICKS == peer.ticks_seen
    assert counts['ticks that allocated'] > TICKS / 3 and all(counts.values())
    assert limited > TICKS / 20 and kept > TICKS / 20
    assert sum(dropped.values()) == sum(
        count for key, count in counts.items() if key.startswith('nonsense'))

    peer.enable(True)
    peer.switch(**dict.fromkeys(NAMES, True))
    peer.node.set_parameters([Parameter('nominal_voltage', value=0.0), *(
        Parameter(f'thrusters.{name}.effectiveness', value=1.0) for name in NAMES)])
    peer.current, peer.orientation = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]
    last = peer.steps(300, [30.0, 0.0, 0.0, 0.0, 0.0, 5.0], [0.0] * 6)[-1]
    peer.report()
    assert peer.report_later()[:2] == ('OK', 'allocating')
    np.testing.assert_allclose(last['unallocated_wrench'][[0, 2, 4, 5]], 0.0, atol=0.1)
