"""What a node has received of every source, and why nothing usable comes from one."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from typing import Any, Callable, Collection, Iterable, Mapping, NamedTuple, Sequence

from ..inputs import UNKNOWN_AGE
from .report import GraphFact

DEFAULT_BUFFER_BYTES = 65536  # rospy's own value: enough for everything but images and clouds
MAX_QUEUED = 1000  # messages between two steps; older ones are dropped and counted


class Input(NamedTuple):
    """One subscription: a ``SimulatorOutputs`` entry of eddi_config.yml."""

    id: str  # name under which ``EDDIInput.processing`` finds the message
    topic: str  # absolute or relative name; remapping and namespaces apply
    type: Any  # message class of the transport
    # receive buffer. rospy hands out old messages when a message is larger than the buffer, so it
    # must be raised for images and point clouds.
    buffer_bytes: int = DEFAULT_BUFFER_BYTES
    every_message: bool = False  # no message is skipped: those between two steps are queued
    # what of the quality of service is otherwise than usual, where the transport has one
    qos: Mapping[str, str | float] = {}
    wakes: bool = True  # a message starts a step at once where the node steps on change


class Receipt(NamedTuple):
    """The last message of an input and what is known about it."""

    message: object  # the message, as the transport hands it out
    at: float  # monotonic seconds of receipt
    received: int  # messages so far
    # how old it was then, in seconds; ``UNKNOWN_AGE`` when it came on connecting from a latching
    # publisher, and no header says when it was made
    age: float = 0.0

    @property
    def latched(self) -> bool:
        """Whether it can be of any age."""
        return self.age == UNKNOWN_AGE

    def age_at(self, now: float) -> float:
        """Return how old the message is, in seconds."""
        return self.age + now - self.at


class Receipts:
    """What a transport hands over in its own threads; all conversion happens in the loop.

    ``arrived`` is called after every message (``on_change`` wakes the loop here).
    """

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
        """Return the last message of every input that has one, at one instant."""
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
            found = self._dropped.items()
            return "; ".join(f"{count} messages of {name} were dropped" for name, count in found)


_QUIET_S = 1.0  # without a message for so long, the graph is asked why


class Topic(NamedTuple):
    """What a transport knows of a topic without new messages, and of who publishes it."""

    name: str  # full name
    expected: str  # type that this node reads, as ROS 1 writes it
    types: Collection[str]  # type of each publication, written so; empty where nobody publishes it
    age: float | None  # of the last message in seconds, ``None`` before the first
    fault: str  # why nothing comes from a publication of that type


class Silence:
    """Finds the reason for the silence of each topic; none is absent in the time of the start."""

    def __init__(self, sources: Sequence[Input], grace: float) -> None:
        self._sources = sources
        self._settled_at = time.monotonic() + grace
        self._were_published: set[str] = set()
        self._published: Collection[str] = ()
        self._absent: dict[str, str] = {}

    def quiet(self, receipts: Mapping[str, Receipt]) -> list[tuple[Input, float | None]]:
        """Return each source without a recent message, and the seconds since its last one."""
        now = time.monotonic()
        ages = {name: now - receipt.at for name, receipt in receipts.items()}
        quiet = [one for one in self._sources if not ages.get(one.id, math.inf) <= _QUIET_S]
        return [(one, ages.get(one.id)) for one in quiet]

    def explained(self, topics: Iterable[Topic], published: Collection[str]) -> GraphFact:
        """Return why nothing usable comes from topics without a recent message."""
        if self._published != (names := frozenset(published)):
            self._published, self._absent = names, {}  # the nearest names are searched anew
        wrong_types, reasons = {}, {}
        for topic in topics:
            if topic.types and topic.expected not in topic.types:
                sent = min(topic.types)
                wrong_types[topic.name] = f"{topic.expected} expected, the publisher sends {sent}"
            else:
                reasons[topic.name] = self._reason(topic)
            if topic.types:
                self._were_published.add(topic.name)
        return GraphFact(wrong_types=wrong_types, reasons=reasons)

    def _reason(self, topic: Topic) -> str:
        if topic.types:
            return topic.fault
        if topic.age is not None or topic.name in self._were_published:
            return "its publisher is gone"
        if time.monotonic() < self._settled_at:
            return ""
        if topic.name not in self._absent:
            import difflib  # noqa: PLC0415 - only for what should not happen

            near = difflib.get_close_matches(topic.name, sorted(self._published), 1)
            nearest = f", the nearest name is {near[0]}" if near else ""
            self._absent[topic.name] = f"nobody publishes it{nearest}"
        return self._absent[topic.name]
