"""Which topic fills an input: taken where it is clear, else listed for a person."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

from eddi_scaffold.common import units
from eddi_scaffold.connect.scoring import ALARM, Candidate, Scorer
from eddi_scaffold.connect.topics import (
    WORDS,
    FieldsOf,
    FieldUse,
    InputNeed,
    RobotTopic,
    TopicField,
    leaves,
    words,
)

_GUARANTEES, _POSTERIORS = "eddi_messages/ConSertOutput", "eddi_messages/BayesianNetworkOutput"
_SETTING = re.compile(
    r"angle_.*|range_m(?:in|ax)|m(?:in|ax)_range|field_of_view|time_increment|scan_time|"
    r"intensities|origin|significance_level|time_from_start"
)
_COMPARED = ("diagnostic_msgs/", "vision_msgs/")
_SURE = ((50, 8), (32, 15))  # score and distance to the next candidate from which a topic is taken
_LEAST_NAME = 15
_LEAST = 25
_MOST = 5
_COMPOSED = 100


@dataclass(frozen=True)
class Decision:
    """What is known of the topic of an input."""

    need: InputNeed
    # `taken`: the first candidate is written; `listed`: a person decides; `none`
    state: Literal["taken", "listed", "none"]
    candidates: tuple[Candidate, ...] = ()  # the best one of each topic, best first
    # points between the taken one and the next of any topic, `None` without a next one
    lead: int | None = None


@dataclass(frozen=True)
class Fulfilment:
    """An output of another monitor that fulfils an input."""

    topic: RobotTopic
    field: str  # path of the output in the message
    why: str  # for a comment
    key: str = ""  # name of the output
    is_sure: bool = True  # it fulfils the input; else a person decides


def decide(
    needs: Sequence[InputNeed],
    topics: Sequence[RobotTopic],
    fields_of: FieldsOf,
    fulfilments: Mapping[str, Sequence[Fulfilment]] | None = None,
) -> list[Decision]:
    """Decide for each input; the same inputs give the same decisions."""
    matcher = _Matcher(topics, fields_of)
    by_input = fulfilments or {}
    return [matcher.decide(need, by_input.get(need.id, ())) for need in needs]


class _Matcher:
    def __init__(self, topics: Sequence[RobotTopic], fields_of: FieldsOf) -> None:
        self._topics = topics
        self._leaves_of = cache(lambda message: tuple(leaves(message, fields_of)))

    def decide(self, need: InputNeed, fulfilments: Sequence[Fulfilment]) -> Decision:
        """Return the decision: what fulfils an input is a matter of composition, not of names."""
        composed = []
        for fulfilment in fulfilments:
            parts = {"composition": _COMPOSED}
            if not fulfilment.is_sure:
                names = (*words(fulfilment.key), *fulfilment.topic.words)
                likeness = sum(need.fit(word, names) for word in need.words) / len(need.words)
                parts = {"name": round(50 * likeness)}
            leaf = TopicField((fulfilment.field,), "bool", None)
            use = FieldUse("field", fulfilment.field)
            composed.append(Candidate(fulfilment.topic, leaf, use, parts, (fulfilment.why,)))
        if composed and fulfilments[0].is_sure:
            return Decision(need, "taken" if len(composed) == 1 else "listed", tuple(composed))
        decision = self._by_name(need)
        if decision.state == "taken" or not composed:
            return decision
        every = sorted((*decision.candidates, *composed), key=lambda candidate: -candidate.score)
        # a claim may have quite another name, so that all are listed where none is like the input
        like = [candidate for candidate in every if candidate.score > 0] or every
        return Decision(need, "listed", tuple(like[:_MOST]))

    def _by_name(self, need: InputNeed) -> Decision:
        fitting_of = {
            type_: [leaf for leaf in self._leaves_of(type_) if _can_fill(need, type_, leaf)]
            for type_ in {topic.type for topic in self._topics}
        }
        fitting = [(topic, leaf) for topic in self._topics for leaf in fitting_of[topic.type]]
        scorer = Scorer(need, dict.fromkeys(topic for topic, _ in fitting))
        every = sorted(
            (scorer.score(topic, leaf) for topic, leaf in fitting),
            key=lambda candidate: (-candidate.score, candidate.topic.id, candidate.leaf.path),
        )
        best: dict[RobotTopic, Candidate] = {}
        for candidate in every:
            best.setdefault(candidate.topic, candidate)
        least = 0 if need.is_demand or need.type.endswith("[]") else _LEAST  # few can be that
        listed = tuple(candidate for candidate in best.values() if candidate.score >= least)
        listed = listed[:_MOST]
        if need.is_demand:
            return Decision(need, "listed" if listed else "none", listed)
        if not listed:
            return Decision(need, "none")
        top = every[0]
        lead = top.score - every[1].score if len(every) > 1 else None
        distance = _SURE[-1][1] if lead is None else lead
        is_sure = (
            any(top.score >= score and distance >= least for score, least in _SURE)
            and top.parts["name"] >= _LEAST_NAME
            and ALARM not in top.parts
            and not scorer.unsaid(top.topic, top.leaf)
            and top.access.is_complete
        )
        if is_sure:
            return Decision(need, "taken", listed, lead)
        return Decision(need, "listed", listed)


def _can_fill(need: InputNeed, message: str, leaf: TopicField) -> bool:
    """Return whether a value of a message type might fill an input."""
    names = [name.partition("[")[0] for name in leaf.path] or [""]
    package = message.partition("/")[0]
    is_of_other_kind = need.is_demand != (message == _GUARANTEES) or message == _POSTERIORS
    is_about_message = names[0] in ("header", "layout") or names[-1] in ("secs", "nsecs")
    if package in WORDS["no_measurements"].split() or is_of_other_kind or is_about_message:
        return False
    if any(map(_SETTING.fullmatch, names)):  # of the sensor
        return False
    if leaf.path and leaf.is_variance != need.says(WORDS["synonyms"]["uncertainty"]):
        return False
    if leaf.path and not _has_type(need, message, leaf):
        return False
    read = leaf.read_units
    if need.unit is None or not need.is_number or read is None:
        return True
    return (
        any(units.factor(unit, need.unit) is not None for unit in read) if read else not need.unit
    )


def _has_type(need: InputNeed, message: str, leaf: TopicField) -> bool:
    is_number = leaf.type in ("int", "float")
    if need.type == "bool":
        is_compared = message.startswith(_COMPARED) or {*words(leaf.text)} <= {*need.compared}
        return leaf.type == "bool" or (is_number and is_compared)
    is_code = leaf.units == () and leaf.type == "int"  # an enumeration, bits
    fits = {
        "float": is_number and not is_code,
        "int": is_number,
        "float[]": is_number and leaf.is_list,
        "bool[]": leaf.type == "bool" and leaf.is_list,
    }
    return fits.get(need.type, leaf.type == "str")  # a text, or a state by its name
