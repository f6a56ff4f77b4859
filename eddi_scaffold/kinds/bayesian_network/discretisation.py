"""``discretisation:`` of a configuration: how values of inputs become states of nodes."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, TypeGuard

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.kinds import DeclaredInput, InputType, JsonValue, Options
from eddi_scaffold.kinds.bayesian_network.network import Network, Node

TRUTH = {"true": True, "false": False}
"""Keys of maps are texts; those that mean a bool."""


def is_number(value: object) -> TypeGuard[int | float]:
    """Return whether a value is a number that a double can hold; NaN and infinity are."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return isinstance(value, float) or abs(value) <= sys.float_info.max


def is_raw(value: object) -> bool:
    """Return whether an input can have this value and JSON can hold it."""
    if isinstance(value, bool | str):
        return True
    return isinstance(value, int | float) and is_number(value) and math.isfinite(value)


def as_integer(text: str) -> int | None:
    """Return the integer that a key of a map is, ``None`` for others."""
    try:
        return int(text)
    except ValueError:
        return None


def value_of(key: str, of: InputType) -> JsonValue:
    """Return the value that a key of a map means, by the type of the input."""
    if of == "bool":
        return TRUTH.get(key)
    if of == "int":
        return as_integer(key)
    if of == "float":
        try:
            return float(key)
        except ValueError:
            return None
    return key


UNOBSERVED = "unobserved"
_KEYS = (
    "input", "bins", "closed", "order", "scale", "offset", "map", "sentinel", "range",
    "out_of_range", "allow_inf", "hysteresis", "missing",
)  # fmt: skip
_CHOICES = {
    "closed": ("right", "left"),
    "out_of_range": (UNOBSERVED, "clamp"),
    "missing": (UNOBSERVED, "prior", "default", "hold"),
}


@dataclass(frozen=True)
class Declaration:
    """One checked entry.

    Attributes:
        node: id of the node.
        input: id of the input.
        type: of the input's values.
        data: as the runtime reads it; maps and sentinels are lists of pairs.
    """

    node: str
    input: str
    type: InputType
    data: Mapping[str, Any]

    def reader_arguments(self, states: Sequence[str]) -> dict[str, Any]:
        """Return the arguments of the runtime's ``Declaration``, without usual ones."""
        data, number = self.data, {state: k for k, state in enumerate(states)}
        special = [(value, number[state]) for value, state in data.get("map", [])]
        for value, state in data.get("sentinel", []):
            # A raw -1 may come as a whole number or as -1.0, but True is not 1.
            twins = [value] if isinstance(value, bool | str) else _twins(value)
            known = len(states) if state == UNOBSERVED else number[state]
            special += [(twin, known) for twin in twins]
        arguments = {
            "missing": len(states),
            "edges": tuple(data["bins"]) if "bins" in data else None,
            "order": tuple(number[state] for state in data.get("order", states)),
            "closed_right": data.get("closed", "right") == "right",
            "scaled": "scale" in data or "offset" in data,
            "scale": data.get("scale", 1.0),
            "offset": data.get("offset", 0.0),
            "limits": tuple(data.get("range", _USUAL["limits"])),
            "clamp": data.get("out_of_range") == "clamp",
            "allow_inf": data.get("allow_inf", False),
            "hysteresis": data.get("hysteresis", 0.0),
            "policy": data.get("missing", UNOBSERVED),
            "special": tuple(special),
        }
        return {key: value for key, value in arguments.items() if value != _USUAL.get(key)}


_USUAL: Mapping[str, Any] = {
    "edges": None,
    "order": (),
    "closed_right": True,
    "scaled": False,
    "scale": 1.0,
    "offset": 0.0,
    "limits": (-math.inf, math.inf),
    "clamp": False,
    "allow_inf": False,
    "hysteresis": 0.0,
    "policy": UNOBSERVED,
    "special": (),
}
"""What the runtime's ``Declaration`` holds where nothing is given."""


def _twins(value: float) -> Iterator[int | float]:
    """Yield a number as a whole number and as a double, where that is exact."""
    for kind in (int, float):
        try:
            twin = kind(value)
        except OverflowError:
            continue
        if twin == value:
            yield twin


def read_discretisation(
    network: Network, options: Options
) -> tuple[list[Declaration], list[Problem]]:
    """Check the section ``discretisation`` (B401 to B405)."""
    given = options.values.get("discretisation")
    if given is None:
        return [], []
    place = options.place("discretisation")
    if not isinstance(given, Mapping):
        return [], [problem("B404.declarations", place)]
    found: list[Declaration] = []
    problems: list[Problem] = []
    names = network.names()
    for name, entry in given.items():
        at = _at(options, name)
        if name not in names:
            problems.append(
                problem("B303.discretised_node", at(), hint=did_you_mean(name, names), name=name)
            )
        elif not isinstance(entry, Mapping):
            problems.append(problem("B404.declaration", at(), name=name))
        else:
            reader = _Entry(network.node(name), entry, options.inputs, at)
            declaration = reader.read()
            problems += reader.problems
            found += [declaration] if declaration is not None else []
    return found, problems


def _at(options: Options, name: str) -> Callable[..., Place]:
    return lambda *path: options.place("discretisation", name, *path)


@dataclass
class _Entry:
    node: Node
    given: Mapping[str, JsonValue]
    inputs: Sequence[DeclaredInput]
    at: Callable[..., Place]
    problems: list[Problem] = field(default_factory=list)

    def read(self) -> Declaration | None:
        self._keys()
        source = self._input()
        order = self._order()
        bins = self._bins(order)
        numbers = self._numbers()
        self._hysteresis(bins, numbers)
        self._choices()
        self._default(source)
        of = self._type(source)
        mapping = self._map(of)
        sentinel = self._sentinel()
        self._reachable(order, mapping, sentinel)
        if any(problem.level == "error" for problem in self.problems) or source is None:
            return None
        data: dict[str, JsonValue] = {"input": source}
        given = self.given
        if bins is not None:
            data |= {"bins": bins, "order": list(order)}
        if mapping is not None:
            data["map"] = mapping
        if sentinel:
            data["sentinel"] = sentinel
        for key in ("closed", "out_of_range", "allow_inf", "missing"):
            if key in given:
                data[key] = given[key]
        return Declaration(self.node.id, source, of, data | numbers)

    def _report(
        self, case: str, /, *path: str | int, hint: str | None = None, **fields: object
    ) -> None:
        fault = problem(case, self.at(*path), hint=hint, **fields)
        self.problems.append(fault.about(f"discretisation of {self.node.id!r}"))

    def _keys(self) -> None:
        for key in self.given:
            if key not in _KEYS:
                hint = did_you_mean(key, _KEYS) or f"known keys: {', '.join(_KEYS)}"
                self._report("B404.unknown_key", key, hint=hint, key=key)
        if ("bins" in self.given) == ("map" in self.given):
            self._report("B404.bins_or_map")
        if "map" in self.given:
            for key in ("closed", "order", "scale", "offset", "range", "hysteresis", "allow_inf"):
                if key in self.given:
                    self._report("B404.useless_with_map", key, key=key)

    def _input(self) -> str | None:
        name = self.given.get("input")
        if not isinstance(name, str):
            self._report("B404.input")
            return None
        names = [input_.id for input_ in self.inputs]
        if name not in names:
            hint = did_you_mean(name, names) or "add it to EDDIInputs"
            self._report("B404.unknown_input", "input", hint=hint, name=name)
            return None
        return name

    def _order(self) -> tuple[str, ...]:
        given = self.given.get("order")
        if given is None:
            return self.node.states
        if not isinstance(given, list) or not all(isinstance(one, str) for one in given):
            self._report("B404.order", "order")
            return self.node.states
        for number, state in enumerate(given):
            self._known_state(state, "order", number)
        if len(set(given)) < len(given):
            self._report("B404.order_twice", "order")
        return tuple(given)

    def _known_state(self, state: object, *path: str | int) -> None:
        if isinstance(state, bool) or not isinstance(state, str):
            self._report("B404.state_name", *path, state=state)
        elif state not in self.node.states:
            hint = did_you_mean(state, self.node.states)
            hint = hint or f"its states: {', '.join(self.node.states)}"
            self._report("B303.bin_state", *path, hint=hint, state=state)

    def _bins(self, order: Sequence[str]) -> list[float] | None:
        given = self.given.get("bins")
        if "bins" not in self.given:
            return None
        if not isinstance(given, list) or not all(is_number(one) for one in given):
            self._report("B404.bins", "bins")
            return None
        if len(given) != len(order) - 1:
            self._report(
                "B401.edge_count", "bins", edges=len(given), bins=len(given) + 1, states=len(order)
            )
        edges = [float(one) for one in given]
        for number, edge in enumerate(edges):
            rising = number == 0 or edges[number - 1] < edge
            if not math.isfinite(edge) or not rising:
                self._report("B401.edge_order", "bins", number)
                break
        return edges

    def _numbers(self) -> dict[str, JsonValue]:
        """Return the numbers that are given, and report what is not one."""
        found: dict[str, JsonValue] = {}
        for key in ("scale", "offset", "hysteresis"):
            if key not in self.given:
                continue
            value = self.given[key]
            if not is_number(value) or not math.isfinite(value):
                self._report("B404.number", key, key=key)
            elif key == "hysteresis" and value < 0:
                self._report("B404.hysteresis", key)
            elif key == "scale" and value == 0:
                self._report("B404.scale", key)
            else:
                found[key] = float(value)
        if "range" in self.given:
            match self.given["range"]:
                case [low, high] if is_number(low) and is_number(high) and low < high:
                    found["range"] = [float(low), float(high)]
                case _:
                    self._report("B404.range", "range")
        return found

    def _hysteresis(self, bins: Sequence[float] | None, numbers: Mapping[str, Any]) -> None:
        """Report a hysteresis with which a bin would be passed over, or never left."""
        band, edges = numbers.get("hysteresis", 0.0), list(bins or ())
        if "range" in numbers:
            scale, offset = numbers.get("scale", 1.0), numbers.get("offset", 0.0)
            low, high = sorted(one * scale + offset for one in numbers["range"])
            edges = [low, *(edge for edge in edges if low < edge < high), high]
        width = min((b - a for a, b in pairwise(edges)), default=math.inf)
        if 0 < width <= band:
            self._report("B404.wide_hysteresis", "hysteresis", hysteresis=band, width=width)

    def _choices(self) -> None:
        for key, known in _CHOICES.items():
            if key in self.given and self.given[key] not in known:
                self._report("B404.choice", key, key=key, allowed=" or ".join(known))
        if "allow_inf" in self.given and not isinstance(self.given["allow_inf"], bool):
            self._report("B404.allow_inf", "allow_inf")

    def _default(self, source: str | None) -> None:
        declared = next((input_ for input_ in self.inputs if input_.id == source), None)
        if self.given.get("missing") == "default" and declared and declared.default is None:
            self._report("B404.no_default", "missing", input=source)

    def _type(self, source: str | None) -> InputType:
        """Return the declared type of the input, or the one that fits."""
        declared = next((input_.type for input_ in self.inputs if input_.id == source), None)
        keys = self.given.get("map")
        if declared is not None:
            if declared == "bool" and "bins" in self.given:
                self._report("B404.bool_bins", "bins")
            return declared
        if not isinstance(keys, Mapping):
            return "float"
        if all(key in TRUTH for key in keys):
            return "bool"
        return "int" if all(as_integer(key) is not None for key in keys) else "str"

    def _map(self, of: InputType) -> list[list[JsonValue]] | None:
        given = self.given.get("map")
        if "map" not in self.given:
            return None
        if not isinstance(given, Mapping) or not given:
            self._report("B404.map", "map")
            return None
        pairs: list[list[JsonValue]] = []
        for key, state in given.items():
            self._known_state(state, "map", key)
            value = value_of(key, of)
            if value is None:
                self._report("B404.map_type", "map", key, key=key, type=of)
            pairs.append([value, state])
        return pairs

    def _sentinel(self) -> list[list[JsonValue]]:
        given = self.given.get("sentinel")
        if given is None:
            return []
        if not isinstance(given, list):
            self._report("B404.sentinel", "sentinel")
            return []
        for number, pair in enumerate(given):
            if not isinstance(pair, list) or len(pair) != 2 or not is_raw(pair[0]):
                self._report("B404.sentinel", "sentinel", number)
            elif pair[1] != UNOBSERVED:
                self._known_state(pair[1], "sentinel", number)
        return list(given)

    def _reachable(
        self,
        order: Sequence[str],
        mapping: list[list[JsonValue]] | None,
        sentinel: list[list[JsonValue]],
    ) -> None:
        """Warn of states that no value gives (B405)."""
        if self.problems:
            return
        given = set(order) if mapping is None else {state for _, state in mapping}
        given |= {pair[1] for pair in sentinel}
        lacking = [state for state in self.node.states if state not in given]
        if lacking:
            self.problems.append(
                problem("B405", self.at(), node=self.node.id, states=", ".join(lacking))
            )
