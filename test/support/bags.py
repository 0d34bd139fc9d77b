"""Recordings for the tests: written message by message, split, compressed, or of a live node."""

from collections.abc import Callable, Mapping
from pathlib import Path
import shutil
from typing import Any

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores
import yaml

STORE = get_typestore(Stores.ROS2_JAZZY)
START = 1_700_000_000 * 10**9  # [ns]


def message(kind: str, **fields):
    """Return a message; what is not given is 0 or empty. A field may be a dict of fields."""
    cls = STORE.types[kind]
    made = {}
    for name, (node, detail) in STORE.fielddefs[kind][1]:
        value = fields.get(name)
        if node.name == 'NAME':
            made[name] = (value if value is not None and not isinstance(value, dict)
                          else message(detail, **(value or {})))
        elif node.name == 'BASE':
            made[name] = value if value is not None else (
                '' if detail[0] == 'string' else False if detail[0] == 'bool' else
                0.0 if detail[0].startswith('float') else 0)
        elif value is not None:
            made[name] = value
        elif detail[0][0].name == 'NAME' or detail[0][1][0] == 'string':
            made[name] = []
        else:
            made[name] = np.zeros(detail[1] if node.name == 'ARRAY' else 0,
                                  dtype=np.dtype(detail[0][1][0]))
    return cls(**made)


def wrench(*values: float):
    """Return a Wrench of six numbers."""
    return message('geometry_msgs/msg/Wrench', **_wrench(values))


def _wrench(values) -> dict:
    return {'force': dict(zip('xyz', values[:3])), 'torque': dict(zip('xyz', values[3:]))}


def stamped_wrench(time: float, *values: float):
    """Return a WrenchStamped of a time since START [s]."""
    return message('geometry_msgs/msg/WrenchStamped', header={'stamp': _stamp(time)},
                   wrench=_wrench(values))


def odometry(*twist: float):
    """Return an Odometry of a velocity of six numbers, level and heading along x."""
    return message('nav_msgs/msg/Odometry', header={'frame_id': 'odom'},
                   child_frame_id='base_link', pose={'pose': {'orientation': {'w': 1.0}}},
                   twist={'twist': {'linear': dict(zip('xyz', twist[:3])),
                                    'angular': dict(zip('xyz', twist[3:]))}})


def changed(node: str, **values: float | bool):
    """Return a ParameterEvent; in the names '__' stands for each dot."""
    parameters = [message('rcl_interfaces/msg/Parameter', name=name.replace('__', '.'),
                          value={'type': 1, 'bool_value': value} if isinstance(value, bool) else
                          {'type': 3, 'double_value': value}) for name, value in values.items()]
    return message('rcl_interfaces/msg/ParameterEvent', node=node, changed_parameters=parameters)


def array(values):
    """Return a Float64MultiArray."""
    return message('std_msgs/msg/Float64MultiArray', data=np.asarray(values, dtype=float))


def _stamp(time: float) -> dict:
    nanoseconds = START + round(time * 1e9)
    return {'sec': nanoseconds // 10**9, 'nanosec': nanoseconds % 10**9}


Recorded = tuple[float, str, object]  # time since START [s], topic, message


def write(path: Path, recorded: list[Recorded], storage: str = 'mcap',
          compressed: str = '') -> Path:
    """
    Write a bag of messages and return its path.

    :param compressed: 'file', 'message', 'storage', or not at all.
    """
    writer = Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
    if compressed:
        writer.set_compression(CompressionMode[compressed.upper()], CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for time, topic, content in sorted(recorded, key=lambda one: one[0]):
            kind = content.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], START + round(time * 1e9),
                         STORE.serialize_cdr(content, kind))
    return path


def write_split(path: Path, recorded: list[Recorded], storage: str, at: float) -> Path:
    """Write a bag of two files, the second one from a time on, as `ros2 bag record -b` does."""
    halves = [write(path.with_name(f'{path.name}_{i}'), half, storage)
              for i, half in enumerate(([one for one in recorded if one[0] < at],
                                        [one for one in recorded if one[0] >= at]))]
    path.mkdir()
    first, second = (yaml.safe_load((half / 'metadata.yaml').read_text()) for half in halves)
    whole, more = (one['rosbag2_bagfile_information'] for one in (first, second))
    for half, part in zip(halves, (whole, more)):
        for name in part['relative_file_paths']:
            shutil.move(half / name, path / name)
    counts = {one['topic_metadata']['name']: one for one in whole['topics_with_message_count']}
    for one in more['topics_with_message_count']:
        known = counts.setdefault(one['topic_metadata']['name'], {**one, 'message_count': 0})
        known['message_count'] += one['message_count']
    whole['topics_with_message_count'] = list(counts.values())
    whole['relative_file_paths'] += more['relative_file_paths']
    whole['files'] += more['files']
    whole['message_count'] += more['message_count']
    whole['duration']['nanoseconds'] = (
        more['starting_time']['nanoseconds_since_epoch'] + more['duration']['nanoseconds']
        - whole['starting_time']['nanoseconds_since_epoch'])
    (path / 'metadata.yaml').write_text(yaml.safe_dump(first))
    return path


def mission(seconds: float, rate: float = 50.0,
            speed: Callable[[float], float] = lambda t: 0.8) -> list[Recorded]:
    """Return a wrench and an odometry at a rate, the paper's test at a speed, in flu axes."""
    recorded = []
    for t in (np.arange(round(seconds * rate)) / rate).tolist():
        v = speed(t)
        recorded += [(t, '/odom', odometry(v, 0.0, 0.0, 0.0, 0.0, 0.0)),
                     (t + 0.001, '/cmd_wrench', wrench(40.0 * v * v, 0.0, 0.0, 0.0, -50.0, 0.0))]
    return recorded


RawRecorded = tuple[int, str, str, bytes]  # time [ns], topic, type, serialised message


def record(peer: Any, topics: Mapping[str, type]) -> list[RawRecorded]:
    """
    Return a list that grows by what a peer hears on topics, as `ros2 bag record` stores it.

    :param topics: classes of the messages by topic.
    """
    rows: list[RawRecorded] = []

    def subscribe(topic: str, kind: type) -> None:
        module = kind.__module__.split('.')
        name = f'{module[0]}/msg/{kind.__name__}'
        peer.create_subscription(
            kind, topic, lambda raw, info: rows.append(
                (info['received_timestamp'], topic, name, bytes(raw))), 1000, raw=True)

    for topic, kind in topics.items():
        subscribe(topic, kind)
    return rows


def write_raw(path: Path, rows: list[RawRecorded]) -> Path:
    """Write a bag of serialised messages and return its path."""
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {topic: writer.add_connection(topic, kind, typestore=STORE)
                       for topic, kind in {(row[1], row[2]) for row in rows}}
        for time, topic, _, raw in sorted(rows, key=lambda row: row[0]):
            writer.write(connections[topic], time, raw)
    return path
