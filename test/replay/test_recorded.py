"""A recording of the running node gives its setpoints again."""

import numpy as np
from nav_msgs.msg import Odometry
from geometry_msgs.msg import Wrench
from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import Parameter
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import SetBool
from support.bags import record, write_raw

TOPICS = {'/cmd_wrench': Wrench, '/odom': Odometry, '/thruster_setpoints': Float64MultiArray,
          '/parameter_events': ParameterEvent}


def sail(peer, ticks: int) -> None:
    """Send a wrench and a velocity that change all the time, for a number of ticks."""
    known = len(peer.ticks)

    def send():
        phase = 0.05 * len(peer.received) / 4.0
        v = 0.8 + 0.3 * np.sin(0.3 * phase)
        peer.send_twist([v, 0.02, 0.0, 0.0, 0.0, 0.05])
        peer.send_wrench([40.0 * v * v, 0.0, 0.0, 0.0, -50.0 * np.cos(phase), 10.0 * np.sin(phase)])

    peer.on_tick = send
    send()
    peer.wait_until(lambda: len(peer.ticks) >= known + ticks, f'{ticks} ticks under way')


def test_recomputed_setpoints_are_the_recorded_ones(start, undrawn, replay, mt2012, tmp_path):
    """Through a live change and a stop: nearly every tick again, to rounding."""
    node, peer = start('rate:=100.0')
    rows = record(peer, TOPICS)
    sail(peer, 100)
    assert node.set_parameters([Parameter('wrench_weights.heave', value=1e4)])[0].successful
    sail(peer, 40)
    node._on_enable(SetBool.Request(data=False), SetBool.Response())
    sail(peer, 20)
    node._on_enable(SetBool.Request(data=True), SetBool.Response())
    sail(peer, 40)
    found = replay(write_raw(tmp_path / 'bag', rows), mt2012)
    assert found['ticks'] >= 190 and found['not_solved'] == 0
    assert found['difference']['median'] < 1e-9
    texts = [event['text'] for event in found['events']]
    assert 'parameter changed: wrench_weights.heave 100.0 to 10000.0' in texts
    assert any(text.startswith('the recorded node gave zeros') for text in texts)
