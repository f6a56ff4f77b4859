"""From what a reader found to a network, with everything that is wrong, whatever the source."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import islice, product

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, error, has_errors, warning
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
    """Check the drafts of a network's nodes (B101 to B114)."""
    if not drafts:
        return None, [error("B101", "the network has no nodes", place)]
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
                self._error("B101", "a node has no name", draft.place)
            elif draft.id in first:
                line = first[draft.id].place.line
                message = f"the node name {draft.id!r} is used twice, first in line {line}"
                self._error("B102", message, draft.place)
            first.setdefault(draft.id, draft)

    def states(self, draft: Draft) -> None:
        counts = Counter(state.text for state in draft.states)
        for state in draft.states:
            if not state.text:
                self._error("B104", f"a state of {draft.id!r} has no name", state.place)
            elif counts[state.text] > 1:
                message = f"the node {draft.id!r} has the state {state.text!r} twice"
                self._error("B104", message, state.place)
                counts[state.text] = 1
        if not draft.states:
            self._error("B103", f"the node {draft.id!r} has no states", draft.place)

    def parents(self, draft: Draft) -> None:
        seen: set[str] = set()
        for parent in draft.parents:
            if parent.text not in self.known:
                message = f"{draft.id!r} has the parent {parent.text!r}, which is not a node"
                self._error("B108", message, parent.place, self.near.hint(parent.text))
            elif parent.text in seen:
                message = f"{parent.text!r} is a parent of {draft.id!r} twice"
                self._error("B105", message, parent.place)
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
                    message = f"the network has a cycle: {' <- '.join(circle)}"
                    self._error("B106", message, self.known[parent].place)
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
            self._error("B110", f"the node {draft.id!r} has no probabilities", draft.place)
            return None
        counts = [*(len(states) for states in parents), len(own)]
        if len(draft.values) != math.prod(counts):
            expected = " x ".join(map(str, counts[:8])) + (" x ..." if len(counts) > 8 else "")
            message = (
                f"the table of {draft.id!r} has {len(draft.values)} values, expected "
                f"{in_digits(math.prod(counts))} ({expected})"
            )
            self._error("B111", message, draft.values_place)
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
                message = f"{what} to {total:.9g}, not to 1"
                self._error(
                    "B113",
                    message,
                    place,
                    f"allowed: 1 within {max(most, TOLERANCE):g}; write more digits",
                )
                continue
            if off > largest:
                largest, at = off, place
            found += values if total == 1.0 else [value / total for value in values]
        if largest > _ROUNDING:
            message = f"rows of {draft.id!r} are normalised: they are off by up to {largest:.3g}"
            self.problems.append(warning("B114", message, at))
        return tuple(found)

    def _number(self, text: str, node: str, where: str, place: Place) -> float | None:
        value = float(text) if _NUMBER.fullmatch(text) else math.nan
        if -TOLERANCE <= value <= 1.0 + TOLERANCE:
            return value
        row = f" in row {where}" if where else ""
        message = f"{text!r} of {node!r}{row} is not a probability"
        hint = "a number from 0 to 1 with a decimal point" if "," in text else None
        self._error("B112", message, place, hint)
        return None

    def _parents_of(self, draft: Draft) -> list[str]:
        return [parent.text for parent in draft.parents if parent.text in self.known]

    def _states_of(self, parent: Named) -> list[str] | None:
        draft = self.known.get(parent.text)
        return [state.text for state in draft.states] if draft is not None else None

    def _error(self, code: str, message: str, place: Place, hint: str | None = None) -> None:
        self.problems.append(error(code, message, place, hint))


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
    return error("B202", f"{what} of type {of!r}, which is not supported", nodes[0].place, hint)


def no_variable(name: str, place: Place, hint: str | None = None) -> Problem:
    """Return the problem with a table of a variable that the file does not have (B222)."""
    message = f"there is a definition for {name!r}, which is not a variable"
    return error("B222", message, place, hint)


def defined_twice(name: str, line: int | None, place: Place) -> Problem:
    """Return the problem with the second table of a variable; the first is in a line (B232)."""
    return error("B232", f"{name!r} is defined twice, first in line {line}", place)


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
