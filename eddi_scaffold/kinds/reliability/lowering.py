"""Chains and fault trees as the runtime evaluates them: with numbers for names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

from eddi_scaffold.kinds.reliability.chains import Chain
from eddi_scaffold.kinds.reliability.decision_diagram import NODE_LIMIT, Diagram, build
from eddi_scaffold.kinds.reliability.fault_tree import Gate, minimal_cut_sets
from eddi_scaffold.kinds.reliability.system import DYNAMIC, input_id
from eddi_scaffold.kinds.reliability.system import Chain as ChainModel
from eddi_scaffold.kinds.reliability.system import FaultTree as TreeModel


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


@dataclass(frozen=True)
class FaultTree:
    """A fault tree by numbers: its diagram, or all minimal cut sets, which then give bounds."""

    events: tuple[Event, ...]
    gates: tuple[Gate, ...]  # those that are no events; their numbers follow those of the events
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

    @cached_property
    def cut_sets(self) -> Sequence[frozenset[int]] | None:
        """All minimal cut sets; None: it is not coherent, or there are too many."""
        return _cut_sets(len(self.events), self.gates, self.top, tuple(self.certain.items()))

    @cached_property
    def diagram(self) -> Diagram | None:
        """The diagram as it runs, None where cut sets give bounds; may raise TooLargeError."""
        if self.bounded and self.cut_sets is not None:
            return None
        observed = frozenset(i for i, event in enumerate(self.events) if event.input is not None)
        numbers = (len(self.events), self.gates, self.top, observed, self.limit)
        return _diagram(*numbers, tuple(self.certain.items()))


_cut_sets = lru_cache(maxsize=8)(minimal_cut_sets)
_diagram = lru_cache(maxsize=8)(build)


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
    for key in names:
        if key not in number and key in tree.gates:
            gate = tree.gates[key]
            number[key] = len(events) + len(gates)
            kind = "OR" if gate.type == "NOT" and not gate.of else gate.type
            k = gate.k or 0 if kind == "VOTE" else 0
            gates.append(Gate(kind, tuple(number[below] for below in gate.of), k))
    limit = tree.node_limit or NODE_LIMIT
    numbered = (tuple(events), tuple(gates), number[tree.top])
    return FaultTree(*numbered, tree.repair, tree.approximate, limit)
