"""``evidence:`` of a configuration: thresholds of posteriors that a ConSert may rest on."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, has_errors, problem
from eddi_scaffold.common.units import QuantityError, duration
from eddi_scaffold.kinds import JsonValue, Options
from eddi_scaffold.kinds.bayesian_network.discretisation import is_number
from eddi_scaffold.kinds.bayesian_network.network import Network

KEY = "evidence"
_KEYS = ("id", "node", "state", "at_most", "at_least", "release", "hold", "topic")
_LIMITS = ("at_most", "at_least")
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
        less, more = (">=", "below") if self.at_least else ("<=", "above")
        held = f" for {self.hold:g} s" if self.hold else ""
        where = f", on {self.topic}" if self.topic is not None else ""
        states = " or ".join(self.states)
        wanted = f"P({self.node} = {states}) {less} {self.limit:g}{held}"
        return f"{wanted}, gone {more} {self.release:g}{where}"


def read_thresholds(
    network: Network, options: Options, discretised: Collection[str]
) -> tuple[list[Threshold], list[Problem]]:
    """Check the section ``evidence`` (B303, B305, B404).

    Args:
        network: whose nodes it names.
        options: the configuration.
        discretised: nodes whose states are observed.
    """
    given = options.values.get(KEY)
    if given is None:
        return [], []
    if not isinstance(given, list) or not all(isinstance(one, Mapping) for one in given):
        return [], [problem("B404.evidence_list", options.place(KEY))]
    found: list[Threshold] = []
    problems: list[Problem] = []
    for number, entry in enumerate(given):
        reader = _Entry(network, entry, _at(options, number), discretised)
        threshold = reader.read()
        problems += reader.problems
        found += [threshold] if threshold is not None else []
    problems += _repeated(found)
    return found, problems


def _at(options: Options, number: int) -> Callable[..., Place]:
    return lambda *path: options.place(KEY, number, *path)


def _repeated(found: Sequence[Threshold]) -> Iterable[Problem]:
    for number, one in enumerate(found):
        before = found[:number]
        if one.id in [other.id for other in before]:
            yield problem("B404.duplicate_id", one.place, name=one.id)
        other = next((two.id for two in before if one.topic and two.topic == one.topic), None)
        if other is not None:
            yield problem("B404.same_topic", one.place, other=other, name=one.id, topic=one.topic)


@dataclass
class _Entry:
    network: Network
    given: Mapping[str, JsonValue]
    at: Callable[..., Place]
    discretised: Collection[str]
    problems: list[Problem] = field(default_factory=list)

    def read(self) -> Threshold | None:
        self._keys()
        name = self._id()
        node = self._node()
        states = self._states(node)
        key, limit = self._limit()
        release = self._release(key, limit)
        hold = self._hold()
        topic = self._topic()
        if has_errors(self.problems):
            return None
        at_least = key == "at_least"
        return Threshold(name, node, states, at_least, limit, release, hold, topic, self.at("id"))

    def _report(
        self, case: str, /, *path: str | int, hint: str | None = None, **fields: object
    ) -> None:
        name = self.given.get("id")
        fault = problem(case, self.at(*path), hint=hint, **fields)
        self.problems.append(
            fault.about(f"evidence {name!r}" if isinstance(name, str) else "evidence")
        )

    def _keys(self) -> None:
        for key in self.given:
            if key not in _KEYS:
                hint = did_you_mean(key, _KEYS) or f"known keys: {', '.join(_KEYS)}"
                self._report("B404.threshold_key", key, hint=hint, key=key)

    def _id(self) -> str:
        name = self.given.get("id")
        if not isinstance(name, str) or _ID.fullmatch(name) is None:
            if name is None:
                self._report("B404.no_id", "id")
            else:
                self._report("B404.id", "id", name=_shown(name))
            return ""
        if name in _RESERVED:
            self._report("B404.reserved_id", "id", name=name)
        return name

    def _node(self) -> str:
        name, names = self.given.get("node"), self.network.names()
        if not isinstance(name, str) or name not in names:
            hint = did_you_mean(str(name), names)
            if name is None:
                self._report("B303.node_missing", "node", hint=hint)
            else:
                self._report("B303.threshold_node", "node", hint=hint, name=_shown(name))
            return ""
        if name in self.discretised:
            self._report("B305.observed", "node", name=name)
        return name

    def _states(self, node: str) -> tuple[str, ...]:
        given = self.given.get("state")
        items = given if isinstance(given, list) else [given]
        if given is None or not items:
            self._report("B303.no_threshold_state", "state")
            return ()
        known = self.network.node(node).states if node else ()
        for state in items if node else ():
            if state not in known:
                self._unknown_state(state, known)
        chosen = tuple(str(item) for item in items)
        if len(set(chosen)) < len(chosen):
            self._report("B303.state_twice", "state")
        elif set(chosen) == set(known):
            self._report("B303.every_state", "state", node=node)
        return chosen

    def _unknown_state(self, state: object, known: Sequence[str]) -> None:
        if isinstance(state, str):
            hint = did_you_mean(state, known) or f"its states: {', '.join(known)}"
        else:
            hint = "quote it, if a text is meant"
        self._report("B303.threshold_state", "state", hint=hint, state=_shown(state))

    def _limit(self) -> tuple[str, float]:
        keys = [key for key in _LIMITS if key in self.given]
        if len(keys) != 1:
            self._report("B404.one_limit", *keys[1:])
            return "at_most", 0.0
        return keys[0], self._probability(keys[0])

    def _probability(self, key: str) -> float:
        value: JsonValue = self.given[key]
        if not is_number(value) or not 0.0 <= value <= 1.0:
            self._report("B404.probability", key, key=key, value=_shown(value))
            return 0.0
        return float(value)

    def _release(self, key: str, limit: float) -> float:
        if "release" not in self.given:
            return limit
        release, sound = self._probability("release"), not has_errors(self.problems)
        side = "above" if key == "at_least" else "below"
        wrong = release > limit if key == "at_least" else release < limit
        if wrong and sound:
            self._report(
                "B404.release", "release", release=release, side=side, key=key, limit=limit
            )
        return release

    def _hold(self) -> float:
        given = self.given.get("hold", 0)
        try:
            hours, has_unit = duration(given)
        except QuantityError as failure:
            self._report("B404.hold", "hold", hint=failure.hint, problem=failure)
            return 0.0
        if not has_unit and hours:
            self._report("B404.hold_unit", "hold", actual=_shown(given), number=given)
        elif hours * 3600.0 > _LONGEST_S:
            self._report("B404.hold_long", "hold", actual=_shown(given))
        return hours * 3600.0

    def _topic(self) -> str | None:
        given = self.given.get("topic")
        if given is not None and (not isinstance(given, str) or not is_ros_name(given)):
            self._report("B404.topic", "topic", actual=_shown(given))
        return None if given is None else str(given)


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
