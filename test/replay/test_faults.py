"""Faults that are planted in a recording are reported, each, however the bag is stored."""

import csv
import math

import pytest
from support.bags import changed, message, mission, odometry, wrench, write, write_split


def planted():
    """Return a mission of 9 s with a fault of every kind."""
    recorded = [one for one in mission(9.0)
                if not (one[1] == '/odom' and 2.0 < one[0] < 5.0
                        or one[1] == '/cmd_wrench' and 6.0 < one[0] < 6.71)]
    sagging = [(float(t), '/battery', message('sensor_msgs/msg/BatteryState',
                                              voltage=16.0 - 0.5 * t)) for t in range(9)]
    return recorded + sagging + [
        (1.0, '/cmd_wrench', wrench(math.nan, 0.0, 0.0, 0.0, 0.0, 0.0)),
        (1.2, '/odom', odometry(99.0, 0.0, 0.0, 0.0, 0.0, 0.0)),
        (1.5, '/parameter_events', changed('/thrust_allocator', wrench_weights__heave=1e4)),
        (1.6, '/parameter_events', changed('/another_node', wrench_weights__heave=1e2)),
        (1.7, '/parameter_events', changed('/thrust_allocator', wrench_weights__heave=-1.0)),
        (7.5, '/parameter_events', changed('/thrust_allocator', thrusters__up__enabled=False))]


STORES = {
    'mcap': lambda path: write(path, planted()),
    'sqlite3': lambda path: write(path, planted(), 'sqlite3'),
    'mcap, chunks compressed': lambda path: write(path, planted(), 'mcap', 'storage'),
    'sqlite3, file compressed': lambda path: write(path, planted(), 'sqlite3', 'file'),
    'sqlite3, messages compressed': lambda path: write(path, planted(), 'sqlite3', 'message'),
    'mcap, split': lambda path: write_split(path, planted(), 'mcap', 4.0),
    'sqlite3, split': lambda path: write_split(path, planted(), 'sqlite3', 4.0),
    'a lone mcap': lambda path: next(write(path, planted()).glob('*.mcap')),
    'a lone db3': lambda path: next(write(path, planted(), 'sqlite3').glob('*.db3'))}


@pytest.mark.parametrize('store', STORES.values(), ids=STORES)
def test_each_planted_fault_is_reported(store, undrawn, replay, variant, tmp_path):
    """Gaps with lengths and effects, a battery that sags, what was dropped, changed, refused."""
    found = replay(store(tmp_path / 'bag'), variant({'nominal_voltage': 16.0}))
    assert found['longest_gap']['odom'] == pytest.approx(3.0, abs=0.03)
    assert found['longest_gap']['cmd_wrench'] == pytest.approx(0.72, abs=0.03)
    assert found['rate']['cmd_wrench'] == pytest.approx(50.0 * 8.28 / 9.0, abs=1.0)
    assert found['dropped'] == {'cmd_wrench not finite': 1, 'odom beyond 50': 1}
    assert found['not_solved'] == 0 and found['difference'] is None
    events = [(round(one['time'], 2), one['text']) for one in found['events']]
    assert [one for one in events if 'dropped' in one[1]] == [
        (1.0, 'message dropped: cmd_wrench not finite'), (1.2, 'message dropped: odom beyond 50')]
    assert (1.5, 'parameter changed: wrench_weights.heave 100.0 to 10000.0') in events
    assert (7.5, 'parameter changed: thrusters.up.enabled True to False') in events
    refused, = [text for time, text in events if time == 1.7]
    assert 'not followed' in refused and 'must be 0 or a number' in refused
    (odom_at, odom), (wrench_at, silent) = [one for one in events if one[1].startswith('no ')]
    assert odom_at == 2.0 and odom.startswith('no odom for 3.00 s: limits no wider than at')
    assert wrench_at == pytest.approx(6.0, abs=0.021) and silent.startswith('no cmd_wrench for 0.7')
    assert 'zero setpoints at ' in silent
    assert (8.0, 'battery down from 16.0 to 12.0 V: 71% of the thrust at nominal_voltage') in events
    assert len(events) == 8
    report = (tmp_path / 'out' / 'report.md').read_text('utf-8')
    assert all(text in report for _, text in events)
    assert 'The motion is held as recorded.' in report.split('##')[0]


def test_a_thruster_that_was_taken_out_pushes_no_more(undrawn, replay, mt2012, tmp_path):
    """From the change on its thrust is 0 and the others take over."""
    replay(write(tmp_path / 'bag', planted()), mt2012)
    rows = [line.split(',') for line in (tmp_path / 'out' / 'ticks.csv').read_text().splitlines()]
    up = rows[0].index('up thrust [N]')
    start = float(rows[1][1])
    before = [float(row[up]) for row in rows[1:] if float(row[1]) < start + 5.9]
    after = [float(row[up]) for row in rows[1:] if float(row[1]) > start + 7.6]
    assert min(before) > 10.0 and len(after) > 50 and not any(after)


def test_a_battery_that_sags_takes_thrust(undrawn, replay, mt2012, variant, tmp_path):
    """Limits at rest follow (V / nominal)^1.2; without nominal_voltage it is said not to count."""
    recorded = mission(30.0, speed=lambda t: 0.0)
    recorded += [(float(t), '/battery', message('sensor_msgs/msg/BatteryState', voltage=12.0))
                 for t in range(30)]
    replay(write(tmp_path / 'bag', recorded), variant({'nominal_voltage': 16.0}))
    with (tmp_path / 'out' / 'ticks.csv').open(encoding='utf-8') as file:
        last = list(csv.DictReader(file))[-1]
    assert float(last['up upper [N]']) == pytest.approx(120.1 * 0.75**1.2, rel=1e-6)
    found = replay(write(tmp_path / 'other', planted()), mt2012)
    assert any('not considered, for nominal_voltage is 0' in one['text']
               for one in found['events'])


def test_a_gap_at_the_end_is_a_gap(undrawn, replay, mt2012, tmp_path):
    """A recording that goes on after the last wrench shows that it was the last."""
    recorded = [one for one in mission(3.0) if one[1] == '/odom' or one[0] < 1.0]
    found = replay(write(tmp_path / 'bag', recorded), mt2012)
    assert found['longest_gap']['cmd_wrench'] == pytest.approx(2.0, abs=0.03)
    assert any(one['text'].startswith('no cmd_wrench for 2.00 s: zero setpoints')
               for one in found['events'])
