"""The files of a replay that machines read: ticks.csv, summary.json, and replay.mcap."""

from collections.abc import Iterator, Sequence
import heapq
from itertools import repeat
import json
from pathlib import Path
import tempfile
from typing import Any

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores
from thrust_allocator.physics.frames import DOFS
from thrust_allocator.replay.run import Run

_TYPES = get_typestore(Stores.ROS2_JAZZY)
_UNITS = ('N', 'N', 'N', 'N*m', 'N*m', 'N*m')
_VELOCITY = ('surge [m/s]', 'sway [m/s]', 'heave [m/s]', 'roll [rad/s]', 'pitch [rad/s]',
             'yaw [rad/s]')


def write_summary(path: Path, found: dict[str, dict[str, Any]], about: dict[str, Any]) -> None:
    """Write the figures of one vehicle at the top, those of several under `vehicles`."""
    body = next(iter(found.values())) if len(found) == 1 else {'vehicles': found}
    path.write_text(json.dumps({**about, **body}, indent=2) + '\n', 'utf-8')


def write_ticks(path: Path, runs: Sequence[Run]) -> None:
    """Write a row for each tick, of several vehicles one after another in one table."""
    tables = [_table(run) for run in runs]
    columns = list(dict.fromkeys(column for table in tables for column in table))
    with path.open('w', encoding='utf-8') as file:
        file.write(','.join(['vehicle', 'time [s]', *columns]) + '\n')
        for run, table in zip(runs, tables):
            rows = np.column_stack([table[column] for column in columns if column in table])
            formats = ['%.9g' if column in table else '' for column in columns]
            row = ','.join([f'"{run.name}"', '%d.%09d', *formats]) + '\n'
            file.writelines(row % (*divmod(time, 10**9), *values) for time, values in zip(
                run.ticks.times.tolist(), map(np.ndarray.tolist, rows)))


def _table(run: Run) -> dict[str, np.ndarray]:
    """Return the columns of a run, (n,) each, by name and unit."""
    unit = run.description.parameters.values['setpoint_unit']
    table = {}
    for i, one in enumerate(run.description.vehicle.thrusters):
        for column, title in (('thrusts', 'thrust [N]'), ('lower', 'lower [N]'),
                              ('upper', 'upper [N]'), ('setpoints', f'setpoint [{unit}]'),
                              ('recorded', f'recorded [{unit}]')):
            table[f'{one.name} {title}'] = run.ticks[column][:, i]
    for column, title in (('wrench', 'commanded'), ('achieved', 'achieved'),
                          ('unallocated', 'unallocated')):
        for i, (dof, force) in enumerate(zip(DOFS, _UNITS)):
            table[f'{title} {dof} [{force}]'] = run.ticks[column][:, i]
    for i, title in enumerate(_VELOCITY):
        table[f'velocity {title}'] = run.ticks['velocity'][:, i]
    return table | {flag: run.ticks[flag] for flag in ('live', 'solved', 'stale', 'stopped')}


def write_bag(path: Path, runs: Sequence[Run]) -> None:
    """
    Write the recomputed topics, under /replay, or /replay/<vehicle> if there are several.

    One message of each topic is serialised; all others differ from it in the numbers at its end.
    """
    with tempfile.TemporaryDirectory(dir=path.parent, prefix='.replay') as folder:
        bag = Path(folder) / 'replay'
        with Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            rows = []
            for run in runs:
                for topic, kind, payloads in _topics(run, len(runs) > 1):
                    connection = writer.add_connection(topic, kind, typestore=_TYPES)
                    rows.append(zip(repeat(connection), payloads))
            for connection, (time, payload) in heapq.merge(*rows, key=lambda row: row[1][0]):
                writer.write(connection, time, payload)
        next(bag.glob('*.mcap')).replace(path)


def _topics(run: Run, several: bool) -> Iterator[tuple[str, str, Iterator[tuple[int, bytes]]]]:
    """Yield topic, type, and time and payload of each message."""
    root = f'/replay/{run.topic}' if several else '/replay'
    names = [one.name for one in run.description.vehicle.thrusters]
    ticks, types = run.ticks, _TYPES.types
    limits = np.hstack([ticks['lower'], ticks['upper']])
    yield (f'{root}/thrust_limits', 'std_msgs/msg/Float64MultiArray',
           _payloads(ticks.times, limits, _array(types, len(names)),
                     'std_msgs/msg/Float64MultiArray'))
    wrench = types['geometry_msgs/msg/Wrench']
    zero = types['geometry_msgs/msg/Vector3'](x=0.0, y=0.0, z=0.0)
    yield (f'{root}/unallocated_wrench', 'geometry_msgs/msg/Wrench',
           _payloads(ticks.times, ticks['unallocated'], wrench(force=zero, torque=zero),
                     'geometry_msgs/msg/Wrench'))
    empty = np.zeros(0)
    states = types['sensor_msgs/msg/JointState'](
        header=types['std_msgs/msg/Header'](
            stamp=types['builtin_interfaces/msg/Time'](sec=0, nanosec=0), frame_id=''),
        name=names, position=np.zeros(len(names)), velocity=empty, effort=np.zeros(len(names)))
    yield f'{root}/thruster_states', states.__msgtype__, _states(run, states)


def _array(types: Any, p: int) -> Any:
    """Return the message of thrust_limits as the node lays it out."""
    dimension = types['std_msgs/msg/MultiArrayDimension']
    layout = types['std_msgs/msg/MultiArrayLayout'](
        dim=[dimension(label='limits', size=2, stride=2 * p),
             dimension(label='thrusters', size=p, stride=p)], data_offset=0)
    return types['std_msgs/msg/Float64MultiArray'](layout=layout, data=np.zeros(2 * p))


def _payloads(times: np.ndarray, rows: np.ndarray, message: Any, kind: str
              ) -> Iterator[tuple[int, bytes]]:
    """Yield messages that differ in the numbers at their end."""
    head = bytes(_TYPES.serialize_cdr(message, kind))[:-8 * rows.shape[1]]
    for time, row in zip(times.tolist(), np.ascontiguousarray(rows, dtype='<f8')):
        yield time, head + row.tobytes()


def _states(run: Run, message: Any) -> Iterator[tuple[int, bytes]]:
    """Yield JointStates, which end in positions, the lengths of the other two, and efforts."""
    template = bytes(_TYPES.serialize_cdr(message, message.__msgtype__))
    size = 8 * len(message.name)
    head, lengths = template[12:-2 * size - 8], template[-size - 8:-size]
    rows = zip(run.ticks.times.tolist(), run.ticks['deflections'].astype('<f8'),
               run.ticks['thrusts'].astype('<f8'))
    for time, positions, efforts in rows:
        seconds, nanoseconds = divmod(time, 10**9)
        stamp = seconds.to_bytes(4, 'little') + nanoseconds.to_bytes(4, 'little')
        yield time, b''.join((template[:4], stamp, head, positions.tobytes(), lengths,
                              efforts.tobytes()))
