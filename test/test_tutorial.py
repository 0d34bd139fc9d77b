"""Who follows the tutorial gets the vehicle on its drawing, and what the tutorial shows."""

from dataclasses import replace
import math
import re
import sys
from types import ModuleType

import numpy as np
from numpy.testing import assert_allclose
import pytest
from rclpy.parameter import Parameter
from support.paths import ROOT
from thrust_allocator.diagnosis.findings import Level
from support.vehicles import propeller
from thrust_allocator.parameters.build import load_vehicle
from thrust_allocator.parameters.check import read_parameters
from thrust_allocator.parameters.file import read_parameter_file
from thrust_allocator.parameters.types import ParameterError
from thrust_allocator.physics.models import Tunnel
from thrust_allocator.ros.command_line import read_command_line
import yaml

TUTORIAL = (ROOT / 'doc/tutorial.md').read_text('utf-8')
TURN = math.sqrt(0.5)
DRAWING = {  # position and direction of positive thrust: x forward, y starboard, z down
    'front_right': ((0.156, 0.111, 0.085), (-TURN, TURN, 0.0)),
    'front_left': ((0.156, -0.111, 0.085), (-TURN, -TURN, 0.0)),
    'rear_right': ((-0.156, 0.111, 0.085), (TURN, TURN, 0.0)),
    'rear_left': ((-0.156, -0.111, 0.085), (TURN, -TURN, 0.0)),
    'vertical_front_right': ((0.120, 0.218, 0.0), (0.0, 0.0, 1.0)),
    'vertical_front_left': ((0.120, -0.218, 0.0), (0.0, 0.0, 1.0)),
    'vertical_rear_right': ((-0.120, 0.218, 0.0), (0.0, 0.0, 1.0)),
    'vertical_rear_left': ((-0.120, -0.218, 0.0), (0.0, 0.0, 1.0))}


@pytest.fixture
def my_vehicle(tmp_path):
    """Return the path of the tutorial's YAML, as a reader would have saved it."""
    path = tmp_path / 'my_vehicle.yaml'
    path.write_text(shown('## 5. The file', 'yaml'), encoding='utf-8')
    return path


def shown(after, kind='text'):
    """Return the block of a kind that the tutorial shows next after some words."""
    pattern = rf'^```{kind}\n(.*?)\n```$'
    return re.search(pattern, TUTORIAL[TUTORIAL.index(after):], re.M | re.S)[1]


def echoed(text):
    """Return the numbers of an array as `ros2 topic echo --field data` prints it."""
    return yaml.safe_load(re.fullmatch(r"array\('d', (\[.*\])\)\n---", text)[1])


def wrenches():
    """Return what the tutorial sends on cmd_wrench and shows of it: (text, (6,), (p,)) of each."""
    pattern = r'"(\{.*?\})"\n(?:ros2 topic echo.*\n)?```\n\n```text\n(array.*\n---)\n```'
    found = []
    for sent, heard in re.findall(r'cmd_wrench geometry_msgs/msg/Wrench ' + pattern, TUTORIAL):
        wrench = yaml.safe_load(sent)
        found.append((sent, np.array([wrench.get(group, {}).get(axis, 0.0) for group in
                                      ('force', 'torque') for axis in 'xyz']),
                      echoed(heard)))
    return found


def test_the_described_vehicle(start, my_vehicle):
    """The node that runs the tutorial's file has the drawing's thrusters, and starts disabled."""
    node, peer = start(file=my_vehicle)
    assert [one.name for one in node.vehicle.thrusters] == list(DRAWING)
    for one in node.vehicle.thrusters:
        position, direction = DRAWING[one.name]
        assert_allclose(one.position, position, atol=1e-12)
        assert_allclose(one.direction, direction, atol=1e-5)
        assert one.bollard_thrust == (-39.9, 51.4)
        assert_allclose(one.model.speed_loss, [12.1, 15.6], atol=0.05)  # as by the tow test
    assert_allclose(np.array([4.069, 5.245]) * 9.807, [39.9, 51.4], atol=0.05)
    assert node.vehicle.warnings() == []
    assert not peer.settle([40.0, 0.0, 0.0, 0.0, 0.0, 0.0])['thruster_setpoints'].any()
    assert node.reporter.present('enable') == 'disabled: zero setpoints'


def test_the_package_has_the_same_vehicle(my_vehicle):
    """Drawn or taken from config/bluerov2_heavy.yaml: thrusters and weights are equal."""
    one, other = (load_vehicle(path)
                  for path in (my_vehicle, ROOT / 'config/bluerov2_heavy.yaml'))
    assert one == other


def test_the_setpoints_shown(start, my_vehicle):
    """Each wrench that the tutorial sends gives the setpoints that it shows."""
    _, peer = start('start_enabled:=true', file=my_vehicle)
    cases = wrenches()
    assert len(cases) == 5
    for sent, wrench, expected in cases:
        twist = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0] if '200' in sent else None
        assert_allclose(peer.settle(wrench, twist)['thruster_setpoints'], expected, atol=0.0051)


def test_what_gives_way_as_shown(start, my_vehicle):
    """The step on what gives way: setpoints and wrenches, and what the diagnostics say."""
    node, peer = start('start_enabled:=true', file=my_vehicle)
    command, forward = [200.0, 0.0, 0.0, 0.0, 0.0, 20.0], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    before = peer.settle(command, forward)
    assert_allclose(before['achieved_wrench'][[0, 5]], [79.6, 8.0], atol=0.06)
    assert_allclose(before['thrust_limits'][[0, 10]], [-33.83, 43.58], atol=0.005)

    def after(name, value, *others):
        """Set a parameter, compare the setpoints with those shown, return surge and yaw."""
        for one in ((name, value), *others):
            typed = one[1] if 'e' in one[1] else float(one[1])  # as `ros2 param set` reads it
            assert node.set_parameters([Parameter(one[0], value=typed)])[0].successful
        tick = peer.settle(command, forward)
        assert_allclose(tick['thruster_setpoints'],
                        echoed(shown(f'{name} {value}')), atol=0.0051)
        return tick['achieved_wrench'][[0, 5]]

    assert_allclose(after('direction_keeping', '0.0'), [109.5, 0.0], atol=0.06)
    node.report()  # of what was before
    peer.settle(command, forward)
    node.report()
    said = re.sub('in [0-9]+% of', 'in 100% of', node.reporter.present('shortfall'))
    status, = yaml.safe_load(shown('## 8. Read the diagnostics'))['status']
    assert (status['level'], status['message']) == (chr(Level.WARN), said)
    assert_allclose(after('wrench_weights.yaw', '1.0e7'), [63.8, 12.2], atol=0.06)
    after('power_limit', '600.0', ('direction_keeping', '1.0'))


def test_c_and_decay_by_hand():
    """The formulas give back what the models were made with, and the figures shown."""
    one = propeller(bollard_thrust=(-40.0, 51.4), speed_loss=(12.0, 15.6),
                    speed_loss_quadratic=(0.0, 3.0), angle_law='cosine')
    loss = {speed: 51.4 - one.limits(speed, 0.0)[1] for speed in (0.5, 1.2)}
    c2 = (loss[1.2] / 1.2 - loss[0.5] / 0.5) / (1.2 - 0.5)
    assert (c2, loss[0.5] / 0.5 - c2 * 0.5) == pytest.approx((3.0, 15.6))
    straight, angle = replace(one, speed_loss_quadratic=(0.0, 0.0)), math.radians(30.0)
    left = straight.limits(1.2 * math.cos(angle), 1.2 * math.sin(angle))[1]
    assert (51.4 - left) / (1.2 * math.cos(angle)**2) == pytest.approx(15.6)

    product = 19.3 * math.log(19.3 / 13.6) / (1000.0 * 1.0**2)
    assert f'c·S = {product:.5f} m²' in TUTORIAL
    assert f'`decay: {product / 0.00385:.2f}`' in TUTORIAL.replace('\n', ' ')
    tunnel = Tunnel((-19.3, 19.3), product / 0.00385, 1000.0 * 0.00385)
    assert tunnel.limits(0.0, 1.0)[1] == pytest.approx(13.6)


def test_the_refusals_shown(start, my_vehicle):
    """What the tutorial sets in vain is refused with the words that it shows."""
    node, _ = start(file=my_vehicle)
    results = node.set_parameters([
        Parameter('wrench_weights.yaw', value='1.0e8'),
        Parameter('thrusters.front_left.position', value=[0.0, 0.0, 0.0])])
    assert [f'Setting parameter failed: {result.reason}' for result in results] == (
        shown('## 10. Keep').splitlines())


def test_the_mistake_shown(my_vehicle):
    """The mistake of step 5 ends in the line that it shows."""
    text = my_vehicle.read_text('utf-8')
    head, _, tail = text.rpartition('      rear_left:')
    broken = head + '      rear_left:' + tail.replace('[-39.9', '[39.9', 1)
    my_vehicle.write_text(broken, encoding='utf-8')
    with pytest.raises(ParameterError) as caught:
        read_parameters(read_parameter_file(my_vehicle))
    assert shown('If there is a mistake') == f'thrust_allocator: {caught.value}'


def test_the_log_shown(start, my_vehicle):
    """At start the node says what the tutorial shows, in that order, without an odometry."""
    node, peer = start(file=my_vehicle)
    said = []
    logger = type('Logger', (), {'warning': said.append, 'info': said.append})
    node.reporter._findings._logger = logger
    for publisher in peer._inputs.values():
        peer.destroy_publisher(publisher)
    peer.wait_until(lambda: len(said) == 3, 'what the node says')
    log = re.sub(r' \[[0-9]{10}\.[0-9]{9}\]', '', shown('Start it:'))  # the times
    started = node._description
    assert [f'{level} [thrust_allocator]: {line}' for level, lines in (
        ('[INFO]', started.remarks), ('[WARN]', (*started.warnings, *said)))
        for line in lines] == log.splitlines()


def test_what_a_unit_is_worth_as_shown(monkeypatch, capsys):
    """The example of step 3 prints what stands below it."""
    monkeypatch.chdir(ROOT)
    exec(shown('What this is worth', 'python'), {})
    assert capsys.readouterr().out.rstrip() == shown('What this is worth')


def test_the_table_of_the_driver():
    """It rises from one Bollard limit of the vehicle to the other, and has as many signals."""
    signals, thrusts = (
        [float(cell.replace('−', '-')) for cell in re.findall(r'−?[0-9.]+(?= )', row)]
        for row in re.findall(r'^\| (?:PWM, µs|thrust at rest, N) \|(.*)$', TUTORIAL, re.M))
    assert len(signals) == len(thrusts) and signals == sorted(signals)
    assert thrusts == sorted(thrusts) and (thrusts[0], thrusts[-1]) == (-39.9, 51.4)
    assert np.interp(0.0, thrusts, signals) == 1500.0


def test_the_fin_shown():
    """It is the first of those in config/delphin2_fins.yaml."""
    fin = yaml.safe_load(shown('A fin, whose lift', 'yaml'))['fin_top']
    file = yaml.safe_load((ROOT / 'config/delphin2_fins.yaml').read_text('utf-8'))
    assert fin == file['/**']['ros__parameters']['thrusters']['fin_top']


def test_the_launch_file_shown(monkeypatch):
    """What launch_ros makes of it is a command line that the node takes, with a file for each."""
    launch, actions = ModuleType('launch'), ModuleType('launch_ros.actions')
    launch.LaunchDescription, actions.Node = list, dict
    monkeypatch.setitem(sys.modules, 'launch', launch)
    monkeypatch.setitem(sys.modules, 'launch_ros.actions', actions)
    exec(shown('### Two vehicles', 'python'), found := {})
    nodes = found['generate_launch_description']()
    assert [node['namespace'] for node in nodes] == ['alpha', 'bravo']
    for node in nodes:
        assert (ROOT / 'resource/executables' / node['executable']).is_file()
        line = read_command_line([
            node['executable'], '--ros-args', '-r', f'__node:={node["name"]}', '-r',
            f'__ns:=/{node["namespace"]}', '--params-file', *node['parameters']])
        assert (line.files, line.unknown) == ([f'{node["namespace"]}.yaml'], [])
