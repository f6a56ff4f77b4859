"""What the diagnostics say about one monitor: pure functions from facts to texts."""

from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

OK, WARN, ERROR, STALE = 0, 1, 2, 3
"""Levels of ``diagnostic_msgs/DiagnosticStatus``."""

_ORDER = (ERROR, STALE, WARN, OK)
_LEVEL_OF_STATE = {"ok": OK, "missing": WARN, "latched": WARN, "stale": STALE, "invalid": ERROR}


class InputFact(NamedTuple):
    """One input at the last step.

    Attributes:
        id: of the input.
        state: ``ok``, ``missing``, ``latched``, ``stale`` or ``invalid``.
        reason: why it is invalid, else empty.
        age: seconds since the oldest message it needs, ``None`` without one.
        received: messages so far, of the required topic with the fewest.
        errors: steps so far in which it was invalid.
        blocks: ids of the guarantees that are inactive because of it.
        no_limit: it may be of any age on purpose (``max_age: none``).
    """

    id: str
    state: str
    reason: str = ""
    age: Optional[float] = None
    received: int = 0
    errors: int = 0
    blocks: Tuple[str, ...] = ()
    no_limit: bool = False


class NodeFact(NamedTuple):
    """The node around the monitor.

    Attributes:
        steps: steps so far.
        overruns: steps that were left out because an earlier one was late.
        recent_overruns: the same since the last periodic report.
        longest_step: seconds.
        error: an exception of the last step or of the output, else empty.
        master: state of the watchdog.
        wrong_types: topics whose publisher sends another type, as sentences.
        silent_for: seconds without a step when that is far too long, else ``None``.
    """

    steps: int
    overruns: int
    recent_overruns: int
    longest_step: float
    error: str
    master: str
    wrong_types: Tuple[str, ...]
    silent_for: Optional[float] = None


class Report(NamedTuple):
    """One diagnostic status: level, short text, key and value pairs."""

    level: int
    message: str
    values: Tuple[Tuple[str, str], ...]


def worst(levels: Sequence[int]) -> int:
    """Return the worst level in the order ERROR, STALE, WARN, OK."""
    return min(levels, key=_ORDER.index, default=OK)


def level_of(states: Sequence[str], error: str) -> int:
    """Return the level of input states and the error of a step (empty: none)."""
    return worst([_LEVEL_OF_STATE[state] for state in states] + [ERROR if error else OK])


def report(identity: Mapping[str, str], inputs: Sequence[InputFact], node: NodeFact) -> Report:
    """Put the facts into one status.

    Args:
        identity: pairs that never change (digest, versions).
        inputs: every input in the order of the model.
        node: the rest.
    """
    findings: List[Tuple[int, str]] = [
        (_LEVEL_OF_STATE[fact.state], _sentence(fact)) for fact in inputs if fact.state != "ok"
    ]
    findings.extend((ERROR, text) for text in node.wrong_types)
    if node.error:
        findings.append((ERROR, node.error))
    if node.silent_for is not None:
        findings.append((ERROR, f"no step for {node.silent_for:.1f} s"))
    if node.recent_overruns:
        findings.append((WARN, f"{node.recent_overruns} steps left out"))
    if node.master == "lost":
        findings.append((WARN, "ROS master lost"))
    findings.sort(key=lambda finding: _ORDER.index(finding[0]))
    values: Dict[str, str] = dict(identity)
    for fact in inputs:
        values.update(_input_values(fact))
    values["steps"] = str(node.steps)
    values["overruns"] = str(node.overruns)
    values["longest_step_ms"] = f"{node.longest_step * 1e3:.3f}"
    values["master"] = node.master
    for index, text in enumerate(node.wrong_types):
        values[f"wrong_type.{index}"] = text
    if node.error:
        values["error"] = node.error
    return Report(
        worst([level for level, _ in findings]),
        "; ".join(text for _, text in findings) or "all inputs are good",
        tuple(values.items()),
    )


def _sentence(fact: InputFact) -> str:
    if fact.state == "latched":
        text = f"{fact.id} latched, age unknown"
    else:
        text = f"{fact.id} {fact.state}"
    if fact.reason:
        text += f": {fact.reason}"
    if fact.blocks:
        text += f" (blocks {', '.join(fact.blocks)})"
    return text


def _input_values(fact: InputFact) -> Dict[str, str]:
    values = {
        fact.id: fact.state,
        f"{fact.id}.age_s": "" if fact.age is None else f"{fact.age:.3f}",
        f"{fact.id}.received": str(fact.received),
        f"{fact.id}.errors": str(fact.errors),
    }
    if fact.no_limit:
        values[f"{fact.id}.max_age"] = "no limit"
    if fact.blocks:
        values[f"{fact.id}.blocks"] = ", ".join(fact.blocks)
    if fact.reason:
        values[f"{fact.id}.reason"] = fact.reason
    return values
