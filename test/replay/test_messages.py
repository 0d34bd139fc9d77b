"""Messages that are read at once hold what the library reads of them."""

from hypothesis import given, strategies as st
import numpy as np
from support.bags import message, odometry, STORE, wrench
from thrust_allocator.replay import messages

SIX = st.lists(st.floats(-1e9, 1e9), min_size=6, max_size=6)


def both(content):
    """Return what is read of a message, at once and by way of the library."""
    kind = content.__msgtype__
    raw = bytes(STORE.serialize_cdr(content, kind))
    swapped = bytes(STORE.serialize_cdr(content, kind, little_endian=False))
    assert raw[1] == 1 and swapped[1] == 0
    return messages.read(raw, kind), messages.read(swapped, kind)


@given(SIX, st.text(max_size=9), st.text(max_size=9), st.floats(-1.0, 1.0))
def test_odometry(values, frame, child, turn):
    """Names of any length move the numbers behind them."""
    content = message(
        'nav_msgs/msg/Odometry', header={'frame_id': frame}, child_frame_id=child,
        pose={'pose': {'orientation': {'w': turn}}}, twist={'twist': odometry(*values).twist.twist})
    at_once, whole = both(content)
    assert at_once.frame == whole.frame == frame
    assert at_once.twist.tolist() == whole.twist.tolist() == values
    assert at_once.orientation.tolist() == whole.orientation.tolist() == [0.0, 0.0, 0.0, turn]


@given(SIX)
def test_wrench(values):
    """Six numbers in a row."""
    at_once, whole = both(wrench(*values))
    assert at_once.wrench.tolist() == whole.wrench.tolist() == values
    assert at_once.stamp == 0 and at_once.wrench.dtype == np.float64
