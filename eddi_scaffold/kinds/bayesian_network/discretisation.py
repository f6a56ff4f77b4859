"""``discretisation:`` of a configuration: how values of inputs become states of nodes."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeGuard

from eddi_runtime.bayesian_network import readers

from eddi_scaffold.common.problems import Problem, did_you_mean, has_errors, problem
from eddi_scaffold.kinds import InputType, Options
from eddi_scaffold.kinds.bayesian_network.network import Network, Node

UNOBSERVED = "unobserved"
_TRUTH = {"true": True, "false": False}
"""Keys of maps are texts; those that mean a bool."""
_OF_BINS = ("closed", "order", "scale", "offset", "range", "hysteresis", "allow_inf")
_KEYS = ("input", "bins", *_OF_BINS, "map", "sentinel", "out_of_range", "missing")
_USUAL: Mapping[str, Any] = readers.Declaration._field_defaults


class EntryReader:
    """Reads keys of a configuration, and collects what is wrong with them.

    Args:
        options: the configuration.
        path: of the entry, below ``Model:``.
        subject: what each message begins with, if anything.
    """

    def __init__(self, options: Options, *path: str | int, subject: str = "") -> None:
        self.options, self.path, self.subject = options, path, subject
        self.problems: list[Problem] = []

    def report(
        self, case: str, /, *path: str | int, hint: str | None = None, **fields: object
    ) -> None:
        """Report a problem with a key of the entry, or with the entry itself."""
        fault = problem(case, self.options.place(*self.path, *path), hint=hint, **fields)
        self.problems.append(fault.about(self.subject) if self.subject else fault)

    def check_keys(self, entry: Mapping[str, Any], known: Sequence[str]) -> None:
        """Report keys that do not exist."""
        for key in entry:
            if key not in known:
                hint = did_you_mean(key, known) or f"known keys: {', '.join(known)}"
                self.report("B404.unknown_key", key, hint=hint, key=key)


def is_number(value: object) -> TypeGuard[int | float]:
    """Return whether a value is a number that a double can hold; NaN and infinity are."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return isinstance(value, float) or abs(value) <= sys.float_info.max


def _is_finite(value: object) -> TypeGuard[int | float]:
    return is_number(value) and math.isfinite(value)


def _is_range(value: object) -> bool:
    match value:
        case [low, high] if is_number(low) and is_number(high):
            return low < high
    return False


_EXPECTED: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "closed": (lambda value: value in ("right", "left"), "right or left"),
    "scale": (lambda value: _is_finite(value) and value != 0, "a finite number, and not 0"),
    "offset": (_is_finite, "a finite number"),
    "range": (_is_range, "two ascending numbers"),
    "out_of_range": (lambda value: value in (UNOBSERVED, "clamp"), "unobserved or clamp"),
    "allow_inf": (lambda value: isinstance(value, bool), "true or false"),
    "hysteresis": (lambda value: _is_finite(value) and value >= 0, "a finite number, 0 or more"),
    "missing": (
        lambda value: value in (UNOBSERVED, "prior", "default", "hold"),
        "unobserved, prior, default or hold",
    ),
}
"""Key -> whether a value can be meant, and what is expected."""


@dataclass(frozen=True)
class Declaration:
    """One checked entry.

    Attributes:
        node: id of the node.
        input: id of the input.
        type: of the input's values.
        data: its keys; maps and sentinels are lists of pairs.
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
            kinds = [type(value)] if isinstance(value, bool | str) else [int, float]
            twins = [twin for twin in (kind(value) for kind in kinds) if twin == value]
            special += [(twin, number.get(state, len(states))) for twin in twins]
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


def read_discretisation(
    network: Network, options: Options
) -> tuple[list[Declaration], list[Problem]]:
    """Check the section ``discretisation`` (B303, B401 to B405)."""
    section, names = options.values.get("discretisation"), network.names()
    reader = EntryReader(options, "discretisation")
    declarations: list[Declaration] = []
    if not isinstance(section, Mapping):
        if section is not None:
            reader.report("B404.declarations")
        return [], reader.problems
    for name, entry in section.items():
        if name not in names:
            reader.report("B303.discretised_node", name, hint=did_you_mean(name, names), name=name)
        elif not isinstance(entry, Mapping):
            reader.report("B404.declaration", name, name=name)
        else:
            of_node = _DeclarationReader(network.node(name), entry, options)
            declarations += of_node.read()
            reader.problems += of_node.problems
    return declarations, reader.problems


class _DeclarationReader(EntryReader):
    def __init__(self, node: Node, entry: Mapping[str, Any], options: Options) -> None:
        subject = f"discretisation of {node.id!r}"
        super().__init__(options, "discretisation", node.id, subject=subject)
        self._node, self._entry = node, entry

    def read(self) -> list[Declaration]:
        """Return the declaration; nothing after an error."""
        entry = self._entry
        self.check_keys(entry, _KEYS)
        if ("bins" in entry) == ("map" in entry):
            self.report("B404.bins_or_map")
        for key in _OF_BINS if "map" in entry else ():
            if key in entry:
                self.report("B404.useless_with_map", key, key=key)
        for key, (is_meant, expected) in _EXPECTED.items():
            if key in entry and not is_meant(entry[key]):
                self.report("B404.value", key, key=key, expected=expected)
        type_, order = self._type(), self._order()
        data: dict[str, Any] = {"input": entry.get("input")}  # its order decides the digest
        if "bins" in entry:
            data |= {"bins": self._bins(order), "order": order}
        if "map" in entry:
            data["map"] = self._map(type_)
        sentinel = self._sentinel()
        data |= {"sentinel": sentinel} if sentinel else {}
        if has_errors(self.problems):
            return []
        for key in ("closed", "out_of_range", "allow_inf", "missing"):
            data |= {key: entry[key]} if key in entry else {}
        for key in ("scale", "offset", "hysteresis"):
            data |= {key: float(entry[key])} if key in entry else {}
        if "range" in entry:
            data["range"] = [float(limit) for limit in entry["range"]]
        self._warn(data)
        return [Declaration(self._node.id, data["input"], type_, data)]

    def _type(self) -> InputType:
        """Return the declared type of the input, or the one that fits."""
        entry, inputs = self._entry, {declared.id: declared for declared in self.options.inputs}
        name, keys = entry.get("input"), entry.get("map")
        if not isinstance(name, str):
            self.report("B404.input")
        elif name not in inputs:
            hint = did_you_mean(name, inputs) or "add it to EDDIInputs"
            self.report("B404.unknown_input", "input", hint=hint, name=name)
        elif entry.get("missing") == "default" and inputs[name].default is None:
            self.report("B404.no_default", "missing", input=name)
        type_ = inputs[name].type if isinstance(name, str) and name in inputs else None
        if type_ == "bool" and "bins" in entry:
            self.report("B404.bool_bins", "bins")
        if type_ is not None or not isinstance(keys, Mapping):
            return type_ or "float"
        fitting: list[InputType] = ["bool", "int", "str"]
        return next(of for of in fitting if None not in [_value_of(key, of) for key in keys])

    def _check_state(self, state: object, *path: str | int) -> None:
        states = self._node.states
        if not isinstance(state, str):
            self.report("B404.state_name", *path, state=state)
        elif state not in states:
            hint = did_you_mean(state, states) or f"its states: {', '.join(states)}"
            self.report("B303.bin_state", *path, hint=hint, state=state)

    def _order(self) -> list[str]:
        order = self._entry.get("order")
        if order is None:
            return list(self._node.states)
        if not isinstance(order, list) or not all(isinstance(state, str) for state in order):
            self.report("B404.order", "order")
            return list(self._node.states)
        for number, state in enumerate(order):
            self._check_state(state, "order", number)
        if len({*order}) < len(order):
            self.report("B404.order_twice", "order")
        return order

    def _bins(self, order: Sequence[str]) -> list[float]:
        edges = self._entry["bins"]
        if not isinstance(edges, list) or not all(map(is_number, edges)):
            self.report("B404.bins", "bins")
            return []
        if len(edges) != len(order) - 1:
            count, states = len(edges), len(order)
            self.report("B401.edge_count", "bins", edges=count, bins=count + 1, states=states)
        for number, edge in enumerate(edges):
            if not math.isfinite(edge) or (number and edge <= edges[number - 1]):
                self.report("B401.edge_order", "bins", number)
                break
        return [float(edge) for edge in edges]

    def _map(self, type_: InputType) -> list[list[Any]]:
        states = self._entry["map"]
        if not isinstance(states, Mapping) or not states:
            self.report("B404.map", "map")
            return []
        for key, state in states.items():
            self._check_state(state, "map", key)
            if _value_of(key, type_) is None:
                self.report("B404.map_type", "map", key, key=key, type=type_)
        return [[_value_of(key, type_), state] for key, state in states.items()]

    def _sentinel(self) -> list[Any]:
        pairs = self._entry.get("sentinel")
        if pairs is not None and not isinstance(pairs, list):
            self.report("B404.sentinel", "sentinel")
            return []
        for number, pair in enumerate(pairs or ()):
            match pair:
                case [value, state] if isinstance(value, bool | str) or _is_finite(value):
                    if state != UNOBSERVED:
                        self._check_state(state, "sentinel", number)
                case _:
                    self.report("B404.sentinel", "sentinel", number)
        return pairs or []

    def _warn(self, data: Mapping[str, Any]) -> None:
        """Warn of a bin that is passed over or never left, and of states that no value gives."""
        edges, band = list(data.get("bins", ())), data.get("hysteresis", 0.0)
        if "range" in data:
            scale, offset = data.get("scale", 1.0), data.get("offset", 0.0)
            low, high = sorted(limit * scale + offset for limit in data["range"])
            edges = [low, *(edge for edge in edges if low < edge < high), high]
        width = min((b - a for a, b in pairwise(edges)), default=math.inf)
        if 0 < width <= band:
            self.report("B404.wide_hysteresis", "hysteresis", hysteresis=band, width=width)
        reachable = [*data.get("order", ()), *(state for _, state in data.get("map", ()))]
        reachable += [state for _, state in data.get("sentinel", ())]
        lacking = [state for state in self._node.states if state not in reachable]
        if lacking:
            place = self.options.place(*self.path)
            self.problems.append(
                problem("B405", place, node=self._node.id, states=", ".join(lacking))
            )


def _value_of(key: str, type_: InputType) -> bool | float | str | None:
    """Return the value that a key of a map means, by the type of the input."""
    try:
        match type_:
            case "bool":
                return _TRUTH.get(key)
            case "int":
                return int(key)
            case "float":
                return float(key)
    except ValueError:
        return None
    return key
