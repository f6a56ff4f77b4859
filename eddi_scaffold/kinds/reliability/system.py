"""What a reliability monitor consists of: chains, trees, component models, thresholds; inputs."""

from __future__ import annotations

import operator
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from eddi_scaffold.common.claims import Use
from eddi_scaffold.common.problems import Place
from eddi_scaffold.common.units import accepted
from eddi_scaffold.kinds import InputType, ModelInput
from eddi_scaffold.kinds.reliability.fault_tree import COHERENT, order

NAME = "reliability"
MISSION_END = "mission_end"
GATES = ("OR", "AND", "NOT", "XOR", "VOTE", "PAND", "POR", "SAND")
DYNAMIC = ("PAND", "POR", "SAND")
TYPES = ("propulsion", "battery", "processor", "k_out_of_n", "series", "fault_tree", "markov")
UNITS = {
    **dict.fromkeys(("rate", "rates", "failure_rate", "alpha", "beta", "degradation"), "1/h"),
    **dict.fromkeys(("mttf_ref", "age"), "h"),
    **dict.fromkeys(("t_ref", "t_max"), "degC"),
    "activation_energy": "eV",
}
"""Units of the numbers of ready-made models, as they are kept."""


CONFIGURATIONS: Mapping[str, list[set[int]]] = {
    "PNPN": [{0}, {1}, {2}, {3}],
    "PNPNPN": [{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}],
    "PPNNPN": [{4}, {5}, {0, 1}, {2, 3}],
    "PPNNPPNN": [{0, 1}, {2, 3}, {4, 5}, {6, 7}],
}
"""Direction of rotation of each motor (P and N) -> least sets of motors whose loss is fatal.

Motors are numbered as in the name, from 0. Source: Aslansefat et al. 2019.
"""
_MIRROR = str.maketrans("PN", "NP")
FATAL = {**CONFIGURATIONS, **{c.translate(_MIRROR): of for c, of in CONFIGURATIONS.items()}}
"""The same, with the mirror image of each frame, where P and N are exchanged."""


@dataclass(frozen=True)
class Law:
    """How probable a basic event is."""

    # `exponential` (rate in 1/h), `weibull` (scale in h, shape), `fixed` (probability), `model`
    # (that of another model)
    kind: str
    values: tuple[float, ...] = ()
    model: str = ""


@dataclass(frozen=True)
class BasicEvent:
    """A basic event, whose id is its key in the tree; no law: no probability was given."""

    name: str
    law: Law | None
    observed: bool = False  # an input reports whether it has happened
    age: float | None = None  # hours that it had run before the mission; None: as long as the tree
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Gate:
    """A gate; ``of`` are ids of events and gates, ``k`` only for VOTE (None: not given)."""

    name: str
    type: str
    of: tuple[str, ...]
    k: int | None = None
    place: Place = field(default=Place(), compare=False)
    # it passes on what other models of an EDDI may provide; it may be unconnected
    is_port: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class FaultTree:
    """A fault tree: the events and gates below one top event, by id."""

    top: str
    events: Mapping[str, BasicEvent]
    gates: Mapping[str, Gate]
    repair: bool = False
    node_limit: int | None = None
    age: float = 0.0  # hours that its events had run before the mission
    approximate: bool = False  # bounds by minimal cut sets in place of the diagram
    bounds_place: Place = field(default=Place(), compare=False)  # where that is asked for

    def reached(self) -> tuple[list[str], tuple[str, ...]]:
        """Return what the top reaches, as ``order`` does."""
        return order(self.top, {key: gate.of for key, gate in self.gates.items()})

    def used_gates(self) -> list[Gate]:
        """Return the gates that the top reaches, each behind those that it refers to."""
        return [self.gates[key] for key in self.reached()[0] if key in self.gates]


@dataclass(frozen=True)
class Arc:
    """A transition with its rate in 1/h."""

    source: str
    target: str
    rate: float
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Observation:
    """A state is excluded while the input is false, or, negated, while it is true."""

    state: str
    input: str
    negated: bool = False


@dataclass(frozen=True)
class Chain:
    """A Markov chain; how many initial and fail states it may have is checked later."""

    states: tuple[str, ...]
    initial: tuple[str, ...]
    fail: tuple[str, ...]
    arcs: tuple[Arc, ...]
    observe: tuple[Observation, ...] = ()
    age: float = 0.0  # hours that it had run, unobserved, before the mission
    repair: bool = False  # after it was seen to have failed it may work again


@dataclass(frozen=True)
class ComponentModel:
    """One model of a monitor."""

    name: str
    type: str  # one of `TYPES`
    content: FaultTree | Chain | None = None  # of a chain or a tree
    # the numbers of the other types, in `UNITS`
    values: Mapping[str, Any] = field(default_factory=dict)
    uses: tuple[str, ...] = ()  # models that it is made of (those of a tree are in its events)
    place: Place = field(default=Place(), compare=False)

    @property
    def below(self) -> tuple[str, ...]:
        """Names of the models that this one uses."""
        if isinstance(self.content, FaultTree):
            laws = [event.law for event in self.content.events.values()]
            return tuple(dict.fromkeys(law.model for law in laws if law and law.model))
        return self.uses

    def inputs(self) -> Iterator[ModelInput]:
        """Yield its inputs."""
        content, values, id_ = self.content, self.values, partial(input_id, self.name)
        known: dict[str, Any]

        def described(id_: str, type_: InputType, text: str, **more: Any) -> ModelInput:
            text = re.sub(r"[\s\"'\\]+", " ", text)[:120]
            return ModelInput(
                id_, type_, description=text, units=accepted(more.get("unit")), **more
            )

        if isinstance(content, Chain):
            for seen in content.observe:
                text = f"{seen.negated}: {self.name} is not in state {seen.state}"
                sample = (seen.state in content.initial) is not seen.negated
                covered = "true" if sample else "false"
                yield described(seen.input, "bool", text, sample=sample, covered=covered)
        elif isinstance(content, FaultTree):
            known = {"sample": False, "covered": "false", "is_good": partial(operator.is_, False)}
            for key, event in content.events.items():
                if event.observed:
                    yield described(
                        id_(key), "bool", f"Has the event {event.name} happened?", **known
                    )
        elif self.type == "propulsion" and values["status"] == "list":
            count = len(values["rates"])
            known = {"sample": [True] * count, "covered": "each true"}
            yield described(
                id_("status"), "bool[]", f"Does each of the {count} motors work?", **known
            )
        elif self.type == "propulsion":
            known = {"sample": True, "covered": "true", "is_good": partial(operator.is_, True)}
            for i in range(len(values["rates"])):
                yield described(id_(f"motor_{i}"), "bool", f"Does motor {i} work?", **known)
        elif self.type == "k_out_of_n":
            text = f"How many units are available, {values['k']} are needed"
            known = {"sample": values["max"] or values["k"], "covered": f"at least {values['k']}"}
            yield described(id_("available"), "int", text, **known)
        elif self.type == "battery":
            known = {"sample": 100.0, "covered": "above 25", "unit": "percent"}
            yield described(id_("level"), "float", "State of charge in percent", **known)
        if "t_ref" in values:
            most = values["t_max"]
            known = {"sample": min(values["t_ref"], most), "covered": f"at most {most:g}"}
            text = f"Temperature of the {self.type}"
            yield described(id_("temperature"), "float", text, unit="degC", **known)
        if self.type == "processor":
            known = {"sample": min(1.0, values["u_max"]), "covered": f"0 to {values['u_max']:g}"}
            text = "Load of the processor, 1 for full"
            yield described(id_("utilisation"), "float", text, **known)


@dataclass(frozen=True)
class Threshold:
    """Evidence that is active while the probability of failure is small."""

    id: str
    activate: float
    release: float
    hold: float = 0.0  # seconds
    topic: str | None = None  # where it is published by itself; None: only within the whole result
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class ReliabilitySystem:
    """Models with a horizon: all that a monitor needs."""

    components: Mapping[str, ComponentModel]
    top: str  # model whose numbers are published
    horizon: float = 1.0  # hours; the longest one when the mission's end is an input
    mission_end: bool = False  # the mission's end is an input
    thresholds: tuple[Threshold, ...] = ()
    # evidence follows the worst case of unknown inputs instead of going away
    worst_case: bool = False
    # seconds between two steps that are still usual; None: the value of `usual_gap`
    max_gap: float | None = None
    quantum: float = 0.1  # seconds of one step of the chains
    place: Place = field(default=Place(), compare=False)

    @property
    def usual_gap(self) -> float:
        """Seconds between two steps that are still usual: at least a step that is left out."""
        return max(1.0, 2.5 * self.quantum) if self.max_gap is None else self.max_gap

    def counts(self) -> Mapping[str, int]:
        """Return how many models, states, gates and events there are, without zeros."""
        contents = [component.content for component in self.components.values()]
        trees = [content for content in contents if isinstance(content, FaultTree)]
        numbers = {
            "models": len(self.components),
            "states": sum(len(c.states) for c in contents if isinstance(c, Chain)),
            "gates": sum(len(tree.gates) for tree in trees),
            "events": sum(len(tree.events) for tree in trees),
        }
        return {key: number for key, number in numbers.items() if number}

    def used_models(self) -> list[ComponentModel]:
        """Return the models that the top uses, each behind what it uses."""
        below = {name: component.below for name, component in self.components.items()}
        names = order(self.top, below)[0]
        return [self.components[name] for name in names if name in self.components]

    def without_unused(self) -> ReliabilitySystem:
        """Return the system without models that the top does not use."""
        names = {component.name for component in self.used_models()}
        kept = {name: model for name, model in self.components.items() if name in names}
        return replace(self, components=kept)

    def inputs(self) -> list[ModelInput]:
        """Return the inputs in the order of the models; one that serves two of them once."""
        inputs: dict[str, ModelInput] = {}
        for model in self.components.values():
            for input_ in model.inputs():
                inputs.setdefault(input_.id, input_)
        if self.mission_end:
            text, seconds = "Seconds from now to the end of the mission", self.horizon * 3600.0
            inputs[MISSION_END] = ModelInput(
                MISSION_END, "float", unit="s", description=text, sample=seconds
            )
        trees = [c.content for c in self.components.values() if isinstance(c.content, FaultTree)]
        if all(gate.type in COHERENT for tree in trees for gate in tree.gates.values()):
            # a failure of a part never makes the system better: a threshold gains from what works
            for id_, input_ in inputs.items():
                if input_.type == "bool" and input_.is_good is not None:
                    inputs[id_] = replace(input_, uses=(Use(input_.is_good),))
        return list(inputs.values())


def input_id(model: str, rest: str) -> str:
    """Return the id of an input: names joined, all else than letters and digits as ``_``."""
    return re.sub(r"[^A-Za-z0-9_]", "_", f"{model}_{rest}")
