"""Bayesian networks from XDSL (GeNIe, SMILE), with noisy-MAX nodes as tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise, product

from eddi_scaffold.common.problems import Place, Problem, has_errors, problem
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, line_of, only, select, text_of
from eddi_scaffold.kinds.bayesian_network.checks import check_network, unsupported
from eddi_scaffold.kinds.bayesian_network.network import Draft, Named, Network, in_digits

LARGEST = 1_000_000
"""A table may have so many entries: it doubles with each parent of two states."""
_TOLERANCE = 1e-6


class NoisyMaxError(ValueError):
    """The numbers are not a noisy-MAX; the message explains why."""


def noisy_max_table(
    parameters: Sequence[str], strengths: Sequence[str], cards: Sequence[int], own: int
) -> tuple[tuple[str, ...], bool]:
    """Return the table in the order of all tables, and whether there is a leak.

    Args:
        parameters: texts of the columns, one after the other.
        strengths: for each parent, the order of its states; empty: as given.
        cards: number of states of each parent.
        own: number of states of the node.

    Raises:
        NoisyMaxError: something does not fit.
    """
    numbers = [_probability(text) for text in parameters]
    count = own * (sum(cards) + 1)
    if len(numbers) != count:
        message = f"{len(numbers)} parameters, expected {count} ({own} x ({sum(cards)} + 1))"
        raise NoisyMaxError(message)
    size = own * math.prod(cards)
    if size > LARGEST:
        message = f"its table would have {in_digits(size)} entries, more than {LARGEST}"
        raise NoisyMaxError(message)
    columns = [numbers[k : k + own] for k in range(0, count, own)]
    for column in columns:
        if abs(math.fsum(column) - 1.0) > _TOLERANCE:
            raise NoisyMaxError(f"a column sums to {math.fsum(column):.9g}, not to 1")
    nothing = [*[0.0] * (own - 1), 1.0]
    at = 0
    causes: list[list[list[float]]] = []
    for number, order in enumerate(_orders(strengths, cards)):
        of = columns[at : at + len(order)]
        at += len(order)
        if of[-1] != nothing:
            message = f"the last column of parent {number + 1} must be 0 ... 0 1"
            raise NoisyMaxError(message)
        causes.append([_below(of[order.index(state)]) for state in range(len(order))])
    leak = _below(columns[-1])
    rows = (_row([*states, leak]) for states in product(*causes))
    return tuple(repr(value) for row in rows for value in row), columns[-1] != nothing


def _probability(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= 1.0:
        raise NoisyMaxError(f"{text!r} is not a probability")
    return value


def _orders(strengths: Sequence[str], cards: Sequence[int]) -> Iterator[list[int]]:
    """Yield, for each parent, the states from the strongest to the one that causes nothing."""
    if strengths and len(strengths) != sum(cards):
        raise NoisyMaxError(f"{len(strengths)} strengths, expected {sum(cards)}")
    at = 0
    for number, card in enumerate(cards):
        known = [str(state) for state in range(card)]
        texts = list(strengths[at : at + card]) or known
        at += card
        if sorted(texts) != sorted(known):
            raise NoisyMaxError(
                f"the strengths of parent {number + 1} are not an ordering of its states"
            )
        order = [int(text) for text in texts]
        if any(order[order[state]] != state for state in order):
            # which of two readings SMILE means shows only here, and in no file
            raise NoisyMaxError(f"the strengths of parent {number + 1} can be read in two ways")
        yield order


def _below(column: Sequence[float]) -> list[float]:
    """Return P(as strong as this state or weaker) for each state, from the strongest on."""
    return [min(math.fsum(column[state:]), 1.0) for state in range(len(column))]


def _row(causes: Sequence[Sequence[float]]) -> list[float]:
    """Return P(state): every cause by itself stays below what the strongest reaches."""
    reached = [*(math.prod(of) for of in zip(*causes, strict=True)), 0.0]
    values = [high - low for high, low in pairwise(reached)]
    total = math.fsum(values)
    return [max(value / total, 0.0) for value in values]


_TYPES = {
    "cpt": "probabilities",
    "deterministic": "resultingstates",
    "noisymax": "parameters",
}
"""Type of node -> element with its numbers."""
_GENERAL = "GeNIe: change the node type to General, then save"
_ADVICE = {
    "noisyadder": _GENERAL,
    "decision": "remove it: a monitor does not decide",
    "utility": "remove it: a monitor does not decide",
    "mau": "remove it: a monitor does not decide",
    "equation": "GeNIe: discretise it, then change the node type to General",
}


def read_xdsl(root: Element, file: str, stem: str) -> tuple[Network | None, list[Problem]]:
    """Read the network of a parsed XDSL file, whose root must be ``smile``.

    Args:
        root: document element.
        file: name of the file, for places.
        stem: name of a network that has none.
    """
    if feature_of(root) != "smile":
        return None, [problem("B201.root", Place(file, line_of(root)), root=feature_of(root))]
    refused = _refused(root, file)
    if refused:
        return None, refused  # what depends on these nodes is no problem of its own
    reader = _Reader(root, file)
    drafts = list(reader.drafts())
    place = Place(file, line_of(root))
    network, problems = check_network(root.get("id") or stem, drafts, place)
    problems = [*reader.problems, *reader.warnings, *problems]
    return (None if reader.problems else network), problems


def _refused(root: Element, file: str) -> list[Problem]:
    """Return a problem for each sort of what is in the file and no monitor can have."""
    problems = [
        problem("B201.dynamic", Place(file, line_of(one))) for one in select(root, "dynamic")
    ]
    others: dict[str, list[Named]] = {}
    for element in select(root, "nodes/*"):
        of = feature_of(element)
        if of not in _TYPES:
            node = Named(element.get("id") or "", Place(file, line_of(element)))
            others.setdefault(of, []).append(node)
    several = [one for one in select(root, "nodes/*/parents") if len(text_of(one).split()) > 1]
    if several and select(root, 'extensions/genie[starts-with(@app, "aGrUM")]'):
        place = Place(file, line_of(several[0]))
        problems.append(problem("B201.pyagrum", place))
    for of, nodes in others.items():
        advice = _ADVICE.get(of, "GeNIe: change the node type to General, or remove it")
        problems.append(unsupported(of, nodes, advice))
    return problems


class _Reader:
    def __init__(self, root: Element, file: str) -> None:
        self.root, self.file = root, file
        self.problems: list[Problem] = []
        self.warnings: list[Problem] = []
        self.titles = {
            str(node.get("id")): _words(next(iter(select(node, "name")), None))
            for node in select(root, "extensions//node[@id]")
        }
        self.states = {
            str(node.get("id")): [one.get("id") or "" for one in select(node, "state")]
            for node in select(root, "nodes/*[@id]")
        }

    def drafts(self) -> Iterator[Draft]:
        for element in select(self.root, "nodes/*"):
            yield self._draft(element, element.get("id") or "", feature_of(element))

    def _draft(self, element: Element, name: str, of: str) -> Draft:
        states = tuple(Named(s.get("id") or "", self._place(s)) for s in select(element, "state"))
        given, tag = self._only(element, "parents"), _TYPES[of]
        place = self._place(element) if given is None else self._place(given)
        parents = tuple(Named(p, place) for p in _words(given).split())
        names = [state.text for state in states]
        values: tuple[str, ...] | None = None
        before = len(self.problems)
        holder = self._only(element, tag)
        if holder is not None:
            words = _words(holder).split()
            if of == "cpt":
                values = tuple(words)
            elif of == "deterministic":
                values = self._rows(words, names, name, holder)
            else:
                values = self._noisy_max(words, names, [parent.text for parent in parents], element)
        place = self._place(element if holder is None else holder)
        return Draft(
            name,
            self.titles.get(name, "") or name,
            states,
            parents,
            values,
            self._place(element),
            place,
            target=element.get("target") == "true",
            broken=has_errors(self.problems[before:]) or (holder is not None and values is None),
        )

    def _rows(
        self, words: list[str], states: list[str], name: str, element: Element
    ) -> tuple[str, ...]:
        """Return 0 and 1 for the one state that each combination of the parents gives."""
        found: list[str] = []
        for word in words:
            if word not in states:
                self._report(
                    "B205.unknown_state", element, state=word, node=name, states=", ".join(states)
                )
            found += ["1.0" if state == word else "0.0" for state in states]
        return tuple(found)

    def _noisy_max(
        self, words: list[str], states: list[str], parents: list[str], element: Element
    ) -> tuple[str, ...] | None:
        """Return the whole table; ``None`` when states are missing, which is reported elsewhere."""
        cards = [len(self.states.get(parent, ())) for parent in parents]
        if min([len(states), *cards]) < 1:
            return None
        name = element.get("id") or ""
        strengths = _words(self._only(element, "strengths")).split()
        try:
            values, leaks = noisy_max_table(words, strengths, cards, len(states))
        except NoisyMaxError as fault:
            self._report("B202.noisy_max", element, hint=_GENERAL, name=name, reason=fault)
            return None
        if leaks:
            self.warnings.append(problem("B208.diez", self._place(element), name=name))
        return values

    def _only(self, node: Element, tag: str) -> Element | None:
        first, problems = only(select(node, tag), "B110.twice", self._place)
        self.problems += problems
        return first

    def _place(self, element: Element) -> Place:
        return Place(self.file, line_of(element))

    def _report(
        self, case: str, element: Element, /, *, hint: str | None = None, **fields: object
    ) -> None:
        self.problems.append(problem(case, self._place(element), hint=hint, **fields))


def _words(element: Element | None) -> str:
    """Return the text of an element with single blanks."""
    return "" if element is None else " ".join(text_of(element).split())
