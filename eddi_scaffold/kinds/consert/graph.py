"""The graph of a ConSert: what feeds what, and its path sets.

Path sets are the minimal sets of leaves whose being TRUE makes a node TRUE. ConSerts have no
negation, so these sets describe a node completely. They are found from the leaves upwards by MOCUS
(Fussell and Vesely 1972): union for And, collection for Or, absorption after each step.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from eddi_scaffold.common.graphs import in_order

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from eddi_scaffold.common.graphs import Graph
    from eddi_scaffold.kinds.consert.model import ConSert

CAP = 256
"""Most sets that are kept for one node."""
_BUDGET = 3_000_000
_MOST_SETS, _MOST_IDS = 64, 2_000
"""Most sets of a guarantee that stand in ``compiled.py``, and a reviewer reads; ids in all sets."""

Sets = frozenset[int]
"""Path sets as bit masks; empty: constant FALSE; with 0: constant TRUE."""


class Work:
    """What may still be spent on path sets: they can grow exponentially."""

    def __init__(self) -> None:
        self.remaining = _BUDGET

    def spend(self, amount: int) -> bool:
        """Take an amount of work; ``False`` when there is not enough left."""
        self.remaining -= amount
        return self.remaining >= 0


def node_ids(consert: ConSert) -> list[str]:
    """Return the ids of all nodes: evidence, demands, gates and guarantees, in file order."""
    groups = (consert.evidence, consert.demands, consert.gates, consert.guarantees)
    return [node.id for group in groups for node in group]


def inputs_of(consert: ConSert) -> Graph:
    """Return what feeds each node; edges from or to unknown ids are left out."""
    inputs: dict[str, dict[str, None]] = {id_: {} for id_ in node_ids(consert)}
    for edge in consert.tree_propagations:
        if edge.source in inputs and edge.target in inputs:
            inputs[edge.target][edge.source] = None
    return {id_: tuple(sources) for id_, sources in inputs.items()}


def leaves_of(consert: ConSert) -> list[str]:
    """Return evidence, then demands: bit ``n`` of a mask is leaf ``n`` of this list."""
    return [node.id for group in (consert.evidence, consert.demands) for node in group]


def constants(consert: ConSert) -> dict[str, bool | None]:
    """Return for each node whether it is constant TRUE or FALSE; ``None``: it depends on leaves.

    Linear in the size of the ConSert, with the meaning of :func:`path_sets`.
    """
    inputs, defaults = inputs_of(consert), _defaults(consert)
    ors = {gate.id for gate in consert.gates if gate.function == "Or"}
    values: dict[str, bool | None] = dict.fromkeys(leaves_of(consert))
    for id_ in in_order(inputs):
        if id_ in values:
            continue
        if id_ in defaults:
            values[id_] = True
            continue
        given = [values[source] for source in inputs[id_]]
        wins = id_ in ors
        if wins in given:
            values[id_] = wins
        else:
            values[id_] = None if None in given else not wins
    return values


def path_sets(consert: ConSert) -> dict[str, Sets | None]:
    """Return the path sets of every node; ``None`` where there are too many.

    A default guarantee holds always; a guarantee or gate without input is what an And or Or
    without input is.
    """
    inputs, defaults = inputs_of(consert), _defaults(consert)
    ors = {gate.id for gate in consert.gates if gate.function == "Or"}
    found: dict[str, Sets | None] = {
        id_: frozenset({1 << index}) for index, id_ in enumerate(leaves_of(consert))
    }
    work = Work()
    for id_ in in_order(inputs):
        if id_ in defaults:
            found[id_] = frozenset({0})
        elif id_ not in found:
            given = [found[source] for source in inputs[id_]]
            found[id_] = combined(given, is_or=id_ in ors, work=work)
    return found


def combined(inputs: Sequence[Sets | None], *, is_or: bool, work: Work) -> Sets | None:
    """Return the path sets of an And or Or over nodes with these path sets.

    None where there are more than :data:`CAP`, or where they are not worth the work.
    """
    known = [sets for sets in inputs if sets is not None]
    if len(known) != len(inputs):
        return None
    if is_or:
        return _minimal({mask for sets in known for mask in sets}, work)
    result: Sets | None = frozenset({0})
    for sets in known:
        if result is None or len(result) * len(sets) > CAP * CAP:
            return None
        result = _minimal({first | second for first in result for second in sets}, work)
    return result


def _minimal(masks: Iterable[int], work: Work) -> Sets | None:
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


def written_paths(consert: ConSert) -> list[list[tuple[str, ...]]] | None:
    """Return the path sets of each guarantee as ids of leaves, by size and then by ids.

    None where there are too many to be written down: then they are searched on the robot.
    """
    sets, leaves = path_sets(consert), leaves_of(consert)
    written = []
    for guarantee in consert.guarantees:
        masks = sets[guarantee.id]
        if masks is None or len(masks) > _MOST_SETS:
            return None
        paths = (
            tuple(sorted(id_ for k, id_ in enumerate(leaves) if mask >> k & 1)) for mask in masks
        )
        written.append(sorted(paths, key=lambda path: (len(path), path)))
    ids = sum(len(path) for paths in written for path in paths)
    return written if ids <= _MOST_IDS else None


def _defaults(consert: ConSert) -> set[str]:
    return {guarantee.id for guarantee in consert.guarantees if guarantee.default}


def implies(first: Sets, second: Sets) -> bool:
    """Return whether the second holds whenever the first does."""
    return all(any(other & mask == other for other in second) for mask in first)


def redundant_inputs(
    id_: str,
    inputs: Graph,
    found: Mapping[str, Sets | None],
    *,
    is_or: bool,
    work: Work,
) -> set[str]:
    """Return the inputs of a node without any of which its path sets stay the same."""
    sources, whole = inputs[id_], found[id_]
    given = [found[source] for source in sources]
    if len(sources) < 2 or whole is None:
        return set()
    if is_or:
        count = Counter(mask for sets in given for mask in sets or ())
        return {
            source
            for source, sets in zip(sources, given, strict=True)
            if all(count[mask] > (mask in (sets or ())) for mask in whole)
        }
    before = _running(given, work)
    behind = _running(given[::-1], work)[::-1]
    others = zip(sources, before, behind[1:], strict=False)
    return {s for s, *rest in others if combined(rest, is_or=False, work=work) == whole}


def _running(given: Sequence[Sets | None], work: Work) -> list[Sets | None]:
    """Return the And of none, of the first, of the first two ... of some nodes."""
    found: list[Sets | None] = [frozenset({0})]
    for sets in given:
        found.append(combined([found[-1], sets], is_or=False, work=work))
    return found
