"""``evidence:`` of a configuration: thresholds of posteriors that a ConSert may rest on."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, has_errors, problem
from eddi_scaffold.common.units import QuantityError, duration
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.bayesian_network.discretisation import EntryReader, Form, is_number
from eddi_scaffold.kinds.bayesian_network.network import Network

_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_RESERVED = ("t", "reason", "unknown", "valid")
"""Columns of what ``run --csv`` writes, and what reads as if it were about all evidence."""
_LONGEST_S = 31_536_000.0


def _is_id(value: object) -> bool:
    return isinstance(value, str) and bool(_ID.fullmatch(value)) and value not in _RESERVED


def _hold_s(value: object) -> float | None:
    try:
        hours, has_unit = duration(value)
    except QuantityError:
        return None
    is_clear = has_unit or not hours
    return hours * 3600.0 if is_clear and hours * 3600.0 <= _LONGEST_S else None


def _are_states(value: object) -> bool:
    states = value if isinstance(value, list) else [value]
    return states != [] and all(isinstance(state, str) for state in states)


_PROBABILITY = (lambda value: is_number(value) and 0 <= value <= 1, "a number from 0 to 1")
_FORM: Form = {
    "id": (_is_id, "a name such as RiskIsLow, and not t, reason, unknown or valid"),
    "node": (lambda value: isinstance(value, str), "a node of the network"),
    "state": (_are_states, "a state, or a list of them, yes and no in quotes"),
    "at_most": _PROBABILITY,
    "at_least": _PROBABILITY,
    "release": _PROBABILITY,
    "hold": (lambda value: _hold_s(value) is not None, "a time such as 2 s, up to a year"),
    "topic": (
        lambda value: isinstance(value, str) and is_ros_name(value),
        "a ROS name: letters, digits, `_` and `/`, such as /rte/land",
    ),
}


@dataclass(frozen=True)
class Threshold:
    """One checked entry."""

    id: str
    node: str
    states: tuple[str, ...]  # whose probabilities are added up
    at_least: bool  # the sum must not be below `limit`; else it must not be above
    limit: float  # where it becomes active
    release: float  # beyond it, it is lost
    hold: float  # seconds for which the limit must be kept before
    topic: str | None  # where it is published alone, `None` for nowhere
    place: Place = field(default=Place(), compare=False)

    def text(self) -> str:
        """Return what it asks for, for people."""
        relation, beyond = (">=", "below") if self.at_least else ("<=", "above")
        held = f" for {self.hold:g} s" if self.hold else ""
        where = f", on {self.topic}" if self.topic is not None else ""
        limit = f"P({self.node} = {' or '.join(self.states)}) {relation} {self.limit:g}"
        return f"{limit}{held}, gone {beyond} {self.release:g}{where}"


def read_thresholds(
    network: Network, options: Options, discretised: Collection[str]
) -> tuple[list[Threshold], list[Problem]]:
    """Check the section ``evidence`` (B303, B305, B404)."""
    section, reader = options.values.get("evidence"), EntryReader(options, "evidence")
    thresholds: list[Threshold] = []
    if section is None:
        section = []
    if not isinstance(section, list) or not all(isinstance(entry, Mapping) for entry in section):
        reader.report("B404.evidence_list")
        return [], reader.problems
    for number, entry in enumerate(section):
        of_entry = _ThresholdReader(network, entry, options, number)
        thresholds += of_entry.read(discretised)
        reader.problems += of_entry.problems
    problems = reader.problems
    for number, threshold in enumerate(thresholds):
        name, place, topic = threshold.id, threshold.place, threshold.topic
        for other in thresholds[:number]:
            if other.id == name:
                problems.append(problem("B404.duplicate_id", place, name=name))
            if topic and other.topic == topic:
                fields = {"other": other.id, "name": name, "topic": topic}
                problems.append(problem("B404.same_topic", place, **fields))
    return thresholds, problems


class _ThresholdReader(EntryReader):
    def __init__(
        self, network: Network, entry: Mapping[str, Any], options: Options, number: int
    ) -> None:
        name = entry.get("id")
        subject = f"evidence {name!r}" if isinstance(name, str) else "evidence"
        super().__init__(options, "evidence", number, entry=entry, subject=subject)
        self._network = network

    def read(self, discretised: Collection[str]) -> list[Threshold]:
        """Return the threshold; nothing after an error."""
        values = self.values(_FORM, "id", "node", "state")
        node, states = values.get("node", ""), values.get("state", [])
        states = [states] if isinstance(states, str) else states
        names = self._network.names()
        if node in discretised:
            self.report("B305.observed", "node", name=node)
        elif node in names:
            known = self._network.node(node).states
            for state in states:
                if state not in known:
                    hint = did_you_mean(state, known) or f"its states: {', '.join(known)}"
                    self.report("B303.threshold_state", "state", hint=hint, state=state)
            if len({*states}) < len(states):
                self.report("B303.state_twice", "state")
            elif {*states} == {*known}:
                self.report("B303.every_state", "state", node=node)
        elif "node" in values:
            similar = did_you_mean(node, names)
            self.report("B303.threshold_node", "node", hint=similar, value=node)
        keys = [key for key in ("at_least", "at_most") if key in self.entry]
        if len(keys) != 1:
            self.report("B404.one_limit", *keys[:1])
        if has_errors(self.problems):
            return []
        (key,) = keys
        limit, is_least = float(values[key]), key == "at_least"
        release = float(values.get("release", limit))
        if release > limit if is_least else release < limit:
            side = "above" if is_least else "below"
            self.report("B404.release", "release", release=release, side=side, key=key, limit=limit)
            return []
        hold_s, topic = _hold_s(values.get("hold", 0)) or 0.0, values.get("topic")
        limits = (is_least, limit, release, hold_s, topic, self.place("id"))
        return [Threshold(values["id"], node, tuple(states), *limits)]
