"""What a replay makes of a recording: numbers, files, and vehicles side by side."""

import csv
import json

import numpy as np
import pytest
from rosbags.rosbag2 import Reader
from support.bags import array, mission, odometry, stamped_wrench, START, STORE, wrench, write
from support.vehicles import PAPER_TEST
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.file import read_parameter_file
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.replay.run import Run


def table(folder) -> dict[str, np.ndarray]:
    """Return the columns of ticks.csv by name, but for the vehicle's."""
    with (folder / 'ticks.csv').open(encoding='utf-8') as file:
        header, *rows = csv.reader(file)
    return dict(zip(header[1:], np.array([row[1:] for row in rows], dtype=float).T))


def test_the_papers_test(undrawn, replay, mt2012, tmp_path):
    """At each speed of the paper's test every tick has the thrusts and limits of its table."""
    for v, thrusts, _, tunnel, pitch, heave in PAPER_TEST[2:5]:
        found = replay(write(tmp_path / f'bag_{v}', mission(1.0, speed=lambda t, v=v: v)), mt2012)
        ticks = table(tmp_path / 'out')
        last = {name: column[-1] for name, column in ticks.items()}
        assert [last[f'{name} thrust [N]'] for name in ('down', 'left', 'up', 'right', 'tunnel')] \
            == pytest.approx(thrusts, abs=0.02)
        assert last['tunnel upper [N]'] == pytest.approx(tunnel, abs=0.06)
        assert -last['achieved pitch [N*m]'] == pytest.approx(pitch, abs=0.01)
        assert -last['achieved heave [N]'] == pytest.approx(heave, abs=0.01)
        assert found['unallocated_max']['heave'] >= abs(heave) - 0.01
        assert found['seconds'] == pytest.approx(0.981, abs=1e-3)
        assert found['saturated_share']['tunnel'] == pytest.approx(float(v > 0.6), abs=0.05)


def test_every_key_of_the_summary(undrawn, replay, mt2012, tmp_path):
    """One vehicle has its figures at the top, by thruster, DOF, topic and cause."""
    found = replay(write(tmp_path / 'bag', mission(1.0)), mt2012)
    assert set(found) >= {
        'ticks', 'seconds', 'saturated_share', 'unallocated_rms', 'unallocated_max',
        'reversed_share', 'dropped', 'longest_gap', 'rate', 'not_solved', 'energy_proxy',
        'difference'}
    assert list(found['saturated_share']) == ['down', 'left', 'up', 'right', 'tunnel']
    assert all(list(found[name]) == list(DOFS)
               for name in ('unallocated_rms', 'unallocated_max', 'reversed_share'))
    assert set(found['rate']) == set(found['longest_gap']) == {'cmd_wrench', 'odom'}


def test_figures_by_hand(undrawn, replay, variant, tmp_path):
    """One constant thruster, 10 N asked of 4: all figures follow from that."""
    vehicle = tmp_path / 'one.yaml'
    vehicle.write_text(
        '/**:\n  ros__parameters:\n    thruster_names: [t]\n    wrench_weights: {surge: 1.0e+6, '
        'sway: 0.0, heave: 0.0, roll: 0.0, pitch: 0.0, yaw: 0.0}\n    thrusters:\n      t: {model: '
        'constant, position: [0.0, 0.0, 0.0], direction: [1.0, 0.0, 0.0], bollard_thrust: '
        '[-4.0, 4.0]}\n')
    recorded = [(i / 50, '/cmd_wrench', wrench(10.0, -1.0, 0.0, 0.0, 0.0, 0.0)) for i in range(101)]
    recorded += [(i / 50 + 0.001, '/thruster_setpoints', array([4.0 if i else 3.0]))
                 for i in range(100)]
    found = replay(write(tmp_path / 'bag', recorded), vehicle)
    assert found['ticks'] == 100 and found['saturated_share'] == {'t': 1.0}
    assert found['unallocated_rms']['surge'] == pytest.approx(6.0)
    assert found['unallocated_max']['sway'] == pytest.approx(1.0)
    assert found['difference'] == {'median': pytest.approx(0.0, abs=1e-12),
                                   'p99': pytest.approx(0.0025), 'max': pytest.approx(0.25)}
    assert found['energy_proxy'] == pytest.approx(99 / 50)  # full power throughout
    assert found['reversed_share']['surge'] == 0.0


def test_ticks_come_when_setpoints_were_recorded(undrawn, replay, mt2012, tmp_path):
    """One tick for each recorded one, at its time, with what had come until then."""
    times = [0.1, 0.25, 0.4]
    recorded = mission(0.5) + [(t, '/thruster_setpoints', array([1.0] * 5)) for t in times]
    found = replay(write(tmp_path / 'bag', recorded), mt2012)
    assert found['ticks'] == 3
    assert table(tmp_path / 'out')['time [s]'] == pytest.approx(
        [START * 1e-9 + t for t in times], abs=1e-6)


def test_a_node_that_had_stopped(undrawn, replay, mt2012, tmp_path):
    """Recorded zeros in spite of a wrench are taken for a stop, and said to be one."""
    recorded = mission(1.0) + [(i / 50 + 0.005, '/thruster_setpoints',
                                array([0.0] * 5 if 20 <= i < 30 else [1.0] * 5))
                               for i in range(50)]
    found = replay(write(tmp_path / 'bag', recorded), mt2012)
    ticks = table(tmp_path / 'out')
    assert ticks['stopped'].sum() == 10 and not ticks['up thrust [N]'][20:30].any()
    event, = found['events']
    assert event['text'].startswith('the recorded node gave zeros in spite of a wrench, for 0.20 s')


def test_the_recomputed_bag(undrawn, replay, mt2012, tmp_path):
    """replay.mcap holds the ticks as the node's messages, under /replay, at their times."""
    replay(write(tmp_path / 'bag', mission(1.0)), mt2012)
    ticks = table(tmp_path / 'out')
    found = {'/replay/thruster_states': [], '/replay/unallocated_wrench': [],
             '/replay/thrust_limits': []}
    with Reader(tmp_path / 'out' / 'replay.mcap') as reader:
        for connection, time, raw in reader.messages(reader.connections):
            found[connection.topic].append((time, STORE.deserialize_cdr(raw, connection.msgtype)))
    assert {len(one) for one in found.values()} == {len(ticks['time [s]'])}
    for i in (0, -1):
        time, states = found['/replay/thruster_states'][i]
        assert time * 1e-9 == pytest.approx(ticks['time [s]'][i], abs=1e-6)
        assert states.header.stamp.sec * 10**9 + states.header.stamp.nanosec == time
        assert states.name == ['down', 'left', 'up', 'right', 'tunnel']
        assert states.effort == pytest.approx(
            [ticks[f'{name} thrust [N]'][i] for name in states.name], abs=1e-6)
        limits = found['/replay/thrust_limits'][i][1]
        assert [one.size for one in limits.layout.dim] == [2, 5]
        assert limits.data.reshape(2, 5)[1, 4] == pytest.approx(
            ticks['tunnel upper [N]'][i], abs=1e-6)
        assert found['/replay/unallocated_wrench'][i][1].torque.y == pytest.approx(
            ticks['unallocated pitch [N*m]'][i], abs=1e-6)


def test_fins(undrawn, replay, mt2012, tmp_path):
    """A fin's deflection is the position in thruster_states, in proportion to its lift."""
    bag = write(tmp_path / 'bag', mission(1.0, speed=lambda t: 0.9))
    replay(bag, mt2012.with_name('delphin2_fins.yaml'))
    ticks = table(tmp_path / 'out')
    with Reader(tmp_path / 'out' / 'replay.mcap') as reader:
        states = [STORE.deserialize_cdr(raw, one.msgtype) for one, _, raw in reader.messages(
            [one for one in reader.connections if one.topic.endswith('states')])]
    last = states[-1]
    fins = np.array([name.startswith('fin_') for name in last.name])
    thrusts = [ticks[f'{name} thrust [N]'][-1] for name in last.name]
    assert last.effort == pytest.approx(thrusts, abs=1e-6) and len(last.velocity) == 0
    assert fins.sum() == 4 and not last.position[~fins].any()
    moved = last.position != 0.0
    assert moved.any() and np.ptp(last.position[moved] / np.array(thrusts)[moved]) < 1e-6


def test_vehicles_side_by_side(undrawn, replay, mt2012, variant, tmp_path):
    """Several files, and each with what --set changes, in one table, with pictures of their own."""
    bag = write(tmp_path / 'bag', mission(1.0, speed=lambda t: 0.9))
    found = replay(bag, mt2012, variant({'thrusters.tunnel.decay': 0.3}),
                   '--set', 'wrench_weights.heave:=1.0e4')['vehicles']
    names = ['mt2012', 'mt2012 with wrench_weights.heave 10000', 'vehicle',
             'vehicle with wrench_weights.heave 10000']
    assert list(found) == names
    heave = [found[name]['unallocated_rms']['heave'] for name in names]
    assert heave[0] > 25.0 and heave[1] < 0.8 * heave[0] and heave[2] < 1.0
    report = (tmp_path / 'out' / 'report.md').read_text('utf-8')
    assert f'| | {" | ".join(names)} |' in report
    assert all(f'(setpoints_{name}.png)' in report for name in (
        'mt2012', 'mt2012_with_wrench_weights_heave_10000', 'vehicle'))
    with Reader(tmp_path / 'out' / 'replay.mcap') as reader:
        assert '/replay/vehicle/thrust_limits' in reader.topics
    with (tmp_path / 'out' / 'ticks.csv').open(encoding='utf-8') as file:
        rows = list(csv.DictReader(file))
    assert list(dict.fromkeys(row['vehicle'] for row in rows)) == names


def test_vehicles_with_different_thrusters(undrawn, replay, mt2012, tmp_path):
    """One table has the columns of all of them, and nothing where a vehicle has no such one."""
    replay(write(tmp_path / 'bag', mission(0.5)), mt2012, mt2012.with_name('delphin2.yaml'))
    with (tmp_path / 'out' / 'ticks.csv').open(encoding='utf-8') as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        assert bool(row['tunnel thrust [N]']) == (row['vehicle'] == 'mt2012')
        assert bool(row['propeller upper [N]']) == (row['vehicle'] == 'delphin2')
        assert float(row['commanded pitch [N*m]']) == -50.0 and None not in row


def test_what_is_set_by_hand_stays(undrawn, replay, mt2012, tmp_path):
    """A change that was recorded does not undo --set."""
    from support.bags import changed

    recorded = mission(1.0) + [(0.1, '/parameter_events', changed(
        '/thrust_allocator', wrench_weights__heave=50.0))]
    found = replay(write(tmp_path / 'bag', recorded), mt2012,
                   '--set', 'wrench_weights.heave:=1.0e4')['vehicles']
    assert [len(one['events']) for one in found.values()] == [1, 0]


def test_namespaces_remaps_and_other_types(undrawn, replay, variant, tmp_path):
    """Topics in a namespace, by --topic, stamped wrenches and twists are all read."""
    velocity = {'twist': 'geometry_msgs/msg/TwistStamped',
                'twist_with_covariance': 'geometry_msgs/msg/TwistWithCovarianceStamped'}
    for kind, name in velocity.items():
        moving = odometry(0.9, 0.0, 0.0, 0.0, 0.0, 0.0).twist
        content = STORE.types[name](header=odometry(*[0.0] * 6).header,
                                    twist=moving if kind.endswith('ance') else moving.twist)
        recorded = []
        for i in range(50):
            recorded += [(i / 50, '/auv/twist', content),
                         (i / 50 + 0.001, '/w', stamped_wrench(i / 50, *[30.0] + [0.0] * 5))]
        found = replay(write(tmp_path / kind, recorded), variant({'velocity_type': kind}),
                       '--topic', 'cmd_wrench:=/w')
        assert found['topics'] == {'twist': '/auv/twist', 'cmd_wrench': '/w'}
        assert table(tmp_path / 'out')['velocity surge [m/s]'][-1] == 0.9
        assert not found['dropped']


def test_no_ticks_are_made_of_a_long_silence(mt2012):
    """After a minute without a message there are none until the next, from which all goes on."""
    run = Run('vehicle', describe(read_parameter_file(mt2012)), {}, 0, as_recorded=False)
    year = 365 * 86400 * 10**9  # [ns], a silence, or a damaged time
    run.finish(year)
    assert len(run.ticks) == 2000  # 1.5 periods apart, for no wrench came
    run.finish(year + 70 * 10**6)
    assert (run.ticks.times[2000:] - year).tolist() == [30 * 10**6, 60 * 10**6]


def test_a_long_recording_is_thinned_for_the_pictures(replay, mt2012, tmp_path):
    """Of many ticks, pictures show the highest and lowest; no peak of one tick is lost."""
    from thrust_allocator.replay.pictures import _thin

    x = np.arange(10_000) * 0.02
    y = np.zeros(10_000)
    y[7777] = 5.0
    grid, (low, high) = _thin(x, y)
    assert len(grid) == 1200 and high.max() == 5.0 and low.min() == 0.0


def test_summary_is_json_without_surprises(undrawn, replay, mt2012, tmp_path):
    """No NaN or infinity, which strict readers refuse."""
    replay(write(tmp_path / 'bag', mission(0.2)), mt2012)

    def refuse(word):
        raise AssertionError(word)

    json.loads((tmp_path / 'out' / 'summary.json').read_text(), parse_constant=refuse)
