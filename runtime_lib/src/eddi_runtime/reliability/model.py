"""The ``model`` part of ``config/model.json`` of a reliability monitor, checked."""

from __future__ import annotations

import math
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Tuple

from ..documents import ModelError, take
from ..thresholds import Threshold
from . import values as rules
from .arrhenius import Arrhenius
from .battery import Battery, battery_spec
from .chain import ChainSpec, Horizons
from .component import Component
from .components import KOutOfN, Processor, Propulsion, Series
from .diagram import NODE_LIMIT, Gate, TooLargeError
from .observed import MarkovChain
from .structures import Rotors, motors_of
from .tree import Event, FaultTree
from .values import Rule

GRID = 256
"""How many horizons are prepared when the mission's end is an input."""

MISSION_END = "mission_end"
_LAWS = {"exponential": 1, "weibull": 2, "fixed": 1, "model": 0, "PAND": None, "POR": None}


class Plan(NamedTuple):
    """A model that was read and compiled.

    Attributes:
        components: by name; each behind those that it uses.
        rules: input id -> what it may hold.
        uses: model -> inputs on which it depends, with those of the models that it uses.
        top: model whose numbers are published.
        horizon: hours; the longest one when the mission's end is an input.
        moving: the mission's end is an input.
        quantum_ns: nanoseconds of one step of the chains.
        thresholds: in the order of the model.
        worst_case: evidence follows the worst case of unknown inputs.
        max_gap_ns: a longer time between two steps is reported.
    """

    components: Mapping[str, Component]
    rules: Mapping[str, Rule]
    uses: Mapping[str, Tuple[str, ...]]
    top: str
    horizon: float
    moving: bool
    quantum_ns: int
    thresholds: Tuple[Threshold, ...]
    worst_case: bool
    max_gap_ns: int


def read_plan(model: Mapping[str, Any]) -> Plan:
    """Read and compile a model.

    Raises:
        ModelError: something is missing or wrong; the reason describes it.
    """
    where = "the model"
    moving = take(model, MISSION_END, bool, where)
    horizon = _number(model, "horizon", where, least=1e-12 if moving else 0.0)
    quantum = _number(model, "quantum", where, least=1e-6)
    horizons = Horizons(horizon / GRID, GRID) if moving else Horizons(horizon)
    reader = _Reader(quantum / 3600.0, horizons)
    for item in take(model, "components", list, where):
        reader.add(item)
    top = take(model, "top", str, where)
    if top not in reader.components:
        raise ModelError("", f"there is no component {top!r}")
    if moving:
        reader.rules[MISSION_END] = rules.SECONDS
    return Plan(
        reader.components,
        reader.rules,
        reader.uses,
        top,
        horizon,
        moving,
        round(quantum * 1e9),
        tuple(_threshold(item) for item in take(model, "thresholds", list, where)),
        take(model, "on_unknown", str, where) == "worst_case",
        round(_number(model, "max_gap", where) * 1e9),
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
    """Makes components, each from the ones before it."""

    def __init__(self, quantum: float, horizons: Horizons) -> None:
        self.components: Dict[str, Component] = {}
        self.rules: Dict[str, Rule] = {}
        self.uses: Dict[str, Tuple[str, ...]] = {}
        self._quantum, self._horizons = quantum, horizons
        self._own: List[str] = []
        self._makers: Dict[str, Callable[[Any, str], Component]] = {
            "markov": self._markov,
            "propulsion": self._propulsion,
            "battery": self._battery,
            "processor": self._processor,
            "k_out_of_n": self._k_out_of_n,
            "fault_tree": self._tree,
            "series": self._series,
        }

    def add(self, item: Any) -> None:
        name = take(item, "name", str, "a component")
        where = f"component {name!r}"
        make = self._makers.get(take(item, "type", str, where))
        if make is None:
            raise ModelError("", f"the type {item['type']!r} of {where} is not known")
        self._own = []
        self.components[name] = make(item, where)
        self.uses[name] = tuple(dict.fromkeys(self._own))

    def _input(self, item: Any, key: str, where: str, rule: Rule) -> str:
        return self._named(take(item, key, str, where), rule)

    def _named(self, name: str, rule: Rule) -> str:
        if self.rules.setdefault(name, rule) != rule:
            raise ModelError("", f"the input {name!r} is used in two ways")
        self._own.append(name)
        return name

    def _used(self, name: str, where: str) -> str:
        if name not in self.components:
            raise ModelError("", f"{where} uses {name!r}, which is not defined before it")
        self._own += self.uses[name]
        return name

    def _markov(self, item: Any, where: str) -> Component:
        states = len(take(item, "states", list, where))
        arcs = tuple(
            (_index(a, states, where), _index(b, states, where), _rate(rate, where))
            for a, b, rate in _triples(item, "arcs", where)
        )
        fail = tuple(_index(i, states, where) for i in take(item, "fail", list, where))
        if not fail:
            raise ModelError("", f"{where} has no fail state")
        spec = ChainSpec(states, _index(item.get("initial"), states, where), fail, arcs)
        observe = tuple(
            (_index(state, states, where), self._named(str(name), rules.BOOL), negated is True)
            for state, name, negated in _triples(item, "observe", where)
        )
        age, repair = _age(item, where), item.get("repair") is True
        return MarkovChain(spec, observe, self._quantum, self._horizons, age, repair=repair)

    def _propulsion(self, item: Any, where: str) -> Component:
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
        rotors = Rotors(configuration, rates)
        repair = take(item, "repair", bool, where)
        return Propulsion(rotors, names, self._quantum, self._horizons, repair=repair)

    def _battery(self, item: Any, where: str) -> Component:
        keys = ("failure_rate", "alpha", "beta", "degradation")
        spec = battery_spec(*(_number(item, key, where) for key in keys))
        level = self._input(item, "level", where, rules.LEVEL)
        repair = take(item, "repair", bool, where)
        longest = self._horizons.step * self._horizons.steps
        if item.get("temperature") is None:
            return Battery(spec, level, longest, repair=repair)
        temperature = self._input(item, "temperature", where, rules.TEMPERATURE)
        heat = _arrhenius(item, where)
        return Battery(spec, level, longest, repair=repair, heat=heat, temperature=temperature)

    def _processor(self, item: Any, where: str) -> Component:
        positive = ("mttf_ref", "shape")
        numbers = {key: _number(item, key, where, least=1e-12) for key in positive}
        numbers["u_max"] = _number(item, "u_max", where)
        numbers["age"] = _age(item, where)
        temperature = self._input(item, "temperature", where, rules.TEMPERATURE)
        load = item.get("utilisation")
        if load is not None:
            load = self._input(item, "utilisation", where, rules.LOAD)
        return Processor(numbers, _arrhenius(item, where), temperature, load)

    def _k_out_of_n(self, item: Any, where: str) -> Component:
        largest: Optional[int] = item.get("max")
        rule = Rule("int", 0.0, 10_000.0 if largest is None else float(largest))
        name = self._input(item, "available", where, rule)
        k = take(item, "k", int, where)
        return KOutOfN(k, _number(item, "rate", where), largest, name)

    def _series(self, item: Any, where: str) -> Component:
        parts = take(item, "of", list, where)
        return Series(tuple(self._used(str(name), where) for name in parts))

    def _tree(self, item: Any, where: str) -> Component:
        events = tuple(self._event(one, where) for one in take(item, "events", list, where))
        gates = [
            _gate(one, len(events) + i, where)
            for i, one in enumerate(take(item, "gates", list, where))
        ]
        top = _index(item.get("top"), len(events) + len(gates), where)
        try:
            return FaultTree(
                events,
                gates,
                top,
                quantum=self._quantum,
                horizons=self._horizons,
                repair=take(item, "repair", bool, where),
                limit=item.get("node_limit", NODE_LIMIT),
                cut_sets=_cut_sets(item, len(events), where),
            )
        except TooLargeError as problem:
            raise ModelError("", f"{where}: {problem}, more than the limit") from None

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
            name = self._input(item, "input", where, rules.BOOL)
        age = _age(item, where)
        return Event(take(item, "name", str, where), law, numbers, model, name, age)


def _cut_sets(item: Any, events: int, where: str) -> Optional[List[List[int]]]:
    if item.get("cut_sets") is None:
        return None
    found: List[Any] = take(item, "cut_sets", list, where)
    if not all(isinstance(one, list) and one for one in found):
        raise ModelError("", f"'cut_sets' of {where} is no list of sets")
    return [[_index(i, events, where) for i in one] for one in found]


def _status_rule(position: Optional[int], count: int) -> Rule:
    return rules.BOOL if position is None else Rule("bool[]", length=count)


def _arrhenius(item: Any, where: str) -> Arrhenius:
    reference, hottest = (_number(item, key, where, least=-273.0) for key in ("t_ref", "t_max"))
    return Arrhenius(_number(item, "activation_energy", where), reference, hottest)


def _gate(item: Any, number: int, where: str) -> Gate:
    kind = take(item, "type", str, where)
    of = tuple(_index(i, number, where) for i in take(item, "of", list, where))
    if kind not in ("AND", "OR", "NOT", "XOR", "VOTE") or (kind == "NOT" and len(of) != 1):
        raise ModelError("", f"a gate {kind!r} of {where} cannot be evaluated")
    k = take(item, "k", int, where) if kind == "VOTE" else 0
    if kind == "VOTE" and not 1 <= k <= len(of):
        raise ModelError("", f"a gate of {where} wants {k} of {len(of)}")
    return Gate(kind, of, k)


def _triples(item: Any, key: str, where: str) -> List[Any]:
    found: List[Any] = take(item, key, list, where)
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
