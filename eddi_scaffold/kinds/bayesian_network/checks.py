"""From what a reader found to a network, with everything that is wrong, whatever the source."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import islice, product

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, has_errors, problem
from eddi_scaffold.kinds.bayesian_network.network import Draft, Named, Network, Node, in_digits

TOLERANCE = 1e-5
"""A row may be off by so much: libraries write probabilities with six digits."""
_ROUNDING = 1e-12
_MOST_BY_ROUNDING = 1e-3
"""Of numbers with three digits or more: with fewer, rounding hides real faults."""
_SHOWN = 4
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?")


def check_network(
    name: str, drafts: Sequence[Draft], place: Place
) -> tuple[Network | None, list[Problem]]:
    """Check the drafts of a network's nodes (B101 to B113)."""
    if not drafts:
        return None, [problem("B101.empty", place)]
    known = {draft.id: draft for draft in reversed(drafts)}
    check = _Check(known, SimilarNames(known))
    check.names(drafts)
    for draft in drafts:
        check.states(draft)
        check.parents(draft)
    check.cycles(drafts)
    nodes = [check.node(draft) for draft in drafts]
    if has_errors(check.problems):
        return None, check.problems
    return Network(name, tuple(node for node in nodes if node), place), check.problems


@dataclass
class _Check:
    known: dict[str, Draft]
    near: SimilarNames
    problems: list[Problem] = field(default_factory=list)

    def names(self, drafts: Iterable[Draft]) -> None:
        first: dict[str, Draft] = {}
        for draft in drafts:
            if not draft.id:
                self._report("B101.unnamed_node", draft.place)
            elif draft.id in first:
                line = first[draft.id].place.line
                self._report("B101.duplicate_node", draft.place, draft=draft.id, line=line)
            first.setdefault(draft.id, draft)

    def states(self, draft: Draft) -> None:
        counts = Counter(state.text for state in draft.states)
        for state in draft.states:
            if not state.text:
                self._report("B101.unnamed_state", state.place, draft=draft.id)
            elif counts[state.text] > 1:
                self._report("B101.duplicate_state", state.place, draft=draft.id, state=state.text)
                counts[state.text] = 1
        if not draft.states:
            self._report("B101.no_states", draft.place, draft=draft.id)

    def parents(self, draft: Draft) -> None:
        seen: set[str] = set()
        for parent in draft.parents:
            if parent.text not in self.known:
                self._report(
                    "B105.unknown_parent",
                    parent.place,
                    hint=self.near.hint(parent.text),
                    draft=draft.id,
                    parent=parent.text,
                )
            elif parent.text in seen:
                self._report(
                    "B105.duplicate_parent", parent.place, parent=parent.text, draft=draft.id
                )
            seen.add(parent.text)

    def cycles(self, drafts: Sequence[Draft]) -> None:
        """Report one cycle for each knot of nodes."""
        state: dict[str, int] = {}
        for draft in drafts:
            path: list[str] = []
            walk = [(draft.id, iter(self._parents_of(draft)))] if draft.id not in state else []
            if walk:
                state[draft.id] = 1
                path.append(draft.id)
            while walk:
                name, rest = walk[-1]
                parent = next(rest, None)
                if parent is None:
                    state[name] = 2
                    walk.pop()
                    path.pop()
                elif state.get(parent) == 1:
                    circle = [*path[path.index(parent) :], parent]
                    self._report("B106", self.known[parent].place, circle=" <- ".join(circle))
                elif parent not in state:
                    state[parent] = 1
                    path.append(parent)
                    walk.append((parent, iter(self._parents_of(self.known[parent]))))

    def node(self, draft: Draft) -> Node | None:
        """Check the table; ``None`` when it has an error."""
        before = len(self.problems)
        shapes = [self._states_of(parent) for parent in draft.parents]
        names = [parent.text for parent in draft.parents]
        if draft.broken or None in shapes or len(set(names)) < len(names):
            return None  # reported before
        own = [state.text for state in draft.states]
        parents = [states for states in shapes if states is not None]
        if draft.values is None:
            self._report("B110.no_table", draft.place, draft=draft.id)
            return None
        counts = [*(len(states) for states in parents), len(own)]
        if len(draft.values) != math.prod(counts):
            expected = " x ".join(map(str, counts[:8])) + (" x ..." if len(counts) > 8 else "")
            self._report(
                "B110.table_length",
                draft.values_place,
                draft=draft.id,
                actual=len(draft.values),
                expected=in_digits(math.prod(counts)),
                factors=expected,
            )
            return None
        if not own:
            return None
        table = self._table(draft, parents, len(own))
        if has_errors(self.problems[before:]):
            return None
        title = draft.title or draft.id
        return Node(draft.id, title, tuple(own), tuple(names), table, draft.target, draft.place)

    def _table(
        self, draft: Draft, parents: Sequence[Sequence[str]], width: int
    ) -> tuple[float, ...]:
        assert draft.values is not None
        found: list[float] = []
        largest, at = 0.0, draft.values_place
        names = [parent.text for parent in draft.parents]
        for row, states in enumerate(product(*parents)):
            place = draft.rows[row] if row < len(draft.rows) else draft.values_place
            texts = draft.values[row * width : (row + 1) * width]
            where = ", ".join(f"{n}={s}" for n, s in zip(names, states, strict=True))
            numbers = [self._number(text, draft.id, where, place) for text in texts]
            if None in numbers:
                continue
            given = [number for number in numbers if number is not None]
            values = [min(max(number, 0.0), 1.0) for number in given]
            total = math.fsum(values)
            off = max(abs(total - 1.0), -min(given), max(given) - 1.0)
            if off > TOLERANCE + _ROUNDING and off > (most := _by_rounding(texts)) + _ROUNDING:
                row_of = f"the row {where} of {draft.id!r} sums"
                what = row_of if where else f"the probabilities of {draft.id!r} sum"
                self._report(
                    "B113.sum", place, subject=what, total=total, most=max(most, TOLERANCE)
                )
                continue
            if off > largest:
                largest, at = off, place
            found += values if total == 1.0 else [value / total for value in values]
        if largest > _ROUNDING:
            self.problems.append(problem("B113.normalised", at, draft=draft.id, largest=largest))
        return tuple(found)

    def _number(self, text: str, node: str, where: str, place: Place) -> float | None:
        value = float(text) if _NUMBER.fullmatch(text) else math.nan
        if -TOLERANCE <= value <= 1.0 + TOLERANCE:
            return value
        row = f" in row {where}" if where else ""
        hint = "a number from 0 to 1 with a decimal point" if "," in text else None
        self._report("B112", place, hint=hint, text=text, node=node, row=row)
        return None

    def _parents_of(self, draft: Draft) -> list[str]:
        return [parent.text for parent in draft.parents if parent.text in self.known]

    def _states_of(self, parent: Named) -> list[str] | None:
        draft = self.known.get(parent.text)
        return [state.text for state in draft.states] if draft is not None else None

    def _report(
        self, case: str, place: Place, /, *, hint: str | None = None, **fields: object
    ) -> None:
        self.problems.append(problem(case, place, hint=hint, **fields))


def _by_rounding(texts: Sequence[str]) -> float:
    """Return how far from 1 the sum of a row may be because its numbers have so few digits."""
    parts = [text.lower().partition("e")[::2] for text in texts]
    digits = [len(mantissa.partition(".")[2]) for mantissa, _ in parts]
    plain = max((n for n, (_, power) in zip(digits, parts, strict=True) if not power), default=0)
    places = [
        max(n - int(power[:6]), 0) if power else plain
        for n, (_, power) in zip(digits, parts, strict=True)
    ]
    return min(sum(0.5 * 10.0**-n for n in places), _MOST_BY_ROUNDING)


def unsupported(of: str, nodes: Sequence[Named], hint: str) -> Problem:
    """Return one problem for all nodes of a type that no monitor can have (B202).

    Args:
        of: the type, as the file calls it.
        nodes: at least one.
        hint: what to do.
    """
    names = ", ".join(repr(node.text) for node in nodes[:_SHOWN])
    more = f" and {len(nodes) - _SHOWN} more" if len(nodes) > _SHOWN else ""
    what = f"the node {names} is" if len(nodes) == 1 else f"the nodes {names}{more} are"
    return problem("B202.node_type", nodes[0].place, hint=hint, subject=what, type=of)


def no_variable(name: str, place: Place, hint: str | None = None) -> Problem:
    """Return the problem with a table of a variable that the file does not have (B205)."""
    return problem("B205.unknown_variable", place, hint=hint, name=name)


def defined_twice(name: str, line: int | None, place: Place) -> Problem:
    """Return the problem with the second table of a variable; the first is in a line (B110)."""
    return problem("B110.duplicate_definition", place, name=name, line=line)


def first_missing(
    parents: Sequence[str], states: Sequence[Sequence[str]], there: set[tuple[str, ...]]
) -> tuple[int, list[str]]:
    """Return how many combinations of the parents' states are missing, and the first three."""
    total = math.prod(len(state) for state in states)
    lacking = (combination for combination in product(*states) if combination not in there)
    shown = [
        ", ".join(f"{n}={s}" for n, s in zip(parents, combination, strict=True))
        for combination in islice(lacking, 3)
    ]
    return total - len(there), shown
