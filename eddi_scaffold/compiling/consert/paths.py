"""Path sets: the minimal sets of leaves whose being TRUE makes a node TRUE.

ConSerts have no negation, so these sets describe a node completely. They are found from the leaves
upwards by MOCUS (Fussell and Vesely 1972): union for And, collection for Or, absorption after
each step. Sets are bit masks over the leaves.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold.compiling.consert.graph import Graph

CAP = 256
"""Most sets that are kept for one node."""

_BUDGET = 3_000_000
_MOST = 64
"""Most sets of a guarantee that stand in ``compiled.py``, and a reviewer reads."""
_MOST_IDS = 2_000
"""The same of ids in all of them."""

Sets = frozenset[int]
"""Path sets as bit masks; empty: constant FALSE; with 0: constant TRUE."""


class Work:
    """What may still be spent on path sets: they can grow exponentially."""

    def __init__(self) -> None:
        self.left = _BUDGET

    def spend(self, amount: int) -> bool:
        """Take an amount of work; ``False`` when there is not enough left."""
        self.left -= amount
        return self.left >= 0


def combined(given: Sequence[Sets | None], *, is_or: bool, work: Work) -> Sets | None:
    """Return the path sets of an And or Or over nodes with these path sets.

    None where there are more than :data:`CAP`, or where they are not worth the work.
    """
    known = [sets for sets in given if sets is not None]
    if len(known) != len(given):
        return None
    if is_or:
        return minimal({mask for sets in known for mask in sets}, work)
    result: Sets | None = frozenset({0})
    for sets in known:
        if result is None or len(result) * len(sets) > CAP * CAP:
            return None
        result = minimal({first | second for first in result for second in sets}, work)
    return result


def minimal(masks: Iterable[int], work: Work) -> Sets | None:
    """Return the masks that contain no other one; ``None`` beyond the cap or the budget."""
    kept: list[int] = []
    for mask in sorted(masks, key=lambda m: (m.bit_count(), m)):
        if not work.spend(len(kept) + 1):
            return None
        if not any(other & mask == other for other in kept):
            kept.append(mask)
            if len(kept) > CAP:
                return None
    return frozenset(kept)


def written_paths(graph: Graph) -> list[tuple[tuple[str, ...], ...]] | None:
    """Return the path sets of each guarantee as ids of inputs, by size and then by ids.

    None where there are too many to be written down: then they are searched on the robot.
    """
    work = Work()
    found: list[Sets | None] = [frozenset({1 << k}) for k in range(graph.leaves)]
    for node in graph.nodes:
        given = [found[source] for source in node.inputs]
        found.append(combined(given, is_or=not node.is_and, work=work))
    wanted = [found[k] for k in graph.guarantees]
    written = [_named(sets, graph) for sets in wanted if sets is not None and len(sets) <= _MOST]
    ids = sum(len(path) for paths in written for path in paths)
    return written if len(written) == len(wanted) and ids <= _MOST_IDS else None


def _named(sets: Sets, graph: Graph) -> tuple[tuple[str, ...], ...]:
    paths = (
        tuple(sorted(graph.names[k] for k in range(graph.leaves) if mask >> k & 1)) for mask in sets
    )
    return tuple(sorted(paths, key=lambda path: (len(path), path)))
