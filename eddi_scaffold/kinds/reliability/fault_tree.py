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


class _TooMuchError(Exception):
    """More sets, or more work on them, than there may be."""


def minimal_cut_sets(
    events: int,
    gates: Sequence[Gate],
    top: int,
    known: Iterable[tuple[int, bool]] = (),
    *,
    work: int = WORK,
) -> tuple[frozenset[int], ...] | None:
    """Return the minimal cut sets as sets of events, shortest first; known events are in none.

    None where the tree has NOT or XOR, so that no set of events is sufficient, where a gate has
    more than ``CUT_SETS`` sets, or where more than so many are made and compared.
    """
    used = used_gates(events, gates, top)
    if any(gate.type not in COHERENT for gate in used.values()):
        return None
    sets_of = {n: [1 << n] for n in (top, *(n for gate in used.values() for n in gate.of))}
    sets_of.update((n, [0] if is_certain else []) for n, is_certain in known)
    search = _Search(work)
    try:
        for n, gate in used.items():
            sets_of[n] = search.sets_of_gate(gate, [sets_of[below] for below in gate.of])
    except _TooMuchError:
        return None
    sets = [_members(cut_set) for cut_set in sets_of[top]]
    return tuple(frozenset(cut_set) for cut_set in sorted(sets, key=lambda s: (len(s), s)))


class _Search:
    """Combines cut sets, whose bit ``i`` is event ``i``, with at most so much work."""

    def __init__(self, work: int) -> None:
        self._work = work

    def sets_of_gate(self, gate: Gate, below: list[list[int]]) -> list[int]:
        needed = {"OR": 1, "AND": len(below)}.get(gate.type, gate.k)
        if needed == 1 or not below:
            self._spend(sum(map(len, below)))
            return self._minimal(cut_set for sets in below for cut_set in sets)
        rows: list[list[int]] = [[0]] + [[] for _ in range(needed)]  # at least j of those so far
        for done, sets in enumerate(below, 1):
            # a row that the inputs that remain cannot fill up is of no use
            for j in range(min(needed, done), max(0, needed - (len(below) - done) - 1), -1):
                self._spend(len(rows[j - 1]) * len(sets) + len(rows[j]))
                both = [fewer | cut_set for fewer in rows[j - 1] for cut_set in sets]
                rows[j] = self._minimal(rows[j] + both)
        return rows[needed]

    def _spend(self, work: int) -> None:
        self._work -= work
        if self._work < 0:
            raise _TooMuchError

    def _minimal(self, sets: Iterable[int]) -> list[int]:
        kept: list[int] = []
        ordered = sorted(set(sets), key=lambda cut_set: (cut_set.bit_count(), cut_set))
        for _, same_size in groupby(ordered, int.bit_count):  # none of them contains another
            new = []
            for cut_set in same_size:
                self._spend(1 + len(kept))
                if not any(other & cut_set == other for other in kept):
                    new.append(cut_set)
            kept += new
        if len(kept) > CUT_SETS:
            raise _TooMuchError
        return kept


def _members(cut_set: int) -> list[int]:
    events = []
    while cut_set:
        lowest = cut_set & -cut_set
        events.append(lowest.bit_length() - 1)
        cut_set ^= lowest
    return events
