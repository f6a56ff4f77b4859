"""Diagnostics of one monitor: pure functions from facts to levels and messages.

Nothing here knows a transport. Words mean one thing: "fresh" and "up to date" refer to when a
message came, "satisfied" and "good" only of evidence that speaks for a guarantee.
"""

from __future__ import annotations

from typing import Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ..inputs import UNKNOWN_AGE
from ..monitor import Standing

OK, WARN, ERROR, STALE = 0, 1, 2, 3
"""Levels of ``diagnostic_msgs/DiagnosticStatus``."""

FRESH, LATCHED, WAITING, NEVER, LATE, INVALID = (
    "ok", "latched", "waiting", "missing", "stale", "invalid",
)  # fmt: skip
"""States of an input, as they are published."""

_ORDER = (ERROR, STALE, WARN, OK)
_LEVEL_OF_STATE = {
    FRESH: OK,
    LATCHED: WARN,
    WAITING: WARN,
    NEVER: ERROR,
    LATE: STALE,
    INVALID: ERROR,
}
_NAMED = 5
"""Inputs that the line of one guarantee names."""


class SourceFact(NamedTuple):
    """One topic that an input is made of.

    Attributes:
        topic: with its full name.
        age: of its last message in seconds; ``UNKNOWN_AGE``: it was latched; ``None``: none came.
        reason: what the transport knows of it, else empty.
    """

    topic: str
    age: Optional[float]
    reason: str = ""


class InputFact(NamedTuple):
    """One input at the last step.

    Attributes:
        id: of the input.
        state: one of those above.
        reason: what is known of it beside its sources, such as why it is invalid, else empty.
        age: of the oldest message it needs in seconds; ``UNKNOWN_AGE`` as there, ``None`` without.
        received: messages so far, of the required topic with the fewest.
        errors: steps so far in which it was invalid.
        blocks: ids of the guarantees that are inactive because of it.
        limit: its ``max_age``: seconds, ``none`` (it may be of any age on purpose), or ``None``.
        sources: the topics that it is made of.
    """

    id: str
    state: str
    reason: str = ""
    age: Optional[float] = None
    received: int = 0
    errors: int = 0
    blocks: Tuple[str, ...] = ()
    limit: Union[float, str, None] = None
    sources: Tuple[SourceFact, ...] = ()


class MonitorFact(NamedTuple):
    """What the monitor made of its inputs in the last step.

    Attributes:
        standings: every guarantee, threshold or event, active or not.
        accepted: acceptances in use, as ``input: key``.
        blocks: input id -> what it blocks.
        doubts: what was missed before and still keeps outputs from being given.
    """

    standings: Tuple[Standing, ...] = ()
    accepted: Tuple[str, ...] = ()
    blocks: Mapping[str, Sequence[str]] = {}
    doubts: Tuple[str, ...] = ()


class GraphFact(NamedTuple):
    """What the transport knows of the graph around the node.

    Attributes:
        values: for the diagnostics, such as the state of a master.
        warnings: sentences.
        wrong_types: full name of a topic -> the type that its publisher sends, and that expected.
        reasons: full name of a topic -> why else nothing usable comes from it.
    """

    values: Tuple[Tuple[str, str], ...] = ()
    warnings: Tuple[str, ...] = ()
    wrong_types: Mapping[str, str] = {}
    reasons: Mapping[str, str] = {}


class NodeFact(NamedTuple):
    """The node around the monitor.

    Attributes:
        steps: steps so far.
        overruns: steps that were left out because an earlier one was late.
        recent_overruns: the same since the last periodic report.
        longest_step: seconds.
        error: an exception of the last step or of the output, else empty.
        graph: what is around it.
        silent_for: seconds without a step when that is far too long, else ``None``.
    """

    steps: int
    overruns: int
    recent_overruns: int
    longest_step: float
    error: str
    graph: GraphFact = GraphFact()
    silent_for: Optional[float] = None


class Report(NamedTuple):
    """One diagnostic status: level, short text, key and value pairs."""

    level: int
    message: str
    values: Tuple[Tuple[str, str], ...]


def worst(levels: Sequence[int]) -> int:
    """Return the worst level in the order ERROR, STALE, WARN, OK."""
    return min(levels, key=_ORDER.index, default=OK)


def level_of(states: Sequence[str], error: str, accepted: Sequence[str] = ()) -> int:
    """Return the level of input states, the error of a step (empty: none) and acceptances."""
    levels = [_LEVEL_OF_STATE[state] for state in states]
    return worst([*levels, ERROR if error else OK, WARN if accepted else OK])


def report(
    identity: Mapping[str, str],
    inputs: Sequence[InputFact],
    monitor: MonitorFact,
    node: NodeFact,
) -> Report:
    """Put the facts into one status.

    Args:
        identity: pairs that never change (digest, versions).
        inputs: every input in the order of the model.
        monitor: what it made of them.
        node: the rest.
    """
    findings = [*_of_inputs(inputs, node.graph), *_of_node(node)]
    findings += [(WARN, f"accepted: {text}") for text in monitor.accepted]
    findings += [(WARN, text) for text in monitor.doubts]
    findings.sort(key=lambda finding: _ORDER.index(finding[0]))
    by_id = {fact.id: fact for fact in inputs}
    values = list(identity.items())
    values += [_standing_value(one, by_id) for one in monitor.standings]
    for fact in inputs:
        values += _input_values(fact)
    values += [(f"accepted.{k}", text) for k, text in enumerate(monitor.accepted)]
    values += _node_values(node)
    return Report(
        worst([level for level, _ in findings]),
        "; ".join(text for _, text in findings) or "all inputs are up to date",
        tuple(values),
    )


def because(fact: InputFact) -> str:
    """Return in one line why an input is not fresh, with the topics that are late or missing."""
    if fact.state == LATCHED:
        return "age unknown"
    blamed = _blamed(fact)
    parts = []
    absent = ", ".join(_explained(one.topic, one) for one in blamed if one.age is None)
    if absent and fact.state == WAITING:
        parts.append(f"waiting for first message of {absent}")
    elif absent:
        parts.append(f"never received since start: {absent}")
    parts += [_late(one, fact.limit) for one in blamed if one.age is not None]
    return ", ".join(parts) or fact.reason


def _blamed(fact: InputFact) -> List[SourceFact]:
    """Return the sources of an input that are late or missing."""
    if fact.state not in (WAITING, NEVER, LATE):
        return []
    return [one for one in fact.sources if one.age is None or _is_late(one, fact.limit)]


def _is_late(source: SourceFact, limit: Union[float, str, None]) -> bool:
    if source.age is None or limit is None or isinstance(limit, str):
        return False
    return not source.age <= limit


def _late(source: SourceFact, limit: Union[float, str, None]) -> str:
    if source.age == UNKNOWN_AGE:
        return f"{source.topic} was latched, its age is not known"
    text = f"{source.topic} is late, {source.age:.3g} s old, the limit is {limit:g} s"
    return _explained(text, source)


def _explained(text: str, source: SourceFact) -> str:
    return f"{text} ({source.reason})" if source.reason else text


def standing_text(one: Standing, inputs: Mapping[str, InputFact]) -> str:
    """Return ``active``, or ``inactive`` with the reason in one line.

    Args:
        one: a guarantee, threshold or event.
        inputs: input id -> what is known of it.
    """
    parts = [one.reason] if one.reason else []
    for name, why in one.lacks[:_NAMED]:
        fact = inputs.get(name)
        late = "" if fact is None or fact.state == FRESH else because(fact)
        parts.append(f"{name}: {late or why}")
    if len(one.lacks) > _NAMED:
        parts.append(f"and {len(one.lacks) - _NAMED} more inputs")
    return ": ".join(
        ["active" if one.active else "inactive", *(["; ".join(parts)] if parts else ())]
    )


def _standing_value(one: Standing, inputs: Mapping[str, InputFact]) -> Tuple[str, str]:
    key = f"{one.what}.{one.id}" if one.what else one.id
    return key, standing_text(one, inputs)


def _of_inputs(inputs: Sequence[InputFact], graph: GraphFact) -> Iterator[Tuple[int, str]]:
    wrong = dict(graph.wrong_types)
    for fact in inputs:
        if fact.state != FRESH:
            mistaken = [one.topic for one in _blamed(fact) if one.topic in graph.wrong_types]
            yield ERROR if mistaken else _LEVEL_OF_STATE[fact.state], _sentence(fact)
            for topic in mistaken:
                wrong.pop(topic, None)
    yield from ((ERROR, text) for text in _sentences(wrong))


def _of_node(node: NodeFact) -> Iterator[Tuple[int, str]]:
    if node.error:
        yield ERROR, node.error
    if node.silent_for is not None:
        yield ERROR, f"no step for {node.silent_for:.1f} s"
    if node.recent_overruns:
        yield WARN, f"{node.recent_overruns} steps left out"
    yield from ((WARN, text) for text in node.graph.warnings)


def _sentences(wrong_types: Mapping[str, str]) -> List[str]:
    return [f"{topic}: {text}" for topic, text in wrong_types.items()]


def _sentence(fact: InputFact) -> str:
    reason = because(fact)
    if fact.state == LATCHED:
        text = f"{fact.id} latched, {reason}"
    else:
        text = f"{fact.id} {fact.state}" + (f": {reason}" if reason else "")
    return text + (f" (blocks {', '.join(fact.blocks)})" if fact.blocks else "")


def _input_values(fact: InputFact) -> Iterator[Tuple[str, str]]:
    yield fact.id, fact.state
    yield f"{fact.id}.age_s", "" if fact.age in (None, UNKNOWN_AGE) else f"{fact.age:.3f}"
    yield f"{fact.id}.received", str(fact.received)
    yield f"{fact.id}.errors", str(fact.errors)
    if fact.limit == "none":
        yield f"{fact.id}.max_age", "no limit"
    if fact.blocks:
        yield f"{fact.id}.blocks", ", ".join(fact.blocks)
    if fact.state != FRESH and (reason := because(fact)):
        yield f"{fact.id}.reason", reason


def _node_values(node: NodeFact) -> List[Tuple[str, str]]:
    values = [
        ("steps", str(node.steps)),
        ("overruns", str(node.overruns)),
        ("longest_step_ms", f"{node.longest_step * 1e3:.3f}"),
        *node.graph.values,
    ]
    wrong = _sentences(node.graph.wrong_types)
    values += [(f"wrong_type.{index}", text) for index, text in enumerate(wrong)]
    return values + ([("error", node.error)] if node.error else [])
