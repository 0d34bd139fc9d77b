"""The numbers of serialised messages: taken out of the bytes, and put into bytes."""

import struct
from typing import Any, NamedTuple

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Empty

# What rclpy writes before a message on this machine, mostly for little-endian CDR. What follows
# is aligned from there on, each number to its own size
ENCODING = serialize_message(Empty())[:4]
STAMP = struct.Struct('=iI')
LENGTH = struct.Struct('=I')  # of a string, with the zero at its end [bytes]


class Malformed(ValueError):
    """Bytes that are no message of their type."""


def read_message(raw: bytes, kind: type) -> Any:
    """Have rclpy read a message; raise Malformed if it cannot."""
    try:
        return deserialize_message(raw, kind)
    except Exception as error:  # RMWError, which is nowhere documented, or worse
        raise Malformed(str(error)) from error


class Content(NamedTuple):
    """What a message holds."""

    stamp: int  # [ns]
    frames: tuple[str, ...]  # frame ids
    numbers: np.ndarray  # not to be written to


class Form(NamedTuple):
    """A type of message that consists of a stamp and frame ids, if any, and reals at its end."""

    kind: type
    frames: int  # how many
    numbers: int  # how many

    def read(self, raw: bytes) -> Content:
        """
        Read a message; what is encoded otherwise or looks odd is left to rclpy first.

        :raises Malformed: if rclpy cannot read it either.
        """
        try:
            return self._read(raw)
        except (ValueError, struct.error):
            return self._read(serialize_message(read_message(raw, self.kind)))

    def _read(self, raw: bytes) -> Content:
        """Read what is as rclpy writes it, or raise ValueError or struct.error."""
        if raw[:4] != ENCODING:
            raise ValueError('another encoding')
        body, at, stamp, frames = raw[4:], 0, 0, []
        if self.frames:
            seconds, nanoseconds = STAMP.unpack_from(body)
            at, stamp = STAMP.size, seconds * 10**9 + nanoseconds
        for _ in range(self.frames):
            start = at + -at % 4 + LENGTH.size
            at = start + LENGTH.unpack_from(body, start - LENGTH.size)[0]
            if body.find(0, start, at) != at - 1:
                raise ValueError('no string that ends in its only zero')
            frames.append(body[start:at - 1].decode())
        at += -at % 8
        if len(body) != at + 8 * self.numbers:
            raise ValueError('another length')
        return Content(stamp, tuple(frames), np.frombuffer(body, float, self.numbers, at))


class Template:
    """A message as rclpy serialises it, with runs of numbers that are exchanged again and again."""

    def __init__(self, message: Any, *runs: bytes) -> None:
        """
        Look for the runs.

        :param runs: numbers that stand in the message, as they lie in memory, in its order.
        :raises ValueError: if they are not found in what rclpy writes.
        """
        self._pieces: list[bytes] = []
        rest = serialize_message(message)
        for run in runs:
            before, found, rest = rest.partition(run)
            if not found:
                raise ValueError(f'{type(message).__name__}: its numbers are not in its bytes')
            self._pieces += [before, found]
        self._pieces.append(rest)

    def filled(self, *runs: bytes) -> bytes:
        """Return the serialised message with other numbers in place of the runs."""
        self._pieces[1::2] = runs
        return b''.join(self._pieces)
