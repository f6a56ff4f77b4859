"""Fault trees of Open-PSA files ("Open-PSA Model Exchange Format" 2.0d): gates, events, numbers."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, line_of, select
from eddi_scaffold.kinds.reliability import system
from eddi_scaffold.kinds.reliability.fault_tree import order

_CONNECTIVES = {"and": "AND", "or": "OR", "xor": "XOR", "not": "NOT", "atleast": "VOTE"}
_NEGATED = {"nand": "AND", "nor": "OR", "iff": "XOR"}
_REFERENCES = ("event", "gate", "basic-event", "house-event", "constant")
_EVENTS = ("define-gate", "define-basic-event", "define-house-event")
_CONTAINERS = ("define-fault-tree", "define-component")
_CHANGES = {
    "define-CCF-group": "R017.common_causes",
    "define-substitution": "R017.substitution",
    "include": "R017.include",
}
"""What changes the probability of a tree, so that it must not be left out."""
_UNITS = {"hours-1": 1.0, "years-1": 1.0 / 8760.0, "fit": 1e-9, "hours": 1.0, "years": 8760.0}
_NO_UNITS = ("", "bool", "int", "float", "demands")
_OPERATIONS: dict[str, Callable[[Sequence[float]], float]] = {
    "add": math.fsum,
    "sub": lambda of: of[0] - math.fsum(of[1:]),
    "mul": math.prod,
    "div": lambda of: of[0] / math.prod(of[1:]),
    "neg": lambda of: operator.neg(*of),
    "exp": lambda of: math.exp(*of),
    "pow": lambda of: math.pow(*of),
    # deviates: their means
    "lognormal-deviate": lambda of: of[0] if len(of) == 3 else math.exp(of[0] + of[1] ** 2 / 2.0),
    "normal-deviate": lambda of: of[0],
    "uniform-deviate": lambda of: (of[0] + of[1]) / 2.0,
    "gamma-deviate": lambda of: of[0] * of[1],
    "beta-deviate": lambda of: of[0] / (of[0] + of[1]),
}
_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
_DEEPEST = 100


def read_open_psa(
    root: Element, file: str, stem: str
) -> tuple[list[system.ReliabilitySystem], list[Problem]]:
    """Read every top event of a parsed file: one system for each gate that no other one uses."""
    reader = _Reader(file)
    reader.declare(root, stem)
    reader.define()
    systems = [] if reader.problems else list(reader.systems())
    return systems, [*dict.fromkeys(reader.problems), *reader.doubts.values()]


def _name(element: Element) -> str:
    return (element.get("name") or "").strip()


def _parts(element: Element) -> list[Element]:
    return [
        part for part in select(element, "*") if feature_of(part) not in ("label", "attributes")
    ]


class _Reader:
    """Reads one file; ``doubts`` are warnings, each once for the file or a type of element."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.names: dict[str, Element] = {}  # definitions of gates and events
        self.trees: dict[str, str] = {}  # name -> the outermost container around it
        self.parameters: dict[str, Element] = {}
        self.values: dict[str, float] = {}  # of parameters
        self.problems: list[Problem] = []
        self.doubts: dict[str, Problem] = {}
        self.gates: dict[str, system.Gate] = {}
        self.events: dict[str, system.BasicEvent] = {}

    def _place(self, element: Element) -> Place:
        return Place(self.file, line_of(element))

    def _fault(self, case: str, element: Element, /, **fields: Any) -> EddiError:
        return EddiError(problem(case, self._place(element), **fields))

    def declare(self, container: Element, tree: str) -> None:
        """Note the definitions in a container, whose names are those of the file."""
        for element in select(container, "*"):
            kind, name = feature_of(element), _name(element)
            fault = None
            if kind == "model-data":
                self.declare(element, tree)
            elif kind in _CHANGES:
                named = name or (element.get("file") or "").strip()
                named = f" {named!r}" if named else ""
                fault = self._fault(_CHANGES[kind], element, type=kind, named=named)
            elif kind not in (*_EVENTS, *_CONTAINERS, "define-parameter"):
                if kind not in ("label", "attributes"):
                    doubt = problem("R018.element", self._place(element), type=kind)
                    self.doubts.setdefault(kind, doubt)
            elif len(name.split()) != 1:
                fault = self._fault("R001.name", element, name=name, type=kind)
            elif kind in _CONTAINERS:
                is_inner = feature_of(container) in _CONTAINERS
                self.declare(element, tree if is_inner else name)
            else:
                names = self.parameters if kind == "define-parameter" else self.names
                if names.setdefault(name, element) is not element:
                    fault = self._fault("R001.duplicate", element, name=name)
                self.trees.setdefault(name, tree)
            self.problems += fault.problems if fault else ()

    def define(self) -> None:
        # what was refused may define what others name
        is_complete = all(problem.code != "R017" for problem in self.problems)
        for key, element in self.names.items():
            formulas = _parts(element)
            try:
                if feature_of(element) == "define-gate":
                    if len(formulas) != 1:
                        raise self._fault("R017.formulas", element, gate=key, number=len(formulas))
                    self._formula(key, formulas[0], 0)
                else:
                    law = self._law(element, key)
                    self.events[key] = system.BasicEvent(key, law, place=self._place(element))
            except EddiError as fault:
                self.problems += [p for p in fault.problems if is_complete or p.code != "R001"]

    def _formula(self, key: str, element: Element, depth: int) -> None:
        """Read a formula as the gate of this key, and those within it as gates of their own."""
        kind, place = feature_of(element), self._place(element)
        if depth > _DEEPEST:
            raise self._fault("R017.depth", element)
        if kind not in {*_REFERENCES, *_CONNECTIVES, *_NEGATED, "imply"}:
            raise self._fault("R017.formula", element, type=kind)
        below = []
        for number, part in enumerate([element] if kind in _REFERENCES else _parts(element), 1):
            if feature_of(part) in _REFERENCES:
                below.append(self._reference(part))
            else:
                below.append(f"{key} {number}")
                self._formula(below[-1], part, depth + 1)
        if kind == "imply" and below:
            self.gates[f"{key} not"] = system.Gate(f"{key} not", "NOT", (below[0],), place=place)
            below[0] = f"{key} not"
        if kind in _NEGATED:
            self.gates[key] = system.Gate(key, "NOT", (f"{key} not",), place=place)
            key = f"{key} not"
        type_ = _CONNECTIVES.get(kind) or _NEGATED.get(kind) or "OR"
        least = (element.get("min") or "").strip()
        k = int(least) if type_ == "VOTE" and least.isdecimal() and len(least) < 10 else None
        self.gates[key] = system.Gate(key, type_, tuple(below), k, place)

    def _reference(self, element: Element) -> str:
        if feature_of(element) == "constant":
            is_true = element.get("value") == "true"
            constant = f"constant {str(is_true).lower()}"
            law, place = system.Law("fixed", (float(is_true),)), self._place(element)
            self.events.setdefault(constant, system.BasicEvent(constant, law, place=place))
            return constant
        if _name(element) not in self.names:
            raise self._fault("R001.unknown_gate", element, name=_name(element))
        return _name(element)

    def systems(self) -> Iterator[system.ReliabilitySystem]:
        used = {below for gate in self.gates.values() for below in gate.of}
        gates = [key for key in self.names if key in self.gates]
        tops: dict[str, list[str]] = {}
        for key in [key for key in gates if key not in used] or gates[:1]:  # of a cycle: check says
            tops.setdefault(self.trees[key], []).append(key)
        below = {key: gate.of for key, gate in self.gates.items()}
        for tree, keys in tops.items():
            for top in keys:
                name = tree if len(keys) == 1 else f"{tree}/{top}"
                reached, cycle = order(top, below)
                ids = [*self.gates, *self.events] if cycle else reached[::-1]
                content = system.FaultTree(
                    top,
                    {id_: self.events[id_] for id_ in ids if id_ in self.events},
                    {id_: self.gates[id_] for id_ in ids if id_ in self.gates},
                )
                place = self.gates[top].place
                component = system.ComponentModel(name, "fault_tree", content, place=place)
                yield system.ReliabilitySystem({name: component}, name, place=place)

    def _law(self, element: Element, name: str) -> system.Law | None:
        parts = _parts(element)
        if len(parts) > 1:
            raise self._fault("R017.event", parts[1], name=name, number=len(parts))
        if feature_of(element) == "define-house-event":
            is_true = any(feature_of(p) == "constant" and p.get("value") == "true" for p in parts)
            return system.Law("fixed", (float(is_true),))
        if not parts:
            return None
        kind, values = feature_of(parts[0]).lower(), _parts(parts[0])
        missions = None  # how many mission times the last value is
        if values:
            factors = _parts(values[-1]) if feature_of(values[-1]) == "mul" else [values[-1]]
            others = [factor for factor in factors if feature_of(factor) != "system-mission-time"]
            if len(others) == len(factors) - 1:
                missions = math.prod(self._number(other, least=0.0) for other in others)
        if kind == "exponential" and len(values) == 2:
            rate = self._number(values[0], least=0.0)
            if missions is not None:
                self._warn_of_unit(values[0], "1/h")
                return system.Law("exponential", (rate * missions,))
            time = self._number(values[1], least=0.0)
            return system.Law("fixed", (-math.expm1(-rate * time),))
        if kind == "weibull" and len(values) == 4 and missions == 1.0:
            scale, shape, start = (self._number(value) for value in values[:3])
            if scale <= 0.0 or not 1e-6 <= shape <= 1e6 or start != 0.0:
                raise self._fault("R002.weibull", parts[0], name=name)
            self._warn_of_unit(values[0], "h")
            return system.Law("weibull", (scale, shape))
        probability = self._number(parts[0])
        if not 0.0 <= probability <= 1.0:
            raise self._fault("R002.probability", parts[0], name=name, probability=probability)
        return system.Law("fixed", (probability,))

    def _parameter(self, element: Element) -> Element:
        if _name(element) not in self.parameters:
            raise self._fault("R001.parameter", element, name=_name(element))
        return self.parameters[_name(element)]

    def _warn_of_unit(self, element: Element, assumed: str) -> None:
        is_parameter = feature_of(element) == "parameter"
        if not is_parameter or self._parameter(element).get("unit") not in _UNITS:
            doubt = problem("R004.no_unit_in_file", self._place(element), assumed=assumed)
            self.doubts.setdefault("unit", doubt)

    def _number(self, element: Element, depth: int = 0, least: float = -math.inf) -> float:
        """Return the value of an expression, in hours and 1/h where it has a unit."""
        kind = feature_of(element)
        if depth > _DEEPEST:
            raise self._fault("R012.expressions", element)
        if kind == "parameter":
            name, defined = _name(element), self._parameter(element)
            if name not in self.values:
                parts, unit = _parts(defined), (defined.get("unit") or "").strip()
                if len(parts) != 1:
                    raise self._fault("R017.parameter", defined, number=len(parts))
                if unit not in _UNITS and unit not in _NO_UNITS:
                    known = ", ".join([*_UNITS, *_NO_UNITS[1:]])
                    raise self._fault("R004.unit", defined, unit=unit, known=known)
                self.values[name] = self._number(parts[0], depth + 1) * _UNITS.get(unit, 1.0)
            value = self.values[name]
        elif kind in ("float", "int"):
            text = (element.get("value") or "").strip()
            value = float(text) if _NUMBER.fullmatch(text) else math.inf
            if not math.isfinite(value):
                raise self._fault("R002.number", element, value=text)
        elif kind in _OPERATIONS:
            if kind.endswith("-deviate"):
                self.doubts.setdefault("deviate", problem("R018.deviates", self._place(element)))
            values = [self._number(part, depth + 1) for part in _parts(element)]
            try:
                value = _OPERATIONS[kind](values)
            except (ArithmeticError, ValueError, IndexError, TypeError):
                value = math.nan
            if not math.isfinite(value):
                raise self._fault("R002.no_number", element, expression=kind)
        else:
            raise self._fault("R017.expression", element, type=kind)
        if value < least:
            raise self._fault("R002.negative", element, value=value)
        return value
