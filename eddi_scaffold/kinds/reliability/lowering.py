"""A system as the runtime evaluates it: what the top uses, with numbers for names."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

from eddi_runtime.reliability.component import Rule

from eddi_scaffold.kinds.reliability.chains import Chain, battery_chain, rotors_chain, survived
from eddi_scaffold.kinds.reliability.decision_diagram import NODE_LIMIT, Diagram, build
from eddi_scaffold.kinds.reliability.fault_tree import Gate, minimal_cut_sets
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    MISSION_END,
    ComponentModel,
    ReliabilitySystem,
    input_id,
)
from eddi_scaffold.kinds.reliability.system import Chain as ChainModel
from eddi_scaffold.kinds.reliability.system import FaultTree as TreeModel

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


class Markov(NamedTuple):
    """A chain; ``observe``: (state, input, negated)."""

    chain: Chain
    observe: tuple[tuple[int, str, bool], ...]
    repair: bool


class Propulsion(NamedTuple):
    """Rotors; ``sets``: failed motors of each state but the last; ``inputs``: (id, position)."""

    chain: Chain
    sets: tuple[tuple[int, ...], ...]
    inputs: tuple[tuple[str, int | None], ...]
    repair: bool


class Battery(NamedTuple):
    """A battery and the chain that its charge is."""

    chain: Chain
    level: str
    heat: Heat | None
    repair: bool


class Processor(NamedTuple):
    """A processor; ``load``: (input, its limit), None for always one."""

    mean: float
    shape: float
    heat: Heat
    load: tuple[str, float] | None
    age: float


class KOutOfN(NamedTuple):
    """Equal units."""

    k: int
    rate: float
    largest: int | None
    available: str


class Series(NamedTuple):
    """Models in series."""

    parts: tuple[str, ...]


class Event(NamedTuple):
    """A basic event, as in ``system``, or a dynamic gate: the law ``PAND`` or ``POR``."""

    name: str
    law: str
    values: tuple[float, ...]  # numbers of the law; of a dynamic gate the rates of its inputs, 1/h
    model: str = ""  # of which it is the failure
    # id of the input that reports whether it has happened; None: not observed
    input: str | None = None
    age: float = 0.0
    place: str = ""  # fragment path of its element in the EDDI, empty where it came from none


class Named(NamedTuple):
    """Name and fragment path of a gate; the path is empty where there is none."""

    name: str
    place: str


@dataclass(frozen=True)
class FaultTree:
    """A fault tree by numbers: its diagram, or all minimal cut sets, which then give bounds."""

    events: tuple[Event, ...]
    gates: tuple[Gate, ...]  # those that are no events; their numbers follow those of the events
    names: tuple[Named, ...]
    top: int
    repair: bool = False
    bounded: bool = False  # bounds by minimal cut sets are asked for
    limit: int = NODE_LIMIT  # nodes that the diagram may have

    @cached_property
    def certain(self) -> Mapping[int, bool]:
        """Events that are certain, or cannot happen, whatever is observed."""
        sure = {("fixed", 0.0): False, ("fixed", 1.0): True, ("exponential", 0.0): False}
        return {
            i: sure[key]
            for i, event in enumerate(self.events)
            if event.input is None and (key := (event.law, *event.values)) in sure
        }

    def all_cut_sets(self, known: Mapping[int, bool]) -> Sequence[frozenset[int]] | None:
        """Return all minimal cut sets, with events known or not; None as `minimal_cut_sets`."""
        return _cut_sets(len(self.events), self.gates, self.top, tuple(known.items()))

    @cached_property
    def cut_sets(self) -> Sequence[frozenset[int]] | None:
        """All minimal cut sets where they give bounds; None: else, too many, or not coherent."""
        return self.all_cut_sets({}) if self.bounded else None

    @cached_property
    def diagram(self) -> Diagram | None:
        """The diagram as it runs, None where cut sets give bounds; may raise TooLargeError."""
        if self.cut_sets is not None:
            return None
        observed = frozenset(i for i, event in enumerate(self.events) if event.input is not None)
        numbers = (len(self.events), self.gates, self.top, observed, self.limit)
        return _diagram(*numbers, tuple(self.certain.items()))


_cut_sets = lru_cache(maxsize=8)(minimal_cut_sets)
_diagram = lru_cache(maxsize=8)(build)
Component = Markov | Propulsion | Battery | Processor | KOutOfN | Series | FaultTree


class LoweredSystem(NamedTuple):
    """What the top of a system uses."""

    components: Mapping[str, Component]  # by name; each behind those that it uses
    # name -> fragment path of the element in the EDDI, empty where it came from none
    places: Mapping[str, str]
    rules: dict[str, Rule]  # input id -> what it may hold
    owners: dict[str, str]  # input id -> the first model that reads it
    # model -> inputs on which it depends, with those of the models that it uses
    uses: dict[str, tuple[str, ...]]


def lower(system: ReliabilitySystem) -> LoweredSystem:
    """Return what the runtime evaluates of a checked system."""
    models = system.used_models()
    places = {model.name: model.place.path or "" for model in models}
    components = {model.name: _lowered(model) for model in models}
    return connected(components, places, mission_end=system.mission_end)


def connected(
    components: Mapping[str, Component], places: Mapping[str, str], *, mission_end: bool
) -> LoweredSystem:
    """Return models, each behind those that it uses, with the inputs that they read."""
    system = LoweredSystem(components, places, {}, {}, {})
    for name, component in components.items():
        inputs: list[str] = []
        for read, rule in _reads(component):
            if rule is None:
                inputs += system.uses[read]
            else:
                system.rules.setdefault(read, rule)
                system.owners.setdefault(read, name)
                inputs.append(read)
        system.uses[name] = tuple(dict.fromkeys(inputs))
    if mission_end:
        system.rules[MISSION_END] = _SECONDS
    return system


def _reads(component: Component) -> list[tuple[str, Rule | None]]:
    """Return the inputs of a model with what they may hold, and the models that it uses."""
    match component:
        case Markov():
            return [(input_, _BOOL) for _, input_, _ in component.observe]
        case Propulsion():
            of_list = Rule("bool[]", length=len(component.inputs))
            return [(id_, _BOOL if at is None else of_list) for id_, at in component.inputs]
        case KOutOfN():
            most = 10_000.0 if component.largest is None else float(component.largest)
            return [(component.available, Rule("int", 0.0, most))]
        case Series():
            return [(part, None) for part in component.parts]
        case FaultTree():
            pairs = (((e.model, None), (e.input, _BOOL)) for e in component.events)
            return [(name, rule) for of in pairs for name, rule in of if name]
    level = [(component.level, _LEVEL)] if isinstance(component, Battery) else []
    heat = [(component.heat.temperature, _TEMPERATURE)] if component.heat else []
    load = None if isinstance(component, Battery) else component.load
    return [*level, *heat, *([(load[0], _LOAD)] if load else [])]


def _lowered(model: ComponentModel) -> Component:
    values, content = model.values, model.content
    id_ = partial(input_id, model.name)

    def numbers(*keys: str) -> Iterator[float]:
        return (float(values.get(key, 0.0)) for key in keys)

    if isinstance(content, TreeModel):
        return lower_tree(model.name, content)
    if isinstance(content, ChainModel):
        number = {state: i for i, state in enumerate(content.states)}
        observe = tuple((number[seen.state], seen.input, seen.negated) for seen in content.observe)
        return Markov(chain_of(content), observe, content.repair)
    if model.type == "series":
        return Series(model.uses)
    if model.type == "k_out_of_n":
        return KOutOfN(values["k"], float(values["rate"]), values["max"], id_("available"))
    if model.type == "propulsion":
        motors = sorted(range(len(values["rates"])), key=values["positions"].__getitem__)
        chain = rotors_chain(values["configuration"], [float(values["rates"][m]) for m in motors])
        status = id_("status") if values["status"] == "list" else None
        inputs = tuple((status, m) if status else (id_(f"motor_{m}"), None) for m in motors)
        sets = tuple(tuple(sorted(failed)) for failed in survived(values["configuration"]))
        return Propulsion(chain, sets, inputs, values["repair"])
    heat = None
    if "t_ref" in values:
        heat = Heat(id_("temperature"), *numbers("activation_energy", "t_ref", "t_max"))
    if model.type == "battery":
        chain = battery_chain(*numbers("failure_rate", "alpha", "beta", "degradation"))
        return Battery(chain, id_("level"), heat, values["repair"])
    assert heat is not None, "a processor has its temperatures"
    load = id_("utilisation"), values["u_max"]
    mean, shape, age = numbers("mttf_ref", "shape", "age")
    return Processor(mean, shape, heat, load, age)


def chain_of(chain: ChainModel) -> Chain:
    """Return a chain by numbers of its states."""
    number = {state: i for i, state in enumerate(chain.states)}
    arcs = tuple((number[arc.source], number[arc.target], arc.rate) for arc in chain.arcs)
    fail = tuple(number[state] for state in chain.fail)
    return Chain(chain.states, number[chain.initial[0]], fail, arcs, chain.age)


def lower_tree(name: str, tree: TreeModel) -> FaultTree:
    """Return a tree by numbers: ports are ORs, dynamic gates are events."""
    names, _ = tree.reached()
    dynamic = [key for key in names if key in tree.gates and tree.gates[key].type in DYNAMIC]
    inputs_of_dynamic = {below for key in dynamic for below in tree.gates[key].of}
    number: dict[str, int] = {}
    event_of: dict[str, int] = {}
    events: list[Event] = []
    for key in names:
        if key in tree.events and key not in inputs_of_dynamic:
            event = tree.events[key]
            law, place = event.law, event.place.path or ""
            assert law is not None, "a checked tree has the law of each event"
            seen = input_id(name, key) if event.observed else None
            age = tree.age if event.age is None else event.age
            number[key] = len(events)
            if law.model and seen is None:  # two events of one other model are the same event
                number[key] = event_of.setdefault(law.model, len(events))
            if number[key] == len(events):
                form = (law.kind, law.values, law.model)
                events.append(Event(event.name, *form, seen, age, place))
    for key in dynamic:
        gate = tree.gates[key]
        number[key] = len(events)
        laws = [tree.events[below].law for below in gate.of]
        rates = tuple(law.values[0] for law in laws if law)
        # SAND: independent continuous events never happen at the same instant
        never = Event(key, "fixed", (0.0,))
        is_never = gate.type == "SAND"
        events.append(never if is_never else Event(key, gate.type, rates, age=tree.age))
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
    limit = tree.node_limit or NODE_LIMIT
    numbered = (tuple(events), tuple(gates), tuple(shown), number[tree.top])
    return FaultTree(*numbered, tree.repair, tree.approximate, limit)
