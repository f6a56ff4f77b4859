"""Diagnostics of one monitor: pure functions from facts to levels and messages."""

from __future__ import annotations

from typing import Iterator, Mapping, NamedTuple, Sequence

from ..inputs import UNKNOWN_AGE
from ..why import FALSE, TRUE, UNKNOWN, Cause, ClaimWhy

OK, WARN, ERROR, STALE = 0, 1, 2, 3  # levels of ``diagnostic_msgs/DiagnosticStatus``
_ORDER = (ERROR, STALE, WARN, OK)

_STATES = ("ok", "latched", "waiting", "missing", "stale", "untold", "invalid")
FRESH, LATCHED, WAITING, NEVER, LATE, UNTOLD, INVALID = _STATES
"""States of an input, as they are published."""
_LEVEL_OF_STATE = dict(zip(_STATES, (OK, WARN, WARN, ERROR, STALE, WARN, ERROR)))
_PREFIXES = {"consert": "guarantee.", "event": "event.", "safeml": "", "state_machine": "state."}


class InputFact(NamedTuple):
    """One input at the last step."""

    id: str  # of the input
    state: str  # one of those above
    reason: str = ""  # why it is not fresh
    # of the oldest message it needs in seconds; ``UNKNOWN_AGE``: it was latched; ``None``: none
    age: float | None = None
    received: int = 0  # messages so far, of the required topic with the fewest
    errors: int = 0  # steps so far in which it was invalid
    # its ``max_age``: seconds, ``none`` (it may be of any age on purpose), or ``None``
    limit: float | str | None = None
    mistaken: bool = False  # something of another type comes
    sources: str = ""  # the topics it is made of, each with the claim that is read there


class MonitorFact(NamedTuple):
    """What the monitor made of its inputs in the last step."""

    kind: str = ""
    why: Mapping[str, ClaimWhy] = {}  # of its claims
    hazards: frozenset[str] = frozenset()  # claims of which the absence holds
    accepted: Sequence[str] = ()  # acceptances in use, as ``input: key``


class Reason(NamedTuple):
    """What a transport knows of a topic from which nothing usable comes."""

    state: str  # of a cause; empty: as it is without that
    text: str = ""  # of another type, or another QoS
    detail: str = ""  # beside the text


class GraphFact(NamedTuple):
    """What the transport knows of the graph around the node."""

    values: tuple[tuple[str, str], ...] = ()  # for the diagnostics, such as the state of a master
    warnings: tuple[str, ...] = ()  # sentences
    reasons: Mapping[str, Reason] = {}  # full name of a topic -> why nothing usable comes from it

    def explained(self, cause: Cause) -> Cause:
        """Return a cause of this node's own topic with what the transport knows."""
        reason = self.reasons.get(cause.topic)
        if reason is None or cause.state not in ("silent", "never", "waiting"):
            return cause
        if reason.state == "gone" and cause.state != "silent":  # it never sent
            return cause.because(cause.state, cause.text, "its publisher is gone")
        text = reason.text if reason.state else cause.text
        return cause.because(reason.state or cause.state, text, reason.detail)


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


def level_of(states: Sequence[str], error: str, monitor: MonitorFact) -> int:
    """Return the level of input states, of the error of a step (empty: none) and of claims."""
    levels = [_LEVEL_OF_STATE[state] for state in states]
    warned = monitor.accepted or [*_of_others(monitor)]
    return _worst([*levels, ERROR if error else OK, WARN if warned else OK])


def _worst(levels: Sequence[int]) -> int:
    return min(levels, key=_ORDER.index, default=OK)


def _of_others(monitor: MonitorFact) -> Iterator[str]:
    """Yield the sentence of each claim that is UNKNOWN through another monitor."""
    for row in monitor.why.values():
        if row.verdict == UNKNOWN and any(len(cause.monitors) > 1 for cause in row.causes):
            yield row.sentence


def report(
    identity: Mapping[str, str], inputs: Sequence[InputFact], monitor: MonitorFact, node: NodeFact
) -> Report:
    """Put the facts into one status; ``identity`` are pairs that never change."""
    findings = [*_of_inputs(inputs)]
    findings += [(ERROR, node.error)] if node.error else []
    if node.silent_for is not None:
        findings.append((ERROR, f"no step for {node.silent_for:.1f} s"))
    warnings = [f"{node.recent_overruns} steps left out"] if node.recent_overruns else []
    warnings += [*node.graph.warnings, *(f"accepted: {text}" for text in monitor.accepted)]
    findings += [(WARN, text) for text in (*warnings, *_of_others(monitor))]
    findings.sort(key=lambda finding: _ORDER.index(finding[0]))
    prefix = _PREFIXES.get(monitor.kind, "threshold.")
    values = list(identity.items())
    values += [
        (f"{prefix}{row.id}", claim_text(row, row.id in monitor.hazards))
        for row in monitor.why.values()
    ]
    for fact in inputs:
        age = "" if fact.age in (None, UNKNOWN_AGE) else f"{fact.age:.3f}"
        pairs = [("age_s", age), ("received", str(fact.received)), ("errors", str(fact.errors))]
        pairs += [("from", fact.sources)] if fact.sources else []
        pairs += [("max_age", "no limit")] if fact.limit == "none" else []
        pairs += [("reason", fact.reason)] if fact.reason else []
        values += [(fact.id, fact.state), *((f"{fact.id}.{key}", text) for key, text in pairs)]
    values += [(f"accepted.{k}", text) for k, text in enumerate(monitor.accepted)]
    values += [("steps", str(node.steps)), ("overruns", str(node.overruns))]
    values += [("longest_step_ms", f"{node.longest_step * 1e3:.3f}"), *node.graph.values]
    values += [("error", node.error)] if node.error else []
    message = "; ".join(text for _, text in findings) or "all inputs are up to date"
    return Report(_worst([level for level, _ in findings]), message, tuple(values))


def claim_text(row: ClaimWhy, hazard: bool = False) -> str:
    """Return how a claim stands, and why: ``active``, or ``inactive: SENTENCE``."""
    if row.verdict == TRUE:
        return "absent" if hazard else "active"
    not_held = ("present" if row.verdict == FALSE else "unknown") if hazard else "inactive"
    return f"{not_held}: {row.sentence}"


def _of_inputs(inputs: Sequence[InputFact]) -> Iterator[tuple[int, str]]:
    for fact in inputs:
        if fact.state != FRESH:
            level = ERROR if fact.mistaken else _LEVEL_OF_STATE[fact.state]
            yield level, f"{fact.id} {fact.state}{f': {fact.reason}' if fact.reason else ''}"


def offer(offered: str, needed: str) -> Reason:
    """Return that a publication has another quality of service than is read."""
    return Reason("offer", f"{offered} is offered, {needed} is needed")


def fault(
    expected: str,
    age: float | None = None,
    *,
    unreadable: bool = False,
    refused: Reason | None = None,  # what of a publication does not fit how this node reads it
    connected: bool = True,
    alive: bool | None = True,
    deadline: float | None = None,
) -> Reason:
    """Return why nothing comes although a topic is published with the right type."""
    if unreadable:
        return Reason("type", f"what is sent there is not {expected}, although it is called so")
    if not connected and refused is not None:
        return refused
    if not connected:
        return Reason("", detail="its publisher is there, and not connected")
    if alive is False:
        return Reason("", detail="its publisher gives no sign of life")
    if deadline is not None and age is not None and age > deadline:
        return Reason("", detail=f"its publisher has missed its deadline of {deadline:g} s")
    return Reason("", detail="its publisher is there")
