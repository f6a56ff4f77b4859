"""Gates of fault trees by number, and minimal cut sets (Fussell and Vesely 1972).

Nothing here recurses, since trees may be deep.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple, TypeVar

COHERENT = frozenset({"OR", "AND", "VOTE"})
CUT_SETS = 10_000  # Sets below any gate
WORK = 20_000_000  # Sets that are made and compared for one tree, about a second
T = TypeVar("T", bound=Hashable)
CutSet = frozenset[int]


class Gate(NamedTuple):
    """A gate: ``of`` are numbers of events, or of gates counted behind the events."""

    type: str
    of: tuple[int, ...]
    k: int = 0


def order(top: T, below: Mapping[T, Sequence[T]]) -> tuple[list[T], tuple[T, ...]]:
    """Return all that the top reaches, each behind what it uses, or else a cycle, in its order."""
    done: dict[T, None] = {}
    path: dict[T, None] = {}
    waiting: list[tuple[T, bool]] = [(top, False)]
    while waiting:
        node, is_left = waiting.pop()
        if is_left:
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


def used_gates(events: int, gates: Sequence[Gate], top: int) -> dict[int, Gate]:
    """Return the gates that the top reaches, by number, each behind those that it refers to."""
    numbered = dict(enumerate(gates, events))
    reached = order(top, {number: gate.of for number, gate in numbered.items()})[0]
    return {number: numbered[number] for number in reached if number in numbered}


class TooLargeError(Exception):
    """A diagram has more nodes, or there are more cut sets or work on them, than there may be."""


def minimal_cut_sets(
    events: int,
    gates: Sequence[Gate],
    top: int,
    known: Iterable[tuple[int, bool]] = (),
    *,
    work: int = WORK,
) -> tuple[CutSet, ...] | None:
    """Return the minimal cut sets as sets of events, shortest first; known events are in none.

    None where the tree has NOT or XOR, so that no set of events is sufficient, where a gate has
    more than ``CUT_SETS`` sets, or where more than so many are made and compared.
    """
    used = used_gates(events, gates, top)
    if any(gate.type not in COHERENT for gate in used.values()):
        return None
    sets_of = {n: [frozenset((n,))] for n in (top, *(n for g in used.values() for n in g.of))}
    sets_of |= {n: [frozenset()] if is_certain else [] for n, is_certain in known}

    def spend(number: int) -> None:
        nonlocal work
        work -= number
        if work < 0:
            raise TooLargeError

    def minimal(sets: Iterable[CutSet]) -> list[CutSet]:
        kept: list[CutSet] = []
        for _, same_size in groupby(sorted(set(sets), key=len), len):  # none contains another
            new = [*same_size]
            spend(len(new) * (1 + len(kept)))
            kept += [of for of in new if not any(other <= of for other in kept)]
        if len(kept) > CUT_SETS:
            raise TooLargeError
        return kept

    def sets_of_gate(gate: Gate) -> list[CutSet]:
        below = [sets_of[n] for n in gate.of]
        needed = {"OR": 1, "AND": len(below)}.get(gate.type, gate.k)
        if needed == 1 or not below:
            return minimal(cut_set for sets in below for cut_set in sets)
        rows: list[list[CutSet]] = [
            [frozenset()],
            *([] for _ in range(needed)),
        ]  # j of those so far
        for done, sets in enumerate(below, 1):
            # a row that the inputs that remain cannot fill up is of no use
            for j in range(min(needed, done), max(0, needed - (len(below) - done) - 1), -1):
                spend(len(rows[j - 1]) * len(sets))
                both = [fewer | cut_set for fewer in rows[j - 1] for cut_set in sets]
                rows[j] = minimal(rows[j] + both)
        return rows[needed]

    try:
        for number, gate in used.items():
            sets_of[number] = sets_of_gate(gate)
    except TooLargeError:
        return None
    return tuple(sorted(sets_of[top], key=lambda of: (len(of), sorted(of))))
