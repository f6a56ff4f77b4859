"""Bags by rosbags: one channel at a time, and the message definitions they carry.

Needs the extra ``bags``: rosbags by itself reads the definitions of all channels at first.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from heapq import merge
from operator import itemgetter
from pathlib import Path
from typing import Any

from rosbags.interfaces import MessageDefinitionFormat
from rosbags.rosbag1 import Reader as Ros1Reader
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.reader import DirectoryReader
from rosbags.rosbag2.storage_mcap import McapReader, Schema
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

_LANGUAGES = ("ros2msg", "ros2idl", "omgidl", "")
_IDL_FILE = re.compile(r"^={80}\n(?:IDL: .*\n)?", re.MULTILINE)
_OTHER_FORMAT = re.compile(r"serialization_format: *(?!['\"]?cdr\b)\S")


class _Schemas(dict[int, Schema]):
    """Schemas of which those in other languages (``jsonschema``) count as absent."""

    def __setitem__(self, key: int, schema: Schema) -> None:
        known = schema.encoding in _LANGUAGES
        super().__setitem__(key, schema if known else Schema(schema.id, schema.name, "", ""))


class _McapReader(McapReader):
    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.schemas = _Schemas()


class _DirectoryReader(DirectoryReader):
    STORAGE_PLUGINS: Mapping[str, Any] = {
        **DirectoryReader.STORAGE_PLUGINS,
        "mcap": _McapReader,
    }


class _Ros2Reader(Reader):
    STORAGE_PLUGINS: Mapping[str, Any] = {
        **Reader.STORAGE_PLUGINS,
        "dir": _DirectoryReader,
        ".mcap": _McapReader,
    }


class Bag:
    """An open bag.

    Args:
        path: of a ROS 1 bag, or the folder or a single file of a ROS 2 bag; a folder whose metadata
            are absent, or name formats that rosbags refuses, is read by its files.
        more: type -> text of its definition, for a bag that has no definitions.
    """

    def __init__(self, path: Path, more: Mapping[str, str]) -> None:
        self.is_ros1 = path.suffix == ".bag"
        metadata = path / "metadata.yaml"
        paths = [path]
        if not metadata.exists() or _OTHER_FORMAT.search(metadata.read_text("utf-8")):
            inside = path.iterdir() if path.is_dir() else ()
            paths = sorted(p for p in inside if p.suffix in (".mcap", ".db3")) or [path]
        reader_class: Any = Ros1Reader if self.is_ros1 else _Ros2Reader
        self._more = more
        self._stores: dict[str, Any] = {}
        with ExitStack() as stack:
            self._readers = [stack.enter_context(reader_class(path)) for path in paths]
            self.close = stack.pop_all().close
        self.connections = [c for reader in self._readers for c in reader.connections]
        self.start_time = min(reader.start_time for reader in self._readers)
        self.end_time = max(reader.end_time for reader in self._readers)

    def messages(self, connections: Sequence[Any]) -> Iterator[tuple[Any, int, bytes]]:
        """Return connection, time and data of each message of some connections, by time."""
        streams = []
        for reader in self._readers:
            own = [connection for connection in reader.connections if connection in connections]
            if own:
                streams.append(reader.messages(own))
        return merge(*streams, key=itemgetter(1))

    def types(self, connection: Any) -> Any:
        """Return the types of the messages of a connection.

        Raises:
            Exception: its definition cannot be read, or is not the one that was recorded.
        """
        name = connection.msgtype
        if name not in self._stores:
            self._stores[name] = self._read(connection)
        return self._stores[name]

    def _read(self, connection: Any) -> Any:
        name, definition = connection.msgtype, connection.msgdef
        encoding = getattr(connection.ext, "serialization_format", "cdr")
        if encoding != "cdr":
            raise ValueError(f"{connection.topic} is recorded as {encoding}, cdr is expected")
        if definition.format == MessageDefinitionFormat.NONE:
            store = get_typestore(Stores.ROS1_NOETIC if self.is_ros1 else Stores.ROS2_HUMBLE)
            for other, text in () if self.is_ros1 else self._more.items():
                store.register(get_types_from_msg(text, other.replace("/", "/msg/")))
            return store
        store = get_typestore(Stores.EMPTY)
        if definition.format == MessageDefinitionFormat.MSG:
            store.register(get_types_from_msg(definition.data, name))
        else:
            parts = filter(str.strip, _IDL_FILE.split(definition.data))
            store.register({k: v for part in parts for k, v in get_types_from_idl(part).items()})
        if connection.digest:
            ros1_digest = self.is_ros1 and store.generate_msgdef(name)[1]
            if (ros1_digest or store.hash_rihs01(name)) != connection.digest:
                raise ValueError(f"the definition of {name} is not the one it was recorded with")
        return store

    def deserialize(self, connection: Any, data: bytes) -> Any:
        """Return a message."""
        store = self.types(connection)
        read = store.deserialize_ros1 if self.is_ros1 else store.deserialize_cdr
        return read(data, connection.msgtype)
