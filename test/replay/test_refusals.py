"""A bag that cannot be replayed is refused in one line that says what to do."""

import sys

import pytest
from support.bags import array, mission, odometry, write
from thrust_allocator.replay.__main__ import main


def test_a_bag_that_was_cut_off(refused, mt2012, tmp_path):
    """The command that mends it is named, for each kind of storage."""
    for storage, suffix, command in (('mcap', '.mcap', 'mcap recover'),
                                     ('sqlite3', '.db3', '.recover | sqlite3')):
        bag = write(tmp_path / storage, mission(2.0), storage)
        file = next(bag.glob(f'*{suffix}'))
        file.write_bytes(file.read_bytes()[:-file.stat().st_size // 3])
        for path in (bag, file):
            line = refused(path, mt2012)
            assert 'cut off or damaged' in line and command in line and str(file) in line


def test_a_bag_without_metadata(refused, mt2012, tmp_path):
    """Its file is named, which can be given itself, and so is what reads a folder again."""
    bag = write(tmp_path / 'bag', mission(1.0))
    (bag / 'metadata.yaml').unlink()
    line = refused(bag, mt2012)
    assert 'has no metadata.yaml' in line and f'{bag}/bag.mcap' in line and 'reindex' in line
    (tmp_path / 'empty').mkdir()
    assert 'is no bag: a folder without metadata.yaml' in refused(tmp_path / 'empty', mt2012)


def test_a_bag_without_a_wrench(refused, mt2012, tmp_path):
    """Which topics there are instead is said, those of a wrench first."""
    motion = [one for one in mission(1.0) if one[1] == '/odom']
    line = refused(write(tmp_path / 'none', motion), mt2012)
    assert 'has no cmd_wrench' in line and '/odom (nav_msgs/msg/Odometry)' in line
    other = [(t, '/auv/wrench' if topic == '/cmd_wrench' else topic, content)
             for t, topic, content in mission(1.0)]
    line = refused(write(tmp_path / 'other', other), mt2012)
    assert '--topic cmd_wrench:=TOPIC' in line and line.endswith('of a wrench are /auv/wrench\n')


def test_topics_that_are_not_what_they_should_be(refused, mt2012, tmp_path):
    """Two candidates, a topic that is not there, and one of another type."""
    two = [(t, ns + topic, content) for t, topic, content in mission(1.0) for ns in ('/a', '/b')]
    line = refused(write(tmp_path / 'two', two), mt2012)
    assert 'cmd_wrench is recorded on /a/cmd_wrench and /b/cmd_wrench' in line
    bag = write(tmp_path / 'bag', mission(1.0))
    assert 'has no topic /gone' in refused(bag, mt2012, '--topic', 'odom:=/gone')
    assert 'must be a geometry_msgs/msg/Wrench or' in refused(
        bag, mt2012, '--topic', 'cmd_wrench:=/odom')


def test_what_is_no_bag(refused, mt2012, variant, tmp_path):
    """A path that is not there, and a file of something else."""
    assert 'cannot be read: No such file' in refused(tmp_path / 'none', mt2012)
    assert 'is no bag' in refused(mt2012, mt2012)
    assert 'makes a tick' in refused(
        write(tmp_path / 'one', [(0.0, '/cmd_wrench', mission(0.1)[1][2])]),
        variant({'tick_on_wrench': False}))


def test_mistakes_in_vehicles(refused, mt2012, variant, tmp_path):
    """A bad value in the file or from --set, and two files of one name."""
    bag = write(tmp_path / 'bag', mission(1.0))
    assert 'thrusters.up.weight: is -1.0' in refused(bag, variant({'thrusters.up.weight': -1.0}))
    assert '--set: wrench_weights.yaw: is -5' in refused(
        bag, mt2012, '--set', 'wrench_weights.yaw:=-5.0')
    assert '--set: wrench_weights.yew: is no parameter' in refused(
        bag, mt2012, '--set', 'wrench_weights.yew:=5.0')
    assert 'must have a name of its own' in refused(bag, mt2012, mt2012)


@pytest.mark.parametrize('module', ['rosbags', 'matplotlib'])
def test_what_is_not_installed_is_named(module, refused, mt2012, tmp_path, monkeypatch):
    """It says plainly which extra brings it."""
    monkeypatch.setitem(sys.modules, module, None)
    assert "pip install 'thrust_allocator[replay]'" in refused(tmp_path / 'bag', mt2012)


@pytest.mark.parametrize('args, words', [
    (['bag'], 'required: VEHICLE.yaml'), (['bag', 'v', '--topic', 'wrench:=/w'], 'NAME:=/TOPIC'),
    (['bag', 'v', '--topic', 'odom:=w'], 'NAME:=/TOPIC'),
    (['bag', 'v', '--set', 'rate'], "'rate' must be PARAMETER:=VALUE")])
def test_a_mistake_on_the_command_line(args, words, capsys):
    """One line and status 2."""
    with pytest.raises(SystemExit) as caught:
        main(['replay', *args, '--output', 'out'])
    error = capsys.readouterr().err
    assert caught.value.code == 2 and words in error and error.count('\n') == 1


def test_recorded_setpoints_of_another_vehicle(undrawn, tmp_path, mt2012):
    """Setpoints of another number of thrusters give ticks, but nothing to compare with."""
    recorded = mission(1.0) + [(i / 50 + 0.002, '/thruster_setpoints', array([1.0, 2.0]))
                               for i in range(50)]
    recorded.append((0.5, '/odom', odometry(0.8, 0.0, 0.0, 0.0, 0.0, 0.0)))
    assert main(['replay', str(write(tmp_path / 'bag', recorded)), str(mt2012), '--output',
                 str(tmp_path / 'out')]) == 0
    report = (tmp_path / 'out' / 'report.md').read_text()
    assert 'No setpoints of as many thrusters were recorded.' in report
