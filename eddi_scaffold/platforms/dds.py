"""DDS: a pip-installable package for each monitor, which joins a ROS 2 graph without ROS."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from eddi_scaffold.common.identifiers import taken_by_python
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.config.field_types import Fields, MessageFields, element, is_primitive
from eddi_scaffold.kinds import WHY, JsonValue
from eddi_scaffold.monitors.binding import BoundMonitor, bound_to
from eddi_scaffold.monitors.nodes import MonitorNode, node_of
from eddi_scaffold.platforms import (
    RUNTIME_PACKAGE,
    Meeting,
    MeetingPlace,
    PackageAnswers,
    Platform,
    pip_install,
)
from eddi_scaffold.platforms.ros_packages import (
    GENERATED,
    distribution,
    long_name,
    runtime_packages,
    types_of,
)

_IDS = {
    "int8": 2, "uint8": 3, "char": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8,
    "uint64": 9, "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17,
}  # fmt: skip
_NESTED, _ARRAY, _SEQUENCE = 1, 48, 144
_EMPTY = {"structure_needs_at_least_one_member": "uint8"}
_Description = dict[str, object]


def type_hash(name: str, known: MessageFields) -> str:
    """Return the hash of a message type."""
    parts = sorted({*with_parts(name, known)} - {name})
    document = {
        "type_description": _described(name, known[name]),
        "referenced_type_descriptions": [_described(part, known[part]) for part in parts],
    }
    return f"RIHS01_{hashlib.sha256(json.dumps(document).encode()).hexdigest()}"


def _described(name: str, fields: Fields) -> _Description:
    rows = [{"name": field, "type": _type(of)} for field, of in (fields or _EMPTY).items()]
    return {"type_name": long_name(name), "fields": rows}


def _type(of: str) -> _Description:
    item, is_list, length = of.removesuffix("]").partition("[")
    kind = (_ARRAY if length else _SEQUENCE) if is_list else 0
    return {
        "type_id": _IDS.get(item, _NESTED) + kind,
        "capacity": int(length or 0),
        "string_capacity": 0,
        "nested_type_name": "" if item in _IDS else long_name(item),
    }


def definitions_of(
    node: MonitorNode, known: MessageFields
) -> tuple[dict[str, list[JsonValue]], list[Problem]]:
    """Return the types of a node, each after its parts, and the hashes of those of its topics.

    What is not known is reported (K048), and has no hash.
    """
    problems: list[Problem] = []
    parts: dict[str, Fields] = {}
    hashes: list[JsonValue] = []
    places = {
        entry.type: node.config.place("SimulatorOutputs", index, "type")
        for index, entry in enumerate(node.config.config.SimulatorOutputs)
    }
    types = [topic.type for topic in node.subscribed] + [topic.type for topic in node.publications]
    for type_ in dict.fromkeys([*types, *node.between_robots.values(), WHY]):
        names, place = list(with_parts(type_, known)), places.get(type_, Place())
        parts |= {name: known[name] for name in names if name in known and name not in parts}
        unknown = [name for name in names if name not in known]
        for name in unknown:
            case = "K048.dds_type" if name == type_ else "K048.part"
            problems.append(problem(case, place, type=type_, part=name))
        hashes += [] if unknown else [{"name": type_, "hash": type_hash(type_, known)}]
    definitions: list[JsonValue] = [
        {"name": name, "fields": ", ".join(f"{of} {field}" for field, of in fields.items())}
        for name, fields in parts.items()
    ]
    hashes.sort(key=str)
    return {"definitions": definitions, "hashes": hashes}, problems


def with_parts(type_: str, known: MessageFields, above: tuple[str, ...] = ()) -> Iterator[str]:
    """Yield the types that a type is made of, then itself; a type inside itself is not known."""
    for of in known.get(type_, {}).values():
        name = element(of) or of
        if name in above:
            yield f"{name} in itself"
        elif not is_primitive(name):
            yield from with_parts(name, known, (*above, type_))
    yield type_


_TEMPLATES = ("dds_monitor", "dds_runtime")


def _monitor(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    known = types_of(monitor)
    monitor, errors = bound_to(monitor, known)
    node, problems = node_of(monitor)
    definitions, unknown = definitions_of(node, known)
    answers, files = distribution(monitor, _TEMPLATES[0], "cyclonedds")
    answers |= node.answers(lambda of: f"messages.{of.replace('/', '_')}", has_qos=True)
    answers |= definitions
    return PackageAnswers(monitor.package, answers, files), [*problems, *errors, *unknown]


def _taken_names(_root: Path | None) -> Mapping[str, str]:
    used = {name: f"it would hide {name}" for name in ("numpy", "cyclonedds", "rich_click")}
    return {**taken_by_python(), **used, RUNTIME_PACKAGE: GENERATED}


def _next_steps(place: Path, monitors: Sequence[str]) -> Sequence[str]:
    return [*pip_install(place, monitors), *monitors]


def _steps_of_robot(
    at: MeetingPlace, place: Path, namespace: str, monitors: Sequence[str]
) -> Sequence[str]:
    arguments = [f"-r __ns:={namespace}"] if namespace else []
    arguments += [f"-p partition:={at.partition}"] if at.partition else []
    below = " ".join([" --ros-args", *arguments]) if arguments else ""
    start = (f"ROS_DOMAIN_ID={at.name} {name}{below}" for name in monitors)
    return [*pip_install(place, monitors), *start]


PLATFORM = Platform(
    name="dds",
    templates=_TEMPLATES,
    monitor=_monitor,
    support=partial(runtime_packages, _TEMPLATES[1]),
    taken_names=_taken_names,
    next_steps=_next_steps,
    meeting=Meeting("domain", "0", _steps_of_robot, has_partitions=True),
)
