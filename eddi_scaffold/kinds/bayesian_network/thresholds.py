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
from eddi_scaffold.kinds.bayesian_network.discretisation import EntryReader, is_number
from eddi_scaffold.kinds.bayesian_network.network import Network

_KEYS = ("id", "node", "state", "at_most", "at_least", "release", "hold", "topic")
_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_RESERVED = ("t", "reason", "unknown", "valid")
"""Columns of what ``run --csv`` writes, and what reads as if it were about all evidence."""
_LONGEST_S = 31_536_000.0


@dataclass(frozen=True)
class Threshold:
    """One checked entry.

    Attributes:
        id: of the evidence.
        node: id of the node.
        states: whose probabilities are added up.
        at_least: the sum must not be below ``limit``; else it must not be above.
        limit: where it becomes active.
        release: beyond it, it is lost.
        hold: seconds for which the limit must be kept before.
        topic: where it is published alone, ``None`` for nowhere.
    """

    id: str
    node: str
    states: tuple[str, ...]
    at_least: bool
    limit: float
    release: float
    hold: float
    topic: str | None
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
    """Check the section ``evidence`` (B303, B305, B404).

    Args:
        network: whose nodes it names.
        options: the configuration.
        discretised: nodes whose states are observed.
    """
    section, reader = options.values.get("evidence"), EntryReader(options, "evidence")
    thresholds: list[Threshold] = []
    if not isinstance(section, list) or not all(isinstance(entry, Mapping) for entry in section):
        if section is not None:
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
                problems.append(
                    problem("B404.same_topic", place, other=other.id, name=name, topic=topic)
                )
    return thresholds, problems


class _ThresholdReader(EntryReader):
    def __init__(
        self, network: Network, entry: Mapping[str, Any], options: Options, number: int
    ) -> None:
        name = entry.get("id")
        subject = f"evidence {name!r}" if isinstance(name, str) else "evidence"
        super().__init__(options, "evidence", number, subject=subject)
        self._network, self._entry = network, entry

    def read(self, discretised: Collection[str]) -> list[Threshold]:
        """Return the threshold; nothing after an error."""
        entry = self._entry
        self.check_keys(entry, _KEYS)
        name, topic = entry.get("id"), entry.get("topic")
        if not isinstance(name, str) or not _ID.fullmatch(name) or name in _RESERVED:
            self.report("B404.id", "id", value=_shown(name))
        if topic is not None and (not isinstance(topic, str) or not is_ros_name(topic)):
            self.report("B404.topic", "topic", actual=_shown(topic))
        node = self._node(discretised)
        states = self._states(node)
        key = "at_least" if "at_least" in entry else "at_most"
        if ("at_least" in entry) == ("at_most" in entry):
            self.report("B404.one_limit", *(["at_least"] if "at_least" in entry else []))
            return []
        limit = self._probability(key)
        release = self._probability("release") if "release" in entry else limit
        is_beyond = release > limit if key == "at_least" else release < limit
        if is_beyond and not has_errors(self.problems):
            side = "above" if key == "at_least" else "below"
            self.report("B404.release", "release", release=release, side=side, key=key, limit=limit)
        hold, place = self._hold_s(), self.options.place(*self.path, "id")
        if has_errors(self.problems):
            return []
        return [
            Threshold(
                str(name), node, states, key == "at_least", limit, release, hold, topic, place
            )
        ]

    def _node(self, discretised: Collection[str]) -> str:
        name, names = self._entry.get("node"), self._network.names()
        if name not in names:
            hint = did_you_mean(str(name), names)
            self.report("B303.threshold_node", "node", hint=hint, value=_shown(name))
            return ""
        if name in discretised:
            self.report("B305.observed", "node", name=name)
        return str(name)

    def _states(self, node: str) -> tuple[str, ...]:
        states = self._entry.get("state")
        chosen = states if isinstance(states, list) else [states]
        if states is None or not chosen:
            self.report("B303.no_threshold_state", "state")
            return ()
        known = self._network.node(node).states if node else ()
        for state in chosen if node else ():
            if state not in known:
                hint = "quote it, if a text is meant"
                if isinstance(state, str):
                    hint = did_you_mean(state, known) or f"its states: {', '.join(known)}"
                self.report("B303.threshold_state", "state", hint=hint, state=_shown(state))
        names = tuple(map(str, chosen))
        if len({*names}) < len(names):
            self.report("B303.state_twice", "state")
        elif {*names} == {*known}:
            self.report("B303.every_state", "state", node=node)
        return names

    def _probability(self, key: str) -> float:
        value = self._entry[key]
        if not is_number(value) or not 0.0 <= value <= 1.0:
            self.report("B404.probability", key, key=key, value=_shown(value))
            return 0.0
        return float(value)

    def _hold_s(self) -> float:
        hold = self._entry.get("hold", 0)
        try:
            hours, has_unit = duration(hold)
        except QuantityError as failure:
            self.report("B404.hold", "hold", hint=failure.hint, problem=failure)
            return 0.0
        if not has_unit and hours:
            self.report("B404.hold_unit", "hold", actual=_shown(hold), number=hold)
        elif hours * 3600.0 > _LONGEST_S:
            self.report("B404.hold_long", "hold", actual=_shown(hold))
        return hours * 3600.0


def _shown(value: object) -> str:
    text = "missing" if value is None else repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
