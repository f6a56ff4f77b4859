"""Fault trees of Open-PSA files ("Open-PSA Model Exchange Format" 2.0d): gates, events, numbers."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from eddi_scaffold.common.problems import EddiError, Place, Problem, SimilarNames, problem
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, line_of, select
from eddi_scaffold.kinds.reliability import system

_CONNECTIVES = {"and": "AND", "or": "OR", "xor": "XOR", "not": "NOT", "atleast": "VOTE"}
_NEGATED = {"nand": "AND", "nor": "OR", "iff": "XOR"}
_REFERENCES = ("event", "gate", "basic-event", "house-event", "constant")
_EVENTS = ("define-gate", "define-basic-event", "define-house-event")
_CONTAINERS = ("define-fault-tree", "define-component")
_COMMON_CAUSES = (
    "make each member an `or` of its own event and of one that all members share: with a "
    "beta-factor, these have (1 - beta) and beta of the rate or probability"
)
_SUBSTITUTIONS = "write what they do as gates: an exclusion is the top `and` `not` the hypothesis"
_INCLUDE = "put its definitions in place of this element: a package remembers one model file"
_CHANGES = {
    "define-CCF-group": ("common causes", _COMMON_CAUSES),
    "define-substitution": ("substitutions", _SUBSTITUTIONS),
    "include": ("other files", _INCLUDE),
}
"""What changes the probability of a tree, so that it must not be left out: subject, and hint."""
_ONE_FILE = "the definitions of a model that is in several files must be in one"
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
_Path = tuple[str, ...]  # Names of the containers around something


class _Definition(NamedTuple):
    element: Element
    path: _Path


def read_open_psa(
    root: Element, file: str, stem: str
) -> tuple[list[system.ReliabilitySystem], list[Problem]]:
    """Read every top event of a parsed file: one system for each gate that no other one uses."""
    reader = _Reader(file, stem)
    reader.declare(root, (), private=False)
    reader.define()
    systems = [] if reader.problems else list(reader.systems())
    return systems, [*dict.fromkeys(reader.problems), *reader.doubts.values()]


def _name(element: Element) -> str:
    return (element.get("name") or "").strip()


class _Names:
    """Names of one sort: public ones are known everywhere, the others by their path."""

    def __init__(self) -> None:
        self.defined: dict[str, _Definition] = {}
        self._keys: dict[str, str] = {}

    def add(self, name: str, path: _Path, element: Element, *, private: bool) -> bool:
        """Return whether this is the first of its name."""
        full = ".".join([*path, name])
        key = full if private else name
        self._keys.setdefault(full, key)
        return self.defined.setdefault(key, _Definition(element, path)).element is element

    def find(self, name: str, path: _Path) -> str | None:
        """Return the key of what a name means within a container."""
        for length in range(len(path), 0, -1):
            key = self._keys.get(".".join([*path[:length], name]))
            if key is not None:
                return key
        return name if name in self.defined else self._keys.get(name)


def _parts(element: Element) -> list[Element]:
    return [
        part for part in select(element, "*") if feature_of(part) not in ("label", "attributes")
    ]


class _Reader:
    """Reads one file; ``doubts`` are warnings, each once for the file or a type of element."""

    def __init__(self, file: str, stem: str) -> None:
        self.file, self.stem = file, stem
        self.names, self.parameters = _Names(), _Names()
        self.values: dict[Element, float] = {}
        self.problems: list[Problem] = []
        self.doubts: dict[str, Problem] = {}
        self.gates: dict[str, system.Gate] = {}
        self.events: dict[str, system.BasicEvent] = {}

    def _place(self, element: Element) -> Place:
        return Place(self.file, line_of(element))

    def _fault(
        self, case: str, element: Element, /, hint: str | None = None, **fields: Any
    ) -> EddiError:
        return EddiError(problem(case, self._place(element), hint=hint, **fields))

    # names

    def declare(self, container: Element, path: _Path, *, private: bool) -> None:
        for element in select(container, "*"):
            kind, name, role = feature_of(element), _name(element), element.get("role")
            is_private = role == "private" or (private and not role)
            fault = None
            if kind == "model-data":
                self.declare(element, path, private=private)
            elif kind in _CHANGES:
                contents, hint = _CHANGES[kind]
                named = name or (element.get("file") or "").strip()
                fields = {"named": f" {named!r}" if named else "", "contents": contents}
                fault = self._fault("R017.content", element, hint=hint, type=kind, **fields)
            elif kind not in (*_EVENTS, *_CONTAINERS, "define-parameter"):
                if kind not in ("label", "attributes"):
                    doubt = problem("R018.element", self._place(element), type=kind)
                    self.doubts.setdefault(f"{'.'.join(path)} {kind}", doubt)
            elif len(name.split()) != 1:
                fault = self._fault("R001.name", element, name=name, type=kind)
            elif kind in _CONTAINERS:
                self.declare(element, (*path, name), private=is_private)
            else:
                names = self.parameters if kind == "define-parameter" else self.names
                if not names.add(name, path, element, private=is_private):
                    fault = self._fault("R001.duplicate", element, name=name)
            self.problems += fault.problems if fault else ()

    def define(self) -> None:
        # what was refused may define what others name
        is_complete = all(problem.code != "R017" for problem in self.problems)
        self.similar = SimilarNames(self.names.defined)
        for key, (element, path) in self.names.defined.items():
            is_gate = feature_of(element) == "define-gate"
            try:
                if is_gate:
                    formulas = _parts(element)
                    if len(formulas) != 1:
                        raise self._fault("R017.formulas", element, gate=key, number=len(formulas))
                    self._formula(key, formulas[0], path, 0)
                else:
                    law = self._law(element, path, key)
                    self.events[key] = system.BasicEvent(key, law, place=self._place(element))
            except EddiError as fault:
                self.problems += [p for p in fault.problems if is_complete or p.code != "R001"]

    # formulas

    def _formula(self, key: str, element: Element, path: _Path, depth: int) -> None:
        """Read a formula as the gate of this key, and those within it as gates of their own."""
        kind, place = feature_of(element), self._place(element)
        if depth > _DEEPEST:
            raise self._fault("R017.depth", element)
        if kind not in {*_REFERENCES, *_CONNECTIVES, *_NEGATED, "imply"}:
            raise self._fault("R017.formula", element, type=kind)
        below = []
        for number, part in enumerate([element] if kind in _REFERENCES else _parts(element), 1):
            if feature_of(part) in _REFERENCES:
                below.append(self._reference(part, path))
            else:
                below.append(f"{key} {number}")
                self._formula(below[-1], part, path, depth + 1)
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

    def _reference(self, element: Element, path: _Path) -> str:
        if feature_of(element) == "constant":
            is_true = element.get("value") == "true"
            constant = f"constant {str(is_true).lower()}"
            law, place = system.Law("fixed", (float(is_true),)), self._place(element)
            self.events.setdefault(constant, system.BasicEvent(constant, law, place=place))
            return constant
        key = self.names.find(_name(element), path)
        if key is None:
            hint = self.similar.hint(_name(element)) or _ONE_FILE
            raise self._fault("R001.unknown_gate", element, hint=hint, name=_name(element))
        return key

    def systems(self) -> Iterator[system.ReliabilitySystem]:
        used = {below for gate in self.gates.values() for below in gate.of}
        gates = [key for key in self.names.defined if key in self.gates]
        tops: dict[str, list[str]] = {}
        for key in [key for key in gates if key not in used] or gates[:1]:  # of a cycle: check says
            path = self.names.defined[key].path
            tops.setdefault(path[0] if path else self.stem, []).append(key)
        below = {key: gate.of for key, gate in self.gates.items()}
        for tree, keys in tops.items():
            for top in keys:
                name = tree if len(keys) == 1 else f"{tree}/{top}"
                reached, cycle = system.order(top, below)
                ids = [*self.gates, *self.events] if cycle else reached[::-1]
                content = system.FaultTree(
                    top,
                    {id_: self.events[id_] for id_ in ids if id_ in self.events},
                    {id_: self.gates[id_] for id_ in ids if id_ in self.gates},
                )
                place = self.gates[top].place
                component = system.ComponentModel(name, "fault_tree", content, place=place)
                yield system.ReliabilitySystem({name: component}, name, place=place)

    # numbers

    def _law(self, element: Element, path: _Path, name: str) -> system.Law | None:
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
                missions = math.prod(self._number(other, path, least=0.0) for other in others)
        if kind == "exponential" and len(values) == 2:
            rate = self._number(values[0], path, least=0.0)
            if missions is not None:
                self._warn_of_unit(values[0], path, "1/h")
                return system.Law("exponential", (rate * missions,))
            time = self._number(values[1], path, least=0.0)
            return system.Law("fixed", (-math.expm1(-rate * time),))
        if kind == "weibull" and len(values) == 4 and missions == 1.0:
            scale, shape, start = (self._number(value, path) for value in values[:3])
            if scale <= 0.0 or not 1e-6 <= shape <= 1e6 or start != 0.0:
                raise self._fault("R002.weibull", parts[0], name=name)
            self._warn_of_unit(values[0], path, "h")
            return system.Law("weibull", (scale, shape))
        probability = self._number(parts[0], path)
        if not 0.0 <= probability <= 1.0:
            raise self._fault("R002.probability", parts[0], name=name, probability=probability)
        return system.Law("fixed", (probability,))

    def _parameter(self, element: Element, path: _Path) -> _Definition:
        key = self.parameters.find(_name(element), path)
        if key is None:
            raise self._fault("R001.parameter", element, name=_name(element))
        return self.parameters.defined[key]

    def _warn_of_unit(self, element: Element, path: _Path, assumed: str) -> None:
        is_parameter = feature_of(element) == "parameter"
        if not is_parameter or self._parameter(element, path).element.get("unit") not in _UNITS:
            doubt = problem("R004.no_unit_in_file", self._place(element), assumed=assumed)
            self.doubts.setdefault("unit", doubt)

    def _number(
        self, element: Element, path: _Path, depth: int = 0, least: float = -math.inf
    ) -> float:
        """Return the value of an expression, in hours and 1/h where it has a unit."""
        kind = feature_of(element)
        if depth > _DEEPEST:
            raise self._fault("R012.expressions", element)
        if kind == "parameter":
            defined, inside = self._parameter(element, path)
            if defined not in self.values:
                parts, unit = _parts(defined), (defined.get("unit") or "").strip()
                if len(parts) != 1:
                    raise self._fault("R017.parameter", defined, number=len(parts))
                if unit not in _UNITS and unit not in _NO_UNITS:
                    known = ", ".join([*_UNITS, *_NO_UNITS[1:]])
                    raise self._fault("R004.unit", defined, unit=unit, known=known)
                number = self._number(parts[0], inside, depth + 1)
                self.values[defined] = number * _UNITS.get(unit, 1.0)
            value = self.values[defined]
        elif kind in ("float", "int"):
            text = (element.get("value") or "").strip()
            value = float(text) if _NUMBER.fullmatch(text) else math.inf
            if not math.isfinite(value):
                raise self._fault("R002.number", element, value=text)
        elif kind in _OPERATIONS:
            if kind.endswith("-deviate"):
                self.doubts.setdefault("deviate", problem("R018.deviates", self._place(element)))
            values = [self._number(part, path, depth + 1) for part in _parts(element)]
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
