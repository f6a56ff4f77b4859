"""Which topic fills an input: taken where it is clear, else listed for a person."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Literal

from eddi_scaffold.common import units
from eddi_scaffold.connect.name_words import words
from eddi_scaffold.connect.needs import InputNeed
from eddi_scaffold.connect.scoring import ALARM, Candidate, scored, unsaid, weights
from eddi_scaffold.connect.topics import (
    FieldsOf,
    FieldUse,
    RobotTopic,
    TopicField,
    leaves,
    units_of,
)

_NO_MEASUREMENTS = (
    *("dynamic_reconfigure", "rcl_interfaces", "bond", "lifecycle_msgs", "rosgraph_msgs"),
    *("visualization_msgs", "tf2_msgs"),
)
_FOR_DEMANDS = ("eddi_messages/ConSertOutput", "eddi_messages/BayesianNetworkOutput")
_SETTING = re.compile(
    r"angle_.*|range_m(?:in|ax)|m(?:in|ax)_range|field_of_view|time_increment|scan_time|"
    r"intensities|origin|significance_level|time_from_start"
)
_PICTURES = ("Image", "CameraInfo", "PointCloud2", "OccupancyGrid")
_SIZES = (
    "width",
    "height",
    "resolution",
    "step",
    "point_step",
    "row_step",
    "binning_x",
    "binning_y",
)
_NEVER = ("header", "layout")
_ABOUT_UNCERTAINTY = ("uncertainty", "covariance", "deviation", "std", "variance", "accuracy")
_COMPARED = ("diagnostic_msgs/", "vision_msgs/")
_TIMES = ("secs", "nsecs")


def objection(need: InputNeed, message: str, leaf: TopicField) -> str | None:
    """Return why a value of a message type cannot fill an input, ``None`` where it might."""
    names = [name.partition("[")[0] for name in leaf.path] or [""]
    if message.partition("/")[0] in _NO_MEASUREMENTS:
        return "it is not a measurement"
    if need.is_demand != (message == _FOR_DEMANDS[0]):
        return "a demand needs the guarantee of another ConSert"
    if message == _FOR_DEMANDS[1]:
        return "posteriors are not evidence"
    if names[0] in _NEVER or names[-1] in _TIMES:
        return "it is about the message"
    is_size = message.rpartition("/")[2] in _PICTURES and names[-1] in _SIZES
    if is_size or any(map(_SETTING.fullmatch, names)):
        return "it is a setting of the sensor"
    if leaf.path and leaf.is_variance != need.says(*_ABOUT_UNCERTAINTY):
        return "it is an uncertainty" if leaf.is_variance else "it is not an uncertainty"
    return _type(need, message, leaf) or _unit(need, leaf)


def _type(need: InputNeed, message: str, leaf: TopicField) -> str | None:
    if not leaf.path:
        return None
    is_number = leaf.type in ("int", "float")
    is_coded = leaf.units == () and leaf.type == "int"  # an enumeration, bits
    if need.type == "bool":
        is_told = bool(leaf.path) and set(words(leaf.text)) <= set(need.told)
        fits = leaf.type == "bool" or (is_number and (message.startswith(_COMPARED) or is_told))
    elif need.type in ("float", "int"):
        fits = is_number and not (is_coded and need.type == "float")
    elif need.type == "float[]":
        fits = is_number and leaf.text.endswith("[]") and leaf.lists == 1
    elif need.type == "bool[]":
        fits = leaf.type == "bool" and leaf.text.endswith("[]") and leaf.lists == 1
    else:  # a text, or a state by its name
        fits = leaf.type == "str"
    return None if fits else f"it is a {leaf.type}"


def _unit(need: InputNeed, leaf: TopicField) -> str | None:
    if need.unit is None or need.type not in ("float", "int"):
        return None
    given = units_of(leaf)
    if given is None:
        return None
    if not given:
        return "it has no unit" if need.unit else None
    if any(units.factor(unit, need.unit) is not None for unit in given):
        return None
    return f"it is in {' or '.join(given)}"


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
    leaf: TopicField
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

    need: InputNeed
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
    needs: Sequence[InputNeed],
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
    need: InputNeed, offers: Sequence[Offer], decide_by_name: Callable[[], Decision]
) -> Decision:
    """Return the decision: what fulfils an input is a matter of composition, not of names."""
    found = [
        Candidate(
            offer.topic,
            TopicField((offer.field,), "bool", None),
            FieldUse("field", offer.field),
            {"composition": _COMPOSED} if offer.is_sure else {"name": _likeness(need, offer)},
            (offer.why,),
        )
        for offer in offers
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


def _likeness(need: InputNeed, offer: Offer) -> int:
    near = (*words(offer.key), *offer.topic.words)
    return round(50 * sum(need.fit(word, near) for word in need.words) / len(need.words))


def _decide(
    need: InputNeed, topics: Sequence[RobotTopic], known: Callable[[str], tuple[TopicField, ...]]
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
    need: InputNeed, topics: Sequence[RobotTopic], known: Callable[[str], tuple[TopicField, ...]]
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
