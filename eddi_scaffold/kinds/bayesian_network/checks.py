"""From what a reader found to a network, with everything that is wrong, whatever the source."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice, product
from typing import Any

from eddi_scaffold.common.graphs import cycles
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, has_errors, problem
from eddi_scaffold.kinds.bayesian_network import network

LARGEST = 1_000_000
"""Entries of a table that a reader fills: it doubles with each parent of two states."""
TOLERANCE = 1e-3  # A row may be off by so much: of four states, with three digits each
_ROUNDING = 1e-12
_NORMALISED = 2.0**-51
"""A row that was divided by its sum may be off by so much: it is not divided again."""
_SHOWN = 4
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?")


def check_network(
    name: str, drafts: Sequence[network.Draft], place: Place
) -> tuple[network.Network | None, list[Problem]]:
    """Check the drafts of a network's nodes (B101 to B113)."""
    if not drafts:
        return None, [problem("B101.empty", place)]
    known = {draft.id: draft for draft in reversed(drafts)}
    problems = [*_check_structure(drafts, known)]
    nodes = []
    for draft in drafts:
        reader = _TableReader(draft, known)
        nodes += reader.read()
        problems += reader.problems
    if has_errors(problems):
        return None, problems
    return network.Network(name, tuple(nodes), place), problems


def _check_structure(
    drafts: Sequence[network.Draft], known: Mapping[str, network.Draft]
) -> Iterator[Problem]:
    """Yield what is wrong with names, states and arcs."""
    similar = SimilarNames(known)
    for draft in drafts:
        first = known[draft.id]
        if not draft.id:
            yield problem("B101.unnamed_node", draft.place)
        elif draft is not first:
            line = first.place.line
            yield problem("B101.duplicate_node", draft.place, draft=draft.id, line=line)
        if not draft.states:
            yield problem("B101.no_states", draft.place, draft=draft.id)
        counts = Counter(state.text for state in draft.states)
        for state in draft.states:
            fields = {"draft": draft.id, "state": state.text}
            if not state.text:
                yield problem("B101.unnamed_state", state.place, draft=draft.id)
            elif counts[state.text] > 1:
                yield problem("B101.duplicate_state", state.place, **fields)
                counts[state.text] = 1
        seen: set[str] = set()
        for parent in draft.parents:
            fields = {"draft": draft.id, "parent": parent.text}
            if parent.text not in known:
                hint = similar.hint(parent.text)
                yield problem("B105.unknown_parent", parent.place, hint=hint, **fields)
            elif parent.text in seen:
                yield problem("B105.duplicate_parent", parent.place, **fields)
            seen.add(parent.text)
    parents = {
        name: [parent.text for parent in draft.parents if parent.text in known]
        for name, draft in known.items()
    }
    for first_id, *others in cycles({draft.id: parents[draft.id] for draft in drafts}):
        circle = " <- ".join([first_id, *reversed(others), first_id])
        yield problem("B106", known[first_id].place, circle=circle)


class _TableReader:
    def __init__(self, draft: network.Draft, known: Mapping[str, network.Draft]) -> None:
        self.problems: list[Problem] = []
        self._draft = draft
        self._drafts_of_parents = [known.get(parent.text) for parent in draft.parents]

    def read(self) -> list[network.Node]:
        """Return the node; nothing when its table has an error."""
        draft, count = self._draft, len(self._draft.states)
        names = tuple(parent.text for parent in draft.parents)
        parents = {
            parent.id: [state.text for state in parent.states]
            for parent in self._drafts_of_parents
            if parent is not None
        }
        are_sound = all(states and len({*states}) == len(states) for states in parents.values())
        if draft.broken or len(parents) < len(names) or (draft.rows is not None and not are_sound):
            return []  # reported before
        rows: list[network.Row] = []
        if draft.rows is not None:
            rows = self._rows(draft.rows, parents)
        elif draft.values is None:
            self._report("B110.no_table", draft.place, draft=draft.id)
        else:
            rows = self._cut(draft.values, [*map(len, parents.values()), count])
        if not draft.states or has_errors(self.problems):
            return []
        table = self._table(rows, parents)
        if has_errors(self.problems):
            return []
        own = tuple(state.text for state in draft.states)
        title = draft.title or draft.id
        return [network.Node(draft.id, title, own, names, table, draft.target, draft.place)]

    def _cut(self, values: Sequence[str], counts: Sequence[int]) -> list[network.Row]:
        """Return the rows of a complete table."""
        draft, size, width = self._draft, math.prod(counts), counts[-1]
        if len(values) != size:
            factors = " x ".join(map(str, counts[:8])) + (" x ..." if len(counts) > 8 else "")
            self._report(
                "B110.table_length",
                draft.values_place,
                draft=draft.id,
                actual=len(values),
                expected=network.in_digits(size),
                factors=factors,
            )
            return []
        starts = range(0, size, width) if width else ()
        return [(values[k : k + width], draft.values_place) for k in starts]

    def _rows(
        self, rows: Mapping[tuple[str, ...], network.Row], parents: Mapping[str, Sequence[str]]
    ) -> list[network.Row]:
        """Return the rows in the order of the table; none after an error."""
        draft, width = self._draft, len(self._draft.states)
        known = [(parent, {*of}, SimilarNames(of)) for parent, of in parents.items()]
        for case, (_, place) in rows.items():
            if len(case) != len(parents):
                counts = f"{len(case)} states, it has {len(parents)} parents"
                self._report("B110.row_parents", place, name=draft.id, listed=counts)
            for (parent, states, similar), state in zip(known, case, strict=False):
                if state not in states:
                    fields = {"hint": similar.hint(state), "state": state, "parent": parent}
                    self._report("B205.unknown_parent_state", place, **fields)
        for numbers, place in [*rows.values(), *([draft.default] if draft.default else [])]:
            if len(numbers) != width:
                actual = len(numbers)
                self._report("B110.row_length", place, name=draft.id, actual=actual, expected=width)
        count = math.prod(map(len, parents.values()))
        if draft.default is not None and count * width > LARGEST:
            name, size = draft.id, network.in_digits(count * width)
            place = draft.values_place
            self._report("B110.table_too_large", place, name=name, size=size, limit=LARGEST)
        elif draft.default is None and not has_errors(self.problems) and count > len(rows):
            lacking = (case for case in product(*parents.values()) if case not in rows)
            shown = [_shown(parents, case) for case in islice(lacking, 3)]
            number = count - len(rows)
            self._report(
                "B110.missing_rows",
                draft.values_place,
                name=draft.id,
                number=number,
                rows="row" if number == 1 else "rows",
                shown="; ".join(shown),
                rest=", ..." if number > len(shown) else "",
            )
        if has_errors(self.problems):
            return []
        default = draft.default or ((), draft.values_place)
        return [rows.get(case, default) for case in product(*parents.values())]

    def _table(
        self, rows: Sequence[network.Row], parents: Mapping[str, Sequence[str]]
    ) -> tuple[float, ...]:
        draft = self._draft
        table: list[float] = []
        largest, largest_place = 0.0, draft.values_place
        for (texts, place), states in zip(rows, product(*parents.values()), strict=True):
            case = _shown(parents, states)
            numbers = [number for text in texts for number in self._number(text, case, place)]
            if len(numbers) < len(texts):
                continue
            values = [min(max(number, 0.0), 1.0) for number in numbers]
            total = math.fsum(values)
            off = max(abs(total - 1.0), -min(numbers), max(numbers) - 1.0)
            if off > TOLERANCE + _ROUNDING:
                row_of = f"the row {case} of {draft.id!r} sums"
                what = row_of if case else f"the probabilities of {draft.id!r} sum"
                self._report("B113.sum", place, subject=what, total=total, most=TOLERANCE)
                continue
            if off > largest:
                largest, largest_place = off, place
            is_normalised = abs(total - 1.0) <= _NORMALISED
            table += values if is_normalised else [value / total for value in values]
        if largest > _ROUNDING:
            self._report("B113.normalised", largest_place, draft=draft.id, largest=largest)
        return tuple(table)

    def _number(self, text: str, case: str, place: Place) -> list[float]:
        value = float(text) if _NUMBER.fullmatch(text) else math.nan
        if -TOLERANCE <= value <= 1.0 + TOLERANCE:
            return [value]
        row = f" in row {case}" if case else ""
        hint = "a number from 0 to 1 with a decimal point" if "," in text else None
        self._report("B112", place, hint=hint, text=text, node=self._draft.id, row=row)
        return []

    def _report(
        self, case: str, place: Place, /, *, hint: str | None = None, **fields: Any
    ) -> None:
        self.problems.append(problem(case, place, hint=hint, **fields))


def unsupported(
    nodes: Iterable[tuple[str, network.Named]], advice: Mapping[str, str], otherwise: str
) -> list[Problem]:
    """Return one problem for each type of nodes that no monitor can have (B202)."""
    names: dict[str, list[network.Named]] = {}
    for type_, node in nodes:
        names.setdefault(type_, []).append(node)
    problems = []
    for type_, of_type in names.items():
        shown = ", ".join(repr(node.text) for node in of_type[:_SHOWN])
        more = f" and {len(of_type) - _SHOWN} more" if len(of_type) > _SHOWN else ""
        subject = f"the nodes {shown}{more} are" if len(of_type) > 1 else f"the node {shown} is"
        hint, place = advice.get(type_, otherwise), of_type[0].place
        problems.append(problem("B202.node_type", place, hint=hint, subject=subject, type=type_))
    return problems


def _shown(parents: Iterable[str], case: Sequence[str]) -> str:
    return ", ".join(f"{parent}={state}" for parent, state in zip(parents, case, strict=True))
