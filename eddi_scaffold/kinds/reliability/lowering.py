"""A system as the runtime evaluates it: what the top uses, with numbers for names."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

from eddi_scaffold.kinds.reliability.chains import Chain, rotors_chain, survived
from eddi_scaffold.kinds.reliability.cut_sets import CutSet, cut_sets_of_gates
from eddi_scaffold.kinds.reliability.fault_tree import NODE_LIMIT, Diagram, Gate, build
from eddi_scaffold.kinds.reliability.inputs import MISSION_END, input_id
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    BasicEvent,
    ComponentModel,
    ReliabilitySystem,
    order,
)
from eddi_scaffold.kinds.reliability.system import Chain as ChainModel
from eddi_scaffold.kinds.reliability.system import FaultTree as TreeModel

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
    """A processor; ``load``: (input, its limit), None for always one."""

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
    model: str = ""
    input: str | None = None
    age: float = 0.0
    place: str = ""


class Named(NamedTuple):
    """A gate for people.

    Attributes:
        name: of it.
        place: fragment path, empty where there is none.
    """

    name: str
    place: str


@dataclass(frozen=True)
class FaultTree:
    """A fault tree by numbers: its diagram, or all minimal cut sets, which then give bounds.

    Attributes:
        events: basic events, and dynamic gates.
        gates: those that are no events; their numbers follow those of the events.
        names: of the gates.
        top: number of the top event.
        repair: an event that was seen to have happened may be repaired.
        bounded: bounds by minimal cut sets are asked for.
        limit: nodes that the diagram may have.
    """

    events: tuple[Event, ...]
    gates: tuple[Gate, ...]
    names: tuple[Named, ...]
    top: int
    repair: bool = False
    bounded: bool = False
    limit: int = NODE_LIMIT

    @cached_property
    def cut_sets(self) -> Sequence[CutSet] | None:
        """All minimal cut sets where they give bounds; None: else, too many, or not coherent."""
        if not self.bounded:
            return None
        return _all_cut_sets(len(self.events), self.gates, self.top)

    @cached_property
    def diagram(self) -> Diagram | None:
        """The diagram as it runs, None where cut sets give bounds; may raise TooLargeError."""
        return self.diagram_knowing(_certain(self.events)) if self.cut_sets is None else None

    def diagram_knowing(self, known: Mapping[int, bool]) -> Diagram:
        """Return the diagram with some events certain (True) or impossible (False).

        Raises:
            TooLargeError: it is above the limit.
        """
        first = frozenset(i for i, event in enumerate(self.events) if event.input is not None)
        return build(len(self.events), self.gates, self.top, first, self.limit, known)


Component = Markov | Propulsion | Battery | Processor | KOutOfN | Series | FaultTree


@dataclass(frozen=True)
class LoweredSystem:
    """What the top of a system uses.

    Attributes:
        components: by name; each behind those that it uses.
        places: name -> fragment path of the element in the EDDI, empty where it came from none.
        rules: input id -> what it may hold.
        owners: input id -> the first model that reads it.
        uses: model -> inputs on which it depends, with those of the models that it uses.
    """

    components: Mapping[str, Component]
    places: Mapping[str, str]
    rules: Mapping[str, Rule]
    owners: Mapping[str, str]
    uses: Mapping[str, tuple[str, ...]]


def used(system: ReliabilitySystem) -> ReliabilitySystem:
    """Return the system without models that the top does not use."""
    below = {name: component.below for name, component in system.components.items()}
    names = set(order(system.top, below)[0])
    kept = {name: component for name, component in system.components.items() if name in names}
    return replace(system, components=kept)


def lower(system: ReliabilitySystem) -> LoweredSystem:
    """Return what the runtime evaluates of a checked system."""
    below = {name: component.below for name, component in system.components.items()}
    used_models = [system.components[name] for name in order(system.top, below)[0]]
    return connected(
        {component.name: _lowered(component) for component in used_models},
        {component.name: component.place.path or "" for component in used_models},
        mission_end=system.mission_end,
    )


def connected(
    components: Mapping[str, Component], places: Mapping[str, str], *, mission_end: bool
) -> LoweredSystem:
    """Return models, each behind those that it uses, with the inputs that they read."""
    rules: dict[str, Rule] = {}
    owners: dict[str, str] = {}
    uses: dict[str, tuple[str, ...]] = {}
    for name, component in components.items():
        inputs: list[str] = []
        for read, rule in _reads(component):
            if rule is None:
                inputs += uses[read]
                continue
            rules.setdefault(read, rule)
            owners.setdefault(read, name)
            inputs.append(read)
        uses[name] = tuple(dict.fromkeys(inputs))
    if mission_end:
        rules[MISSION_END] = _SECONDS
    return LoweredSystem(components, places, rules, owners, uses)


def _reads(component: Component) -> Iterator[tuple[str, Rule | None]]:
    """Yield the inputs of a model with what they may hold, and the models that it uses."""
    if isinstance(component, Markov):
        yield from ((name, _BOOL) for _, name, _ in component.observe)
    elif isinstance(component, Propulsion):
        of_list = Rule("bool[]", length=len(component.inputs))
        for name, position in component.inputs:
            yield name, _BOOL if position is None else of_list
    elif isinstance(component, Battery):
        yield component.level, _LEVEL
        if component.heat is not None:
            yield component.heat.temperature, _TEMPERATURE
    elif isinstance(component, Processor):
        yield component.heat.temperature, _TEMPERATURE
        if component.load is not None:
            yield component.load[0], _LOAD
    elif isinstance(component, KOutOfN):
        most = 10_000.0 if component.largest is None else float(component.largest)
        yield component.available, Rule("int", 0.0, most)
    elif isinstance(component, Series):
        yield from ((part, None) for part in component.parts)
    else:
        for event in component.events:
            if event.model:
                yield event.model, None
            if event.input is not None:
                yield event.input, _BOOL


def _lowered(component: ComponentModel) -> Component:
    name, values, content = component.name, component.values, component.content
    if isinstance(content, TreeModel):
        return lower_tree(name, content)
    if isinstance(content, ChainModel):
        number = {state: i for i, state in enumerate(content.states)}
        observe = tuple((number[seen.state], seen.input, seen.negated) for seen in content.observe)
        return Markov(chain_of(content), observe, content.repair)
    if component.type == "propulsion":
        return _propulsion(component)
    if component.type == "battery":
        keys = ("failure_rate", "alpha", "beta", "degradation")
        chain = battery_chain(*(float(values[key]) for key in keys))
        heat = _heat(component) if "t_ref" in values else None
        return Battery(chain, input_id(name, "level"), heat, values["repair"])
    if component.type == "processor":
        mean, shape, age = (float(values.get(key, 0.0)) for key in ("mttf_ref", "shape", "age"))
        load = input_id(name, "utilisation"), float(values["u_max"])
        return Processor(mean, shape, _heat(component), load, age)
    if component.type == "k_out_of_n":
        available = input_id(name, "available")
        return KOutOfN(values["k"], float(values["rate"]), values["max"], available)
    return Series(component.uses)


def chain_of(chain: ChainModel) -> Chain:
    """Return a chain by numbers of its states."""
    number = {state: i for i, state in enumerate(chain.states)}
    arcs = tuple((number[arc.source], number[arc.target], arc.rate) for arc in chain.arcs)
    fail = tuple(number[state] for state in chain.fail)
    return Chain(chain.states, number[chain.initial[0]], fail, arcs, chain.age)


def _propulsion(component: ComponentModel) -> Propulsion:
    values, name = component.values, component.name
    motors = sorted(range(len(values["rates"])), key=values["positions"].__getitem__)
    rates = [float(values["rates"][motor]) for motor in motors]
    inputs = tuple(
        (input_id(name, "status"), motor)
        if values["status"] == "list"
        else (input_id(name, f"motor_{motor}"), None)
        for motor in motors
    )
    sets = tuple(tuple(sorted(failed)) for failed in survived(values["configuration"]))
    return Propulsion(rotors_chain(values["configuration"], rates), sets, inputs, values["repair"])


def _heat(component: ComponentModel) -> Heat:
    keys = ("activation_energy", "t_ref", "t_max")
    numbers = (float(component.values[key]) for key in keys)
    return Heat(input_id(component.name, "temperature"), *numbers)


def lower_tree(name: str, tree: TreeModel) -> FaultTree:
    """Return a tree by numbers: ports are ORs, dynamic gates are events."""
    names, _ = order(tree.top, {key: gate.of for key, gate in tree.gates.items()})
    dynamic = [key for key in names if key in tree.gates and tree.gates[key].type in DYNAMIC]
    inner = {below for key in dynamic for below in tree.gates[key].of}
    number: dict[str, int] = {}
    of_model: dict[str, int] = {}
    events: list[Event] = []
    for key in names:
        if key in tree.events and key not in inner:
            event = _event(name, key, tree)
            # two events of one other model are the same event
            if event.model and event.input is None and event.model in of_model:
                number[key] = of_model[event.model]
                continue
            number[key] = len(events)
            if event.model and event.input is None:
                of_model[event.model] = number[key]
            events.append(event)
    for key in dynamic:
        number[key] = len(events)
        events.append(_dynamic(key, tree))
    gates: list[Gate] = []
    shown: list[Named] = []
    for key in names:
        if key not in number and key in tree.gates:
            gate = tree.gates[key]
            number[key] = len(events) + len(gates)
            kind = "OR" if gate.type == "NOT" and not gate.of else gate.type
            k = gate.k or 0 if kind == "VOTE" else 0
            gates.append(Gate(kind, tuple(number[below] for below in gate.of), k))
            shown.append(Named(gate.name, gate.place.path or ""))
    return FaultTree(
        tuple(events),
        tuple(gates),
        tuple(shown),
        number[tree.top],
        tree.repair,
        tree.approximate,
        tree.node_limit or NODE_LIMIT,
    )


def _event(name: str, key: str, tree: TreeModel) -> Event:
    event: BasicEvent = tree.events[key]
    law = event.law
    assert law is not None, "a checked tree has the law of each event"
    seen = input_id(name, key) if event.observed else None
    age = tree.age if event.age is None else event.age
    return Event(event.name, law.kind, law.values, law.model, seen, age, event.place.path or "")


def _dynamic(key: str, tree: TreeModel) -> Event:
    gate = tree.gates[key]
    if gate.type == "SAND":  # independent continuous events never happen at the same instant
        return Event(key, "fixed", (0.0,))
    rates = tuple(law.values[0] for name in gate.of if (law := tree.events[name].law))
    return Event(key, gate.type, rates, age=tree.age)


def _certain(events: tuple[Event, ...]) -> dict[int, bool]:
    """Return the events of a tree that are certain, or cannot happen, whatever is observed."""
    never = {("fixed", 0.0): False, ("fixed", 1.0): True, ("exponential", 0.0): False}
    return {
        i: never[key]
        for i, event in enumerate(events)
        if event.input is None and (key := (event.law, *event.values)) in never
    }


@lru_cache(maxsize=8)
def _all_cut_sets(events: int, gates: tuple[Gate, ...], top: int) -> Sequence[CutSet] | None:
    try:
        return cut_sets_of_gates(events, gates, top)
    except ValueError:  # NOT or XOR
        return None


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
        states = ("nothing yet", "the first came first", "another did")
        return Chain(states, 0, (1,), arcs, event.age)
    lost = len(rates) + 1
    ordered = []
    for done in range(len(rates)):
        ordered.append((done, done + 1, rates[done]))
        ordered += [(done, lost, rate) for rate in rates[done + 1 :]]
    names = (*(f"{done} in order" for done in range(lost)), "out of order")
    return Chain(names, 0, (len(rates),), tuple(ordered), event.age)
