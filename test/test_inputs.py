"""What was received last, without ROS: what counts, for how long, and what is dropped."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
import pytest
from support.rotations import ANGLES, quaternion, rotation
from thrust_allocator.inputs import AHEAD, Inputs, LARGEST_VELOCITY, LARGEST_WRENCH, Timeouts

SECOND = 10**9  # [ns]
TIMEOUTS = Timeouts(wrench=SECOND, velocity=SECOND, current=10 * SECOND)
WRENCH = np.array([60.0, 0.0, 10.0, 0.0, 20.0, -15.0])
TWIST = np.array([1.0, 0.3, -0.2, 0.05, 0.1, -0.1])
CURRENT = np.array([0.7, -1.1, 0.4])  # [m/s], in the odometry's parent frame
LEVEL = np.array([0.0, 0.0, 0.0, 1.0])


def told(now: int = 0, orientation=LEVEL, frame: str = 'odom') -> Inputs:
    """Return inputs that have had one message of each at a time."""
    inputs = Inputs()
    inputs.accept_wrench(WRENCH, now)
    inputs.accept_velocity(TWIST, now, 'odom', 'odom', np.array(orientation, dtype=float))
    inputs.accept_current(CURRENT, frame, now)
    return inputs


@pytest.mark.parametrize('angles', ANGLES)
def test_the_current_is_turned_into_the_body(angles):
    """The velocity through the water is that over ground less the current, turned by a matrix."""
    orientation = 1.0005 * quaternion(*angles)  # nearly unit counts
    motion = told(orientation=orientation).motion(0, TIMEOUTS)
    assert_allclose(motion.twist[:3], TWIST[:3] - rotation(*angles).T @ CURRENT, atol=1e-12)
    assert_array_equal(motion.twist[3:], TWIST[3:])
    assert motion.current_ignored == ''


def test_what_came_is_kept_as_it_came():
    """Taking the current off leaves the velocity that was received alone."""
    inputs = told()
    assert_array_equal(inputs.motion(0, TIMEOUTS).twist, inputs.motion(0, TIMEOUTS).twist)
    assert_array_equal(inputs.velocity.values, TWIST)


def test_without_a_current_the_velocity_counts_as_through_the_water():
    """Nothing is taken off, and nothing is said."""
    inputs = Inputs()
    inputs.accept_velocity(TWIST, 0, 'odom', 'odom', LEVEL)
    assert_array_equal(inputs.motion(0, TIMEOUTS).twist, TWIST)
    assert inputs.motion(0, TIMEOUTS).current_ignored == ''


@pytest.mark.parametrize('age, counts', [(10 * SECOND, True), (10 * SECOND + 1, False)])
def test_a_current_counts_until_its_time_out(age, counts):
    """The time-out itself included; then it is ignored, and it is said."""
    inputs = told()
    inputs.accept_velocity(TWIST, age, 'odom', 'odom', LEVEL)
    motion = inputs.motion(age, TIMEOUTS)
    assert_allclose(motion.twist[:3], TWIST[:3] - (CURRENT if counts else 0.0))
    assert (motion.current_ignored == '') == counts


def test_a_current_from_another_frame_is_ignored():
    """One from another frame than the odometry's parent cannot be turned into the body."""
    motion = told(frame='map').motion(0, TIMEOUTS)
    assert_array_equal(motion.twist, TWIST)
    assert "'map'" in motion.current_ignored and "'odom'" in motion.current_ignored


@pytest.mark.parametrize('orientation', [
    [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0011], [0.0, 0.0, 0.0, 0.9989], [1.0, 0.0, 0.0, 1.0],
    [0.0, 0.0, np.nan, 1.0], [np.nan] * 4, [0.0, 0.0, 0.0, np.inf], [1e100] * 4], ids=str)
def test_an_orientation_that_is_none(orientation):
    """With an orientation that is no unit quaternion the current is ignored."""
    motion = told(orientation=orientation).motion(0, TIMEOUTS)
    assert_array_equal(motion.twist, TWIST)
    assert 'unit quaternion' in motion.current_ignored


@pytest.mark.parametrize('age, stale', [(0, False), (SECOND, False), (SECOND + 1, True)])
def test_a_velocity_is_stale_beyond_its_time_out(age, stale):
    """The time-out itself is not beyond it; an old velocity is told all the same."""
    motion = told().motion(age, TIMEOUTS)
    assert (motion.stale, motion.missing != '') == (stale, stale)
    assert_allclose(motion.twist[:3], TWIST[:3] - CURRENT)


def test_since_when_a_velocity_is_missing():
    """Never yet, for so many seconds, or since the clock went back; not if none is expected."""
    assert Inputs().motion(0, TIMEOUTS).missing == 'yet'
    assert told().motion(3 * SECOND + SECOND // 2, TIMEOUTS).missing == 'for 3.5 s'
    inputs = told()
    inputs.forget()
    assert 'clock' in inputs.motion(0, TIMEOUTS).missing
    for none_expected in (Inputs(), inputs):
        motion = none_expected.motion(0, TIMEOUTS._replace(velocity=0))
        assert motion.stale and motion.missing == ''


@pytest.mark.parametrize('age, live', [(0, True), (SECOND, True), (SECOND + 1, False)])
def test_a_wrench_is_live_until_its_time_out(age, live):
    """The time-out itself included."""
    assert (told().live_wrench(age, TIMEOUTS) is not None) == live


@pytest.mark.parametrize('old, now, live', [
    (0, SECOND, True), (SECOND, 0, True), (SECOND + 1, 0, False), (SECOND // 2, SECOND // 2, True),
    (SECOND // 2, SECOND, True), (SECOND // 2, SECOND + 1, False), (-AHEAD, SECOND, True)])
def test_a_stamp_makes_a_wrench_older_never_younger(old, now, live):
    """The larger counts of the age that the stamp gave it and the time since it came."""
    inputs = Inputs()
    inputs.accept_wrench(WRENCH, 0, old)
    assert (inputs.live_wrench(now, TIMEOUTS) is not None) == live


def test_a_wrench_from_the_future_is_dropped():
    """Further ahead than clocks differ: dropped, counted, and the one before counts on."""
    inputs = told()
    inputs.accept_wrench(2.0 * WRENCH, 0, -AHEAD - 1)
    assert_array_equal(inputs.live_wrench(0, TIMEOUTS), WRENCH)
    assert dict(inputs.dropped) == {'cmd_wrench stamped in the future': 1}


def test_a_clock_that_goes_back_makes_all_of_it_expire():
    """No wrench is live, velocity and current are older than any time-out; new ones count."""
    inputs = told(now=900 * SECOND)
    inputs.forget()
    for now in (0, 899 * SECOND, 901 * SECOND):
        assert inputs.live_wrench(now, TIMEOUTS) is None
        motion = inputs.motion(now, Timeouts(wrench=2**61, velocity=2**61, current=2**61))
        assert motion.stale and motion.current_ignored
    Inputs().forget()  # of nothing
    inputs.accept_wrench(WRENCH, 0)
    inputs.accept_velocity(TWIST, 0, 'odom', 'odom', LEVEL)
    assert inputs.live_wrench(0, TIMEOUTS) is not None
    assert not inputs.motion(0, TIMEOUTS).stale


ACCEPT = {
    'cmd_wrench': lambda inputs, values: inputs.accept_wrench(values, 5),
    'odom': lambda inputs, values: inputs.accept_velocity(values, 5, 'odom', 'odom', LEVEL),
    'twist': lambda inputs, values: inputs.accept_velocity(values, 5, 'twist'),
    'current': lambda inputs, values: inputs.accept_current(values, 'odom', 5)}
LARGEST = {'cmd_wrench': LARGEST_WRENCH, 'odom': LARGEST_VELOCITY, 'twist': LARGEST_VELOCITY,
           'current': LARGEST_VELOCITY}


def state(inputs: Inputs) -> list:
    """Return values and times of what was received last."""
    return [(one.values.tolist(), one.time)
            for one in (inputs.wrench, inputs.velocity, inputs.current)]


@pytest.mark.parametrize('topic', ACCEPT)
def test_one_broken_component_drops_the_whole_message(topic):
    """Not finite or too large, in whichever component: dropped, counted by cause, no refresh."""
    size, largest = 3 if topic == 'current' else 6, LARGEST[topic]
    for cause, values in (('not finite', (np.nan, np.inf, -np.inf)),
                          (f'beyond {largest:g}', (1e308, 1.0001 * largest, -1.0001 * largest))):
        inputs = told()
        before = state(inputs)
        for value in values:
            for broken in np.where(np.eye(size, dtype=bool), value, 2.0):
                ACCEPT[topic](inputs, broken)
        assert state(inputs) == before
        assert dict(inputs.dropped) == {f'{topic} {cause}': 3 * size}


@pytest.mark.parametrize('topic', ACCEPT)
def test_the_largest_values_count(topic):
    """The limits of what is accepted are inside them."""
    size, inputs = 3 if topic == 'current' else 6, told()
    ACCEPT[topic](inputs, LARGEST[topic] * np.resize([1.0, -1.0], size))
    assert not inputs.dropped
    assert 5 in [time for _, time in state(inputs)]
