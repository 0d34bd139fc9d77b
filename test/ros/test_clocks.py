"""Real time: stamps go by the system's clock, ages by the steady one, though they lie far apart."""

import time

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from support.peer import TYPES_IN
from visualization_msgs.msg import MarkerArray

NEAR = 60.0  # [s], between clocks that agree; those that do not are years apart
WRENCH = np.array([60.0, 0.0, 10.0, 0.0, 20.0, -15.0])


def seconds(stamp):
    """Return a stamp in seconds."""
    return stamp.sec + 1e-9 * stamp.nanosec


def is_near_now(message):
    """Tell whether a message is stamped with the system's time."""
    return abs(seconds(message.header.stamp) - time.time()) < NEAR


@pytest.fixture
def stamped(start, monkeypatch):
    """Return the node, a peer, and a function that sends a wrench of an age [s] by its stamp."""
    monkeypatch.setitem(TYPES_IN, 'cmd_wrench', WrenchStamped)
    node, peer = start('stamped_wrench:=true', 'wrench_timeout:=5.0')
    publisher = peer.create_publisher(WrenchStamped, 'cmd_wrench', 1)
    peer.wait_until(publisher.get_subscription_count, 'the node')

    def send(age):
        message = WrenchStamped()
        now = time.time_ns() - round(1e9 * age)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(now, 10**9)
        message.wrench.force.x = 60.0
        publisher.publish(message)
        peer.wait_until(lambda: node._inputs.wrench is not None, 'the wrench')

    return node, peer, send


def test_a_fresh_stamp_counts(stamped):
    """A wrench stamped with the present time of the system is answered, and is young."""
    _, peer, send = stamped
    reports = []
    peer.create_subscription(DiagnosticArray, '/diagnostics', reports.append, 10)
    send(age=0.0)
    peer.wait_until(lambda: np.any(peer.setpoints()), 'an answer')

    def ages():
        return [pair.value for report in reports for pair in report.status[0].values
                if pair.key == 'age of wrench [s]' and pair.value != 'none']

    peer.wait_until(ages, 'a report of its age')
    assert 0.0 <= float(ages()[-1]) < NEAR
    assert is_near_now(reports[-1])


def test_an_old_stamp_does_not(stamped):
    """A wrench stamped ten seconds ago has expired when it comes."""
    node, peer, send = stamped
    send(age=10.0)
    assert not any(tick['thruster_setpoints'].any() for tick in peer.wait_for_ticks(3))
    assert 10.0 <= 1e-9 * node._inputs.wrench.old < NEAR


def test_what_goes_out_is_stamped_with_the_systems_time(start):
    """Joint states and markers bear the time that everybody else's messages bear."""
    _, peer = start()
    states, pictures = [], []
    peer.create_subscription(JointState, 'thruster_states', states.append, 10)
    peer.create_subscription(MarkerArray, 'thruster_markers', pictures.append, 10)
    peer.settle(WRENCH)
    peer.wait_until(lambda: states and pictures, 'a state and a picture')
    assert is_near_now(states[-1]) and all(map(is_near_now, pictures[-1].markers))
