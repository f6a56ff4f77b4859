"""Bags by rosbags: one channel at a time, and the message definitions they carry.

Needs the extra ``bags``: rosbags by itself reads the definitions of all channels at first.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
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

from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config.field_paths import (
    FieldPath,
    FieldPathError,
    parse_field,
    path_text,
    resolve,
)
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.message_types import TIMES, Fields, MessageFields
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.monitors.binding import BoundMonitor, InputBinding, fits
from eddi_scaffold.monitors.expression_names import head_of, path_behind
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS

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


def storage_files(path: Path) -> Sequence[Path]:
    """Return the files of a bag of ROS 2 that hold messages."""
    if not path.is_dir():
        return [path]
    return sorted(one for one in path.iterdir() if one.suffix in (".mcap", ".db3"))


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
        whole = metadata.exists() and not _OTHER_FORMAT.search(metadata.read_text("utf-8"))
        paths = [path] if whole else storage_files(path) or [path]
        of: Any = Ros1Reader if self.is_ros1 else _Ros2Reader
        self._more = more
        self._stores: dict[str, Any] = {}
        with ExitStack() as stack:
            self._readers = [stack.enter_context(of(one)) for one in paths]
            self._close = stack.pop_all().close
        self.connections = [
            connection for reader in self._readers for connection in reader.connections
        ]
        self.start_time = min(reader.start_time for reader in self._readers)
        self.end_time = max(reader.end_time for reader in self._readers)

    def close(self) -> None:
        """Close its files."""
        self._close()

    def messages(self, connections: Sequence[Any]) -> Iterator[tuple[Any, int, bytes]]:
        """Return connection, time and data of each message of some connections, by time."""
        readers = [
            reader.messages(own)
            for reader in self._readers
            if (
                own := [
                    connection for connection in reader.connections if connection in connections
                ]
            )
        ]
        return merge(*readers, key=itemgetter(1))

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
        of, text = connection.msgdef.format, connection.msgdef.data
        encoding = getattr(connection.ext, "serialization_format", "cdr")
        if encoding != "cdr":
            raise ValueError(f"{connection.topic} is recorded as {encoding}, cdr is expected")
        if of == MessageDefinitionFormat.NONE:
            return self._usual()
        store = get_typestore(Stores.EMPTY)
        if of == MessageDefinitionFormat.MSG:
            store.register(get_types_from_msg(text, connection.msgtype))
        else:
            parts = filter(str.strip, _IDL_FILE.split(text))
            store.register({k: v for part in parts for k, v in get_types_from_idl(part).items()})
        if connection.digest:
            ros1, name = self.is_ros1, connection.msgtype
            digest = store.generate_msgdef(name)[1] if ros1 else store.hash_rihs01(name)
            if digest != connection.digest:
                raise ValueError(f"the definition of {name} is not the one it was recorded with")
        return store

    def _usual(self) -> Any:
        store = get_typestore(Stores.ROS1_NOETIC if self.is_ros1 else Stores.ROS2_HUMBLE)
        for name, text in () if self.is_ros1 else self._more.items():
            store.register(get_types_from_msg(text, name.replace("/", "/msg/")))
        return store

    def deserialize(self, connection: Any, data: bytes) -> Any:
        """Return a message."""
        store = self.types(connection)
        read = store.deserialize_ros1 if self.is_ros1 else store.deserialize_cdr
        return read(data, connection.msgtype)


_TIMES = {"builtin_interfaces/Time": "time", "builtin_interfaces/Duration": "duration"}


def tables(definitions: Mapping[str, Any]) -> MessageFields:
    """Return message type -> its fields, of the definitions as rosbags has read them."""
    found: dict[str, Fields] = {}
    for name, (_, fields) in definitions.items():
        found[name.replace("/msg/", "/")] = {field: _type(*of) for field, of in fields}
    return {**found, **TIMES}


def _type(node: Any, of: Any) -> str:
    """Return a type in the words of ``.msg`` files."""
    if node.name == "BASE":
        return str(of[0])
    if node.name == "NAME":
        name = str(of).replace("/msg/", "/")
        return _TIMES.get(name, name)
    inner, size = of  # an array or a sequence
    return f"{_type(*inner)}[{size if node.name == 'ARRAY' else ''}]"


def check_fields(
    monitor: BoundMonitor, known: MessageFields, there: Collection[str]
) -> Iterator[Problem]:
    """Report fields that the messages of a bag do not have, or not of that type (I012).

    Args:
        monitor: it has a configuration.
        known: the messages of the bag.
        there: full names of the topics in the bag: others cannot be checked.
    """
    assert monitor.config is not None
    entries = {entry.id: k for k, entry in enumerate(monitor.config.config.EDDIInputs)}
    for binding in monitor.inputs:
        if binding.model.id not in entries:
            continue
        place = _place(monitor.config, entries[binding.model.id])
        for source, path, is_value in _reads(binding, monitor.config, entries[binding.model.id]):
            if monitor.topic(source.topic) not in there:
                continue
            shown = f"{source.type} in the bag"
            try:
                of = resolve(path, source.type, known.get).type
            except FieldPathError as failure:
                yield problem("I012.value", place, hint=failure.hint, shown=shown, problem=failure)
                continue
            if is_value and of is not None and not fits(of, binding.model.type):
                message = f"{shown}: {path_text(path)!r} is a {of}"
                yield problem("I012.value_type", place, message=message, type=binding.model.type)


def _place(config: ConfigFile, index: int) -> Any:
    entry = config.config.EDDIInputs[index]
    key = next((key for key in ("field", *EXPRESSION_KEYS) if getattr(entry, key)), "requires")
    return config.place("EDDIInputs", index, key)


def _reads(
    binding: InputBinding, config: ConfigFile, index: int
) -> Iterator[tuple[SimulatorOutput, FieldPath, bool]]:
    """Yield message, path, and whether what is there is the value itself."""
    if binding.reads is not None:
        sources = {attribute(requirement.id): requirement for requirement in binding.requires}
        for name in binding.reads:
            if head_of(name) in sources:
                yield sources[head_of(name)], path_behind(name), False
        return
    field = config.config.EDDIInputs[index].field
    if not binding.is_given:
        return
    for argument, source in zip(binding.arguments, binding.requires, strict=False):
        believed = (binding.known_fields or {}).get(argument, ())
        taken = believed[0] if field is None and len(believed) == 1 else field
        if taken is not None:
            yield source, parse_field(taken), True
