"""Test vectors of a ConSert: minimal path and cut sets, unknown inputs, MC/DC, leaves, filters."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.evidence.vectors import MOST_BYTES, MOST_INPUTS, age_row, text, vectors_file
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Dimension,
    Evidence,
    Range,
)
from eddi_scaffold.kinds.consert.ranges import exact

if TYPE_CHECKING:
    from eddi_scaffold.kinds.consert.options import ConSertOptions
    from eddi_scaffold.program.input_expressions import BoundInput

Sets = list[frozenset[str]]
MOST_SETS, MOST_VECTORS, DRAWN = 64, 4096, 256
_MOST_PRODUCTS, _MOST_WORK = 4096, 1_000_000  # of sets; beyond, vectors are drawn
_MOST_STEPS = 200_000  # of all vectors, where a filter needs several steps for each
_F, _U, _T = range(3)
_LETTERS = "FUT"


class ConSertVectors:
    """The vectors of a ConSert, by definition over its graph."""

    def __init__(self, consert: ConSert) -> None:
        self.consert = consert
        self.defaults = {one.id for one in consert.guarantees if one.default}
        self._ors = {gate.id for gate in consert.gates if gate.function == "Or"}
        leaves = {*consert.leaves}
        self._inner = [id_ for id_ in in_order(consert.inputs) if id_ not in leaves]
        self.paths = self._sets(is_path=True)
        self.cuts = self._sets(is_path=False)

    def _sets(self, *, is_path: bool) -> dict[str, Sets | None]:
        """Return the minimal sets of leaves of each node whose TRUE gives it, or FALSE ends it."""
        work = 0
        sets: dict[str, Sets | None] = {leaf: [frozenset([leaf])] for leaf in self.consert.leaves}
        for id_ in self._inner:
            sources = () if id_ in self.defaults else self.consert.inputs[id_]
            is_choice = (id_ in self._ors) is is_path
            result: Sets | None = [] if is_choice else [frozenset()]
            for of in (sets[source] for source in sources):
                if result is None or of is None or len(result) * len(of) > _MOST_PRODUCTS:
                    result = None
                    break
                both = [*result, *of] if is_choice else [a | b for a in result for b in of]
                work += sum(map(len, both))
                kept: Sets = []
                for one in sorted(set(both), key=lambda one: (len(one), sorted(one))):
                    if not any(other <= one for other in kept):
                        kept.append(one)
                result = kept if len(kept) <= 4 * MOST_SETS and work < _MOST_WORK else None
            sets[id_] = result
        return sets

    def verdicts(self, leaves: Mapping[str, int]) -> str:
        """Return the letter of each guarantee."""
        values = dict(leaves)
        for id_ in self._inner:
            is_or = id_ in self._ors
            of = [values[source] for source in self.consert.inputs[id_]]
            value = (max if is_or else min)(of, default=_F if is_or else _T)
            values[id_] = _T if id_ in self.defaults else value
        return "".join(_LETTERS[values[one.id]] for one in self.consert.guarantees)

    def letters(self, leaves: Mapping[str, int]) -> str:
        """Return the letter of each leaf."""
        return "".join(_LETTERS[leaves[id_]] for id_ in self.consert.leaves)

    def where(self, inside: Iterable[str], value: int, rest: int) -> dict[str, int]:
        """Return all leaves at ``rest``, but those inside at ``value``."""
        return dict.fromkeys(self.consert.leaves, rest) | dict.fromkeys(inside, value)

    def pair(self, leaf: str) -> dict[str, int]:
        """Return leaves where this one decides about a guarantee, if there are such."""
        known = (self.paths[one.id] or () for one in self.consert.guarantees)
        path = next((path for sets in known for path in sets if leaf in path), frozenset())
        return self.where(path, _T, _F)

    def of(self, guarantee: str) -> Iterator[tuple[str, dict[str, int]]]:
        """Yield the vectors of a guarantee, each with its class; drawn where sets are too many."""
        paths, cuts, at = self.paths[guarantee], self.cuts[guarantee], self.where
        if not self.complete(guarantee) or paths is None or cuts is None:
            draw = random.Random(guarantee)  # noqa: S311 - the same vectors every time
            for number in range(DRAWN):  # mostly TRUE to mostly FALSE: a constant tells nothing
                likely = number % 16 / 15
                leaves = {
                    id_: _U if draw.random() < 1 / 16 else _T * (draw.random() < likely)
                    for id_ in self.consert.leaves
                }
                yield "drawn", leaves
            yield "unknown", at((), _T, _U)
            return
        for sets, name, inside, rest in ((paths, "path", _T, _F), (cuts, "cut", _F, _T)):
            for one in sets:
                yield name, at(one, inside, rest)
                yield f"{name}_rest_unknown", at(one, inside, _U)
                for id_ in sorted(one):
                    yield "unknown", at(one, inside, rest) | {id_: _U}
        yield "unknown", at((), _T, _U)
        left = [id_ for id_ in self.consert.leaves if any(id_ in path for path in paths)]
        starts = [*paths, *(frozenset(left) - cut for cut in cuts)]
        while left:
            grown = (self._mcdc(start, left, paths) for start in starts)
            chosen, left = min(grown, key=lambda of: len(of[1]))
            yield from (("mcdc", at(inside, _T, _F)) for inside in chosen)

    def _mcdc(
        self, start: frozenset[str], left: Sequence[str], paths: Sets
    ) -> tuple[Sets, list[str]]:
        """Return n + 1 vectors with the pairs of n leaves, and the leaves without one."""
        chosen, rest = [start], [*left]
        for inside in chosen:
            for id_ in [*rest]:
                other = inside ^ {id_}
                if len({any(path <= of for path in paths) for of in (inside, other)}) == 2:
                    chosen.append(other)
                    rest.remove(id_)
        return chosen, rest

    def complete(self, guarantee: str) -> bool:
        """Return whether its path and cut sets are few enough for a vector each."""
        both = self.paths[guarantee], self.cuts[guarantee]
        return all(sets is not None and len(sets) <= MOST_SETS for sets in both)


def consert_vectors(
    consert: ConSert,
    options: ConSertOptions,
    inputs: Sequence[BoundInput],
    about: Mapping[str, str],
) -> str:
    """Return the content of ``vectors.json``; ``about`` says of which model it is."""
    if len(inputs) > MOST_INPUTS:
        return ""
    vectors = ConSertVectors(consert)
    bound, nodes = {input_.id: input_ for input_ in inputs}, {n.id: n for n in consert.leaf_nodes}
    judged = {id_: [*_judged(nodes[id_], bound[id_].factor)] for id_ in consert.leaves}
    states = {id_: _states(rows) for id_, rows in judged.items()}
    active = [one.id for one in consert.guarantees if not one.default]
    steps = options.filter_steps if options.filter == "debounce" else 1
    complete = all(map(vectors.complete, active))

    def reachable(leaves: Mapping[str, int]) -> dict[str, int]:
        """Return leaves of which each can be what it is; a range may have all numbers."""
        rest = leaves.items()
        return {
            id_: _U if value != _U and states[id_][value] is None else value for id_, value in rest
        }

    lists: dict[str, list[Any]] = {
        "shown": [shown(nodes[input_.id], input_.factor) for input_ in inputs],
        "guarantees": [
            [one.id, options.published(one.id), one.default, one.ranking]
            for one in consert.guarantees
        ],
        "services": [[one.id, [*one.members]] for one in consert.provided_services],
        "states": [[id_, *states[id_][::2]] for id_ in consert.leaves],
        "paths": [],
        "leaves": [],
        "ages": [],
        "filter": [*_filtered(vectors, options, active, reachable)],
    }
    if complete:
        lists["paths"] = [[id_, [sorted(p) for p in vectors.paths[id_] or ()]] for id_ in active]
    size = len(vectors_file(about, inputs, lists, complete=complete)) + 1000
    for id_ in consert.leaves:
        leaves = reachable(vectors.pair(id_))
        verdicts = {letter: vectors.verdicts({**leaves, id_: k}) for k, letter in enumerate("FUT")}
        row = [id_, vectors.letters(leaves), verdicts]
        fresh, late = (_flags(options, consert, verdicts[letter]) for letter in "TU")
        ages = [*filter(None, [age_row(bound[id_], row[1], fresh, late)])]
        size += len(text([row, judged[id_], ages])) + 20
        if size > MOST_BYTES // 2:
            complete = False
            break
        lists["leaves"].append([*row, judged[id_]])
        lists["ages"] += ages
    rows: dict[str, str] = {}
    for guarantee in active:
        for class_, given in vectors.of(guarantee):
            leaves = reachable(given)
            letters = vectors.letters(leaves)
            row_text = f"{letters} {vectors.verdicts(leaves)} {class_}:{guarantee}"
            size += 0 if letters in rows else len(row_text.encode()) + 10
            if size > MOST_BYTES or len(rows) == min(MOST_VECTORS, _MOST_STEPS // steps):
                complete = False
                break
            rows.setdefault(letters, row_text)
    lists["vectors"] = [*rows.values()]
    return vectors_file(about, inputs, lists, complete=complete, steps=steps)


def _flags(options: ConSertOptions, consert: ConSert, verdicts: str) -> dict[str, bool]:
    ids = (options.published(guarantee.id) for guarantee in consert.guarantees)
    return {id_: letter == "T" for id_, letter in zip(ids, verdicts, strict=True)}


def _states(rows: Sequence[tuple[object, str]]) -> list[object]:
    """Return values of a leaf that are FALSE, UNKNOWN and TRUE; ``None`` where none is."""
    plain = [(value, verdict) for value, verdict in rows if not isinstance(value, dict)]
    return [next((value for value, verdict in plain if verdict == of), None) for of in _LETTERS]


def shown(node: Evidence | Demand, factor: tuple[int, int] | None) -> tuple[Any, ...] | None:
    """Return how a value is shown to people: what is needed, unit, factor."""
    dimension = dimension_of(node)
    if isinstance(dimension, BinaryDimension | CategoricalDimension):
        return None
    unit = "%" if dimension.uom in {"percent", "pct"} else dimension.uom or ""
    needs = " or ".join(covered.short for covered in dimension.covered)
    return f"{needs} {unit}".rstrip(), unit, factor or (1, 1)


def dimension_of(node: Evidence | Demand) -> Dimension:
    """Return what is judged of a leaf: a demand is a Boolean at run time."""
    return node.dimension if isinstance(node, Evidence) else BinaryDimension("")


def _judged(
    node: Evidence | Demand, factor: tuple[int, int] | None
) -> Iterator[tuple[object, str]]:
    """Yield values of a leaf with their verdicts; one in braces is of no type of JSON."""
    dimension = dimension_of(node)
    yield from ((value, "U") for value in (None, {"is": "nan"}, {"is": "object"}, {"is": "absent"}))
    if isinstance(dimension, BinaryDimension):
        yield from ((value, "T" if value is dimension.value else "F") for value in (True, False))
        yield from ((value, "U") for value in (1, 0, 2, 1.0, "True", "true", ""))
        return
    yield from ((value, "U") for value in (True, False))
    if isinstance(dimension, CategoricalDimension):
        texts = [*dimension.covered, *(text.swapcase() for text in dimension.covered), "", "-"]
        for text in dict.fromkeys(texts):
            yield text, "T" if text in dimension.covered else "F"
        yield from ((value, "U") for value in (0, 1.5))
        return
    yield from ((value, "U") for value in ("1", ""))
    covered: list[tuple[Range, float, float]] = [
        (one, in_unit(one.start, factor), in_unit(one.end, factor)) for one in dimension.covered
    ]
    ends = [end for _, start, end_ in covered for end in (start, end_)]
    declared = [end.value for one in dimension.covered for end in (one.start, one.end)]
    near = [math.nextafter(end, to) for end in ends for to in (-math.inf, math.inf)]
    middles = [start / 2 + end / 2 for _, start, end in covered if math.isfinite(start + end)]
    for value in sorted({*ends, *declared, *near, *middles, 0.0, math.inf, -math.inf}):
        shown = value if math.isfinite(value) else {"is": str(value)}
        yield shown, "T" if any(_covers(*one, value) for one in covered) else "F"


def _covers(covered: Range, start: float, end: float, value: float) -> bool:
    is_above = value >= start if covered.start_inclusive else value > start
    return is_above and (value <= end if covered.inclusive else value < end)


def in_unit(bound: Bound, factor: tuple[int, int] | None) -> float:
    """Return the double that is next to a bound, in the unit of the input."""
    value = exact(bound)
    if factor is None or isinstance(value, float):
        return bound.value
    try:
        return float(value * Fraction(factor[1], factor[0]))
    except OverflowError:
        return math.copysign(math.inf, value)


def _filtered(
    vectors: ConSertVectors,
    options: ConSertOptions,
    active: Sequence[str],
    reachable: Callable[[Mapping[str, int]], dict[str, int]],
) -> Iterator[list[object]]:
    """Yield steps of a leaf through a filter: letters, how often, verdicts at the end of them."""
    leaves = [path for id_ in active for path in vectors.paths[id_] or () if path]
    steps = options.filter_steps
    if not options.filter or not leaves or steps > _MOST_STEPS // 10:
        return
    leaf = min(leaves[0])
    base, half = reachable(vectors.pair(leaf)), steps // 2
    if options.filter == "debounce":
        rows = [(_F, steps, _F), (_T, steps - 1, _F), (_T, 1, _T), (_U, 1, _U)]
        rows += [(_T, steps - 1, _U), (_T, 1, _T), (_F, 1, _F)]
    else:
        rows = [(_F, steps, _F), (_T, half, _F), (_T, 1, _T), (_F, steps - half - 1, _T)]
        rows += [(_F, 1, _F), (_F, steps, _F), (_U, half, _F), (_U, 1, _U)]
    for raw, times, verdict in rows:
        if times:
            given, counts = {**base, leaf: raw}, {**base, leaf: verdict}
            yield [vectors.letters(given), times, vectors.letters(counts), vectors.verdicts(counts)]
