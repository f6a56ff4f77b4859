"""What the tree of a ConSert says whatever the evidence: constants and path sets.

Path sets are the minimal sets of leaves whose being TRUE makes a node TRUE. ConSerts have no
negation, so these sets describe a node completely. They are found from the leaves upwards by MOCUS
(Fussell and Vesely 1972): union for And, collection for Or, absorption after each step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
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


class Work:
    """What may still be spent on path sets: they can grow exponentially."""

    remaining = _BUDGET

    def spend(self, amount: int) -> bool:
        """Take an amount of work; ``False`` when there is not enough left."""
        self.remaining -= amount
        return self.remaining >= 0


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
    """Return the path sets of every node; ``None`` where there are too many."""
    own: list[Sets | None] = [frozenset({1 << index}) for index in range(len(consert.leaves))]
    return _values(consert, own, frozenset({0}), partial(_combined, Work()))


def _combined(work: Work, inputs: Sequence[Sets | None], is_or: bool) -> Sets | None:
    """Return the path sets of an And or Or over nodes with these path sets.

    None where there are more than :data:`MOST_SETS`, or where they are not worth the work.
    """
    known = [sets for sets in inputs if sets is not None]
    if len(known) != len(inputs):
        return None
    if is_or:
        return _minimal({mask for sets in known for mask in sets}, work)
    result: Sets | None = frozenset({0})
    for sets in known:
        if result is None or len(result) * len(sets) > MOST_SETS * MOST_SETS:
            return None
        result = _minimal({first | second for first in result for second in sets}, work)
    return result


def _minimal(masks: Iterable[int], work: Work) -> Sets | None:
    """Return the masks that contain no other one; ``None`` beyond the most or the budget."""
    minimal: list[int] = []
    for mask in sorted(masks, key=lambda m: (m.bit_count(), m)):
        if not work.spend(len(minimal) + 1):
            return None
        if not any(other & mask == other for other in minimal):
            minimal.append(mask)
            if len(minimal) > MOST_SETS:
                return None
    return frozenset(minimal)


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
