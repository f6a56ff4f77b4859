"""How an old ROS node was connected: topics, types, rate and inputs, read from its text."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import EllipsisType

from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.packages.adopting.old_package import ParsedModule
from eddi_scaffold.packages.adopting.proposals import attribute_of
from eddi_scaffold.yaml_text.nodes import dump_plain

_TYPES = {bool: "bool", int: "int", float: "float", str: "str"}


@dataclass(frozen=True)
class Subscription:
    """A topic that the node listens to.

    Attributes:
        type: ``package/Type``; empty when the import of its class was not found.
    """

    id: str
    type: str
    topic: str


@dataclass(frozen=True)
class OldInput:
    """An input of the monitor.

    Attributes:
        default: value before the first message.
        requires: ids of topics.
        type: as its use tells, where there is no default.
    """

    id: str
    default: JsonValue
    requires: tuple[str, ...]
    type: str | None = None

    @property
    def known_type(self) -> str | None:
        """Its type in a configuration, ``None`` where nothing tells."""
        return _TYPES.get(type(self.default), self.type)


@dataclass(frozen=True)
class Wiring:
    """The content of a configuration, as far as it could be read."""

    options: Mapping[str, JsonValue] = field(default_factory=dict)
    frequency: float | None = None
    topics: tuple[Subscription, ...] = ()
    outputs: tuple[tuple[str, str], ...] = ()
    inputs: tuple[OldInput, ...] = ()
    lost: tuple[str, ...] = field(default=())

    def as_yaml(self, name: str, kind: str, model: str) -> str:
        """Return the text of an ``eddi_config.yml``.

        Args:
            name: id of the model.
            kind: spelling of its type in configurations.
            model: file of the model, relative to the configuration.
        """
        section: dict[str, JsonValue] = {"id": name, "type": kind}
        if self.frequency is not None:
            section["frequency"] = self.frequency
        section |= self.options
        section["parameters"] = [{"model": model}]
        document = {
            "Model": section,
            "SimulatorOutputs": [
                {"id": topic.id, "type": topic.type.replace("/", "."), "topic": topic.topic}
                for topic in self.topics
            ],
            "EDDIInputs": [_input(input_) for input_ in self.inputs],
            "EDDIOutputs": [{"id": name, "topic": topic} for name, topic in self.outputs],
        }
        return dump_plain(document)


def _input(one: OldInput) -> dict[str, JsonValue]:
    found: dict[str, JsonValue] = {"id": one.id}
    if one.known_type is not None:
        found["type"] = one.known_type
    found["requires"] = list(one.requires)
    if one.default is not None:
        found["default"] = one.default
    return found


def read_wiring(
    node: ParsedModule | None, eddi_input: ParsedModule | None, config: ParsedModule | None
) -> Wiring:
    """Read the connections of a node script, and the inputs.

    Without a class of inputs they are what the methods of a network read.
    """
    if eddi_input is not None:
        inputs = tuple(_inputs(eddi_input))
    else:
        inputs = tuple(inputs_read(config)) if config is not None else ()
    if node is None:
        missing = "there is no RosNode.py, which has topics, their types, the rate and the outputs"
        return Wiring(
            inputs=tuple(replace(input_, requires=()) for input_ in inputs), lost=(missing,)
        )
    classes = dict(_message_classes(node))
    stored = dict(_stored(node))
    lost: list[str] = []
    topics: dict[str, Subscription] = {}
    outputs: dict[str, str] = {}
    for call, target in _calls(node):
        words = [_constant(argument) for argument in call.args]
        name = _name_of(call.func)
        if name.endswith("Subscriber") and len(call.args) > 2:
            callback = _name_of(call.args[2]).rpartition(".")[2]
            id_ = stored.get(callback, callback.removesuffix("_callback"))
            of = classes.get(_name_of(call.args[1]).rpartition(".")[2], "")
            if isinstance(words[0], str) and of:
                topics.setdefault(id_, Subscription(id_, of, words[0]))
            else:
                lost.append(f"{node.path.name}:{call.lineno}: topic or message type of {id_!r}")
        elif name.endswith("Publisher") and words and isinstance(words[0], str):
            outputs.setdefault(target.removesuffix("_pub") or "output", words[0])
    frequency = next(_rates(node), None)
    if frequency is None:
        lost.append(f"{node.path.name}: the rate of the loop")
    for input_ in inputs:
        lost += [
            f"{node.path.name}: the topic of {name!r}, which {input_.id} needs"
            for name in input_.requires
            if name not in topics
        ]
    kept = tuple(
        replace(input_, requires=tuple(name for name in input_.requires if name in topics))
        for input_ in inputs
    )
    return Wiring(
        frequency=frequency,
        topics=tuple(topics.values()),
        outputs=tuple(outputs.items()),
        inputs=kept,
        lost=tuple(lost),
    )


def _message_classes(module: ParsedModule) -> Iterator[tuple[str, str]]:
    for node in module.imports:
        if isinstance(node, ast.ImportFrom) and node.module and node.module.endswith(".msg"):
            package = node.module.removesuffix(".msg")
            for alias in node.names:
                yield alias.asname or alias.name, f"{package}/{alias.name}"


def _stored(module: ParsedModule) -> Iterator[tuple[str, str]]:
    """Yield callback -> key under which it keeps the message."""
    for name, method in module.methods.items():
        for node in ast.walk(method.tree):
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript):
                key = _constant(node.targets[0].slice)
                if isinstance(key, str) and name.endswith("_callback"):
                    yield name, key


def _calls(module: ParsedModule) -> Iterator[tuple[ast.Call, str]]:
    """Yield every call with the attribute that it is assigned to, in the order of the file."""
    for method in module.methods.values():
        for node in ast.walk(method.tree):
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
                yield node.value, _name_of(node.targets[0]).rpartition(".")[2]
            elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
                yield node.value, ""


def _rates(module: ParsedModule) -> Iterator[float]:
    for call, _ in _calls(module):
        if _name_of(call.func).endswith("Rate") and call.args:
            value = _constant(call.args[0])
            if isinstance(value, int | float) and not isinstance(value, bool):
                yield value


def _inputs(module: ParsedModule) -> Iterator[OldInput]:
    defaults = dict(_defaults(module))
    required = dict(_required(module))
    names = [
        name.removeprefix("process_") for name in module.methods if name.startswith("process_")
    ]
    for name in dict.fromkeys([*defaults, *names]):
        yield OldInput(name, defaults.get(name), required.get(name, ()))


def _defaults(module: ParsedModule) -> Iterator[tuple[str, JsonValue]]:
    method = module.methods.get("__init__")
    for node in method.tree.body if method else ():
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Attribute):
            value = _constant(node.value)
            if not isinstance(value, bytes) and value is not Ellipsis:
                yield node.targets[0].attr, value


def _required(module: ParsedModule) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield input -> ids of the messages that ``processing`` passes to its method."""
    method = module.methods.get("processing")
    for node in ast.walk(method.tree) if method else ():
        if isinstance(node, ast.Call):
            name = _name_of(node.func).rpartition(".")[2]
            keys = [
                _constant(argument.slice)
                for argument in node.args
                if isinstance(argument, ast.Subscript)
            ]
            if name.startswith("process_"):
                yield name.removeprefix("process_"), tuple(k for k in keys if isinstance(k, str))


def inputs_read(config: ParsedModule) -> Iterator[OldInput]:
    """Yield the inputs that the methods of a network read, in the order of the file."""
    types: dict[str, set[str]] = {}
    for method in config.methods.values():
        names: dict[str, str] = {}
        for node in ast.walk(method.tree):
            name = attribute_of(node, {})
            if name is not None:
                types.setdefault(name, set())
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                held = attribute_of(node.value, names)
                names |= {node.targets[0].id: held} if held is not None else {}
        for operand, of in _typed(method.tree):
            name = attribute_of(operand, names)
            if name is not None:
                types[name].add(of)
    for name, found in types.items():
        yield OldInput(name, None, (), found.pop() if len(found) == 1 else None)


def _typed(tree: ast.AST) -> Iterator[tuple[ast.expr, str]]:
    """Yield expressions with the type that their use tells."""
    for node in ast.walk(tree):
        match node:
            case ast.If(test=test) | ast.IfExp(test=test):
                yield test, "bool"
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                yield operand, "bool"
            case ast.BoolOp(values=values):
                yield from ((value, "bool") for value in values)
            case ast.BinOp(left=left, right=right):
                yield from ((left, "float"), (right, "float"))
            case ast.Compare(left=left, comparators=others):
                operands = (left, *others)
                is_text = any(isinstance(_constant(one), str) for one in operands)
                yield from ((one, "str" if is_text else "float") for one in operands)


def compared_texts(eddi_input: ParsedModule | None) -> frozenset[str]:
    """Return the texts with which the methods of a class of inputs compare something."""
    methods = eddi_input.methods.values() if eddi_input is not None else ()
    tests = (
        node
        for method in methods
        for node in ast.walk(method.tree)
        if isinstance(node, ast.Compare)
    )
    values = (_constant(one) for test in tests for one in (test.left, *test.comparators))
    return frozenset(value for value in values if isinstance(value, str))


def published_ids(monitor: ParsedModule | None) -> frozenset[str]:
    """Return the ids of guarantees that an old monitor's results have (SESAME D7.2 Fig 9)."""
    methods = monitor.methods.values() if monitor is not None else ()
    results = (
        node for method in methods for node in ast.walk(method.tree) if isinstance(node, ast.Dict)
    )
    found = set()
    for result in results:
        entry = {
            _constant(key): _constant(value)
            for key, value in zip(result.keys, result.values, strict=True)
            if key is not None and isinstance(_constant(key), str)
        }
        if "active" in entry and isinstance(entry.get("id"), str):
            found.add(str(entry["id"]))
    return frozenset(found)


def _constant(node: ast.expr) -> JsonValue | bytes | EllipsisType:
    try:
        found: JsonValue | bytes | EllipsisType = ast.literal_eval(node)
    except (ValueError, TypeError, MemoryError, RecursionError):
        return None
    return found


def _name_of(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return f"{_name_of(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""
