"""Why nothing usable comes from a topic: what a transport knows of its publishers, in words."""

import time
from typing import (
    Collection,
    Dict,
    Iterable,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
)

from .receipts import Input, Receipt
from .report import GraphFact

_QUIET_S = 1.0
"""Without a message for so long, the graph is asked why."""


class Topic(NamedTuple):
    """What a transport knows of a topic without new messages, and of who publishes it.

    Attributes:
        name: full name.
        expected: type that this node reads, as ROS 1 writes it.
        types: type of each publication, written so; empty where nobody publishes it.
        age: of the last message in seconds, ``None`` before the first.
        unreadable: what came last has the name of the type, and another content.
        refused: what of a publication does not fit how this node reads, empty when all does.
        connected: this node listens to one of them.
        alive: one of them still gives a sign of life; ``None`` where that cannot be known.
        deadline: seconds between two messages that a publication promises, if it does.
    """

    name: str
    expected: str
    types: Collection[str]
    age: Optional[float] = None
    unreadable: bool = False
    refused: str = ""
    connected: bool = True
    alive: Optional[bool] = True
    deadline: Optional[float] = None


class Silence:
    """Finds the reason for the silence of each topic.

    Nothing is called absent in the time of the start, in which the graph becomes known.

    Args:
        sources: what is subscribed to.
        grace: seconds from now that the start takes.
    """

    def __init__(self, sources: Sequence[Input], grace: float) -> None:
        self._sources = sources
        self._settled_at = time.monotonic() + grace
        self._were_published: Set[str] = set()
        self._published: Collection[str] = ()
        self._absent: Dict[str, str] = {}

    def quiet(self, receipts: Mapping[str, Receipt]) -> List[Tuple[Input, Optional[float]]]:
        """Return each source without a recent message, and the seconds since its last one."""
        now = time.monotonic()
        ages = {name: now - one.at for name, one in receipts.items()}
        found = [(one, ages.get(one.id)) for one in self._sources]
        return [(one, age) for one, age in found if age is None or age > _QUIET_S]

    def explained(self, topics: Iterable[Topic], published: Collection[str]) -> GraphFact:
        """Return why nothing usable comes from topics, of each for which that is known.

        Args:
            topics: those without a recent message.
            published: full names of all topics that somebody publishes.
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
            return _fault(topic)
        if topic.age is not None or topic.name in self._were_published:
            return "its publisher is gone"
        if time.monotonic() < self._settled_at:
            return ""
        if topic.name not in self._absent:
            self._absent[topic.name] = _absent(topic.name, self._published)
        return self._absent[topic.name]


def _fault(topic: Topic) -> str:
    """Return why nothing comes although the topic is published with the right type."""
    if topic.unreadable:
        return f"what is sent there is not {topic.expected}, although it is called so"
    if not topic.connected and topic.refused:
        return f"{topic.refused} that its publisher has does not fit"
    if not topic.connected:
        return "its publisher is there, and not connected"
    if topic.alive is False:
        return "its publisher gives no sign of life"
    if topic.deadline is not None and topic.age is not None and topic.age > topic.deadline:
        return f"its publisher has missed its deadline of {topic.deadline:g} s"
    return f"its publisher is {'registered' if topic.alive is None else 'there'}, and silent"


def _absent(topic: str, published: Collection[str]) -> str:
    import difflib  # noqa: PLC0415 - only for what should not happen

    near = difflib.get_close_matches(topic, sorted(published), 1)
    return "nobody publishes it" + (f", the nearest name is {near[0]}" if near else "")
