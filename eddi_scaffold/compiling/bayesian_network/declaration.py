"""One entry of ``discretisation`` in the model file, typed and checked."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.document import ModelError

UNOBSERVED = "unobserved"
_KEYS = frozenset(
    {"input", "bins", "closed", "order", "scale", "offset", "map", "sentinel", "range"}
    | {"out_of_range", "allow_inf", "hysteresis", "missing"}
)


_USUAL: Mapping[str, Any] = {
    "edges": None,
    "order": (),
    "closed_right": True,
    "scaled": False,
    "scale": 1.0,
    "offset": 0.0,
    "limits": (float("-inf"), float("inf")),
    "clamp": False,
    "allow_inf": False,
    "hysteresis": 0.0,
    "policy": UNOBSERVED,
    "special": (),
}
"""What the runtime's ``Declaration`` holds where nothing is given."""


def read_declaration(given: Mapping[str, Any], states: Sequence[str], name: str) -> dict[str, Any]:
    """Return the arguments of the runtime's ``Declaration`` for a node, without usual ones.

    Args:
        given: as in the model file. ``map`` is a list of pairs (value, state), or an object whose
            keys are texts; None represents an absent key.
        states: names of the states of the node.
        name: of the node, for errors.

    Raises:
        ModelError: a key is not known, of a wrong type, or contradicts another one.
    """
    try:
        found = _Reader(given, states).read()
    except ModelError as problem:
        reason = f"the discretisation of {name!r}: {problem.reason}"
        raise ModelError("", reason) from None
    return {key: value for key, value in found.items() if value != _USUAL.get(key)}


class _Reader:
    def __init__(self, given: Mapping[str, Any], states: Sequence[str]) -> None:
        self._given = {key: value for key, value in given.items() if value is not None}
        self._states = {state: k for k, state in enumerate(states)}

    def read(self) -> dict[str, Any]:
        given = self._given
        unknown = sorted(set(given) - _KEYS)
        if unknown:
            raise ModelError("", f"the key {unknown[0]!r} is not known")
        limits = self._numbers("range") if "range" in given else [float("-inf"), float("inf")]
        if len(limits) != 2:
            raise ModelError("", "'range' is no pair")
        order = tuple(self._state(one) for one in given.get("order", self._states))
        return {
            "missing": len(self._states),
            "edges": self._edges(len(order)),
            "order": order,
            "closed_right": self._choice("closed", ("right", "left")) == "right",
            "scaled": "scale" in given or "offset" in given,
            "scale": self._number("scale", 1.0),
            "offset": self._number("offset", 0.0),
            "limits": (limits[0], limits[1]),
            "clamp": self._choice("out_of_range", (UNOBSERVED, "clamp")) == "clamp",
            "allow_inf": given.get("allow_inf") is True,
            "hysteresis": self._number("hysteresis", 0.0),
            "policy": self._choice("missing", (UNOBSERVED, "prior", "default", "hold")),
            "special": self._special(),
        }

    def _edges(self, bins: int) -> tuple[float, ...] | None:
        if ("bins" in self._given) == ("map" in self._given):
            raise ModelError("", "it has not exactly one of 'bins' and 'map'")
        if "bins" not in self._given:
            return None
        edges = self._numbers("bins")
        if len(edges) != bins - 1:
            raise ModelError("", f"{len(edges)} edges for {bins} states")
        if not all(one < other for one, other in itertools.pairwise(edges)):
            raise ModelError("", "the edges do not ascend")
        return tuple(edges)

    def _special(self) -> tuple[tuple[bool | int | float | str, int], ...]:
        given = self._given.get("map", [])
        pairs = self._pairs(list(given.items()) if isinstance(given, dict) else given)
        found = [(value, self._state(state)) for value, state in pairs]
        for value, state in self._pairs(self._given.get("sentinel", [])):
            known = len(self._states) if state == UNOBSERVED else self._state(state)
            # A raw -1 may come as a whole number or as -1.0, but True is not 1.
            if isinstance(value, (bool, str)):
                found.append((value, known))
            else:
                found += [(twin, known) for twin in _twins(value)]
        return tuple(found)

    def _pairs(self, items: Any) -> list[tuple[Any, Any]]:
        if not isinstance(items, list):
            raise ModelError("", "'map' or 'sentinel' is no list of pairs")
        pairs = []
        for item in items:
            if not isinstance(item, (list, tuple)) or len(item) != 2:
                raise ModelError("", "'map' or 'sentinel' is no list of pairs")
            if type(item[0]) not in (bool, int, float, str):
                raise ModelError("", "'map' or 'sentinel' names a value of a wrong type")
            pairs.append((item[0], item[1]))
        return pairs

    def _state(self, name: Any) -> int:
        if not isinstance(name, str) or name not in self._states:
            raise ModelError("", f"there is no state {name!r}")
        return self._states[name]

    def _number(self, key: str, default: float) -> float:
        value = self._given.get(key, default)
        if type(value) not in (int, float):
            raise ModelError("", f"{key!r} is no number")
        return float(value)

    def _numbers(self, key: str) -> list[float]:
        values = self._given[key]
        if not isinstance(values, list) or any(type(value) not in (int, float) for value in values):
            raise ModelError("", f"{key!r} is no list of numbers")
        return [float(value) for value in values]

    def _choice(self, key: str, known: tuple[str, ...]) -> str:
        value = self._given.get(key, known[0])
        if value not in known:
            raise ModelError("", f"{key!r} is {value!r}, not one of {', '.join(known)}")
        return str(value)


def _twins(value: float) -> Iterator[int | float]:
    """Yield a number as a whole number and as a double, where that is exact."""
    for kind in (int, float):
        try:
            twin = kind(value)
        except OverflowError:
            continue
        if twin == value:
            yield twin
