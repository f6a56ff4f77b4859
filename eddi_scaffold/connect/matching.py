"""Which topic fills an input: taken where it is clear, else listed for a person."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Literal

from eddi_scaffold.connect.access import Access
from eddi_scaffold.connect.filters import objection
from eddi_scaffold.connect.needs import Need
from eddi_scaffold.connect.scoring import ALARM, Candidate, scored, unsaid, weights
from eddi_scaffold.connect.topics import FieldsOf, Leaf, RobotTopic, leaves
from eddi_scaffold.connect.words import words

_SURE = ((50, 8), (32, 15))
"""Score and distance to the next candidate from which a topic is taken."""
_LEAST_NAME = 15
_LEAST = 25
_MOST = 5
_COMPOSED = 100


@dataclass(frozen=True)
class NearMiss:
    """A topic that a rule keeps out, though its name fits."""

    topic: RobotTopic
    leaf: Leaf
    why: str


@dataclass(frozen=True)
class Decision:
    """What is known of the topic of an input.

    Attributes:
        state: ``taken``: the first candidate is written; ``listed``: a person decides; ``none``.
        candidates: the best one of each topic, best first.
        lead: points between the taken one and the next of any topic, ``None`` without a next one.
        missed: where there are none.
    """

    need: Need
    state: Literal["taken", "listed", "none"]
    candidates: tuple[Candidate, ...] = ()
    lead: int | None = None
    missed: NearMiss | None = None


@dataclass(frozen=True)
class Offer:
    """An output of another monitor that fulfils an input.

    Attributes:
        field: path of the output in the message.
        why: for a comment.
        key: name of the output.
        is_sure: it fulfils the input; else a person decides.
    """

    topic: RobotTopic
    field: str
    why: str
    key: str = ""
    is_sure: bool = True


def decide(
    needs: Sequence[Need],
    topics: Sequence[RobotTopic],
    fields_of: FieldsOf,
    offers: Mapping[str, Sequence[Offer]] | None = None,
) -> list[Decision]:
    """Decide for each input; the same inputs give the same decisions.

    Args:
        needs: the inputs.
        topics: of the robot.
        fields_of: message type -> fields, ``None`` where they are not known.
        offers: input -> outputs of other monitors that fulfil it.
    """
    known = cache(lambda message: tuple(leaves(message, fields_of)))
    given = offers or {}
    return [
        _with_offers(need, given.get(need.id, ()), partial(_decide, need, topics, known))
        for need in needs
    ]


def _with_offers(
    need: Need, offers: Sequence[Offer], decide_by_name: Callable[[], Decision]
) -> Decision:
    """Return the decision: what fulfils an input is a matter of composition, not of names."""
    found = [
        Candidate(
            one.topic,
            Leaf((one.field,), "bool", None),
            Access("field", one.field),
            {"composition": _COMPOSED} if one.is_sure else {"name": _likeness(need, one)},
            (one.why,),
        )
        for one in offers
    ]
    if found and offers[0].is_sure:
        return Decision(need, "taken" if len(found) == 1 else "listed", tuple(found))
    decision = decide_by_name()
    if decision.state == "taken" or not found:
        return decision
    every = sorted((*decision.candidates, *found), key=lambda one: -one.score)
    # a claim may have quite another name, so that all are listed where none is like the input
    like = [one for one in every if one.score > 0] or every
    return Decision(need, "listed", tuple(like[:_MOST]))


def _likeness(need: Need, offer: Offer) -> int:
    near = (*words(offer.key), *offer.topic.words)
    return round(50 * sum(need.fit(one, near) for one in need.words) / len(need.words))


def _decide(
    need: Need, topics: Sequence[RobotTopic], known: Callable[[str], tuple[Leaf, ...]]
) -> Decision:
    fitting_of = {
        type_: [leaf for leaf in known(type_) if objection(need, type_, leaf) is None]
        for type_ in {topic.type for topic in topics}
    }
    fitting = [(topic, leaf) for topic in topics for leaf in fitting_of[topic.type]]
    left = list(dict.fromkeys(topic for topic, _ in fitting))
    weight = weights(need, left)
    every = sorted(
        (scored(need, topic, leaf, weight) for topic, leaf in fitting),
        key=lambda one: (-one.score, one.topic.id, one.leaf.path),
    )
    first: dict[RobotTopic, Candidate] = {}
    for one in every:
        first.setdefault(one.topic, one)
    least = 0 if need.is_demand or need.type.endswith("[]") else _LEAST  # few topics can be that
    listed = tuple(one for one in first.values() if one.score >= least)[:_MOST]
    if need.is_demand:
        return Decision(need, "listed" if listed else "none", listed)
    if not listed:
        return Decision(need, "none", missed=_missed(need, topics, known))
    top = every[0]
    lead = top.score - every[1].score if len(every) > 1 else None
    far = _SURE[-1][1] if lead is None else lead
    sure = any(top.score >= score and far >= distance for score, distance in _SURE)
    is_named = top.parts["name"] >= _LEAST_NAME and ALARM not in top.parts
    if sure and is_named and not unsaid(need, top.topic, top.leaf) and top.access.is_complete:
        return Decision(need, "taken", listed, lead)
    return Decision(need, "listed", listed)


def _missed(
    need: Need, topics: Sequence[RobotTopic], known: Callable[[str], tuple[Leaf, ...]]
) -> NearMiss | None:
    """Return the value that would fit best by its name, with the rule that keeps it out."""
    weight = weights(need, topics)

    def near(topic: RobotTopic) -> float:
        return sum(weight(word) * need.fit(word, topic.words) for word in need.words)

    topic = min(topics, key=lambda one: (-near(one), one.id), default=None)
    if topic is None or not near(topic):
        return None
    misses = {
        (-scored(need, topic, leaf, weight).parts["name"], leaf.path): NearMiss(topic, leaf, why)
        for leaf in known(topic.type)
        if (why := objection(need, topic.type, leaf)) is not None
    }
    return misses[min(misses)] if misses else None
