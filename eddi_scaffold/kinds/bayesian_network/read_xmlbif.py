"""Bayesian networks from XMLBIF 0.3 (Cozman, "The Interchange Format for Bayesian Networks")."""

from __future__ import annotations

import re
from collections.abc import Iterator

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.eddi_xml.parsing import Element, feature_of, line_of, only, select, text_of
from eddi_scaffold.kinds.bayesian_network.checks import (
    check_network,
    defined_twice,
    no_variable,
    unsupported,
)
from eddi_scaffold.kinds.bayesian_network.network import Draft, Named, Network


def read_xmlbif(root: Element, file: str, stem: str) -> tuple[Network | None, list[Problem]]:
    """Read the network of a parsed XMLBIF file, whose root must be ``BIF``."""
    if feature_of(root) != "BIF":
        return None, [problem("B201.bif_root", Place(file, line_of(root)), root=feature_of(root))]
    others: dict[str, list[Named]] = {}
    for variable in select(root, "NETWORK/VARIABLE"):
        of = variable.get("TYPE") or "nature"
        if of != "nature":
            name = next(iter(select(variable, "NAME")), None)
            node = Named(_text(name), Place(file, line_of(variable)))
            others.setdefault(of, []).append(node)
    if others:  # what depends on these nodes is no problem of its own
        hint = "remove it: a monitor does not decide"
        return None, [unsupported(of, nodes, hint) for of, nodes in others.items()]
    reader = _Reader(root, file)
    reader.only(root, "NETWORK")
    name = _text(reader.only(root, "NETWORK/NAME")) or stem
    drafts = list(reader.drafts())
    network, problems = check_network(name, drafts, Place(file, line_of(root)))
    problems = [*reader.problems, *problems]
    return (None if reader.problems else network), problems


class _Reader:
    def __init__(self, root: Element, file: str) -> None:
        self.root, self.file = root, file
        self.problems: list[Problem] = []

    def only(self, parent: Element, path: str) -> Element | None:
        """Return what may be there once; report others (B110)."""
        first, problems = only(select(parent, path), "B110.twice", self._place)
        self.problems += problems
        return first

    def drafts(self) -> Iterator[Draft]:
        definitions: dict[str, Element] = {}
        for definition in select(self.root, "NETWORK/DEFINITION"):
            name = _text(self.only(definition, "FOR"))
            if name in definitions:
                line = line_of(definitions[name])
                self.problems.append(defined_twice(name, line, self._place(definition)))
            definitions.setdefault(name, definition)
        names = set()
        for variable in select(self.root, "NETWORK/VARIABLE"):
            name = _text(self.only(variable, "NAME"))
            names.add(name)
            yield self._draft(variable, name, definitions.get(name))
        for name, definition in definitions.items():
            if name not in names:
                self.problems.append(no_variable(name, self._place(definition)))

    def _draft(self, variable: Element, name: str, definition: Element | None) -> Draft:
        states = tuple(Named(_text(one), self._place(one)) for one in select(variable, "OUTCOME"))
        parents: tuple[Named, ...] = ()
        values: tuple[str, ...] | None = None
        place = self._place(variable)
        if definition is not None:
            parents = tuple(
                Named(_text(one), self._place(one)) for one in select(definition, "GIVEN")
            )
            table = self.only(definition, "TABLE")
            if table is not None:
                values = tuple(text_of(table).split())
                place = self._place(table)
        return Draft(name, name, states, parents, values, self._place(variable), place)

    def _place(self, element: Element) -> Place:
        return Place(self.file, line_of(element))


def _text(element: Element | None) -> str:
    return "" if element is None else " ".join(text_of(element).split())


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
