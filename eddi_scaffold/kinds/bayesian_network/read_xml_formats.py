"""Bayesian networks from XDSL (GeNIe, SMILE), and from XMLBIF 0.3 (Cozman)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise, product

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem, has_errors, problem
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, line_of, only, select, text_of
from eddi_scaffold.kinds.bayesian_network.checks import LARGEST, check_network, unsupported
from eddi_scaffold.kinds.bayesian_network.network import (
    TARGET,
    TITLE,
    Draft,
    Named,
    Network,
    in_digits,
)

_TOLERANCE = 1e-6
_NUMBERS_OF = {
    "cpt": "probabilities",
    "deterministic": "resultingstates",
    "noisymax": "parameters",
}
"""Type of node -> element with its numbers."""
_GENERAL = "GeNIe: change the node type to General, then save"
_NO_DECISION = "remove it: a monitor does not decide"
_ADVICE = {
    "noisyadder": _GENERAL,
    "decision": _NO_DECISION,
    "utility": _NO_DECISION,
    "mau": _NO_DECISION,
    "equation": "GeNIe: discretise it, then change the node type to General",
}
_OTHER_ADVICE = "GeNIe: change the node type to General, or remove it"


class _Reader:
    def __init__(self, root: Element, file: str) -> None:
        self.root, self._file = root, file
        self.problems: list[Problem] = []

    def network(self, name: str, drafts: list[Draft]) -> tuple[Network | None, list[Problem]]:
        """Return the network, with what was wrong before as well."""
        network, problems = check_network(name, drafts, self.place(self.root))
        return (None if has_errors(self.problems) else network), [*self.problems, *problems]

    def report(
        self, case: str, element: Element, /, *, hint: str | None = None, **fields: object
    ) -> None:
        self.problems.append(problem(case, self.place(element), hint=hint, **fields))

    def only(self, parent: Element, path: str) -> Element | None:
        """Return what may be there once; report others (B110)."""
        first, problems = only(select(parent, path), "B110.twice", self.place)
        self.problems += problems
        return first

    def place(self, element: Element) -> Place:
        return Place(self._file, line_of(element))


def _text(element: Element | None) -> str:
    """Return the text of an element with single blanks."""
    return "" if element is None else " ".join(text_of(element).split())


def read_xdsl(root: Element, file: str, stem: str) -> tuple[Network | None, list[Problem]]:
    """Read the network of a parsed XDSL file, whose root must be ``smile``."""
    reader = _XdslReader(root, file)
    if feature_of(root) != "smile":
        reader.report("B201.root", root, root=feature_of(root))
    else:
        reader.refuse()
    if reader.problems:
        return None, reader.problems  # what depends on these nodes is no problem of its own
    return reader.network(root.get("id") or stem, reader.drafts())


class _XdslReader(_Reader):
    def refuse(self) -> None:
        """Report all that no monitor can have."""
        for dynamic in select(self.root, "dynamic"):
            self.report("B201.dynamic", dynamic)
        lists = select(self.root, "nodes/*/parents")
        several = [parents for parents in lists if len(text_of(parents).split()) > 1]
        if several and select(self.root, 'extensions/genie[starts-with(@app, "aGrUM")]'):
            self.report("B201.pyagrum", several[0])
        nodes = [
            (feature_of(node), Named(node.get("id") or "", self.place(node)))
            for node in select(self.root, "nodes/*")
        ]
        unknown = [(type_, node) for type_, node in nodes if type_ not in _NUMBERS_OF]
        self.problems += unsupported(unknown, _ADVICE, _OTHER_ADVICE)

    def drafts(self) -> list[Draft]:
        titles = {
            str(node.get("id")): _text(next(iter(select(node, "name")), None))
            for node in select(self.root, "extensions//node[@id]")
        }
        nodes = select(self.root, "nodes/*")
        cards = {str(node.get("id")): len(select(node, "state")) for node in nodes}
        return [self._draft(node, titles.get(node.get("id") or "", ""), cards) for node in nodes]

    def _draft(self, node: Element, title: str, cards: Mapping[str, int]) -> Draft:
        name, type_ = node.get("id") or "", feature_of(node)
        states = tuple(Named(s.get("id") or "", self.place(s)) for s in select(node, "state"))
        before = len(self.problems)
        list_ = self.only(node, "parents")
        place = self.place(node if list_ is None else list_)
        parents = tuple(Named(parent, place) for parent in _text(list_).split())
        numbers = self.only(node, _NUMBERS_OF[type_])
        values: tuple[str, ...] | None = tuple(_text(numbers).split())
        if numbers is None:
            values = None
        elif type_ == "deterministic":
            values = self._certain(values or (), [state.text for state in states], node, numbers)
        elif type_ == "noisymax":
            counts = [cards.get(parent.text, 0) for parent in parents]
            values = self._noisy_max(values or (), len(states), counts, node)
        return Draft(
            *(name, title or name, states, parents, values, self.place(node)),
            self.place(node if numbers is None else numbers),
            target=node.get("target") == "true",
            broken=has_errors(self.problems[before:]) or (numbers is not None and values is None),
        )

    def _certain(
        self, chosen: Sequence[str], states: Sequence[str], node: Element, place: Element
    ) -> tuple[str, ...]:
        """Return 0 and 1 for the one state that each combination of the parents gives."""
        for state in chosen:
            if state not in states:
                known, name = ", ".join(states), node.get("id")
                self.report("B205.unknown_state", place, state=state, node=name, states=known)
        return tuple("1.0" if state == other else "0.0" for state in chosen for other in states)

    def _noisy_max(
        self, parameters: Sequence[str], own: int, cards: Sequence[int], node: Element
    ) -> tuple[str, ...] | None:
        """Return the complete table; ``None`` when states are missing: reported elsewhere."""
        strengths = _text(self.only(node, "strengths")).split()
        if min([own, *cards]) < 1:
            return None
        name = node.get("id") or ""
        if strengths not in ([], [str(state) for card in cards for state in range(card)]):
            reason = "the states of its parents are in an order of their own"
            self.report("B202.noisy_max", node, hint=_GENERAL, name=name, reason=reason)
            return None
        try:
            values, leaks = noisy_max_table(parameters, cards, own)
        except NoisyMaxError as fault:
            self.report("B202.noisy_max", node, hint=_GENERAL, name=name, reason=fault)
            return None
        if leaks:
            self.report("B208.diez", node, name=name)
        return values


class NoisyMaxError(ValueError):
    """The numbers are not a noisy-MAX; the message explains why."""


def noisy_max_table(
    parameters: Sequence[str], cards: Sequence[int], own: int
) -> tuple[tuple[str, ...], bool]:
    """Return the table in the order of all tables, and whether there is a leak.

    Args:
        parameters: texts of the columns, one after the other.
        cards: number of states of each parent.
        own: number of states of the node.

    Raises:
        NoisyMaxError: something does not fit.
    """
    try:
        numbers = [float(text) for text in parameters]
    except ValueError as fault:
        raise NoisyMaxError(f"{fault}") from None
    count, size = own * (sum(cards) + 1), own * math.prod(cards)
    if len(numbers) != count:
        message = f"{len(numbers)} parameters, expected {count} ({own} x ({sum(cards)} + 1))"
        raise NoisyMaxError(message)
    if size > LARGEST:
        message = f"its table would have {in_digits(size)} entries, more than {LARGEST}"
        raise NoisyMaxError(message)
    columns = [numbers[k : k + own] for k in range(0, count, own)]
    for column in columns:
        if not (min(column) >= 0.0 and abs(math.fsum(column) - 1.0) <= _TOLERANCE):  # nor NaN
            raise NoisyMaxError(f"a column sums to {math.fsum(column):.9g}, not to 1")
    nothing = [*[0.0] * (own - 1), 1.0]
    # of each state, P(as strong as this one or weaker), from the strongest on
    at_most = [[min(math.fsum(column[k:]), 1.0) for k in range(own)] for column in columns]
    causes, start = [], 0
    for number, card in enumerate(cards, 1):
        causes.append(at_most[start : start + card])
        start += card
        if columns[start - 1] != nothing:
            raise NoisyMaxError(f"the last column of parent {number} must be 0 ... 0 1")
    table: list[float] = []
    for states in product(*causes):
        # every cause by itself stays below what the strongest reaches
        below = [math.prod(of_state) for of_state in zip(*states, at_most[-1], strict=True)]
        row = [high - low for high, low in pairwise([*below, 0.0])]
        total = math.fsum(row)
        table += [max(value / total, 0.0) for value in row]
    return tuple(map(repr, table)), columns[-1] != nothing


def read_xmlbif(root: Element, file: str, stem: str) -> tuple[Network | None, list[Problem]]:
    """Read the network of a parsed XMLBIF file, whose root must be ``BIF``."""
    reader = _XmlBifReader(root, file)
    if feature_of(root) != "BIF":
        reader.report("B201.bif_root", root, root=feature_of(root))
        return None, reader.problems
    variables = select(root, "NETWORK/VARIABLE")
    others = []
    for variable in variables:
        type_, name = variable.get("TYPE") or "nature", next(iter(select(variable, "NAME")), None)
        if type_ != "nature":
            others.append((type_, Named(_text(name), reader.place(variable))))
    if others:  # what depends on these nodes is no problem of its own
        return None, unsupported(others, {}, _NO_DECISION)
    reader.only(root, "NETWORK")
    name = _text(reader.only(root, "NETWORK/NAME")) or stem
    return reader.network(name, reader.drafts(variables))


class _XmlBifReader(_Reader):
    def drafts(self, variables: Sequence[Element]) -> list[Draft]:
        definitions: dict[str, Element] = {}
        for definition in select(self.root, "NETWORK/DEFINITION"):
            name = _text(self.only(definition, "FOR"))
            if name in definitions:
                line = line_of(definitions[name])
                self.report("B110.duplicate_definition", definition, name=name, line=line)
            definitions.setdefault(name, definition)
        names = [_text(self.only(variable, "NAME")) for variable in variables]
        for name, definition in definitions.items():
            if name not in names:
                self.report("B205.unknown_variable", definition, name=name)
        return [
            self._draft(variable, name, definitions.get(name))
            for variable, name in zip(variables, names, strict=True)
        ]

    def _draft(self, variable: Element, name: str, definition: Element | None) -> Draft:
        states = self._named(select(variable, "OUTCOME"))
        parents: tuple[Named, ...] = ()
        table = None
        if definition is not None:
            parents = self._named(select(definition, "GIVEN"))
            table = self.only(definition, "TABLE")
        values = None if table is None else tuple(text_of(table).split())
        place = self.place(variable)
        at_table = place if table is None else self.place(table)
        properties = [_text(property_) for property_ in select(variable, "PROPERTY")]
        titles = (text.removeprefix(TITLE) for text in properties if text.startswith(TITLE))
        is_target = TARGET in properties
        title = next(titles, name)
        return Draft(name, title, states, parents, values, place, at_table, target=is_target)

    def _named(self, elements: Sequence[Element]) -> tuple[Named, ...]:
        return tuple(Named(_text(element), self.place(element)) for element in elements)


_DOCTYPE = re.compile(rb"<!DOCTYPE\s+BIF\s*(?:\[(?P<inner>[^\[\]]*)\]\s*)?>")
_HARMLESS = re.compile(rb"(?:\s+|<!(?:ELEMENT|ATTLIST)\b[^<>&%]*>|<!--(?:(?!--).)*-->)*", re.DOTALL)


def without_doctype(source: Source) -> tuple[Source, list[Problem]]:
    """Return the file with blanks in place of a harmless document type; lines stay."""
    data = source.data
    start = data.find(b"<!DOCTYPE")
    if start < 0:
        return source, []
    match = _DOCTYPE.match(data, start)
    if match is None or not _HARMLESS.fullmatch(match["inner"] or b""):
        line = data.count(b"\n", 0, start) + 1
        return Source(source.name, b""), [problem("X001.declarations", Place(source.name, line))]
    blank = re.sub(rb"[^\n]", b" ", match.group())
    return Source(source.name, data[:start] + blank + data[match.end() :]), []
