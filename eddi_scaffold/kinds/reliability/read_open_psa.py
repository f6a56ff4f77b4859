"""Fault trees of Open-PSA files ("Open-PSA Model Exchange Format" 2.0d): gates, events, numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.common.problems import EddiError, Problem, SimilarNames, problem
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, select
from eddi_scaffold.kinds.reliability.open_psa_numbers import Numbers, arguments, place_of
from eddi_scaffold.kinds.reliability.system import (
    BasicEvent,
    ComponentModel,
    FaultTree,
    Gate,
    Law,
    ReliabilitySystem,
    order,
)

_CONNECTIVES = {"and": "AND", "or": "OR", "xor": "XOR", "not": "NOT", "atleast": "VOTE"}
_NEGATED = {"nand": "AND", "nor": "OR", "iff": "XOR"}
_REFERENCES = ("event", "gate", "basic-event", "house-event")
_EVENTS = ("define-gate", "define-basic-event", "define-house-event")
_CONTAINERS = ("define-fault-tree", "define-component")
_CHANGES = {
    "define-CCF-group": (
        "common causes",
        (
            "make each member an `or` of its own event and of one that all members share: with a "
            "beta-factor, these have (1 - beta) and beta of the rate or probability"
        ),
    ),
    "define-substitution": (
        "substitutions",
        (
            "write as gates what they make of the tree: for an exclusion, `and` the top with `not` "
            "of the hypothesis"
        ),
    ),
    "include": (
        "other files",
        "put its definitions in place of this element: a package remembers one model file",
    ),
}
"""What changes the probability of a tree, so that it must not be left out: what it is about, and
what to write instead."""
_ONE_FILE = "the definitions of a model that is in several files must be in one"
_DEEPEST = 100
_FALSE, _TRUE = "constant false", "constant true"


@dataclass(frozen=True)
class _Defined:
    """A definition, and the names of the containers around it."""

    element: Element
    path: tuple[str, ...]


def read_mef(root: Element, file: str, stem: str) -> tuple[list[ReliabilitySystem], list[Problem]]:
    """Read every top event of a parsed file: one system for each gate that no other one uses."""
    reader = _Reader(file, stem)
    reader.declare(root, (), private=False)
    reader.define(is_whole="R017" not in {problem.code for problem in reader.problems})
    systems = [] if reader.problems else list(reader.systems())
    return systems, [*dict.fromkeys(reader.problems), *reader.numbers.doubts, *reader.doubts]


class _Names:
    """Names of one sort: public ones are known everywhere, the others by their path."""

    def __init__(self) -> None:
        self.defined: dict[str, _Defined] = {}
        self._keys: dict[str, str] = {}

    def add(self, name: str, path: tuple[str, ...], element: Element, *, private: bool) -> bool:
        """Return whether this is the first of its name."""
        full = ".".join([*path, name])
        key = full if private else name
        if key in self.defined:
            return False
        self.defined[key] = _Defined(element, path)
        self._keys.setdefault(full, key)
        return True

    def find(self, name: str, path: tuple[str, ...]) -> str | None:
        """Return the key of what a name means within a container."""
        for length in range(len(path), 0, -1):
            key = self._keys.get(".".join([*path[:length], name]))
            if key is not None:
                return key
        return name if name in self.defined else self._keys.get(name)


class _Reader:
    def __init__(self, file: str, stem: str) -> None:
        self.file, self.stem = file, stem
        self.names, self.parameters = _Names(), _Names()
        self.numbers = Numbers(file, self._parameter)
        self.problems: list[Problem] = []
        self.doubts: list[Problem] = []
        self.gates: dict[str, Gate] = {}
        self.events: dict[str, BasicEvent] = {}

    def _parameter(
        self, name: str, path: tuple[str, ...]
    ) -> tuple[Element, tuple[str, ...]] | None:
        key = self.parameters.find(name, path)
        found = self.parameters.defined.get(key or "")
        return (found.element, found.path) if found else None

    def declare(self, container: Element, path: tuple[str, ...], *, private: bool) -> None:
        """Collect the definitions of a container and of those in it."""
        left_out: dict[str, Element] = {}
        for element in select(container, "*"):
            of, name = feature_of(element), (element.get("name") or "").strip()
            hidden = element.get("role") == "private" or (private and not element.get("role"))
            if of == "model-data":
                self.declare(element, path, private=private)
            elif of in _CHANGES:
                self._change(of, element)
            elif of not in (*_EVENTS, *_CONTAINERS, "define-parameter"):
                left_out.setdefault(of, element)
            elif len(name.split()) != 1:
                self._report("R001.name", element, name=name, type=of)
            elif of in _CONTAINERS:
                self.declare(element, (*path, name), private=hidden)
            else:
                names = self.parameters if of == "define-parameter" else self.names
                if not names.add(name, path, element, private=hidden):
                    self._report("R001.duplicate", element, name=name)
        for of, element in left_out.items():
            if of not in ("label", "attributes"):
                self.doubts.append(problem("R018.element", place_of(element, self.file), type=of))

    def _change(self, of: str, element: Element) -> None:
        """Refuse what would change the probability of the tree (R017)."""
        about, hint = _CHANGES[of]
        named = (element.get("name") or element.get("file") or "").strip()
        self.problems.append(
            problem(
                "R017.content",
                place_of(element, self.file),
                hint=hint,
                type=of,
                named=f" {named!r}" if named else "",
                contents=about,
            )
        )

    def define(self, *, is_whole: bool) -> None:
        """Read all formulas and numbers.

        Args:
            is_whole: nothing was refused that may define what others name.
        """
        self.near = SimilarNames(self.names.defined)
        for key, one in self.names.defined.items():
            of = feature_of(one.element)
            try:
                if of == "define-gate":
                    self._gate(key, one)
                else:
                    law = self.numbers.law(
                        one.element, one.path, key, house=of != "define-basic-event"
                    )
                    place = place_of(one.element, self.file)
                    self.events[key] = BasicEvent(key, law, place=place)
            except EddiError as fault:
                self.problems += [
                    problem for problem in fault.problems if is_whole or problem.code != "R001"
                ]

    def _gate(self, key: str, one: _Defined) -> None:
        formulas = arguments(one.element)
        if len(formulas) != 1:
            raise self._fault("R017.formulas", one.element, gate=key, number=len(formulas))
        self._formula(key, formulas[0], one.path, 0)

    def _formula(self, key: str, element: Element, path: tuple[str, ...], depth: int) -> None:
        """Read a formula as the gate of this key, and those within it as gates of their own."""
        of = feature_of(element)
        place = place_of(element, self.file)
        if depth > _DEEPEST:
            raise self._fault("R017.depth", element)
        if of in _REFERENCES or of == "constant":
            self.gates[key] = Gate(key, "OR", (self._reference(element, path),), place=place)
            return
        if of not in {*_CONNECTIVES, *_NEGATED, "imply"}:
            raise self._fault("R017.formula", element, type=of)
        below = []
        for number, part in enumerate(arguments(element), 1):
            if feature_of(part) in _REFERENCES or feature_of(part) == "constant":
                below.append(self._reference(part, path))
            else:
                below.append(f"{key} {number}")
                self._formula(below[-1], part, path, depth + 1)
        kind = _CONNECTIVES.get(of) or _NEGATED.get(of) or "OR"
        if of == "imply" and below:
            self.gates[f"{key} not"] = Gate(f"{key} not", "NOT", (below[0],), place=place)
            below[0] = f"{key} not"
        if of in _NEGATED:
            self.gates[key] = Gate(key, "NOT", (f"{key} not",), place=place)
            key = f"{key} not"
        least = (element.get("min") or "").strip()
        k = int(least) if kind == "VOTE" and least.isdecimal() and len(least) < 10 else None
        self.gates[key] = Gate(key, kind, tuple(below), k, place)

    def _reference(self, element: Element, path: tuple[str, ...]) -> str:
        if feature_of(element) == "constant":
            is_true = element.get("value") == "true"
            key = _TRUE if is_true else _FALSE
            law = Law("fixed", (float(is_true),))
            self.events.setdefault(key, BasicEvent(key, law, place=place_of(element, self.file)))
            return key
        name = (element.get("name") or "").strip()
        found = self.names.find(name, path)
        if found is None:
            place = place_of(element, self.file)
            raise EddiError(
                problem(
                    "R001.unknown_gate", place, hint=self.near.hint(name) or _ONE_FILE, name=name
                )
            )
        return found

    def systems(self) -> Iterator[ReliabilitySystem]:
        """Yield the tops of each tree, with what they reach."""
        used = {below for gate in self.gates.values() for below in gate.of}
        tops: dict[str, list[str]] = {}
        for key, one in self.names.defined.items():
            if key in self.gates:
                keys = tops.setdefault(one.path[0] if one.path else self.stem, [])
                keys += [key] if key not in used else []
        below = {key: gate.of for key, gate in self.gates.items()}
        for tree, keys in tops.items():
            for key in keys:
                name = tree if len(keys) == 1 else f"{tree}/{key}"
                yield self._system(name, key, below)
        if tops and not any(tops.values()):
            first = next(key for key in self.names.defined if key in self.gates)
            yield self._system(next(iter(tops)), first, below)  # its cycle is reported by check

    def _system(
        self, name: str, top: str, below: Mapping[str, tuple[str, ...]]
    ) -> ReliabilitySystem:
        reached, cycle = order(top, below)
        keys = [*self.gates, *self.events] if cycle else list(reversed(reached))
        gates = {key: self.gates[key] for key in keys if key in self.gates}
        events = {key: self.events[key] for key in keys if key in self.events}
        place = self.gates[top].place
        tree = FaultTree(top, events, gates)
        component = ComponentModel(name, "fault_tree", tree, place=place)
        return ReliabilitySystem({name: component}, name, place=place)

    def _fault(self, case: str, element: Element, /, **fields: Any) -> EddiError:
        return EddiError(problem(case, place_of(element, self.file), **fields))

    def _report(self, case: str, element: Element, /, **fields: Any) -> None:
        self.problems += self._fault(case, element, **fields).problems
