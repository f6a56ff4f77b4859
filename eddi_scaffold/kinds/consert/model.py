"""The ConSert as data: guarantees supported by gates over runtime evidence and demands.

Source: SESAME D7.2 section 3.1; Schneider and Trapp, "Conditional Safety Certification of Open
Adaptive Systems" (2013). Lists keep the order of the file, which is the order of every output.
Places do not count in comparisons: two files with the same content hold equal ConSerts.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from eddi_scaffold.common.problems import Place
from eddi_scaffold.kinds.consert.names import published_class

NAME = "consert"

Subset = Literal["Demand", "Guarantee", "Equals", "Intersection"]
"""How the values of a guarantee and of the demand that it fulfils lie to each other: those of the
demand inside, those of the guarantee inside, the same, or some in common. The demand decides; a
guarantee or evidence may have none."""
GateFunction = Literal["And", "Or"]


@dataclass(frozen=True)
class Bound:
    """One end of a range.

    Attributes:
        text: decimal text as written, for exact comparison and for output.
        value: the same as a double; may be infinite, never NaN in a checked model.
    """

    text: str
    value: float


@dataclass(frozen=True)
class Range:
    """A range of numbers in the unit of its dimension.

    Attributes:
        inclusive: the end lies inside as well (``Inclusive``), or outside (``Exclusive``).
        start_inclusive: the start lies inside, as it always does in YAML.
    """

    start: Bound
    end: Bound
    inclusive: bool
    place: Place = field(default=Place(), compare=False)
    start_inclusive: bool = True


@dataclass(frozen=True)
class BinaryDimension:
    """A property that holds or does not hold.

    Attributes:
        value: what is good, expected or guaranteed; true unless an EDDI says false.
    """

    type: str
    place: Place = field(default=Place(), compare=False)
    value: bool = True


@dataclass(frozen=True)
class CategoricalDimension:
    """A property with named values, one of which is expected to be among ``covered``."""

    type: str
    covered: tuple[str, ...]
    subset: Subset | None
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class NumericDimension:
    """A number with a unit, expected to lie in one of the ``covered`` ranges.

    Attributes:
        uom: unit as written; ``""`` is a ratio, ``None`` means that none was given (C016).
    """

    type: str
    covered: tuple[Range, ...]
    subset: Subset | None
    uom: str | None
    place: Place = field(default=Place(), compare=False)


Dimension = BinaryDimension | CategoricalDimension | NumericDimension


@dataclass(frozen=True)
class Evidence:
    """Runtime evidence: one property that is observed on this system while it runs."""

    id: str
    dimension: Dimension
    description: str | None = None
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Demand:
    """A guarantee expected from another system."""

    id: str
    dimensions: tuple[Dimension, ...]
    description: str | None = None
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Guarantee:
    """A property that this system assures while its support holds.

    Attributes:
        default: holds always and has no support (DEIS: the fallback of its service).
        ranking: lowest is best; ``None`` when not given.
    """

    id: str
    dimensions: tuple[Dimension, ...]
    description: str | None = None
    default: bool = False
    ranking: int | None = None
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Gate:
    """A Boolean function over its inputs."""

    id: str
    function: GateFunction
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Propagation:
    """An edge: ``source`` supports ``target`` (ids)."""

    source: str
    target: str
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class RequiredService:
    """A service expected from another system, with the ids of the demands it groups.

    Attributes:
        allocated: places of the services that are to provide it, as the file says.
    """

    id: str
    functional_service_type: str
    demands: tuple[str, ...]
    place: Place = field(default=Place(), compare=False)
    allocated: tuple[Place, ...] = field(default=(), compare=False)


@dataclass(frozen=True)
class ProvidedService:
    """A service offered to other systems, with the ids of the guarantees it groups.

    Attributes:
        allocated: places of the services that it is to provide, as the file says.
    """

    id: str
    functional_service_type: str
    guarantees: tuple[str, ...]
    place: Place = field(default=Place(), compare=False)
    allocated: tuple[Place, ...] = field(default=(), compare=False)


@dataclass(frozen=True)
class ConSert:
    """A conditional safety certificate: a directed acyclic graph from evidence to guarantees.

    Attributes:
        system: name of the system that it is of, empty where the file does not say it.
    """

    name: str
    guarantees: tuple[Guarantee, ...]
    demands: tuple[Demand, ...]
    evidence: tuple[Evidence, ...]
    gates: tuple[Gate, ...]
    tree_propagations: tuple[Propagation, ...]
    required_services: tuple[RequiredService, ...]
    provided_services: tuple[ProvidedService, ...]
    place: Place = field(default=Place(), compare=False)
    system: str = ""


@dataclass(frozen=True)
class ConSertOptions:
    """What a configuration chooses.

    Attributes:
        guarantee_ids: ``source``: messages have the ids of the model; ``class``: SESAME D7.2's
            names of classes.
        filter: ``debounce`` or ``majority`` of the leaves, empty for none.
        filter_steps: over how many steps.
    """

    guarantee_ids: str = "source"
    filter: str = ""
    filter_steps: int = 1

    def published(self, id_: str) -> str:
        """Return the id of a guarantee in messages."""
        return published_class(id_) if self.guarantee_ids == "class" else id_

    def hold_s(self, frequency: float) -> float:
        """Return for how many seconds a majority may hold after it was lost: half its window."""
        return self.filter_steps // 2 / frequency if self.filter == "majority" else 0.0
