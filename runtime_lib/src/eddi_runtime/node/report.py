"""Diagnostics of one monitor: pure functions from facts to levels and messages."""

from __future__ import annotations

import math
from typing import Iterator, Mapping, NamedTuple, Sequence

from ..inputs import UNKNOWN_AGE
from ..monitor import Standing

OK, WARN, ERROR, STALE = 0, 1, 2, 3  # levels of ``diagnostic_msgs/DiagnosticStatus``
_ORDER = (ERROR, STALE, WARN, OK)

_STATES = ("ok", "latched", "waiting", "missing", "stale", "untold", "invalid")
FRESH, LATCHED, WAITING, NEVER, LATE, UNTOLD, INVALID = _STATES
"""States of an input, as they are published."""
_LEVEL_OF_STATE = dict(zip(_STATES, (OK, WARN, WARN, ERROR, STALE, WARN, ERROR)))
_NAMED = 5  # inputs that the line of one guarantee names


class SourceFact(NamedTuple):
    """One topic that an input is made of."""

    topic: str  # with its full name
    # of its last message in seconds; ``UNKNOWN_AGE``: it was latched; ``None``: none came
    age: float | None
    reason: str = ""  # what the transport knows of it, else empty

    def explained(self, text: str) -> str:
        return f"{text} ({self.reason})" if self.reason else text


class InputFact(NamedTuple):
    """One input at the last step."""

    id: str  # of the input
    state: str  # one of those above
    reason: str = ""  # beside its sources, such as why it is invalid, else empty
    # of the oldest message it needs in seconds; ``UNKNOWN_AGE`` as there, ``None`` without
    age: float | None = None
    received: int = 0  # messages so far, of the required topic with the fewest
    errors: int = 0  # steps so far in which it was invalid
    blocks: tuple[str, ...] = ()  # ids of the guarantees that are inactive because of it
    # its ``max_age``: seconds, ``none`` (it may be of any age on purpose), or ``None``
    limit: float | str | None = None
    sources: tuple[SourceFact, ...] = ()  # the topics that it is made of

    def blamed(self) -> list[SourceFact]:
        """Return the sources that are late or missing."""
        limit = self.limit if isinstance(self.limit, (int, float)) else math.inf
        if self.state not in (WAITING, NEVER, LATE):
            return []
        return [source for source in self.sources if source.age is None or not source.age <= limit]


class MonitorFact(NamedTuple):
    """What the monitor made of its inputs in the last step."""

    standings: tuple[Standing, ...] = ()  # every guarantee, threshold or event, active or not
    accepted: tuple[str, ...] = ()  # acceptances in use, as ``input: key``
    blocks: Mapping[str, Sequence[str]] = {}  # input id -> what it blocks
    doubts: tuple[str, ...] = ()  # what was missed before and still keeps outputs from being given


class GraphFact(NamedTuple):
    """What the transport knows of the graph around the node."""

    values: tuple[tuple[str, str], ...] = ()  # for the diagnostics, such as the state of a master
    warnings: tuple[str, ...] = ()  # sentences
    # full name of a topic -> the type that its publisher sends, and that expected
    wrong_types: Mapping[str, str] = {}
    reasons: Mapping[str, str] = {}  # full name -> why else nothing usable comes from a topic


class NodeFact(NamedTuple):
    """The node around the monitor."""

    steps: int  # steps so far
    overruns: int  # steps that were left out because an earlier one was late
    recent_overruns: int  # the same since the last periodic report
    longest_step: float  # seconds
    error: str  # an exception of the last step or of the output, else empty
    graph: GraphFact = GraphFact()  # what is around it
    silent_for: float | None = None  # seconds without a step when that is far too long


class Report(NamedTuple):
    """One diagnostic status: level, short text, key and value pairs."""

    level: int
    message: str
    values: tuple[tuple[str, str], ...]
    name: str = ""  # of the status (``<node>: <model id>``)
    node: str = ""  # full name


def level_of(states: Sequence[str], error: str, accepted: Sequence[str] = ()) -> int:
    """Return the level of input states, the error of a step (empty: none) and acceptances."""
    levels = [_LEVEL_OF_STATE[state] for state in states]
    return _worst([*levels, ERROR if error else OK, WARN if accepted else OK])


def _worst(levels: Sequence[int]) -> int:
    return min(levels, key=_ORDER.index, default=OK)


def report(
    identity: Mapping[str, str], inputs: Sequence[InputFact], monitor: MonitorFact, node: NodeFact
) -> Report:
    """Put the facts into one status; ``identity`` are pairs that never change."""
    findings = [*_of_inputs(inputs, node.graph)]
    findings += [(ERROR, node.error)] if node.error else []
    if node.silent_for is not None:
        findings.append((ERROR, f"no step for {node.silent_for:.1f} s"))
    warnings = [f"{node.recent_overruns} steps left out"] if node.recent_overruns else []
    warnings += [*node.graph.warnings, *(f"accepted: {text}" for text in monitor.accepted)]
    findings += [(WARN, text) for text in (*warnings, *monitor.doubts)]
    findings.sort(key=lambda finding: _ORDER.index(finding[0]))
    by_id = {fact.id: fact for fact in inputs}
    values = list(identity.items())
    for standing in monitor.standings:
        key = f"{standing.what}.{standing.id}" if standing.what else standing.id
        values.append((key, standing_text(standing, by_id)))
    for fact in inputs:
        age = "" if fact.age in (None, UNKNOWN_AGE) else f"{fact.age:.3f}"
        pairs = [("age_s", age), ("received", str(fact.received)), ("errors", str(fact.errors))]
        pairs += [("max_age", "no limit")] if fact.limit == "none" else []
        pairs += [("blocks", ", ".join(fact.blocks))] if fact.blocks else []
        reason = "" if fact.state == FRESH else because(fact)
        pairs += [("reason", reason)] if reason else []
        values += [(fact.id, fact.state), *((f"{fact.id}.{key}", text) for key, text in pairs)]
    values += [(f"accepted.{k}", text) for k, text in enumerate(monitor.accepted)]
    values += [("steps", str(node.steps)), ("overruns", str(node.overruns))]
    values += [("longest_step_ms", f"{node.longest_step * 1e3:.3f}"), *node.graph.values]
    for k, (topic, text) in enumerate(node.graph.wrong_types.items()):
        values.append((f"wrong_type.{k}", f"{topic}: {text}"))
    values += [("error", node.error)] if node.error else []
    message = "; ".join(text for _, text in findings) or "all inputs are up to date"
    return Report(_worst([level for level, _ in findings]), message, tuple(values))


def because(fact: InputFact) -> str:
    """Return in one line why an input is not fresh, with the topics that are late or missing."""
    if fact.state == LATCHED:
        return "age unknown"
    blamed, parts = fact.blamed(), []
    absent = ", ".join(source.explained(source.topic) for source in blamed if source.age is None)
    if absent:
        waiting = fact.state == WAITING
        begin = "waiting for first message of" if waiting else "never received since start:"
        parts.append(f"{begin} {absent}")
    for source in blamed:
        if source.age == UNKNOWN_AGE:
            parts.append(f"{source.topic} was latched, its age is not known")
        elif source.age is not None:
            late = f"{source.topic} is late, {source.age:.3g} s old, the limit is {fact.limit:g} s"
            parts.append(source.explained(late))
    return ", ".join(parts) or fact.reason


def standing_text(standing: Standing, inputs: Mapping[str, InputFact]) -> str:
    """Return ``active``, or ``inactive`` with the reason in one line."""
    parts = [standing.reason] if standing.reason else []
    for name, why in standing.lacks[:_NAMED]:
        fact = inputs.get(name)
        late = "" if fact is None or fact.state == FRESH else because(fact)
        parts.append(f"{name}: {late or why}")
    if len(standing.lacks) > _NAMED:
        parts.append(f"and {len(standing.lacks) - _NAMED} more inputs")
    reason = f": {'; '.join(parts)}" if parts else ""
    return f"{'active' if standing.active else 'inactive'}{reason}"


def _of_inputs(inputs: Sequence[InputFact], graph: GraphFact) -> Iterator[tuple[int, str]]:
    wrong = dict(graph.wrong_types)
    for fact in inputs:
        if fact.state != FRESH:
            mistaken = graph.wrong_types.keys() & {source.topic for source in fact.blamed()}
            reason = because(fact)
            why = f"{',' if fact.state == LATCHED else ':'} {reason}" if reason else ""
            blocks = f" (blocks {', '.join(fact.blocks)})" if fact.blocks else ""
            level = ERROR if mistaken else _LEVEL_OF_STATE[fact.state]
            yield level, f"{fact.id} {fact.state}{why}{blocks}"
            for topic in mistaken:
                wrong.pop(topic, None)
    yield from ((ERROR, f"{topic}: {text}") for topic, text in wrong.items())


def fault(
    expected: str,
    age: float | None = None,
    *,
    unreadable: bool = False,
    refused: str = "",  # what of a publication does not fit how this node reads it
    connected: bool = True,
    alive: bool | None = True,
    deadline: float | None = None,
) -> str:
    """Return why nothing comes although a topic is published with the right type."""
    if unreadable:
        return f"what is sent there is not {expected}, although it is called so"
    if not connected and refused:
        return f"{refused} that its publisher has does not fit"
    if not connected:
        return "its publisher is there, and not connected"
    if alive is False:
        return "its publisher gives no sign of life"
    if deadline is not None and age is not None and age > deadline:
        return f"its publisher has missed its deadline of {deadline:g} s"
    return f"its publisher is {'registered' if alive is None else 'there'}, and silent"
