"""What a node publishes: messages of a monitor, or values of them, each on its topic.

A transport may turn ``None`` into ``False``, take ``2`` for ``True``, and raise for a numpy scalar
only once somebody listens (rospy does). So each value is checked and converted here.
"""

from __future__ import annotations

import math
from contextlib import suppress
from types import ModuleType
from typing import Any, Callable, Iterable, Iterator, List, Mapping, NamedTuple, Union

from ..monitor import Tree
from ..plain_values import Step, follow, plain

Trees = Union[Tree, List[Tree], None]
"""What one step of a monitor gives: one message tree, several, or none."""

_WHOLE: Mapping[str, tuple[int, int]] = {
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
}
_FLOATS = {"float32": 3.4028235e38, "float64": math.inf}
_EXACT = {"bool": bool, "string": str}


class MessageClasses(NamedTuple):
    """The message classes of one package, as a transport knows them."""

    module: ModuleType  # holds the classes by name (``eddi_messages.msg``)
    # class -> its fields, each with its type as a ``.msg`` file spells it
    fields: Callable[[object], Iterable[tuple[str, str]]]
    type_name: Callable[[object], str]  # message or class -> ``package/Name``
    stamp: Callable[[], object]  # returns the present time for a header


class MessageError(TypeError):
    """A value does not fit the message; the text names field, expected type and value."""


class Converter:
    """Turns ``("Name", {field: value})`` into messages of one message package."""

    def __init__(self, classes: MessageClasses) -> None:
        self._classes = classes
        self._plans: dict[str, tuple[Any, dict[str, str], bool]] = {}

    def message(self, tree: Tree) -> Any:
        """Build one message, all fields of it, each of its type, or raise MessageError."""
        name, fields = tree
        if name not in self._plans:
            self._plans[name] = self._plan(name)
        cls, kinds, has_header = self._plans[name]
        if fields.keys() != kinds.keys():
            # D7.2 prints `oddViolation`, where the packages that it describes have `odd_violation`
            spelt = {field.replace("_", "").lower(): field for field in kinds}
            letters = {field: field.replace("_", "").lower() for field in fields}
            fields = {spelt.get(letters[field], field): fields[field] for field in fields}
        if fields.keys() != kinds.keys():
            raise MessageError(
                f"{name}: fields {', '.join(sorted(fields))} given,"
                f" the message has {', '.join(sorted(kinds))}; rebuild the message package"
            )
        built = cls()
        for field, kind in kinds.items():
            given = fields[field]
            exact = type(given) is _EXACT.get(kind)  # as nearly all are
            setattr(built, field, given if exact else self._value(name, field, kind, given))
        if has_header:
            built.header.stamp = self._classes.stamp()
        return built

    def messages(self, trees: Trees) -> object:
        """Build what one step gives: a message, a list of them, or None."""
        if isinstance(trees, list):
            return [self.message(tree) for tree in trees]
        return None if trees is None else self.message(trees)

    def beside(self, monitor: object, name: str) -> object:
        """Build the message of that name that a monitor gives beside the result of a step."""
        make = getattr(monitor, f"{name}_message", None)
        if make is None:
            raise MessageError(f"the monitor gives no message {name!r} in addition to its result")
        return self.messages(make())

    def type_name(self, message: object) -> str:
        """Return ``package/Name`` of a message or of its class."""
        return self._classes.type_name(message)

    def _plan(self, name: str) -> tuple[Any, dict[str, str], bool]:
        """Return the class of a message, its fields without a header, and whether it has one."""
        cls = getattr(self._classes.module, name, None)
        if cls is None:
            raise MessageError(f"message {name} is not in {self._classes.module.__name__}")
        kinds = dict(self._classes.fields(cls))
        has_header = kinds.get("header") in ("Header", "std_msgs/Header")
        if has_header:
            del kinds["header"]
        return cls, kinds, has_header

    def _value(self, message: str, field: str, kind: str, value: object) -> object:
        if kind.endswith("]"):
            one, _, length = kind[:-1].partition("[")
            if isinstance(value, (list, tuple)) and (not length or len(value) == int(length)):
                return [self._value(message, field, one, item) for item in value]
        elif kind == "byte":  # in a diagnostic status only, where the transport knows its type
            return value
        elif kind in _EXACT or kind in _WHOLE or kind in _FLOATS:
            found = _scalar(kind, value)
            if found is not None:
                return found
        elif isinstance(value, tuple) and len(value) == 2:
            built = self.message(value)
            if self.type_name(built) == kind:
                return built
        expected = "str" if kind == "string" else kind
        given = f"{type(value).__name__} {value!r}"
        shown = given if len(given) <= 80 else given[:77] + "..."
        raise MessageError(f"{message}.{field}: {expected} expected, got {shown}")


def _scalar(kind: str, value: object) -> bool | int | float | str | None:
    """Return a value as a plain one of a type, None where it is none of that type."""
    item = plain(value)
    if kind in _EXACT:
        return item if type(item) is _EXACT[kind] else None
    if type(item) is int and kind in _WHOLE:
        low, high = _WHOLE[kind]
        return item if low <= item <= high else None
    if isinstance(item, (int, float)) and type(item) is not bool and kind in _FLOATS:
        with suppress(OverflowError):
            number = float(item)
            # NaN passes: only the kind knows whether that is its "no value".
            return number if not math.isfinite(number) or abs(number) <= _FLOATS[kind] else None
    return None


class Output(NamedTuple):
    """One publication: an ``EDDIOutputs`` entry of eddi_config.yml."""

    id: str  # name of the output, for people
    topic: str  # name of the message's topic
    type: Any  # message class of the transport
    status_topic: str | None = None  # topic of the facts behind the result, ``None`` for none
    status_type: Any = None  # its message class (with a header), ``None`` for none
    # place of the value that is published alone, as ``data`` of a message of std_msgs: names of
    # fields, positions and ``("id", id)``; empty: the whole message
    field: tuple[Step, ...] = ()
    # id of the one message, of several in a step, that goes here; ``None``: all
    only: str | None = None
    # which message of the monitor: empty for the result, else the name of one beside it
    # (``evidence``), which the monitor's ``evidence_message()`` gives
    of: str = ""
    qos: Mapping[str, str | float] = {}  # as of an input


Publish = Callable[[object], None]  # sends one message to one topic


class Publications:
    """The topics of one monitor; ``advertise`` returns what sends to one."""

    def __init__(self, outputs: Iterable[Output], advertise: Callable[[Output], Publish]) -> None:
        self._topics: dict[str, list[tuple[Output, Publish]]] = {}
        for channel in channels(outputs):
            self._topics.setdefault(channel.of, []).append((channel, advertise(channel)))
        self.beside = [name for name in self._topics if name]  # messages beside the result

    def publish(self, message: object, of: str = "") -> None:
        """Publish on every topic of the result, or ``of`` a message beside it."""
        for channel, publish in self._topics.get(of, ()):
            for one in each(message):
                if channel.only in (None, getattr(one, "id", None)):
                    publish(picked(one, channel))


def channels(outputs: Iterable[Output]) -> Iterator[Output]:
    """Yield one output for each topic: its own, and that of the facts behind it."""
    for output in outputs:
        yield output
        if output.status_topic is not None:
            yield Output(
                output.id, output.status_topic, output.status_type, of="status", qos=output.qos
            )


def picked(message: object, channel: Output) -> object:
    """Return what goes to a topic: the message, or the one value of it that is asked for."""
    if not channel.field:
        return message
    try:
        value = follow(message, channel.field)
    except (AttributeError, LookupError) as problem:
        raise MessageError(f"{channel.topic}: {problem}") from None
    return channel.type(data=value)


def check_outputs(
    converter: Converter, result: Trees, monitor: object, outputs: Iterable[Output]
) -> None:
    """Raise MessageError where the workspace's messages cannot carry what is published."""
    for channel in channels(outputs):
        of = channel.of
        built = converter.beside(monitor, of) if of else converter.messages(result)
        for one in each(built):
            sent = picked(one, channel)
            if not isinstance(sent, channel.type):
                declared, made = converter.type_name(channel.type), converter.type_name(sent)
                raise MessageError(f"{channel.topic} carries {declared}, the monitor makes {made}")


def each(messages: object) -> list[object]:
    """Return what one step gives as a list."""
    if messages is None:
        return []
    return messages if isinstance(messages, list) else [messages]
