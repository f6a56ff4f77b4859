"""The ``model`` part of a reliability model file as typed data, checked."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from eddi_scaffold.compiling.document import ModelError, take
from eddi_scaffold.compiling.reliability.diagram import (
    NODE_LIMIT,
    Diagram,
    TooLargeError,
    build,
)
from eddi_scaffold.compiling.reliability.markov import Chain
from eddi_scaffold.compiling.reliability.simplification import Gate
from eddi_scaffold.compiling.reliability.structures import motors_of, rotors_chain, survived

GRID = 256
"""How many horizons are prepared when the mission's end is an input."""

MISSION_END = "mission_end"
DYNAMIC = ("PAND", "POR")
_LAWS = {"exponential": 1, "weibull": 2, "fixed": 1, "model": 0, "PAND": None, "POR": None}
_BATTERY = ("B4", "C4", "B3", "C3", "B2", "C2", "Empty", "F")


class Rule(NamedTuple):
    """What an input may hold, as ``eddi_runtime.reliability.Rule``."""

    type: str
    low: float = 0.0
    high: float = math.inf
    slack: float = 0.0
    length: int = 0


_BOOL = Rule("bool")
_LEVEL = Rule("float", 0.0, 100.0, slack=0.5)
_TEMPERATURE = Rule("float", -200.0, sys.float_info.max)
_LOAD = Rule("float", 0.0, sys.float_info.max)
_SECONDS = Rule("float", -1e12, 1e12)


class Threshold(NamedTuple):
    """A threshold, as ``eddi_runtime.reliability.Threshold``."""

    id: str
    activate: float
    release: float
    hold_ns: int


class Heat(NamedTuple):
    """How heat ages something: input, activation energy in eV, reference and hottest in degC."""

    temperature: str
    energy: float
    reference: float
    hottest: float


@dataclass(frozen=True)
class Markov:
    """A chain; ``observe``: (state, input, negated)."""

    chain: Chain
    observe: tuple[tuple[int, str, bool], ...]
    repair: bool


@dataclass(frozen=True)
class Propulsion:
    """Rotors; ``sets``: failed motors of each state but the last; ``inputs``: (id, position)."""

    chain: Chain
    sets: tuple[tuple[int, ...], ...]
    inputs: tuple[tuple[str, int | None], ...]
    repair: bool


@dataclass(frozen=True)
class Battery:
    """A battery and the chain that its charge is."""

    chain: Chain
    level: str
    heat: Heat | None
    repair: bool


@dataclass(frozen=True)
class Processor:
    """A processor; ``load``: (input, its limit)."""

    mean: float
    shape: float
    heat: Heat
    load: tuple[str, float] | None
    age: float


@dataclass(frozen=True)
class KOutOfN:
    """Equal units."""

    k: int
    rate: float
    largest: int | None
    available: str


@dataclass(frozen=True)
class Series:
    """Models in series."""

    parts: tuple[str, ...]


class Event(NamedTuple):
    """A basic event.

    Attributes:
        name: for people.
        law: ``exponential`` (1/h), ``weibull`` (scale in h, shape), ``fixed`` (probability),
            ``model`` (of another model), ``PAND`` or ``POR`` (rates of the inputs, 1/h).
        values: numbers of the law.
        model: name of the model.
        input: id of the input that reports whether it has happened; None: not observed.
        age: hours that it had run before the start of the mission.
        place: fragment path of its element in the EDDI, empty where it came from none.
    """

    name: str
    law: str
    values: tuple[float, ...]
    model: str
    input: str | None
    age: float
    place: str


class Named(NamedTuple):
    """A gate for people.

    Attributes:
        name: with its type.
        place: fragment path, empty where there is none.
    """

    name: str
    place: str


@dataclass(frozen=True)
class FaultTree:
    """A fault tree: its diagram, or all minimal cut sets, which then give bounds.

    Attributes:
        events: basic events, and dynamic gates.
        gates: those that are no events; their numbers follow those of the events.
    """

    events: tuple[Event, ...]
    gates: tuple[Named, ...]
    diagram: Diagram | None
    cut_sets: tuple[tuple[int, ...], ...] | None
    repair: bool


Component = Markov | Propulsion | Battery | Processor | KOutOfN | Series | FaultTree


@dataclass(frozen=True)
class Plan:
    """A model that was read.

    Attributes:
        components: by name; each behind those that it uses.
        places: name -> fragment path of the element in the EDDI, for those that came from one.
        rules: input id -> what it may hold.
        owners: input id -> the first model that reads it.
        uses: model -> inputs on which it depends, with those of the models that it uses.
        top: model whose numbers are published.
        horizon: hours; the longest one when the mission's end is an input.
        moving: the mission's end is an input.
        quantum: seconds of one step of the chains.
        thresholds: in the order of the model.
        worst_case: evidence follows the worst case of unknown inputs.
        max_gap: seconds; a longer time between two steps is reported.
    """

    components: Mapping[str, Component]
    places: Mapping[str, str]
    rules: Mapping[str, Rule]
    owners: Mapping[str, str]
    uses: Mapping[str, tuple[str, ...]]
    top: str
    horizon: float
    moving: bool
    quantum: float
    thresholds: tuple[Threshold, ...]
    worst_case: bool
    max_gap: float


def read_plan(model: Mapping[str, Any]) -> Plan:
    """Read a model and build its diagrams.

    Raises:
        ModelError: something is missing or wrong; the reason describes it.
    """
    where = "the model"
    moving = take(model, MISSION_END, bool, where)
    horizon = _number(model, "horizon", where, least=1e-12 if moving else 0.0)
    quantum = _number(model, "quantum", where, least=1e-6)
    reader = _Reader()
    for item in take(model, "components", list, where):
        reader.add(item)
    top = take(model, "top", str, where)
    if top not in reader.components:
        raise ModelError("", f"there is no component {top!r}")
    if moving:
        reader.rules[MISSION_END] = _SECONDS
    return Plan(
        reader.components,
        reader.places,
        reader.rules,
        reader.owners,
        reader.uses,
        top,
        horizon,
        moving,
        quantum,
        tuple(_threshold(item) for item in take(model, "thresholds", list, where)),
        take(model, "on_unknown", str, where) == "worst_case",
        _number(model, "max_gap", where),
    )


def _threshold(item: Any) -> Threshold:
    where = "a threshold"
    return Threshold(
        take(item, "id", str, where),
        _number(item, "activate", where),
        _number(item, "release", where),
        round(_number(item, "hold", where) * 1e9),
    )


class _Reader:
    """Reads components, each from the ones before it."""

    def __init__(self) -> None:
        self.components: dict[str, Component] = {}
        self.places: dict[str, str] = {}
        self.rules: dict[str, Rule] = {}
        self.owners: dict[str, str] = {}
        self.uses: dict[str, tuple[str, ...]] = {}
        self._name = ""
        self._own: list[str] = []
        self._makers: dict[str, Callable[[Any, str], Component]] = {
            "markov": self._markov,
            "propulsion": self._propulsion,
            "battery": self._battery,
            "processor": self._processor,
            "k_out_of_n": self._k_out_of_n,
            "fault_tree": self._tree,
            "series": self._series,
        }

    def add(self, item: Any) -> None:
        self._name = name = take(item, "name", str, "a component")
        where = f"component {name!r}"
        make = self._makers.get(take(item, "type", str, where))
        if make is None:
            raise ModelError("", f"the type {item['type']!r} of {where} is not known")
        self._own = []
        self.components[name] = make(item, where)
        self.uses[name] = tuple(dict.fromkeys(self._own))
        self.places[name] = _path(item)

    def _input(self, item: Any, key: str, where: str, rule: Rule) -> str:
        return self._named(take(item, key, str, where), rule)

    def _named(self, name: str, rule: Rule) -> str:
        if self.rules.setdefault(name, rule) != rule:
            raise ModelError("", f"the input {name!r} is used in two ways")
        self.owners.setdefault(name, self._name)
        self._own.append(name)
        return name

    def _used(self, name: str, where: str) -> str:
        if name not in self.components:
            raise ModelError("", f"{where} uses {name!r}, which is not defined before it")
        self._own += self.uses[name]
        return name

    def _markov(self, item: Any, where: str) -> Markov:
        names = tuple(map(str, take(item, "states", list, where)))
        states = len(names)
        arcs = tuple(
            (_index(a, states, where), _index(b, states, where), _rate(rate, where))
            for a, b, rate in _triples(item, "arcs", where)
        )
        fail = tuple(_index(i, states, where) for i in take(item, "fail", list, where))
        if not fail:
            raise ModelError("", f"{where} has no fail state")
        initial = _index(item.get("initial"), states, where)
        chain = Chain(names, initial, fail, arcs, _age(item, where))
        observe = tuple(
            (_index(state, states, where), self._named(str(name), _BOOL), negated is True)
            for state, name, negated in _triples(item, "observe", where)
        )
        return Markov(chain, observe, repair=item.get("repair") is True)

    def _propulsion(self, item: Any, where: str) -> Propulsion:
        configuration = take(item, "configuration", str, where)
        rates = [_rate(rate, where) for rate in take(item, "rates", list, where)]
        count = motors_of(configuration)
        inputs = take(item, "inputs", list, where)
        if count is None or len(rates) != count or len(inputs) != count:
            raise ModelError("", f"{where} needs as many rates and inputs as {configuration!r} has")
        names = tuple(
            (self._named(str(name), _status_rule(position, count)), position)
            for name, position in inputs
        )
        sets = tuple(tuple(sorted(failed)) for failed in survived(configuration))
        repair = take(item, "repair", bool, where)
        return Propulsion(rotors_chain(configuration, rates), sets, names, repair)

    def _battery(self, item: Any, where: str) -> Battery:
        keys = ("failure_rate", "alpha", "beta", "degradation")
        chain = battery_chain(*(_number(item, key, where) for key in keys))
        level = self._input(item, "level", where, _LEVEL)
        repair = take(item, "repair", bool, where)
        heat = None if item.get("temperature") is None else self._heat(item, where)
        return Battery(chain, level, heat, repair)

    def _heat(self, item: Any, where: str) -> Heat:
        temperature = self._input(item, "temperature", where, _TEMPERATURE)
        reference, hottest = (_number(item, key, where, least=-273.0) for key in ("t_ref", "t_max"))
        return Heat(temperature, _number(item, "activation_energy", where), reference, hottest)

    def _processor(self, item: Any, where: str) -> Processor:
        mean, shape = (_number(item, key, where, least=1e-12) for key in ("mttf_ref", "shape"))
        most, age = _number(item, "u_max", where), _age(item, where)
        heat = self._heat(item, where)
        load = None
        if item.get("utilisation") is not None:
            load = self._input(item, "utilisation", where, _LOAD), most
        return Processor(mean, shape, heat, load, age)

    def _k_out_of_n(self, item: Any, where: str) -> KOutOfN:
        largest: int | None = item.get("max")
        rule = Rule("int", 0.0, 10_000.0 if largest is None else float(largest))
        name = self._input(item, "available", where, rule)
        k = take(item, "k", int, where)
        return KOutOfN(k, _number(item, "rate", where), largest, name)

    def _series(self, item: Any, where: str) -> Series:
        parts = take(item, "of", list, where)
        return Series(tuple(self._used(str(name), where) for name in parts))

    def _tree(self, item: Any, where: str) -> FaultTree:
        events = tuple(self._event(one, where) for one in take(item, "events", list, where))
        given = take(item, "gates", list, where)
        gates = [_gate(one, len(events) + i, where) for i, one in enumerate(given)]
        shown = tuple(
            Named(f"{gate.type} {one.get('name') or ''}".rstrip(), _path(one))
            for gate, one in zip(gates, given, strict=True)
        )
        top = _index(item.get("top"), len(events) + len(gates), where)
        sets = _cut_sets(item, len(events), where)
        first = frozenset(i for i, event in enumerate(events) if event.input is not None)
        limit = item.get("node_limit", NODE_LIMIT)
        known = certain(take(item, "events", list, where))
        try:
            diagram = build(len(events), gates, top, first, limit, known) if sets is None else None
        except TooLargeError as problem:
            raise ModelError("", f"{where}: {problem}, more than the limit") from None
        return FaultTree(events, shown, diagram, sets, take(item, "repair", bool, where))

    def _event(self, item: Any, where: str) -> Event:
        law = take(item, "law", str, where)
        if law not in _LAWS:
            raise ModelError("", f"the law {law!r} in {where} is not known")
        numbers = tuple(_rate(value, where) for value in take(item, "values", list, where))
        wanted = _LAWS[law]
        if len(numbers) != wanted if wanted is not None else not numbers:
            raise ModelError("", f"the law {law!r} in {where} has {len(numbers)} numbers")
        if law == "weibull" and min(numbers) <= 0.0:
            raise ModelError("", f"a Weibull law in {where} has a number that is not positive")
        if law == "fixed" and numbers[0] > 1.0:
            raise ModelError("", f"a probability in {where} is above 1")
        model = self._used(take(item, "model", str, where), where) if law == "model" else ""
        name = item.get("input")
        if name is not None:
            name = self._input(item, "input", where, _BOOL)
        shown = take(item, "name", str, where)
        return Event(shown, law, numbers, model, name, _age(item, where), _path(item))


def certain(events: Iterable[Mapping[str, Any]]) -> dict[int, bool]:
    """Return the events of a tree that are certain, or cannot happen, whatever is observed."""
    never = {("fixed", 0.0): False, ("fixed", 1.0): True, ("exponential", 0.0): False}
    return {
        i: never[key]
        for i, event in enumerate(events)
        if event.get("input") is None and (key := (event["law"], *event["values"])) in never
    }


def battery_chain(failure: float, alpha: float, beta: float, degradation: float) -> Chain:
    """Return the chain of charge (rates in 1/h): bands of use and of recovery, empty, failed."""
    arcs = []
    for b in (0, 2, 4):
        arcs += [(b, b + 1, alpha), (b + 1, b, beta), (b, b + 2, degradation), (b, 7, failure)]
    return Chain(_BATTERY, 0, (6, 7), tuple(arcs))


def order_chain(event: Event) -> Chain:
    """Return the chain over orders of occurrence of a dynamic gate."""
    rates = event.values
    if event.law == "POR":
        arcs = ((0, 1, rates[0]), (0, 2, math.fsum(rates[1:])))
        return Chain(
            ("nothing yet", "the first came first", "another did"), 0, (1,), arcs, event.age
        )
    lost = len(rates) + 1
    found = []
    for done in range(len(rates)):
        found.append((done, done + 1, rates[done]))
        found += [(done, lost, rate) for rate in rates[done + 1 :]]
    names = (*(f"{done} in order" for done in range(lost)), "out of order")
    return Chain(names, 0, (len(rates),), tuple(found), event.age)


def _path(item: Any) -> str:
    """Return the fragment path of an element; a line of a file changes for nothing."""
    place = item.get("place")
    return place if isinstance(place, str) and not place.startswith("line ") else ""


def _cut_sets(item: Any, events: int, where: str) -> tuple[tuple[int, ...], ...] | None:
    if item.get("cut_sets") is None:
        return None
    found: list[Any] = take(item, "cut_sets", list, where)
    if not all(isinstance(one, list) and one for one in found):
        raise ModelError("", f"'cut_sets' of {where} is no list of sets")
    return tuple(tuple(sorted(_index(i, events, where) for i in one)) for one in found)


def _status_rule(position: int | None, count: int) -> Rule:
    return _BOOL if position is None else Rule("bool[]", length=count)


def _gate(item: Any, number: int, where: str) -> Gate:
    kind = take(item, "type", str, where)
    of = tuple(_index(i, number, where) for i in take(item, "of", list, where))
    if kind not in ("AND", "OR", "NOT", "XOR", "VOTE") or (kind == "NOT" and len(of) != 1):
        raise ModelError("", f"a gate {kind!r} of {where} cannot be evaluated")
    k = take(item, "k", int, where) if kind == "VOTE" else 0
    if kind == "VOTE" and not 1 <= k <= len(of):
        raise ModelError("", f"a gate of {where} wants {k} of {len(of)}")
    return Gate(kind, of, k)


def _triples(item: Any, key: str, where: str) -> list[Any]:
    found: list[Any] = take(item, key, list, where)
    if not all(isinstance(one, list) and len(one) == 3 for one in found):
        raise ModelError("", f"{key!r} of {where} is no list of triples")
    return found


def _index(value: Any, count: int, where: str) -> int:
    if type(value) is not int or not 0 <= value < count:
        raise ModelError("", f"{value!r} in {where} is no number below {count}")
    return value


def _rate(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ModelError("", f"{value!r} in {where} is no number")
    if not 0.0 <= value < math.inf:
        raise ModelError("", f"{value!r} in {where} is negative or not finite")
    return float(value)


def _age(item: Any, where: str) -> float:
    return 0.0 if item.get("age") is None else _number(item, "age", where)


def _number(item: Any, key: str, where: str, least: float = 0.0) -> float:
    value = float(take(item, key, (int, float), where))
    if not least <= value < math.inf:
        raise ModelError("", f"{key!r} of {where} is {value!r}, below {least:g} or not finite")
    return value
