"""How well a value of a topic fits an input, in points with their reasons."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from eddi_scaffold.common import units
from eddi_scaffold.connect.topics import (
    MEANS_THE_SAME,
    WORDS,
    FieldUse,
    InputNeed,
    RobotTopic,
    TopicField,
    access,
    words,
)

_TELLING = 14  # from so many points on, the message alone explains the words of its row
_NAME = 50
ALARM = "true may be bad"
"""Part of a candidate that may be true where the input is false; it is never taken."""


_USUAL = [
    (frozenset(row["words"].split()), row["measures"], row["messages"]) for row in WORDS["usual"]
]
_COMMANDS = frozenset(WORDS["commands"].split())
_BAD_WHEN_TRUE = frozenset(WORDS["bad_when_true"].split())
_SIDES = [frozenset(group.split()) for group in WORDS["sides"]]
_AXES = {tuple(axis.split(".")): frozenset(said.split()) for axis, said in WORDS["axes"].items()}


@dataclass(frozen=True)
class Candidate:
    """A value of a topic that might fill an input."""

    topic: RobotTopic
    leaf: TopicField
    access: FieldUse
    # what the score is made of: name, unit, prior, type, and what counts against it
    parts: Mapping[str, int]
    reasons: Sequence[str] = ()  # the same in words, for a comment

    @property
    def score(self) -> int:
        """All points together."""
        return sum(self.parts.values())


class Scorer:
    """Compares an input with values of topics."""

    def __init__(self, need: InputNeed, topics: Collection[RobotTopic]) -> None:
        """Weigh the words of the input: one that many of the topics match tells less."""
        self.need = need
        self._weights = dict.fromkeys((*need.words, *need.described, *need.compared), 1.0)
        count = len(topics)
        for word in self._weights if count > 1 else ():
            matching = sum(need.fit(word, topic.words) >= MEANS_THE_SAME for topic in topics)
            self._weights[word] = 0.3 + math.log((count + 1) / (matching + 1)) / math.log(count + 1)

    def unsaid(self, topic: RobotTopic, leaf: TopicField) -> list[str]:
        """Return the words of an input without which a value may be something else.

        Of a number, those that no name of it has: a temperature need not be that of the
        motor. Of a flag among other fields, all, where the field has none of them: any flag of a
        battery would say that there is power.
        """
        need, inside = self.need, words(leaf.text)
        if leaf.type == "bool":
            is_said = leaf.is_only or any(need.fit(word, inside) for word in need.words)
            return [] if is_said else list(need.words)
        names = (*topic.words, *inside, *words(topic.message))
        known = {*self._usual(topic, leaf)[1]}
        if leaf.path[-2:] in _AXES:
            known |= {"speed", "velocity"} | _AXES[leaf.path[-2:]]
        return [word for word in need.words if word not in known and not need.fit(word, names)]

    def score(self, topic: RobotTopic, leaf: TopicField) -> Candidate:
        """Return a value of a topic as a candidate."""
        usual, explained = self._usual(topic, leaf)
        name, matched = self._name(topic, leaf, explained)
        use = access(self.need, topic, leaf)
        unit, in_unit = self._unit(leaf)
        form, of_type = self._type(leaf, use)
        against = self._against(topic, leaf)
        missing = " or ".join(self.unsaid(topic, leaf))
        doubt = f"nothing says {missing}"
        if leaf.type == "bool":
            doubt = f"{leaf.text} may be another flag"
        parts = {"name": round(name), "unit": unit, "prior": usual, "type": form, **against}
        reasons = [
            f"{' and '.join(matched)} in the name" if matched else "",
            f"usual for {topic.message}" if usual >= _TELLING else "",
            in_unit,
            of_type,
            *(reason for reason in against if reason != "rest"),
            doubt if missing else "",
        ]
        return Candidate(topic, leaf, use, parts, [*filter(None, reasons)])

    def _usual(self, topic: RobotTopic, leaf: TopicField) -> tuple[int, frozenset[str]]:
        """Return the points of the best row that applies, and the words that it explains."""
        points, explained = 0, frozenset[str]()
        for names, dimensions, messages in _USUAL:
            more = messages.get(topic.message, 0)
            is_meant = not names.isdisjoint(self.need.words)
            if more > points and is_meant and self._measures(dimensions, leaf):
                points, explained = more, names
        return points, explained if points >= _TELLING else frozenset()

    def _measures(self, dimensions: Collection[str], leaf: TopicField) -> bool:
        """Return whether input and value, as far as their units are known, have a dimension."""
        if self.need.type == "bool" or "bool" in dimensions:
            return self.need.type == "bool" and "bool" in dimensions
        if leaf.is_variance:
            return True
        return all(
            any(units.find(unit) is None or units.dimension(unit) in dimensions for unit in some)
            for some in ((self.need.unit,) if self.need.unit else (), leaf.units or ())
            if some
        )

    def _name(
        self, topic: RobotTopic, leaf: TopicField, explained: Collection[str]
    ) -> tuple[float, list[str]]:
        """Return the points of the names, and the words that match."""
        need, inside, message = self.need, words(leaf.text), words(topic.message)

        def mean(some: Sequence[str]) -> float:
            total = points = 0.0
            for word in some:
                fit = max(
                    need.fit(word, topic.words),
                    0.9 * need.fit(word, inside),
                    0.7 * need.fit(word, message),
                    0.6 if word in explained else 0.0,
                )
                total += self._weights[word]
                points += self._weights[word] * fit
            return points / total if total else 0.0

        own = mean(need.words)
        both = max(own, 0.6 * own + 0.4 * mean(need.described)) if need.described else own
        matched = [word for word in need.words if need.fit(word, topic.words) > 0]
        return _NAME * max(both, mean(need.compared)), matched

    def _unit(self, leaf: TopicField) -> tuple[int, str]:
        need, read = self.need, leaf.read_units
        if not need.is_number or not need.unit or not read:
            return 8, ""
        if len(read) > 1:
            return 14, f"{' or '.join(read)}, {need.unit} in the model"
        if units.factor(read[0], need.unit) == 1:
            return 20, f"{need.unit} as in the model"
        return 18, f"{read[0]}, converted to {need.unit}"

    def _type(self, leaf: TopicField, use: FieldUse) -> tuple[int, str]:
        if not leaf.path:
            return 0, "the fields of the message are not known"
        if self.need.type == "bool" and leaf.type != "bool":
            return 3, "a number, to be compared"
        if leaf.lists and not self.need.type.endswith("[]"):
            least = "the least of its list, a tenth of which may be missing"
            return 6, least if use.is_complete else "an element of a list"
        if leaf.is_only:
            return 10, "the only field of its message"
        return (10 if leaf.type == "bool" else 8), ""

    def _against(self, topic: RobotTopic, leaf: TopicField) -> dict[str, int]:
        """Return what counts against a candidate, by its name."""
        need, names = self.need, {*topic.words}
        asked = {*need.words, *need.described}
        sides = sum(
            bool(asked & group and names & group and not asked & names & group) for group in _SIDES
        )
        is_command = topic.message in WORDS["commanded"].split() and names & _COMMANDS
        is_alarm = need.type == "bool" and names & _BAD_WHEN_TRUE
        is_joint = topic.message.startswith("Joint")
        rest = sum(
            all(not need.fit(other, (word,)) for other in asked) for word in {*words(topic.topic)}
        )
        points = {
            "a command": -25 if is_command and not need.every_word & _COMMANDS else 0,
            "another axis": 0 if self._is_axis(leaf) else -12,
            "another side": -30 * sides,
            "another number": -30 if self._numbers_differ(topic.words) else 0,
            ALARM: -15 if is_alarm and not need.every_word & _BAD_WHEN_TRUE else 0,
            "of joints": -20 if is_joint and not need.says(WORDS["of_joints"]) else 0,
            "rest": -min(5, rest),
        }
        return {reason: number for reason, number in points.items() if number}

    def _is_axis(self, leaf: TopicField) -> bool:
        """Return whether a component of a velocity is the one that is meant."""
        axes = [axis for axis in _AXES if axis[:1] == leaf.path[-2:-1]]
        meant = [axis for axis in axes[1:] if self.need.every_word & _AXES[axis]] or axes
        return not axes or leaf.path[-2:] == meant[0]

    def _numbers_differ(self, names: Sequence[str]) -> bool:
        """Return whether both have words with digits, and none begins with another one."""
        asked = [word for word in self.need.words if any(map(str.isdigit, word))]
        there = [word for word in names if any(map(str.isdigit, word))]
        alike = any(a.startswith(b) or b.startswith(a) for a in asked for b in there)
        return bool(asked and there and not alike)
