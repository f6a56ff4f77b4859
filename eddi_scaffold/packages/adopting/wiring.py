"""How an old ROS node was connected: topics, types, rate and inputs, read from its text."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import EllipsisType

from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.packages.adopting.old_package import ParsedModule
from eddi_scaffold.yaml_text.nodes import dump_plain

_TYPES = {bool: "bool", int: "int", float: "float", str: "str"}


@dataclass(frozen=True)
class OldInput:
    """An input of the monitor."""

    id: str
    default: JsonValue  # value before the first message
    requires: tuple[str, ...]  # ids of topics

    def as_entry(self) -> dict[str, JsonValue]:
        """Return its entry in a configuration, without a type where nothing tells it."""
        type_ = _TYPES.get(type(self.default))
        entry: dict[str, JsonValue] = {"id": self.id}
        entry |= {"type": type_} if type_ is not None else {}
        entry["requires"] = list(self.requires)
        return entry | ({"default": self.default} if self.default is not None else {})


@dataclass(frozen=True)
class Wiring:
    """The content of a configuration, as far as it could be read, and what could not."""

    options: Mapping[str, JsonValue] = field(default_factory=dict)
    frequency: float | None = None
    topics: Mapping[str, Mapping[str, JsonValue]] = field(default_factory=dict)  # entries by id
    outputs: Mapping[str, str] = field(default_factory=dict)  # id -> topic
    inputs: Sequence[OldInput] = ()
    lost: Sequence[str] = ()

    def as_yaml(self, name: str, kind: str, model: str) -> str:
        """Return the text of an ``eddi_config.yml`` of a model of a kind, in a file beside it."""
        frequency = {"frequency": self.frequency} if self.frequency is not None else {}
        document = {
            "Model": {"id": name, "type": kind, "model": model, **frequency, **self.options},
            "SimulatorOutputs": list(self.topics.values()),
            "EDDIInputs": [input_.as_entry() for input_ in self.inputs],
            "EDDIOutputs": [{"id": id_, "topic": topic} for id_, topic in self.outputs.items()],
        }
        return dump_plain(document)


def read_wiring(
    node: ParsedModule | None, eddi_input: ParsedModule | None, config: ParsedModule | None
) -> Wiring:
    """Read the connections of a node script, and the inputs.

    Without a class of inputs they are what the methods of a network read.
    """
    inputs = list(_inputs(eddi_input) if eddi_input is not None else _inputs_read(config))
    if node is None:
        missing = "there is no RosNode.py, which has topics, their types, the rate and the outputs"
        return Wiring(inputs=[replace(input_, requires=()) for input_ in inputs], lost=[missing])
    classes = dict(_message_classes(node))
    stored = dict(_stored(node))
    lost: list[str] = []
    topics: dict[str, dict[str, JsonValue]] = {}
    outputs: dict[str, str] = {}
    frequency = None
    for call, target in _calls(node):
        words = [_constant(argument) for argument in call.args]
        name = _name_of(call.func)
        if name.endswith("Subscriber") and len(call.args) > 2:
            callback = _name_of(call.args[2]).rpartition(".")[2]
            id_ = stored.get(callback, callback.removesuffix("_callback"))
            type_ = classes.get(_name_of(call.args[1]).rpartition(".")[2], "")
            if isinstance(words[0], str) and type_:
                topics.setdefault(id_, {"id": id_, "type": type_, "topic": words[0]})
            else:
                lost.append(f"{node.path.name}:{call.lineno}: topic or message type of {id_!r}")
        elif name.endswith("Publisher") and words and isinstance(words[0], str):
            outputs.setdefault(target.removesuffix("_pub") or "output", words[0])
        elif name.endswith("Rate") and words and isinstance(words[0], int | float):
            frequency = frequency or words[0]
    if frequency is None:
        lost.append(f"{node.path.name}: the rate of the loop")
    lost += [
        f"{node.path.name}: the topic of {name!r}, which {input_.id} needs"
        for input_ in inputs
        for name in input_.requires
        if name not in topics
    ]
    connected = [
        replace(input_, requires=tuple(name for name in input_.requires if name in topics))
        for input_ in inputs
    ]
    return Wiring({}, frequency, topics, outputs, connected, lost)


def _message_classes(module: ParsedModule) -> Iterator[tuple[str, str]]:
    for node in module.imports:
        if isinstance(node, ast.ImportFrom) and node.module and node.module.endswith(".msg"):
            for alias in node.names:
                name = alias.asname or alias.name
                yield name, f"{node.module.removesuffix('.msg')}/{alias.name}"


def _stored(module: ParsedModule) -> Iterator[tuple[str, str]]:
    """Yield callback -> key under which it keeps the message."""
    for name, method in module.methods.items():
        for node in ast.walk(method.tree) if name.endswith("_callback") else ():
            match node:
                case ast.Assign(targets=[ast.Subscript(slice=ast.Constant(value=str(key))), *_]):
                    yield name, key


def _calls(module: ParsedModule) -> Iterator[tuple[ast.Call, str]]:
    """Yield every call with the attribute that it is assigned to, in the order of the file."""
    for node in _nodes(module):
        match node:
            case ast.Assign(targets=[target, *_], value=ast.Call() as call):
                yield call, _name_of(target).rpartition(".")[2]
            case ast.Expr(value=ast.Call() as call):
                yield call, ""


def _inputs(module: ParsedModule) -> Iterator[OldInput]:
    """Yield the inputs of a class of inputs: with a value at first, or a method of their own."""
    defaults: dict[str, JsonValue] = {}
    required: dict[str, tuple[str, ...]] = {}
    first, processing = module.methods.get("__init__"), module.methods.get("processing")
    for node in first.tree.body if first else ():
        match node:
            case ast.Assign(targets=[ast.Attribute(attr=name), *_], value=value):
                default = _constant(value)
                if not isinstance(default, bytes | EllipsisType):
                    defaults[name] = default
    for call in ast.walk(processing.tree) if processing else ():
        name = _name_of(call.func).rpartition(".")[2] if isinstance(call, ast.Call) else ""
        if isinstance(call, ast.Call) and name.startswith("process_"):
            keys = (_constant(arg.slice) for arg in call.args if isinstance(arg, ast.Subscript))
            id_ = name.removeprefix("process_")
            required[id_] = tuple(key for key in keys if isinstance(key, str))
    methods = [name for name in module.methods if name.startswith("process_")]
    for id_ in dict.fromkeys([*defaults, *(name.removeprefix("process_") for name in methods)]):
        yield OldInput(id_, defaults.get(id_), required.get(id_, ()))


def _inputs_read(config: ParsedModule | None) -> Iterator[OldInput]:
    """Return the inputs that the methods of a network read: ``self.dra_data.x``."""
    names: dict[str, None] = {}
    for node in _nodes(config):
        match node:
            case ast.Attribute(value=ast.Attribute(value=ast.Name(), attr="dra_data"), attr=name):
                names[name] = None
    return (OldInput(name, None, ()) for name in names)


def _nodes(module: ParsedModule | None) -> Iterator[ast.AST]:
    for method in module.methods.values() if module is not None else ():
        yield from ast.walk(method.tree)


def published_ids(monitor: ParsedModule | None) -> set[str]:
    """Return the ids of guarantees that an old monitor's results have (SESAME D7.2 Fig 9)."""
    ids = set()
    for result in _nodes(monitor):
        if isinstance(result, ast.Dict):
            keys = [key and _constant(key) for key in result.keys]
            entry = dict(zip(map(str, keys), map(_constant, result.values), strict=True))
            if "active" in entry and isinstance(id_ := entry.get("id"), str):
                ids.add(id_)
    return ids


def _constant(node: ast.expr) -> JsonValue | bytes | EllipsisType:
    try:
        value: JsonValue | bytes | EllipsisType = ast.literal_eval(node)
    except (ValueError, TypeError, MemoryError, RecursionError):
        return None
    return value


def _name_of(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return f"{_name_of(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""
