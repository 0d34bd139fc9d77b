"""Read a rosbag2 recording, without ROS."""

from collections.abc import Iterator, Mapping
from pathlib import Path
import shlex
from typing import Any, NamedTuple

from rosbags.rosbag2 import Reader
from thrust_allocator.replay.errors import ReplayError
from thrust_allocator.replay.messages import read
from thrust_allocator.replay.topics import find_topics, PARAMETER_EVENTS


class Message(NamedTuple):
    """One message of a bag."""

    time: int  # of the recorder [ns]
    name: str  # that its topic has in the node's contract
    content: Any  # as `messages` reads it


class Bag:
    """A recording, in one file or several, mcap or sqlite3, compressed or not."""

    def __init__(self, path: Path, topics: Mapping[str, str], node: str) -> None:
        """
        Open a bag; use it in a `with` statement.

        :param topics: given by hand, by name of the node's contract.
        :param node: full name of the node whose topics and parameters are wanted.
        :raises ReplayError: if it cannot be read, or has no wrench.
        """
        self.path = path
        namespace, _, name = node.rpartition('/')
        _refuse_folder_without_metadata(path)
        try:
            self._reader = Reader(path)
            self._reader.open()
        except FileNotFoundError:
            raise ReplayError(f'{path}: cannot be read: No such file or directory') from None
        except Exception as error:  # of nearly any type if the file is cut in the wrong place
            raise ReplayError(self._damaged(error)) from None
        kinds = {one.topic: one.msgtype for one in self._reader.connections}
        try:
            self.topics = find_topics(kinds, topics, namespace)  # names by topic
        except ReplayError as error:
            raise ReplayError(f'{path}: {error}') from None
        # The node may have run in the namespace of its topics
        self._nodes = {node, *(f'{topic.removesuffix(f"/{known}")}/{name}'
                               for topic, known in self.topics.items())}
        wanted = dict(self.topics)
        if kinds.get(PARAMETER_EVENTS) == 'rcl_interfaces/msg/ParameterEvent':
            wanted[PARAMETER_EVENTS] = 'parameter_events'
        self._wanted = wanted
        self._connections = [one for one in self._reader.connections if one.topic in wanted]
        self.start, self.end = self._reader.start_time, self._reader.end_time  # [ns]
        self.count = sum(one.msgcount for one in self._connections)

    def __enter__(self) -> 'Bag':
        return self

    def __exit__(self, *_: object) -> None:
        self._reader.close()

    def has(self, name: str) -> bool:
        """Tell whether a topic of this name of the contract was recorded, and not in vain."""
        return any(self._wanted[one.topic] == name and one.msgcount for one in self._connections)

    def __iter__(self) -> Iterator[Message]:
        """
        Yield the messages that concern a replay, in the order of their times.

        :raises ReplayError: where the bag is damaged.
        """
        try:
            for connection, time, raw in self._reader.messages(self._connections):
                content = read(raw, connection.msgtype)
                if connection.topic != PARAMETER_EVENTS or content.node in self._nodes:
                    yield Message(time, self._wanted[connection.topic], content)
        except (GeneratorExit, KeyboardInterrupt):
            raise
        except Exception as error:  # of nearly any type
            raise ReplayError(self._damaged(error)) from None

    def _damaged(self, error: Exception) -> str:
        files = sorted(self.path.iterdir()) if self.path.is_dir() else [self.path]
        sqlite = any(file.suffix == '.db3' for file in files)
        broken = shlex.quote(str(next(
            (file for file in files if file.suffix in ('.mcap', '.db3')), self.path)))
        mend = (f'sqlite3 {broken} .recover | sqlite3 mended.db3' if sqlite else
                f'mcap recover {broken} -o mended.mcap')
        reason = f' ({error})' if str(error) else ''
        return f'{self.path}: is no bag, or cut off or damaged{reason}: try {mend}'


def _refuse_folder_without_metadata(path: Path) -> None:
    if not path.is_dir() or (path / 'metadata.yaml').exists():
        return
    files = sorted(file for file in path.iterdir() if file.suffix in ('.mcap', '.db3'))
    if not files:
        raise ReplayError(f'{path}: is no bag: a folder without metadata.yaml, .mcap or .db3')
    raise ReplayError(f'{path}: has no metadata.yaml: give its file {files[0]} itself'
                      + (f' (one of {len(files)})' if len(files) > 1 else '')
                      + f', or make one with ros2 bag reindex {shlex.quote(str(path))}')
