"""Decisions as lines of a configuration, with their reasons as comments.

Texts of models become YAML scalars by ``quoted`` and comments by ``one_line``, nothing else.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from eddi_scaffold.common.escaping import one_line
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.units import QuantityError, duration
from eddi_scaffold.connect.matching import Decision
from eddi_scaffold.connect.needs import InputNeed
from eddi_scaffold.connect.scoring import Candidate
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.kinds import TODO, JsonValue
from eddi_scaffold.yaml_text.nodes import dump_plain, quoted

MARK = "# connect:"
"""What the comments of this command begin with; a person's do not."""
_EXPRESSIBLE = ("bool", "float", "int")
_CHOOSE = "one of the above, or another"
_FIND = "no topic is known"
_CONDITION = "the condition for it, such as load.data > 60"
_SECONDS = "seconds"
_NO_RATE = "seconds: no rate of {} is known"
_NOTES = re.compile(
    "|".join((_CHOOSE, _FIND, re.escape(_CONDITION), _SECONDS, _NO_RATE.format(r"\S+")))
)
_PERIODS = 2.5
_SPARE = 1.2
_OUTAGE = 10.0
"""Usual periods after which a pause is none of the rate: its source was dead, or switched off."""
_RARE = 0.05
"""Share of the gaps that may be such pauses; a topic with more has no period."""
_FEW = 3
"""Periods from which a recording says how often a topic is published."""


@dataclass(frozen=True)
class Age:
    """When the messages of a topic are too old.

    Attributes:
        seconds: the limit.
        why: where it is from; empty where a person said so.
    """

    seconds: float
    why: str


@dataclass(frozen=True)
class EntryDraft:
    """One entry of ``EDDIInputs``.

    Attributes:
        why: its comments.
        source: the lines that say where the value comes from.
        taken: keys and texts of these where nothing is open.
        age: line of the age limit, empty where the input needs none.
    """

    id: str
    why: tuple[str, ...]
    source: tuple[str, ...]
    taken: Mapping[str, str]
    age: str

    def lines(self) -> list[str]:
        """Return the whole entry, without indentation."""
        more = (*self.why, *self.source, *((self.age,) if self.age else ()))
        return [f"- id: {_name(self.id)}", *(f"  {line}" for line in more)]


def recorded_age(times: Sequence[int], where: str) -> Age | None:
    """Return the limit for a topic that was recorded, ``None`` where that says nothing.

    Args:
        times: of its messages, nanoseconds, ascending.
        where: name of the recording.
    """
    gaps = [(later - earlier) / 1e9 for earlier, later in pairwise(times)]
    if len(gaps) < _FEW or max(gaps) <= 0:
        return None
    usual, why = median(gaps), f"{len(times)} messages of {where}"
    steady = [gap for gap in gaps if gap <= _OUTAGE * usual] if usual > 0 else gaps
    left = len(gaps) - len(steady)
    if left > _RARE * len(gaps):
        return None  # it has no period
    if left:
        why += f", without {left} gap{'s' if left > 1 else ''} of up to {max(gaps):.2g} s"
    return age_of(usual, max(steady), why)


def age_of(period: float, longest: float, why: str) -> Age:
    """Return the limit for messages that come so often: usual and longest seconds between two."""
    wanted = max(_PERIODS * period, _SPARE * longest)
    digit = 10.0 ** (math.floor(math.log10(wanted)) - 1)
    return Age(float(f"{math.ceil(round(wanted / digit, 6)) * digit:.2g}"), why)


def deadline_age(deadlines: Sequence[str]) -> Age | None:
    """Return the limit for a topic by the quality of service of all that publish it.

    Only where each of them promises a deadline with a unit: `100 ms`. The longest counts.
    """
    try:
        found = [duration(deadline) for deadline in deadlines]
    except QuantityError:
        return None
    if not found or not all(one.has_unit and one.value > 0 for one in found):
        return None
    seconds = max(one.value for one in found) * 3600
    return age_of(seconds, 0.0, f"2.5 deadlines of {seconds:g} s in its quality of service")


def entry(decision: Decision, ages: Mapping[str, Age]) -> EntryDraft:
    """Return the entry of an input.

    Args:
        decision: which topic it is, as far as that is clear.
        ages: topic -> when its messages are too old, where that is known.
    """
    need = decision.need
    if decision.state == "taken":
        best = decision.candidates[0]
        taken = _keys(best)
        source = [_key_line(key, value) for key, value in taken.items()]
        why = [_comment(f"taken, {_why(best)}{_ahead(decision)}")]
        limit = age_line(best.topic, ages)
        age = _todo("max_age", _NO_RATE.format(best.topic.topic)) if limit is None else limit
    else:
        taken, age = {}, _todo("max_age", _SECONDS)
        source = _open_source(need, _CHOOSE if decision.candidates else _FIND)
        why = _choice(decision)
    why = [*(_comment(f"the EDDI names the event {event}") for event in need.events), *why]
    if need.timeout is not None:
        age = _known(Age(need.timeout, "TIMEOUT of the model"))
    elif not need.needs_age:
        age = ""
    return EntryDraft(need.id, tuple(why), tuple(source), taken, age)


def _open_source(need: InputNeed, note: str) -> list[str]:
    if need.states:
        return ["states:", *(f"  {_todo(quoted(state), _CONDITION)}" for state in need.states)]
    keys = ("expression",) if need.type in _EXPRESSIBLE else ("requires", "field")
    return [_todo(key, note) for key in keys]


def option_lines(
    options: Mapping[str, JsonValue],
    notes: Mapping[tuple[str, ...], str],
    path: tuple[str, ...] = (),
) -> list[str]:
    """Return options as block YAML; what is open has a comment."""
    lines: list[str] = []
    for key, value in options.items():
        inner = (*path, key)
        if isinstance(value, Mapping) and value:
            below = option_lines(value, notes, inner)
            lines += [f"{quoted(key)}:", *(f"  {line}" for line in below)]
        elif value == TODO:
            lines.append(_todo(quoted(key), notes.get(inner, key)))
        else:
            lines += dump_plain({key: value}).splitlines()
    return lines


def _keys(candidate: Candidate) -> dict[str, str]:
    taken = candidate.access
    given: dict[str, str] = {taken.key: taken.text}
    if taken.key == "field":
        given = {"requires": candidate.topic.id, **given}
    return {**given, "unit": taken.unit} if taken.unit is not None else given


def _key_line(key: str, value: str) -> str:
    return f"{key}: [{_name(value)}]" if key == "requires" else f"{key}: {quoted(value)}"


def _name(text: str) -> str:
    """Return an id as YAML; one that is called TODO is not open."""
    return quoted(text) if text != TODO else f'"{TODO}"'


def _todo(key: str, note: str) -> str:
    return f"{key}: {TODO}  # {TODO} {one_line(note)}"


def is_own(comment: str) -> bool:
    """Return whether a comment is of this command, as it is, so that it may be rewritten."""
    start, _, note = comment.partition(f"# {TODO} ")
    return comment.startswith(MARK) or (not start and _NOTES.fullmatch(note) is not None)


def _comment(text: str) -> str:
    return f"{MARK} {one_line(text)}"


def _choice(decision: Decision) -> list[str]:
    """Return the comments of an input that a person decides."""
    found, missed = decision.candidates, decision.missed
    if decision.need.is_demand:
        head = "a guarantee of another monitor; --with its configuration finds it"
    elif found:
        head = "1 candidate, not sure" if len(found) == 1 else f"{len(found)} candidates, take one"
    elif missed is not None:
        head = f"no topic fits; nearest {missed.leaf.text} of {missed.topic.topic}: {missed.why}"
    else:
        head = "no topic fits"
    return [_comment(head), *(_comment(f"  {_line(one, decision)}") for one in found)]


def as_expression(need: InputNeed, candidate: Candidate) -> str | None:
    """Return a candidate as an expression, ``None`` for an input that takes none."""
    if need.type not in _EXPRESSIBLE:
        return None
    taken = candidate.access
    name = attribute(candidate.topic.id)
    return taken.text if taken.key == "expression" else f"{name}.{taken.text}"


def _line(candidate: Candidate, decision: Decision) -> str:
    """Return a candidate as it can be written in place of TODO."""
    taken, expression = candidate.access, as_expression(decision.need, candidate)
    if expression is None:
        text = f"requires: [{quoted(candidate.topic.id)}], field: {quoted(taken.text)}"
    else:
        text = f"expression: {quoted(expression)}"
    unit = f" with unit: {quoted(taken.unit)}" if taken.unit is not None else ""
    return f"{text}{unit}   {_why(candidate)}"


def _why(candidate: Candidate) -> str:
    reasons = "".join(f"; {reason}" for reason in candidate.reasons)
    return f"{candidate.score} points: {candidate.topic.type} on {candidate.topic.topic}{reasons}"


def _ahead(decision: Decision) -> str:
    return (
        "; no other candidate" if decision.lead is None else f"; the next has {decision.lead} less"
    )


def age_line(topic: RobotTopic, ages: Mapping[str, Age]) -> str | None:
    """Return the line of the age limit of a topic, ``None`` where it is not known.

    It is empty for a topic of a monitor: its messages have a limit where none is written.
    """
    if topic.is_of_monitor:
        return ""
    return _known(ages[topic.topic]) if topic.topic in ages else None


def _known(age: Age) -> str:
    return f"max_age: {age.seconds:g}{f'  # {one_line(age.why)}' if age.why else ''}"


def outputs(package: str, topic: str, parts: Sequence[str]) -> list[dict[str, JsonValue]]:
    """Return the entries of ``EDDIOutputs``: one, or one for each part of the result."""
    if len(parts) < 2:
        return [{"id": package, "topic": f"{package}/{topic}"}]
    return [{"id": part, "topic": f"{package}/{part}", "event": part} for part in parts]
