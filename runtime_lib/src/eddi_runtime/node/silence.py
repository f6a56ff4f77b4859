"""Why nothing usable comes from a topic: what a transport knows of its publishers, in words."""

from __future__ import annotations

import time
from typing import Collection, Iterable, Mapping, NamedTuple, Sequence

from .receipts import Input, Receipt
from .report import GraphFact

_QUIET_S = 1.0
"""Without a message for so long, the graph is asked why."""


class Topic(NamedTuple):
    """What a transport knows of a topic without new messages, and of who publishes it."""

    name: str  # full name
    expected: str  # type that this node reads, as ROS 1 writes it
    types: Collection[str]  # type of each publication, written so; empty where nobody publishes it
    age: float | None  # of the last message in seconds, ``None`` before the first
    fault: str  # why nothing comes from a publication of that type


class Silence:
    """Finds the reason for the silence of each topic.

    Nothing is called absent in the time of the start, in which the graph becomes known.
    """

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
        found = [(source, ages.get(source.id)) for source in self._sources]
        return [(one, age) for one, age in found if age is None or age > _QUIET_S]

    def explained(self, topics: Iterable[Topic], published: Collection[str]) -> GraphFact:
        """Return why nothing usable comes from topics without a recent message, where known.

        ``published``: full names of all topics that somebody publishes.
        """
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
            self._absent[topic.name] = _absent(topic.name, self._published)
        return self._absent[topic.name]


def _absent(topic: str, published: Collection[str]) -> str:
    import difflib  # noqa: PLC0415 - only for what should not happen

    near = difflib.get_close_matches(topic, sorted(published), 1)
    return "nobody publishes it" + (f", the nearest name is {near[0]}" if near else "")
