"""Numbers in serialised messages, against rosbags' own CDR; and what happens to broken bytes."""

from array import array
import struct

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3, Wrench
from hypothesis import given, strategies as st
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from support.bags import message, STORE
from thrust_allocator.ros import cdr
from thrust_allocator.ros.cdr import Form, Malformed, Template
from thrust_allocator.ros.subscriptions import (
    CURRENT, INPUT, VELOCITIES, WRENCH, WRENCH_STAMPED)

ODOMETRY = VELOCITIES['odometry']
NAMES = {WRENCH: 'geometry_msgs/msg/Wrench', WRENCH_STAMPED: 'geometry_msgs/msg/WrenchStamped',
         CURRENT: 'geometry_msgs/msg/Vector3Stamped', ODOMETRY: 'nav_msgs/msg/Odometry',
         VELOCITIES['twist']: 'geometry_msgs/msg/TwistStamped',
         VELOCITIES['twist_with_covariance']: 'geometry_msgs/msg/TwistWithCovarianceStamped'}
HEADER = {'stamp': {'sec': 1_700_000_000, 'nanosec': 123_456_789}, 'frame_id': 'map'}
reals = st.floats(allow_nan=False)


def vector(values):
    """Return the fields of a vector or a quaternion."""
    return dict(zip('xyzw', values))


def odometry(numbers, frame, child):
    """Return rosbags' odometry of 85 numbers in the order of its definition."""
    return message(
        NAMES[ODOMETRY], header={'stamp': HEADER['stamp'], 'frame_id': frame},
        child_frame_id=child, pose={
            'pose': {'position': vector(numbers[:3]), 'orientation': vector(numbers[3:7])},
            'covariance': np.array(numbers[7:43])},
        twist={'twist': {'linear': vector(numbers[43:46]), 'angular': vector(numbers[46:49])},
               'covariance': np.array(numbers[49:])})


def encoded(one, form, little_endian=True):
    """Return a message as rosbags serialises it."""
    return bytes(STORE.serialize_cdr(one, NAMES[form], little_endian=little_endian))


@pytest.fixture
def alone(monkeypatch):
    """Take rclpy's deserialiser away."""
    def refuse(*arguments):
        raise AssertionError('rclpy was asked')
    monkeypatch.setattr(cdr, 'deserialize_message', refuse)


def test_odometry_with_frame_names_of_every_length(alone):
    """0 to 40 characters each, and others than ASCII: its numbers are found without rclpy."""
    random = np.random.default_rng(1)
    names = [('x' * n, 'y' * m) for n in range(41) for m in range(41)]
    for frame, child in (*names, ('odométrie', '基座'), ('/a b', '')):
        numbers = random.normal(size=85).tolist()
        found = ODOMETRY.read(encoded(odometry(numbers, frame, child), ODOMETRY))
        assert found.numbers.tolist() == numbers
        assert found.frames == (frame, child) and found.stamp == 1_700_000_000_123_456_789


@given(few=st.lists(reals, min_size=5, max_size=5), frame=st.text(max_size=40),
       child=st.text(max_size=40))
def test_both_ways_come_to_the_same(few, frame, child):
    """What rclpy reads of rosbags' bytes, of either endianness, is what is read without it."""
    numbers = [0.5, -1.5, 2.5, *few, *np.arange(38.0).tolist(), *few, *np.arange(34.0).tolist()]
    frame, child = frame.replace('\0', ''), child.replace('\0', '')
    one = odometry(numbers, frame, child)
    raw = encoded(one, ODOMETRY)
    theirs = deserialize_message(raw, Odometry)
    turn, linear, angular = (theirs.pose.pose.orientation, theirs.twist.twist.linear,
                             theirs.twist.twist.angular)
    for bytes_ in (raw, encoded(one, ODOMETRY, little_endian=False), serialize_message(theirs)):
        found = ODOMETRY.read(bytes_)
        assert found.frames == (theirs.header.frame_id, theirs.child_frame_id) == (frame, child)
        assert found.numbers.tobytes() == array('d', numbers).tobytes()
        assert found.numbers[3:7].tolist() == [turn.x, turn.y, turn.z, turn.w]
        assert found.numbers[43:49].tolist() == [linear.x, linear.y, linear.z,
                                                 angular.x, angular.y, angular.z]


@pytest.mark.parametrize('form, fields', [
    (WRENCH, {'force': vector('123'), 'torque': vector('456')}),
    (WRENCH_STAMPED, {'wrench': {'force': vector('123'), 'torque': vector('456')}}),
    (CURRENT, {'vector': vector('123')}),
    (VELOCITIES['twist'], {'twist': {'linear': vector('123'), 'angular': vector('456')}}),
    (VELOCITIES['twist_with_covariance'],
     {'twist': {'twist': {'linear': vector('123'), 'angular': vector('456')}}})],
    ids=lambda value: value.kind.__name__ if isinstance(value, Form) else '')
def test_the_other_types(form, fields, alone):
    """Their first numbers are 1, 2, 3 (4, 5, 6), as they were put in by name."""
    def real(value):
        return ({name: real(one) for name, one in value.items()} if isinstance(value, dict)
                else float(value))
    if form.frames:
        fields = {**fields, 'header': 0.0}
    one = message(NAMES[form], **{name: HEADER if name == 'header' else real(value)
                                  for name, value in fields.items()})
    found = form.read(encoded(one, form))
    count = min(form.numbers, 6)
    assert found.numbers[:count].tolist() == list(range(1, count + 1))
    assert len(found.numbers) == form.numbers
    assert found.frames == (('map',) if form.frames else ())


GOOD = encoded(odometry(list(map(float, range(85))), 'odom', 'base'), ODOMETRY)


def readable(raw):
    """Tell whether rclpy by itself can read an odometry."""
    try:
        deserialize_message(raw, Odometry)
    except Exception:
        return False
    return True


@pytest.mark.parametrize('raw', [
    *(GOOD[:length] for length in (0, 1, 3, 4, 11, 15, 16, 18, 30, 100, len(GOOD) - 1)),
    *(bytes([0, encoding, 0, options]) + GOOD[4:] for encoding in range(12)
      for options in (0, 1, 3, 255)),
    *(GOOD[:12] + struct.pack('<I', length) + GOOD[16:]
      for length in (0, 1, 4, 6, 2**31 - 1, 2**31, 2**32 - 1)),
    GOOD[:16] + b'\xff\xfe\xfd\xfc\0' + GOOD[21:], GOOD[:16] + b'o\0om\0' + GOOD[21:],
    GOOD[:16] + b'odomX' + GOOD[21:], GOOD + b'xx', GOOD + GOOD, b'\xff' * len(GOOD)])
def test_odd_bytes_are_read_as_rclpy_reads_them(raw):
    """Or are called malformed where it cannot; never another error."""
    if not readable(raw):
        with pytest.raises(Malformed):
            ODOMETRY.read(raw)
        return
    theirs = deserialize_message(raw, Odometry)
    found = ODOMETRY.read(raw)
    assert found.frames == (theirs.header.frame_id, theirs.child_frame_id)
    assert found.numbers[43:46].tobytes() == array('d', [
        theirs.twist.twist.linear.x, theirs.twist.twist.linear.y,
        theirs.twist.twist.linear.z]).tobytes()


@given(data=st.data())
def test_damaged_bytes_raise_nothing_else(data):
    """Bytes cut off, changed or put in: content, or Malformed."""
    raw = bytearray(GOOD)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, min(40, len(raw))))
        raw[at:at + data.draw(st.integers(0, 9))] = data.draw(st.binary(max_size=9))
    try:
        assert len(ODOMETRY.read(bytes(raw)).numbers) == 85
    except Malformed:
        pass


@given(numbers=st.lists(reals, min_size=6, max_size=6))
def test_a_filled_template_is_the_message(numbers):
    """rclpy and rosbags read back what was filled in, to the bit, again and again."""
    marks = array('d', [1.5, 2.5, 3.5, 4.5, 5.5, 6.5])
    template = Template(Wrench(force=Vector3(x=1.5, y=2.5, z=3.5),
                               torque=Vector3(x=4.5, y=5.5, z=6.5)), marks.tobytes())
    for values in (numbers, numbers[::-1]):
        raw = template.filled(array('d', values).tobytes())
        for one in (deserialize_message(raw, Wrench), STORE.deserialize_cdr(raw, NAMES[WRENCH])):
            found = [getattr(part, axis) for part in (one.force, one.torque) for axis in 'xyz']
            assert array('d', found).tobytes() == array('d', values).tobytes()


def test_a_template_without_its_numbers_is_refused():
    """Numbers that do not stand in the message are an error at once, not wrong messages later."""
    with pytest.raises(ValueError, match='Wrench: its numbers'):
        Template(Wrench(), array('d', [1.5]).tobytes())


def test_malformed_messages_are_dropped_and_counted(start):
    """On every topic that comes in: a count by topic, no exception, and the next is answered."""
    node, peer = start()
    reports = []
    peer.create_subscription(DiagnosticArray, '/diagnostics', reports.append, 10)
    for topic, form in (('cmd_wrench', WRENCH), ('odom', ODOMETRY), ('current', CURRENT)):
        publisher = peer.create_publisher(form.kind, topic, INPUT)
        peer.wait_until(publisher.get_subscription_count, 'the node')
        for raw in (GOOD[:30], b'\0\1\0\0', GOOD[:12] + b'\xff' * 9):
            before = node._inputs.dropped[f'{topic} malformed']
            publisher.publish(raw)
            peer.wait_until(lambda: node._inputs.dropped[f'{topic} malformed'] > before,
                            'the count')
    wrench = [60.0, 10.0, 20.0, 5.0, 30.0, -15.0]
    tick = peer.settle(wrench, [1.0, 0.3, -0.2, 0.05, 0.1, -0.1])
    assert tick['thruster_setpoints'].all()
    peer.wait_until(lambda: reports, 'a report')
    figures = {pair.key: pair.value for pair in reports[-1].status[0].values}
    assert figures['dropped: odom malformed'] == '3'
