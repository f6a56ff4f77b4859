"""The ConSert as data: guarantees supported by gates over runtime evidence and demands.

Source: SESAME D7.2 section 3.1; Schneider and Trapp, "Conditional Safety Certification of Open
Adaptive Systems" (2013). Lists keep the order of the file, which is the order of every output.
Places do not count in comparisons: two files with the same content hold equal ConSerts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, Literal

from eddi_scaffold.common.graphs import Graph
from eddi_scaffold.common.problems import Place

Subset = Literal["Demand", "Guarantee", "Equals", "Intersection"]
"""How the values of a guarantee and of the demand that it fulfils lie to each other: those of the
demand inside, those of the guarantee inside, the same, or some in common. The demand decides; a
guarantee or evidence may have none."""
GateFunction = Literal["And", "Or"]


@dataclass(frozen=True)
class Bound:
    """One end of a range."""

    text: str  # decimal text as written, for exact comparison and for output
    value: float  # the same as a double; may be infinite, never NaN in a checked model


@dataclass(frozen=True)
class Range:
    """A range of numbers in the unit of its dimension."""

    start: Bound
    end: Bound
    inclusive: bool  # the end lies inside as well (`Inclusive`), or outside (`Exclusive`)
    place: Place = field(default=Place(), compare=False)
    start_inclusive: bool = True  # the start lies inside, as it always does in YAML

    def text(self, unit: str | None = None) -> str:
        """Return it for people: ``[0, 5] m``, ``[0, 5)``."""
        opening, closing = "[" if self.start_inclusive else "(", "]" if self.inclusive else ")"
        ends = f"{opening}{self.start.text}, {self.end.text}{closing}"
        return f"{ends} {unit}" if unit else ends

    @property
    def short(self) -> str:
        """What it asks for, as the short form of ConSerts has it: ``20 .. 100``, ``below 5``."""
        start, end = self.start.text, self.end.text
        least = "at least" if self.start_inclusive else "above"
        if math.isinf(self.start.value):
            return f"{'at most' if self.inclusive else 'below'} {end}"
        if math.isinf(self.end.value):
            return f"{least} {start}"
        between = f"{start} {'..' if self.inclusive else '..<'} {end}"
        return between if self.start_inclusive else f"above {between}"

    def covers(self, value: float) -> bool:
        """Return whether a number lies inside."""
        return (
            self.start.value < value < self.end.value
            or (self.inclusive and value == self.end.value)
            or (self.start_inclusive and value == self.start.value)
        )


RANGES = {
    (True, True): "Inclusive",
    (True, False): "Exclusive",
    (False, True): "StartExclusive",
    (False, False): "BothExclusive",
}
"""Whether the start and the end lie inside -> what YAML calls the range."""


@dataclass(frozen=True)
class BinaryDimension:
    """A property that holds or does not hold."""

    type: str
    place: Place = field(default=Place(), compare=False)
    value: bool = True  # what is good, expected or guaranteed; true unless an EDDI says false

    @property
    def text(self) -> str:
        """What is good, in one line."""
        return self.type if self.value else f"{self.type} is false"

    def covers(self, value: object) -> bool:
        """Return whether a value at run time is good."""
        return value is self.value


@dataclass(frozen=True)
class CategoricalDimension:
    """A property with named values, one of which is expected to be among ``covered``."""

    type: str
    covered: tuple[str, ...]
    subset: Subset | None = None
    place: Place = field(default=Place(), compare=False)

    @property
    def covered_text(self) -> str:
        """The values: ``{low, middle}``."""
        return f"{{{', '.join(self.covered)}}}"

    @property
    def text(self) -> str:
        """What is good, in one line: ``Risk in {low, middle}``."""
        return f"{self.type} in {self.covered_text}"

    def covers(self, value: object) -> bool:
        """Return whether a value at run time is good."""
        return value in self.covered


@dataclass(frozen=True)
class NumericDimension:
    """A number with a unit, expected to lie in one of the ``covered`` ranges."""

    type: str
    covered: tuple[Range, ...]
    subset: Subset | None = None
    uom: str | None = None  # unit as written; `""` is a ratio, `None`: none was given (C016)
    place: Place = field(default=Place(), compare=False)

    @property
    def covered_text(self) -> str:
        """The ranges: ``[0, 5) m or [7, 9] m``."""
        return " or ".join(covered.text(self.uom) for covered in self.covered)

    @property
    def text(self) -> str:
        """What is good, in one line: ``Distance in [0, 5) m``."""
        return f"{self.type} in {self.covered_text}"

    def covers(self, value: object) -> bool:
        """Return whether a value at run time is good."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False
        return any(covered.covers(value) for covered in self.covered)


Dimension = BinaryDimension | CategoricalDimension | NumericDimension


@dataclass(frozen=True)
class Evidence:
    """Runtime evidence: one property that is observed on this system while it runs."""

    kind: ClassVar[str] = "evidence"
    id: str
    dimension: Dimension
    description: str | None = None
    place: Place = field(default=Place(), compare=False)

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Its dimension, as other nodes have several."""
        return (self.dimension,)


@dataclass(frozen=True)
class Demand:
    """A guarantee expected from another system."""

    kind: ClassVar[str] = "demand"
    id: str
    dimensions: tuple[Dimension, ...]
    description: str | None = None
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Guarantee:
    """A property that this system assures while its support holds."""

    kind: ClassVar[str] = "guarantee"
    id: str
    dimensions: tuple[Dimension, ...]
    description: str | None = None
    default: bool = False  # holds always and has no support (DEIS: the fallback of its service)
    ranking: int | None = None  # lowest is best; `None` when not given
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Gate:
    """A Boolean function over its inputs."""

    kind: ClassVar[str] = "gate"
    id: str
    function: GateFunction
    place: Place = field(default=Place(), compare=False)


Node = Evidence | Demand | Gate | Guarantee


@dataclass(frozen=True)
class Propagation:
    """An edge: ``source`` supports ``target`` (ids)."""

    source: str
    target: str
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class _Service:
    member_kind: ClassVar[str]
    id: str
    functional_service_type: str

    @property
    def members(self) -> tuple[str, ...]:
        """The ids of what it groups, each once."""
        return tuple(dict.fromkeys(getattr(self, f"{self.member_kind}s")))


@dataclass(frozen=True)
class RequiredService(_Service):
    """A service expected from another system, with the ids of the demands that it groups."""

    kind: ClassVar[str] = "required service"
    member_kind: ClassVar[str] = "demand"
    demands: tuple[str, ...]
    place: Place = field(default=Place(), compare=False)
    # places of the services that are to provide it, as the file says
    allocated: tuple[Place, ...] = field(default=(), compare=False)


@dataclass(frozen=True)
class ProvidedService(_Service):
    """A service offered to other systems, with the ids of the guarantees that it groups."""

    kind: ClassVar[str] = "provided service"
    member_kind: ClassVar[str] = "guarantee"
    guarantees: tuple[str, ...]
    place: Place = field(default=Place(), compare=False)
    # places of the services that it is to provide, as the file says
    allocated: tuple[Place, ...] = field(default=(), compare=False)


Service = RequiredService | ProvidedService


@dataclass(frozen=True)
class ConSert:
    """A conditional safety certificate: a directed acyclic graph from evidence to guarantees."""

    name: str
    guarantees: tuple[Guarantee, ...]
    demands: tuple[Demand, ...]
    evidence: tuple[Evidence, ...]
    gates: tuple[Gate, ...]
    tree_propagations: tuple[Propagation, ...]
    required_services: tuple[RequiredService, ...]
    provided_services: tuple[ProvidedService, ...]
    place: Place = field(default=Place(), compare=False)
    system: str = ""  # name of the system that it is of, empty where the file does not say it

    @property
    def leaf_nodes(self) -> tuple[Evidence | Demand, ...]:
        """What comes from outside."""
        return (*self.evidence, *self.demands)

    @property
    def nodes(self) -> tuple[Node, ...]:
        """All nodes, what comes from outside first."""
        return (*self.evidence, *self.demands, *self.gates, *self.guarantees)

    @property
    def services(self) -> tuple[Service, ...]:
        """All services."""
        return (*self.required_services, *self.provided_services)

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """The ids of evidence, then of demands."""
        return tuple(node.id for node in self.leaf_nodes)

    @cached_property
    def inputs(self) -> Graph:
        """What supports each node; without edges from or to unknown ids, and into leaves."""
        inputs: dict[str, dict[str, None]] = {node.id: {} for node in self.nodes}
        leaves = set(self.leaves)
        for edge in self.tree_propagations:
            if edge.source in inputs and edge.target in inputs and edge.target not in leaves:
                inputs[edge.target][edge.source] = None
        return {id_: tuple(sources) for id_, sources in inputs.items()}
