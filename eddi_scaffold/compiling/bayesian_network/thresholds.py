"""Thresholds of posteriors in the model file, typed and checked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from eddi_scaffold.compiling.document import ModelError, take


class StateThreshold(NamedTuple):
    """A threshold of the probability of some states of a node.

    Attributes:
        node: number of the node.
        states: numbers of the states whose probabilities are added up.
        at_least: the probability must not be below; else it must not be above.
        id: of the evidence.
        activate: where it begins; of the negative probability for ``at_least``.
        release: where it ends, likewise.
        hold_ns: nanoseconds that it must be kept for.
    """

    node: int
    states: tuple[int, ...]
    at_least: bool
    id: str
    activate: float
    release: float
    hold_ns: int


def read_thresholds(
    items: Any, names: Sequence[str], states: Sequence[Sequence[str]]
) -> tuple[StateThreshold, ...]:
    """Read the list ``thresholds`` of a model.

    Raises:
        ModelError: something is missing, of a wrong type, or not known.
    """
    if not isinstance(items, list):
        raise ModelError("", "'thresholds' is no list")
    found = [_threshold(item, names, states) for item in items]
    if len({one.id for one in found}) < len(found):
        raise ModelError("", "two thresholds have the same id")
    return tuple(found)


def _threshold(item: Any, names: Sequence[str], states: Sequence[Sequence[str]]) -> StateThreshold:
    name = take(item, "id", str, "a threshold")
    where = f"threshold {name!r}"
    node = take(item, "node", str, where)
    if node not in names:
        raise ModelError("", f"{where}: there is no node {node!r}")
    number = names.index(node)
    chosen = _states(take(item, "states", list, where), states[number], where)
    key = "at_least" if "at_least" in item else "at_most"
    sign = -1.0 if key == "at_least" else 1.0
    activate, release = (sign * _probability(item, one, where) for one in (key, "release"))
    hold_ns = take(item, "hold_ns", int, where)
    return StateThreshold(number, chosen, key == "at_least", name, activate, release, hold_ns)


def _states(given: Any, known: Sequence[str], where: str) -> tuple[int, ...]:
    numbers: list[int] = []
    for state in given:
        if state not in known:
            raise ModelError("", f"{where}: there is no state {state!r}")
        numbers.append(known.index(state))
    if not numbers or len(set(numbers)) < len(numbers):
        raise ModelError("", f"{where}: no states, or one of them twice")
    return tuple(numbers)


def _probability(item: Any, key: str, where: str) -> float:
    value = item.get(key)
    if type(value) not in (int, float) or not 0.0 <= value <= 1.0:
        raise ModelError("", f"{where}: {key!r} is no probability")
    return float(value)
