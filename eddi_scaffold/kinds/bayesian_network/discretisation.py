"""``discretisation:`` of a configuration: how values of inputs become states of nodes."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias, TypeGuard

from eddi_runtime.bayesian_network import readers

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, has_errors, problem
from eddi_scaffold.kinds import InputType, Options
from eddi_scaffold.kinds.bayesian_network.network import Network, Node

UNOBSERVED = "unobserved"
_TRUTH = {"true": True, "false": False}  # Keys of maps are texts; those that mean a bool
Form: TypeAlias = Mapping[str, tuple[Callable[[Any], bool], str]]
"""Key -> whether a value can be meant, and what is expected."""


class EntryReader:
    """Reads keys of a configuration, and collects what is wrong with them."""

    def __init__(
        self,
        options: Options,
        *path: str | int,  # of the entry, below `Model:`
        entry: Mapping[str, Any] | None = None,  # its keys
        subject: str = "",  # what each message begins with, if anything
    ) -> None:
        self.options, self.path, self.subject = options, path, subject
        self.entry = entry or {}
        self.problems: list[Problem] = []

    def place(self, *path: str | int) -> Place:
        """Return the place of the entry, or of a key in it."""
        return self.options.place(*self.path, *path)

    def report(
        self, case: str, /, *path: str | int, hint: str | None = None, **fields: object
    ) -> None:
        """Report a problem with a key of the entry, or with the entry itself."""
        fault = problem(case, self.place(*path), hint=hint, **fields)
        self.problems.append(fault.about(self.subject) if self.subject else fault)

    def values(self, form: Form, *required: str) -> dict[str, Any]:
        """Return the values that can be meant; report all others, and keys that do not exist."""
        values = {}
        for key, value in {**dict.fromkeys(required), **self.entry}.items():
            is_meant, expected = form.get(key, (None, ""))
            if is_meant is None:
                hint = did_you_mean(key, form) or f"known keys: {', '.join(form)}"
                self.report("B404.unknown_key", key, hint=hint, key=key)
            elif is_meant(value):
                values[key] = value
            else:
                self.report("B404.value", key, key=key, expected=expected)
        return values


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


def _is_sentinel(value: object) -> bool:
    match value:
        case [special, _]:
            return isinstance(special, bool | str) or _is_finite(special)
    return False


def _all(is_meant: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, list) and all(map(is_meant, value))


_FORM: Form = {
    "input": (lambda _: True, ""),
    "bins": (_all(is_number), "a list of numbers, the edges"),
    "closed": (lambda value: value in ("right", "left"), "right or left"),
    "order": (_all(lambda state: isinstance(state, str)), "a list of states, yes and no in quotes"),
    "scale": (lambda value: _is_finite(value) and value != 0, "a finite number, and not 0"),
    "offset": (_is_finite, "a finite number"),
    "range": (_is_range, "two ascending numbers"),
    "hysteresis": (lambda value: _is_finite(value) and value >= 0, "a finite number, 0 or more"),
    "allow_inf": (lambda value: isinstance(value, bool), "true or false"),
    "map": (lambda value: isinstance(value, Mapping) and value != {}, "a map: value -> state"),
    "sentinel": (_all(_is_sentinel), "a list of pairs [value, state]"),
    "out_of_range": (lambda value: value in (UNOBSERVED, "clamp"), "unobserved or clamp"),
    "missing": (
        lambda value: value in (UNOBSERVED, "prior", "default", "hold"),
        "unobserved, prior, default or hold",
    ),
}
_OF_BINS = ("closed", "order", "scale", "offset", "range", "hysteresis", "allow_inf")


@dataclass(frozen=True)
class Declaration:
    """One checked entry."""

    node: str
    input: str
    type: InputType
    reader: readers.Declaration  # how these become states, for the runtime

    @property
    def values_of_map(self) -> list[object] | None:
        """The values that give a state; ``None`` where bins do."""
        of = self.reader
        return None if of.edges is not None else [v for v, k in of.special if k != of.missing]


def read_discretisation(
    network: Network, options: Options
) -> tuple[list[Declaration], list[Problem]]:
    """Check the section ``discretisation`` (B303, B401 to B405)."""
    section, names = options.values.get("discretisation"), network.names()
    reader = EntryReader(options, "discretisation")
    declarations: list[Declaration] = []
    if not isinstance(section, Mapping | None):
        reader.report("B404.declarations")
        section = None
    # sorted, as the answers of a package keep them: their order decides nothing
    for name, entry in sorted((section or {}).items(), key=str):
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
        super().__init__(options, "discretisation", node.id, entry=entry, subject=subject)
        self._node = node

    def read(self) -> list[Declaration]:
        """Return the declaration; nothing after an error."""
        entry, node, values = self.entry, self._node, self.values(_FORM)
        if ("bins" in entry) == ("map" in entry):
            self.report("B404.bins_or_map")
        for key in _OF_BINS if "map" in entry else ():
            if key in entry:
                self.report("B404.useless_with_map", key, key=key)
        type_, states = self._type(), values.get("map", {})
        for key, state in states.items():
            self._check_state(state, "map", key)
            if _value_of(key, type_) is None:
                self.report("B404.map_type", "map", key, key=key, type=type_)
        for number, state in enumerate(values.get("order", ())):
            self._check_state(state, "order", number)
        for number, (_, state) in enumerate(values.get("sentinel", ())):
            if state != UNOBSERVED:
                self._check_state(state, "sentinel", number)
        edges, order = values.get("bins", ()), values.get("order", node.states)
        if "bins" in values and len({*order}) < len(order):
            self.report("B404.order_twice", "order")
        if "bins" in values and len(edges) != len(order) - 1:
            count, number = len(edges), len(order)
            self.report("B401.edge_count", "bins", edges=count, bins=count + 1, states=number)
        for number, edge in enumerate(edges):
            if not math.isfinite(edge) or (number and edge <= edges[number - 1]):
                self.report("B401.edge_order", "bins", number)
                break
        if has_errors(self.problems):
            return []
        pairs = [(_value_of(key, type_), state) for key, state in states.items()]
        reader = reader_of({**values, "map": pairs}, node.states)
        self._warn(reader)
        return [Declaration(node.id, values["input"], type_, reader)]

    def _type(self) -> InputType:
        """Return the declared type of the input, or the one that fits."""
        entry, inputs = self.entry, {declared.id: declared for declared in self.options.inputs}
        name, keys = entry.get("input"), entry.get("map")
        declared = inputs.get(name) if isinstance(name, str) else None
        if not isinstance(name, str):
            self.report("B404.input")
        elif declared is None:
            hint = did_you_mean(name, inputs) or "add it to EDDIInputs"
            self.report("B404.unknown_input", "input", hint=hint, name=name)
        elif entry.get("missing") == "default" and declared.default is None:
            self.report("B404.no_default", "missing", input=name)
        type_ = declared.type if declared else None
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

    def _warn(self, reader: readers.Declaration) -> None:
        """Warn of a bin that is passed over or never left, and of states that no value gives."""
        low, high = sorted(limit * reader.scale + reader.offset for limit in reader.limits)
        edges = [low, *(edge for edge in reader.edges or () if low < edge < high), high]
        width, band = min(b - a for a, b in pairwise(edges)), reader.hysteresis
        if 0 < width <= band:
            self.report("B404.wide_hysteresis", "hysteresis", hysteresis=band, width=width)
        reachable = {state for _, state in reader.special}
        reachable |= set() if reader.edges is None else {*reader.order}
        lacking = [state for k, state in enumerate(self._node.states) if k not in reachable]
        if lacking:
            fields = {"node": self._node.id, "states": ", ".join(lacking)}
            self.problems.append(problem("B405", self.place(), **fields))


def reader_of(values: Mapping[str, Any], states: Sequence[str]) -> readers.Declaration:
    """Return what the runtime takes of the keys of an entry; ``map`` has pairs."""
    numbers = {state: k for k, state in enumerate(states)}
    special = [(value, numbers[state]) for value, state in values.get("map", ())]
    for value, state in values.get("sentinel", ()):
        # A raw -1 may come as a whole number or as -1.0, but True is not 1.
        kinds = [type(value)] if isinstance(value, bool | str) else [int, float]
        twins = [twin for twin in (kind(value) for kind in kinds) if twin == value]
        special += [(twin, numbers.get(state, len(states))) for twin in twins]
    scale, offset = float(values.get("scale", 1.0)), float(values.get("offset", 0.0))
    low, high = map(float, values.get("range", (-math.inf, math.inf)))
    return readers.Declaration(
        missing=len(states),
        edges=tuple(map(float, values["bins"])) if "bins" in values else None,
        order=tuple(numbers[state] for state in values.get("order", states)),
        closed_right=values.get("closed") != "left",
        scaled=(scale, offset) != (1.0, 0.0),
        scale=scale,
        offset=offset,
        limits=(low, high),
        clamp=values.get("out_of_range") == "clamp",
        allow_inf=values.get("allow_inf", False),
        hysteresis=float(values.get("hysteresis", 0.0)),
        policy=values.get("missing", UNOBSERVED),
        special=tuple(special),
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
