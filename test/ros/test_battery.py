"""The battery on the running node: heard only if it counts, live, and missed in words."""

import math

import numpy as np
from numpy.testing import assert_allclose
from sensor_msgs.msg import BatteryState
from support.live_parameters import change
from support.stepped_peer import SECOND
from support.vehicles import mt2012

BOLLARD = mt2012().bollard_thrust.ravel()


class Pack:
    """Publishes voltages to a node that is stepped."""

    def __init__(self, one):
        """Create the publisher; the node need not listen yet."""
        self._one = one
        self._publisher = one.create_publisher(BatteryState, 'battery', 10)

    @property
    def is_heard(self):
        """Tell whether the node listens, as the graph has it."""
        return self._one.node.count_subscribers('battery') == 1

    def wait_until_heard(self, by=1):
        """Wait for the node to listen, or to have stopped."""
        self._one.wait_until(
            lambda: self._publisher.get_subscription_count() == by, f'{by} on battery')

    def tell(self, voltage):
        """Send a voltage, and let a tick pass."""
        self._publisher.publish(BatteryState(voltage=voltage))
        return self._one.step(np.zeros(6), np.zeros(6))


def test_from_16_to_12_volts(stepped):
    """Limits follow the closed form; the last voltage stands in silence, with a WARN."""
    one = stepped('nominal_voltage:=16.0')
    pack = Pack(one)
    pack.wait_until_heard()
    one.step(np.zeros(6), np.zeros(6))
    assert 'no battery voltage yet: the limits are those at nominal_voltage' in one.report()[1]
    assert_allclose(pack.tell(16.0)['thrust_limits'], BOLLARD, atol=1e-9)
    pack.tell(12.0)
    start = one.time
    tick = one.steps(25)[-1]
    voltage = 12.0 + 4.0 * math.exp(-(one.time - start) / SECOND / 2.0)
    assert_allclose(tick['thrust_limits'], BOLLARD * (voltage / 16.0)**1.2, rtol=0.01)
    one.time += 100 * SECOND
    tick = one.step(np.zeros(6), np.zeros(6))
    assert_allclose(tick['thrust_limits'], BOLLARD * 0.75**1.2, atol=1e-6)
    level, text, _ = one.report()
    assert level == 'WARN' and 'no battery voltage for 100' in text and 'the last one' in text


def test_what_is_no_voltage(stepped):
    """Dropped and counted in the diagnostics; nothing changes."""
    one = stepped('nominal_voltage:=16.0')
    pack = Pack(one)
    pack.wait_until_heard()
    before = pack.tell(14.0)['thrust_limits']
    for voltage in (math.nan, math.inf, 0.0, -1.0, 33.0):
        assert_allclose(pack.tell(voltage)['thrust_limits'], before, atol=1e-6)
    figures = one.report()[2]
    assert figures['dropped: battery not finite'] == '2'
    assert figures['dropped: battery outside 0 to 2 nominal_voltage'] == '3'


def test_live(stepped):
    """The node listens from the change on that makes the voltage count, and no longer after it."""
    one = stepped()
    pack = Pack(one)
    one.step(np.zeros(6), np.zeros(6))
    assert not pack.is_heard
    assert change(one, {'nominal_voltage': 16.0, 'voltage_exponent': 1.0},
                  atomically=True) == [(True, '')]
    pack.wait_until_heard()
    assert sum(end.topic_name == '/battery' for end in one.node.subscriptions) == 1
    assert_allclose(pack.tell(12.0)['thrust_limits'], 0.75 * BOLLARD, atol=1e-9)
    assert change(one, {'voltage_exponent': 2.0}) == [(True, '')]
    assert_allclose(one.step()['thrust_limits'], 0.75**2 * BOLLARD, atol=1e-9)
    (successful, reason), = change(one, {'voltage_exponent': 3.1})
    assert not successful and 'voltage_exponent' in reason
    assert change(one, {'nominal_voltage': 0.0}) == [(True, '')]
    assert_allclose(one.step()['thrust_limits'], BOLLARD, atol=0.0)
    pack.wait_until_heard(by=0)
    assert change(one, {'nominal_voltage': 24.0}) == [(True, '')]
    pack.wait_until_heard()
