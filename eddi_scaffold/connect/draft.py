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
from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.connect.matching import Decision
from eddi_scaffold.connect.scoring import Candidate
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.spellings import PATH
from eddi_scaffold.yaml_text.nodes import dump_plain, quoted

MARK = "# connect:"
"""What the comments of this command begin with; a person's do not."""
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
_RARE = 0.05  # share of the gaps that may be such pauses; a topic with more has no period
_FEW = 3  # periods from which a recording says how often a topic is published


@dataclass(frozen=True)
class Age:
    """When the messages of a topic are too old."""

    seconds: float  # the limit
    why: str  # where it is from; empty where a person said so

    def line(self) -> str:
        """Return it as a line of an entry."""
        return f"max_age: {self.seconds:g} s{f'  # {one_line(self.why)}' if self.why else ''}"


def recorded_age(times: Sequence[int], where: str) -> Age | None:
    """Return the limit for a topic by the times (ns, ascending) of its messages in a recording."""
    gaps = [(later - earlier) / 1e9 for earlier, later in pairwise(times)]
    if len(gaps) < _FEW or max(gaps) <= 0:
        return None
    usual, why = median(gaps), f"{len(times)} messages of {where}"
    steady = [gap for gap in gaps if gap <= _OUTAGE * usual] if usual > 0 else gaps
    pauses = len(gaps) - len(steady)
    if pauses > _RARE * len(gaps):
        return None  # it has no period
    if pauses:
        why += f", without {pauses} gap{'s' if pauses > 1 else ''} of up to {max(gaps):.2g} s"
    seconds = max(_PERIODS * usual, _SPARE * max(steady))
    digit = 10.0 ** (math.floor(math.log10(seconds)) - 1)
    return Age(float(f"{math.ceil(round(seconds / digit, 6)) * digit:.2g}"), why)


def age_line(topic: RobotTopic, ages: Mapping[str, Age]) -> str | None:
    """Return the line of the age limit of a topic, ``None`` where it is not known."""
    if topic.is_of_monitor:  # its messages have a limit where none is written
        return ""
    return ages[topic.topic].line() if topic.topic in ages else None


@dataclass(frozen=True)
class EntryDraft:
    """One entry of ``EDDIInputs``."""

    id: str
    why: tuple[str, ...]  # its comments
    source: tuple[str, ...]  # the lines that say where the value comes from
    taken: Mapping[str, str]  # keys and texts of these where nothing is open
    age: str  # line of the age limit, empty where the input needs none

    def lines(self) -> list[str]:
        """Return the whole entry, without indentation."""
        more = filter(None, (*self.why, *self.source, self.age))
        return [f"- id: {_name(self.id)}", *(f"  {line}" for line in more)]


def entry(decision: Decision, ages: Mapping[str, Age]) -> EntryDraft:
    """Return the entry of an input, with what is known of the age of each topic."""
    need, taken = decision.need, dict[str, str]()
    why = [f"the EDDI names the event {event}" for event in need.events]
    if decision.state == "taken":
        best = decision.candidates[0]
        unit = best.access.unit
        taken = _origin(best) | ({"unit": unit} if unit is not None else {})
        source = _texts(taken)
        lead = decision.lead
        ahead = "no other candidate" if lead is None else f"the next has {lead} less"
        why += [f"taken, {_points(best)}; {ahead}"]
        age = age_line(best.topic, ages)
        if age is None:
            age = _todo("max_age", _NO_RATE.format(best.topic.topic))
    else:
        note = _CHOOSE if decision.candidates else _FIND
        source = [_todo("from", note)]
        if need.states:
            states = (f"  {_todo(quoted(state), _CONDITION)}" for state in need.states)
            source = ["states:", *states]
        why += _choice(decision)
        age = _todo("max_age", _SECONDS)
    if need.timeout is not None:
        age = Age(need.timeout, "TIMEOUT of the model").line()
    elif not need.safety:
        age = ""
    comments = tuple(f"{MARK} {one_line(reason)}" for reason in why)
    return EntryDraft(need.id, comments, tuple(source), taken, age)


def _choice(decision: Decision) -> list[str]:
    """Return the comments of an input that a person decides."""
    candidates = decision.candidates
    if decision.need.is_demand:
        head = "a guarantee of another monitor; --with its configuration finds it"
    elif candidates:
        count = len(candidates)
        head = "1 candidate, not sure" if count == 1 else f"{count} candidates, take one"
    else:
        head = "no topic fits"
    lines = [head]
    for candidate in candidates:  # each as it can be written in place of TODO
        line, unit = ", ".join(_texts(_origin(candidate))), candidate.access.unit
        with_unit = f" with unit: {quoted(unit)}" if unit is not None else ""
        lines.append(f"  {line}{with_unit}   {_points(candidate)}")
    return lines


def _origin(candidate: Candidate) -> dict[str, str]:
    """Return keys and texts that say where the value comes from."""
    use, id_ = candidate.access, candidate.topic.id
    text = use.text if use.key == "expression" else f"{id_}.{use.text}"
    if use.key == "expression" or PATH.fullmatch(text):
        return {"from": text}
    return {"requires": id_, "field": use.text}  # an id that is no word of a condition


def _texts(source: Mapping[str, str]) -> list[str]:
    return [
        f"{key}: [{_name(text)}]" if key == "requires" else f"{key}: {quoted(text)}"
        for key, text in source.items()
    ]


def _points(candidate: Candidate) -> str:
    reasons = "".join(f"; {reason}" for reason in candidate.reasons)
    return f"{candidate.score} points: {candidate.topic.type} on {candidate.topic.topic}{reasons}"


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


def _name(text: str) -> str:
    """Return an id as YAML; one that is called TODO is not open."""
    return quoted(text) if text != TODO else f'"{TODO}"'


def _todo(key: str, note: str) -> str:
    return f"{key}: {TODO}  # {TODO} {one_line(note)}"


def is_own(comment: str) -> bool:
    """Return whether a comment is of this command, as it is, so that it may be rewritten."""
    start, _, note = comment.partition(f"# {TODO} ")
    return comment.startswith(MARK) or (not start and _NOTES.fullmatch(note) is not None)
