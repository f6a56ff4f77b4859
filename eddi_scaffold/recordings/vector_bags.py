"""Test vectors of a ConSert as a bag, for its node and for ``run --bag``; needs rosbags."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from contextlib import suppress
from functools import reduce
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import Writer as Ros2Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from eddi_scaffold.config.field_paths import (
    Attribute,
    ByKey,
    FieldPath,
    FieldPathError,
    parse_field,
)
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.recordings.bags import own_messages
from eddi_scaffold.recordings.node import PLAIN_DEFAULTS, SECOND

_PERIODS = 10  # that a vector lasts
_ENDS = ({"is": "inf"}, {"is": "-inf"})
_ROS2_VERSION: Any = 9


def bag_of(monitor: BoundMonitor, name: str) -> tuple[dict[str, bytes], list[str], list[str]]:
    """Return the files of a bag, when which vector is in it, and those that are no messages.

    Each vector lasts for ten periods of the monitor, and until what is silent in it is too old.

    Args:
        monitor: of a ConSert.
        name: of the bag: ``.bag`` is one of ROS 1, any other a folder of ROS 2.
    """
    data = json.loads(monitor.model.vectors(monitor.bound, {}) or "{}")
    values: dict[str, dict[str, list[Any]]] = {}  # of a leaf, for each letter
    for id_, _, _, judged in data.get("leaves", ()):
        rows = [(float(of["is"]) if of in _ENDS else of, letter) for of, letter in judged]
        values[id_] = {of: [value for value, letter in rows if letter == of] for of in "FUT"}
    inputs = {of.model.id: of for of in monitor.inputs}
    is_ros1 = name.endswith(".bag")
    store = get_typestore(Stores.ROS1_NOETIC if is_ros1 else Stores.ROS2_HUMBLE)
    for type_, text in own_messages([monitor]).items():
        store.register(get_types_from_msg(text, type_.replace("/", "/msg/")))
    serialize = store.serialize_ros1 if is_ros1 else store.serialize_cdr
    rate = monitor.config.config.Model.frequency if monitor.config is not None else 1.0
    ages = [of.max_age for of in monitor.inputs if isinstance(of.max_age, float | int)]
    filtered = max((times for _, times, *_ in data.get("filter", ())), default=0)
    longest = filtered + math.ceil(max(ages, default=0) * rate)
    periods = max(_PERIODS, longest + 2)
    left, vectors = list[str](), list[tuple[str, list[tuple[str, str, bytes]]]]()
    for row in data.get("vectors", ()):
        letters, verdicts, shows = row.split(" ", 2)
        try:
            pairs = zip(values.items(), letters, strict=True)
            given = {id_: of[letter] for (id_, of), letter in pairs}
            messages = [
                (topic, type_, bytes(serialize(_message(store, type_, tree), type_)))
                for (topic, type_), tree in _trees(monitor, inputs, given).items()
            ]
        except (FieldPathError, KeyError, TypeError, ValueError):
            left.append(shows)
            continue
        vectors.append((f"{verdicts}  {shows}", messages))
    if not any(messages for _, messages in vectors):
        return {}, [], left
    vectors.sort(key=lambda of: not of[1])  # a bag begins with a message
    told = [f"{k * periods / rate:8.1f} s  {text}" for k, (text, _) in enumerate(vectors)]
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        writer: Any = Ros1Writer(path) if is_ros1 else Ros2Writer(path, version=_ROS2_VERSION)
        with writer:
            channels: dict[str, Any] = {}
            for number, (_, messages) in enumerate(vectors):
                for step, (topic, type_, content) in product(range(periods), messages):
                    if topic not in channels:
                        channels[topic] = writer.add_connection(topic, type_, typestore=store)
                    time = (number * periods + step) / rate
                    writer.write(channels[topic], SECOND + round(time * SECOND), content)
        files = [path] if is_ros1 else [*path.iterdir()]
        return {str(of.relative_to(folder)): of.read_bytes() for of in files}, told, left


def _trees(
    monitor: BoundMonitor, inputs: Mapping[str, InputBinding], given: Mapping[str, list[Any]]
) -> dict[tuple[str, str], Any]:
    """Return topic and type -> the fields of its message; nothing of what is unknown is sent.

    Raises:
        ValueError: an input is no field of one message, or cannot be unknown in this way.
    """
    trees: dict[tuple[str, str], Any] = {}
    silent = set[tuple[str, str]]()
    for id_, values in given.items():
        binding = inputs[id_]
        (source,), path = binding.requires, _path(binding)
        topic = monitor.topic(source.topic), source.type.replace("/", "/msg/")
        if None not in values:
            trees[topic] = _merged(trees.get(topic, {}), _tree(path, values))
        elif isinstance(binding.max_age, float | int):
            silent.add(topic)
        else:
            raise ValueError(id_)
    if silent & trees.keys():
        raise ValueError(silent)
    return trees


def _path(binding: InputBinding) -> FieldPath:
    if binding.expression is None:
        raise ValueError(binding.attribute)
    return parse_field(binding.text or binding.expression.partition(".")[2])


def _tree(path: FieldPath, value: object) -> Any:
    """Return the fields along a path: name -> what is in it; for a list, key and its value."""

    def around(inner: Any, step: object) -> Any:
        match step:
            case Attribute(name):
                return {name: inner}
            case ByKey(key, field):
                return {(field or "id", key): inner}
        raise ValueError(step)

    return reduce(around, reversed(path), value)


def _merged(fields: Any, more: Any) -> Any:
    if isinstance(fields, list):
        raise TypeError("two inputs read the same field")
    both = {name: _merged(fields[name], more[name]) for name in fields.keys() & more.keys()}
    return fields | more | both


def _message(store: Any, type_: str, tree: Mapping[str, Any]) -> Any:
    """Return a message; fields that are not in the tree are as in a new one."""
    fields = store.fielddefs[type_][1]
    return store.types[type_](**{name: _field(store, of, tree.get(name)) for name, of in fields})


def _field(store: Any, field: Any, given: Any) -> Any:
    """Return the value of a field: the first of those given that it can hold.

    Raises:
        ValueError: it can hold none, such as without rounding.
    """
    kind, content = field
    if kind.name == "NAME":
        return _message(store, content, given or {})
    if kind.name == "BASE":
        name, default = content[0], PLAIN_DEFAULTS.get(content[0], 0)
        if given is None:
            return default
        for value in given if isinstance(given, list) else [given]:
            with suppress(OverflowError, TypeError, ValueError):  # of another type
                held = type(default)(np.float32(value) if name == "float32" else value)
                if held == value and isinstance(held, bool) == isinstance(value, bool):
                    return held
        raise ValueError(given)
    inner, size = content
    if isinstance(given, dict):
        given = [{name: key, **of} for (name, key), of in given.items()]
    items = [_field(store, inner, of) for of in given or [None] * (kind.name == "ARRAY") * size]
    is_list = inner[0].name != "BASE" or inner[1][0] == "string"
    return items if is_list else np.array(items, "uint8" if inner[1][0] == "octet" else inner[1][0])
