"""What a node receives of every source, why one is silent, and what it publishes on each topic.

A transport may turn ``None`` into ``False``, take ``2`` for ``True``, and raise for a numpy scalar
only once somebody listens (rospy does). So each value that is published is checked here.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Collection, Iterator
from contextlib import suppress
from types import ModuleType
from typing import Any, Callable, Iterable, Mapping, NamedTuple, Sequence, Tuple

from ..monitor import Tree, Trees
from ..plain_values import Step, follow, plain
from .report import GraphFact, Reason

DEFAULT_BUFFER_BYTES = 65536  # rospy's own value: enough for everything but images and clouds
MAX_QUEUED = 1000  # messages between two steps; older ones are dropped and counted


class Input(NamedTuple):
    """One subscription: a ``SimulatorOutputs`` entry of eddi_config.yml."""

    id: str  # name under which ``EDDIInput.processing`` finds the message
    topic: str  # absolute or relative name; remapping and namespaces apply
    type: Any  # message class of the transport
    # rospy hands out old messages when a message is larger, such as an image
    buffer_bytes: int = DEFAULT_BUFFER_BYTES
    every_message: bool = False  # no message is skipped: those between two steps are queued
    # what of the quality of service is otherwise than usual, where the transport has one
    qos: Mapping[str, str | float] = {}
    wakes: bool = True  # a message starts a step at once where the node steps on change

    def waiting(self, usual: int) -> int:
        """Return how many messages may wait for a step: all where none is skipped."""
        return MAX_QUEUED if self.every_message else usual


def reading_qos(requested: Mapping[str, Any], depth: int) -> dict[str, Any]:
    """Return how evidence is read: as sensor data, so that every publisher fits."""
    # What is kept for who comes later is sent again only to who reads reliably (Fast DDS).
    kept = requested.get("durability") == "transient_local"
    reliability = "reliable" if kept else "best_effort"
    return {"reliability": reliability, "durability": "volatile", "depth": depth, **requested}


def writing_qos(requested: Mapping[str, Any], depth: int) -> dict[str, Any]:
    """Return how results are written: none is lost, and who comes late gets the last one."""
    usual = {"reliability": "reliable", "durability": "transient_local", "depth": depth}
    return {**usual, **requested}


def why_topic(topic: str) -> str:
    """Return where a monitor tells why, of the topic of its result or of what is below that."""
    above, _, last = topic.rpartition("/")
    return f"{above if last in ('status', 'evidence') else topic}/why"


class Receipt(NamedTuple):
    """The last message of an input and what is known about it."""

    message: object  # the message, as the transport hands it out
    at: float  # monotonic seconds of receipt
    received: int  # messages so far
    # how old it was then, in seconds; ``UNKNOWN_AGE`` when it was latched, without a header
    age: float = 0.0

    def age_at(self, now: float) -> float:
        """Return how old the message is, in seconds."""
        return self.age + now - self.at


class Receipts:
    """What a transport hands over in its own threads; ``arrived`` is called for each message."""

    def __init__(self, sources: Collection[Input], arrived: Callable[[], None]) -> None:
        self._lock = threading.Lock()
        self._arrived = arrived
        self._silent = {source.id for source in sources if not source.wakes}
        self._latest: dict[str, Receipt] = {}
        self._queues: dict[str, deque[object]] = {
            source.id: deque(maxlen=MAX_QUEUED) for source in sources if source.every_message
        }
        self._dropped: dict[str, int] = {}

    def receive(self, source: str, message: object, age: float = 0.0) -> None:
        """Store one message of an input, see ``Receipt``."""
        now = time.monotonic()
        age = 0.0 if source in self._silent else age  # no evidence: it counts from its receipt
        with self._lock:
            before = self._latest.get(source)
            number = 1 if before is None else before.received + 1
            self._latest[source] = Receipt(message, now, number, age)
            queue = self._queues.get(source)
            if queue is not None:
                if len(queue) == MAX_QUEUED:
                    self._dropped[source] = self._dropped.get(source, 0) + 1
                queue.append(message)
        if source not in self._silent:
            self._arrived()

    def latest(self) -> dict[str, Receipt]:
        with self._lock:
            return dict(self._latest)

    def taken(self) -> tuple[dict[str, Receipt], dict[str, list[object]]]:
        """Return the last messages, and of inputs that take each those since the last call."""
        with self._lock:
            new = {name: list(queue) for name, queue in self._queues.items()}
            for queue in self._queues.values():
                queue.clear()
            return dict(self._latest), new

    def dropped(self) -> str:
        """Return how many messages were dropped because too many came in one period, in words."""
        with self._lock:
            counts = self._dropped.items()
            return "; ".join(f"{count} messages of {name} were dropped" for name, count in counts)


class Topic(NamedTuple):
    """What a transport knows of a topic without new messages, and of who publishes it."""

    name: str  # full name
    expected: str  # type that this node reads, as ROS 1 writes it
    types: Collection[str]  # type of each publication, written so; empty where nobody publishes it
    age: float | None  # of the last message in seconds, ``None`` before the first
    fault: Reason  # why nothing comes from a publication of that type


def other_type(sent: str, expected: str) -> Reason:
    """Return that a publication has another type than is read."""
    return Reason("type", f"{sent} comes, {expected} is needed")


class Silence:
    """Finds the reason for the silence of each topic; none is absent in the time of the start."""

    def __init__(self, sources: Sequence[Input], grace: float) -> None:
        self.suspected: Collection[str] = ()  # ids of sources from which nothing usable comes
        self._sources = sources
        self._settled_at = time.monotonic() + grace
        self._were_published: set[str] = set()
        self._published: Collection[str] = ()
        self._absent: dict[str, Reason] = {}

    def quiet(self, receipts: Mapping[str, Receipt]) -> list[tuple[Input, float | None]]:
        """Return each suspected source, and the seconds since its last message."""
        now = time.monotonic()
        ages = {name: now - receipt.at for name, receipt in receipts.items()}
        suspected = [source for source in self._sources if source.id in self.suspected]
        return [(source, ages.get(source.id)) for source in suspected]

    def explained(self, topics: Iterable[Topic], published: Collection[str]) -> GraphFact:
        """Return why nothing usable comes from topics without a recent message."""
        if self._published != (names := frozenset(published)):
            self._published, self._absent = names, {}  # the nearest names are searched anew
        reasons = {}
        for name, expected, types, age, fault in topics:
            if types:
                fits = expected in types
                reasons[name] = fault if fits else other_type(min(types), expected)
                self._were_published.add(name)
            elif age is not None or name in self._were_published:
                reasons[name] = Reason("gone")
            elif time.monotonic() >= self._settled_at:
                if name not in self._absent:
                    import difflib  # noqa: PLC0415 - only for what should not happen

                    similar = difflib.get_close_matches(name, sorted(self._published), 1)
                    nearest = f", the nearest name is {similar[0]}" if similar else ""
                    self._absent[name] = Reason("", detail=f"nobody publishes it{nearest}")
                reasons[name] = self._absent[name]
        return GraphFact(reasons=reasons)


_WHOLE: Mapping[str, tuple[int, int]] = {
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
}
_FLOATS = {"float32": 3.4028235e38, "float64": math.inf}
_EXACT = {"bool": bool, "string": str}


Fields = Callable[[Any], Iterable[Tuple[str, str]]]
"""Class of a message -> its fields, each with its type as a ``.msg`` file spells it."""
TypeName = Callable[[Any], str]  # message or class -> ``package/Name``


class MessageError(TypeError):
    """A value does not fit the message; the text names field, expected type and value."""


class Converter:
    """Turns ``("Name", {field: value})`` into messages of a module with their classes."""

    def __init__(
        self, module: ModuleType, fields: Fields, type_name: TypeName, stamp: Callable[[], object]
    ) -> None:
        self._module, self._fields, self.type_name, self._stamp = module, fields, type_name, stamp
        self._plans: dict[str, tuple[Any, dict[str, str], bool]] = {}

    def class_of(self, name: str) -> Any:
        """Return the class of a message, None where the package has none of that name."""
        return getattr(self._module, name, None)

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
            value = fields[field]
            exact = type(value) is _EXACT.get(kind)  # as nearly all are
            setattr(built, field, value if exact else self._value(name, field, kind, value))
        if has_header:
            built.header.stamp = self._stamp()
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

    def _plan(self, name: str) -> tuple[Any, dict[str, str], bool]:
        """Return the class of a message, its fields without a header, and whether it has one."""
        cls = self.class_of(name)
        if cls is None:
            raise MessageError(f"message {name} is not in {self._module.__name__}")
        kinds = dict(self._fields(cls))
        has_header = kinds.get("header") in ("Header", "std_msgs/Header")
        if has_header:
            del kinds["header"]
        return cls, kinds, has_header

    def _value(self, message: str, field: str, kind: str, value: object) -> object:
        if kind.endswith("]"):
            item_kind, _, length = kind[:-1].partition("[")
            if isinstance(value, (list, tuple)) and (not length or len(value) == int(length)):
                return [self._value(message, field, item_kind, item) for item in value]
        elif kind == "byte":  # in a diagnostic status only, where the transport knows its type
            return value
        elif kind in _EXACT or kind in _WHOLE or kind in _FLOATS:
            scalar = _scalar(kind, value)
            if scalar is not None:
                return scalar
        elif isinstance(value, tuple) and len(value) == 2:
            built = self.message(value)
            if self.type_name(built) == kind:
                return built
        expected = "str" if kind == "string" else kind
        text = f"{type(value).__name__} {value!r}"
        shown = text if len(text) <= 80 else text[:77] + "..."
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
    # path to the value that is published alone, as ``data`` of std_msgs; empty: the message
    field: tuple[Step, ...] = ()
    # id of the one message, of several in a step, that goes here; ``None``: all
    only: str | None = None
    # empty for the result; ``evidence`` is what ``evidence_message()`` of the monitor gives
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
            for part in each(message):
                if channel.only in (None, getattr(part, "id", None)):
                    publish(picked(part, channel))


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
        for part in each(built):
            sent = picked(part, channel)
            if not isinstance(sent, channel.type):
                types = map(converter.type_name, (channel.type, sent))
                text = "{} carries {}, the monitor makes {}"
                raise MessageError(text.format(channel.topic, *types))


def each(messages: object) -> list[object]:
    """Return what one step gives as a list."""
    if messages is None:
        return []
    return messages if isinstance(messages, list) else [messages]
