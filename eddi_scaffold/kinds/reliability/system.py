"""What a reliability monitor is made of: chains, trees, component models, thresholds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.common.problems import Place

NAME = "reliability"
GATES = ("OR", "AND", "NOT", "XOR", "VOTE", "PAND", "POR", "SAND")
DYNAMIC = ("PAND", "POR", "SAND")
TYPES = (
    "propulsion",
    "battery",
    "processor",
    "k_out_of_n",
    "series",
    "fault_tree",
    "markov",
)


@dataclass(frozen=True)
class Law:
    """How probable a basic event is.

    Attributes:
        kind: ``exponential`` (rate in 1/h), ``weibull`` (scale in h, shape), ``fixed``
            (probability), ``model`` (that of another model).
        values: its numbers.
        model: name of the model.
    """

    kind: str
    values: tuple[float, ...] = ()
    model: str = ""


@dataclass(frozen=True)
class BasicEvent:
    """A basic event; ``law`` is None while no probability was given.

    Attributes:
        name: for people; its id is the key in the tree.
        observed: an input reports whether it has happened.
        age: hours that it had run before the mission; None: as long as the tree.
    """

    name: str
    law: Law | None
    observed: bool = False
    age: float | None = None
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Gate:
    """A gate; ``of`` are ids of events and gates, ``k`` only for VOTE (None: not given).

    Attributes:
        is_port: it passes on what other models of an EDDI may provide; it may be unconnected.
    """

    name: str
    type: str
    of: tuple[str, ...]
    k: int | None = None
    place: Place = field(default=Place(), compare=False)
    is_port: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class FaultTree:
    """A fault tree: the events and gates below one top event, by id.

    Attributes:
        cut_sets: minimal cut sets that the file states, names of events; None: none stated.
        age: hours that its events had run before the mission.
        approximate: bounds by minimal cut sets in place of the diagram.
        bounds_place: where that is asked for.
    """

    top: str
    events: Mapping[str, BasicEvent]
    gates: Mapping[str, Gate]
    repair: bool = False
    node_limit: int | None = None
    cut_sets: frozenset[frozenset[str]] | None = None
    age: float = 0.0
    approximate: bool = False
    bounds_place: Place = field(default=Place(), compare=False)


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
    """A Markov chain; how many initial and fail states it may have is checked later.

    Attributes:
        age: hours that it had run, unobserved, before the mission.
        repair: after it was seen to have failed it may work again.
    """

    states: tuple[str, ...]
    initial: tuple[str, ...]
    fail: tuple[str, ...]
    arcs: tuple[Arc, ...]
    observe: tuple[Observation, ...] = ()
    age: float = 0.0
    repair: bool = False


@dataclass(frozen=True)
class ComponentModel:
    """One model of a monitor.

    Attributes:
        name: unique in its system.
        type: one of ``TYPES``.
        content: of a chain or a tree.
        values: the numbers of the other types, in h, 1/h and degC.
        uses: models that it is made of (those of a tree are in its events).
    """

    name: str
    type: str
    content: FaultTree | Chain | None = None
    values: Mapping[str, Any] = field(default_factory=dict)
    uses: tuple[str, ...] = ()
    place: Place = field(default=Place(), compare=False)

    @property
    def below(self) -> tuple[str, ...]:
        """Names of the models that this one uses."""
        if isinstance(self.content, FaultTree):
            laws = [event.law for event in self.content.events.values()]
            return tuple(dict.fromkeys(law.model for law in laws if law and law.model))
        return self.uses


@dataclass(frozen=True)
class Threshold:
    """Evidence that is active while the probability of failure is small.

    Attributes:
        hold: seconds.
        topic: where it is published by itself; None: only within the whole result.
    """

    id: str
    activate: float
    release: float
    hold: float = 0.0
    topic: str | None = None
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class ReliabilitySystem:
    """Models with a horizon: all that a monitor needs.

    Attributes:
        components: by name, in the order of the file.
        top: model whose numbers are published.
        horizon: hours; the longest one when the mission's end is an input.
        mission_end: the mission's end is an input.
        thresholds: evidence.
        worst_case: evidence follows the worst case of unknown inputs instead of going away.
        max_gap: seconds between two steps that are still usual; None: the value of ``usual_gap``.
        quantum: seconds of one step of the chains.
    """

    components: Mapping[str, ComponentModel]
    top: str
    horizon: float = 1.0
    mission_end: bool = False
    thresholds: tuple[Threshold, ...] = ()
    worst_case: bool = False
    max_gap: float | None = None
    quantum: float = 0.1
    place: Place = field(default=Place(), compare=False)

    @property
    def usual_gap(self) -> float:
        """Seconds between two steps that are still usual: at least a step that is left out."""
        return max(1.0, 2.5 * self.quantum) if self.max_gap is None else self.max_gap


def order(top: str, below: Mapping[str, Sequence[str]]) -> tuple[list[str], tuple[str, ...]]:
    """Return all that the top reaches, each behind what it uses, and a cycle if there is one.

    Args:
        top: where to begin.
        below: what each uses; what has no entry uses nothing.

    Returns:
        The order, incomplete when there is a cycle, and the members of the first cycle, each
        using the next one and the last the first; empty for none.
    """
    done: dict[str, None] = {}
    path: dict[str, None] = {}
    waiting: list[tuple[str, bool]] = [(top, False)]
    while waiting:
        node, leaving = waiting.pop()
        if leaving:
            path.pop(node)
            done[node] = None
        elif node in path:
            members = list(path)
            return list(done), tuple(members[members.index(node) :])
        elif node not in done:
            path[node] = None
            waiting.append((node, True))
            waiting += [(n, False) for n in reversed(below.get(node, ()))]
    return list(done), ()
