"""What the tree of a ConSert says whatever the evidence: constants and path sets.

Path sets are the minimal sets of leaves whose being TRUE makes a node TRUE. ConSerts have no
negation, so these sets describe a node completely. They are found from the leaves upwards by MOCUS
(Fussell and Vesely 1972): union for And, collection for Or, absorption after each step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.kinds.consert.consert import ConSert

MOST_SETS = 256  # Most sets that are kept for one node
_BUDGET = 3_000_000
_MOST_WRITTEN_SETS, _MOST_WRITTEN_IDS = 64, 2_000
"""Most sets of a guarantee that stand in ``compiled.py``, and a reviewer reads; ids in all sets."""

Sets = frozenset[int]
"""Path sets as bit masks of leaves; empty: constant FALSE; with 0: constant TRUE."""
Value = TypeVar("Value")


def _values(
    consert: ConSert,
    leaf_values: Iterable[Value],
    default: Value,
    combine: Callable[[Sequence[Value], bool], Value],
) -> dict[str, Value]:
    """Return the values of all nodes from those of the leaves upwards.

    A default guarantee holds always; a guarantee or gate without input is what an And or Or
    without input is.
    """
    values = dict(zip(consert.leaves, leaf_values, strict=True))
    values |= {guarantee.id: default for guarantee in consert.guarantees if guarantee.default}
    ors = {gate.id for gate in consert.gates if gate.function == "Or"}
    for id_ in in_order(consert.inputs):
        if id_ not in values:
            values[id_] = combine([values[source] for source in consert.inputs[id_]], id_ in ors)
    return values


def constants(consert: ConSert) -> dict[str, bool | None]:
    """Return for each node whether it is constant TRUE or FALSE; ``None``: it depends on leaves.

    Linear in the size of the ConSert, with the meaning of :func:`path_sets`.
    """

    def combined(values: Sequence[bool | None], is_or: bool) -> bool | None:
        if is_or in values:
            return is_or
        return None if None in values else not is_or

    no_values: list[bool | None] = [None] * len(consert.leaves)
    return _values(consert, no_values, default=True, combine=combined)


def path_sets(consert: ConSert) -> dict[str, Sets | None]:
    """Return the path sets of every node; ``None`` where there are too many, or not worth the work.

    Above :data:`MOST_SETS` they are too many; their number can grow exponentially.
    """
    remaining = _BUDGET  # comparisons

    def minimal(masks: Iterable[int]) -> Sets | None:
        nonlocal remaining
        result: list[int] = []
        for mask in sorted(masks, key=lambda m: (m.bit_count(), m)):
            remaining -= len(result) + 1
            if not any(other & mask == other for other in result):
                result.append(mask)
            if remaining < 0 or len(result) > MOST_SETS:
                return None
        return frozenset(result)

    def combined(inputs: Sequence[Sets | None], is_or: bool) -> Sets | None:
        known = [sets for sets in inputs if sets is not None]
        if len(known) != len(inputs):
            return None
        if is_or:
            return minimal({mask for sets in known for mask in sets})
        result: Sets | None = frozenset({0})
        for sets in known:
            if result is None or len(result) * len(sets) > MOST_SETS * MOST_SETS:
                return None
            result = minimal({first | second for first in result for second in sets})
        return result

    own: list[Sets | None] = [frozenset({1 << index}) for index in range(len(consert.leaves))]
    return _values(consert, own, frozenset({0}), combined)


def written_paths(consert: ConSert) -> list[list[tuple[str, ...]]] | None:
    """Return the path sets of each guarantee as ids of leaves, by size and then by ids.

    None where there are too many to be written down: then they are searched on the robot.
    """
    sets = path_sets(consert)
    written = []
    for guarantee in consert.guarantees:
        masks = sets[guarantee.id]
        if masks is None or len(masks) > _MOST_WRITTEN_SETS:
            return None
        paths = (tuple(sorted(leaves_in(consert, mask))) for mask in masks)
        written.append(sorted(paths, key=lambda path: (len(path), path)))
    ids = sum(len(path) for paths in written for path in paths)
    return written if ids <= _MOST_WRITTEN_IDS else None


def leaves_in(consert: ConSert, mask: int) -> list[str]:
    """Return the leaves of a mask."""
    return [id_ for index, id_ in enumerate(consert.leaves) if mask >> index & 1]


def implies(first: Sets, second: Sets) -> bool:
    """Return whether the second holds whenever the first does."""
    return all(any(other & mask == other for other in second) for mask in first)
