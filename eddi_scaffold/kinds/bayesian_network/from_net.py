"""Bayesian networks from the NET format of Hugin ("The HUGIN file format", 2011)."""

from __future__ import annotations

import re
from collections.abc import Iterator

from eddi_scaffold.kinds.bayesian_network.check import (
    check_network,
    defined_twice,
    no_variable,
    unsupported,
)
from eddi_scaffold.kinds.bayesian_network.model import Draft, Named, Network
from eddi_scaffold.kinds.bayesian_network.words import Word, Words
from eddi_scaffold.problems import EddiError, NearNames, Place, Problem
from eddi_scaffold.source import Source

_PATTERN = re.compile(
    r"""\s+|%[^\n]*|"((?:[^"\\]|\\.)*)"|([{}()|=;])|([^\s%{}()|=;"]+)|(.)""", re.DOTALL
)
_ADVICE = {
    "decision": "remove it: a monitor does not decide",
    "utility": "remove it: a monitor does not decide",
}
_ONCE = ("name", "label", "states", "data")
"""Attributes that are read: the second would be lost, or the first."""
_Table = tuple[Named, tuple[Named, ...], tuple[str, ...] | None, Place]
"""Variable, parents, numbers, place of the numbers."""


def read_net(source: Source) -> tuple[Network | None, list[Problem]]:
    """Read the network of a Hugin file."""
    try:
        reader = _Reader(Words(source, _PATTERN))
        reader.read()
    except EddiError as fault:
        return None, list(fault.problems)
    if reader.others:
        advice = "write it as a discrete node"
        return None, [
            unsupported(of, nodes, _ADVICE.get(of, advice)) for of, nodes in reader.others.items()
        ]
    problems: list[Problem] = []
    known = {draft.id for draft in reader.nodes}
    near = NearNames(known)
    for name, table in reader.tables.items():
        if name not in known:
            problems.append(no_variable(name, table[0].place, near.hint(name)))
    for again in reader.twice:
        line = reader.tables[again.text][0].place.line
        problems.append(defined_twice(again.text, line, again.place))
    drafts = [reader.with_table(draft) for draft in reader.nodes]
    network, found = check_network(reader.name or source.stem, drafts, Place(source.name, 1))
    return (None if problems else network), [*problems, *found]


class _Reader:
    def __init__(self, words: Words) -> None:
        self.words = words
        self.name = ""
        self.nodes: list[Draft] = []
        self.tables: dict[str, _Table] = {}
        self.twice: list[Named] = []
        self.others: dict[str, list[Named]] = {}

    def with_table(self, draft: Draft) -> Draft:
        """Return a node with its parents and numbers, whose order is that of all tables."""
        if draft.id not in self.tables:
            return draft
        _, parents, values, place = self.tables[draft.id]
        return Draft(draft.id, draft.title, draft.states, parents, values, draft.place, place)

    def read(self) -> None:
        """Read the domain, or the class that it is in.

        Raises:
            EddiError: the text does not have the form of the format (B231).
        """
        if self.words.next.text == "class":
            self.words.take()
            self.name = self.words.name("the name of the class").text
            self.words.mark("{")
            self._elements("}")
            if not self.words.at_end:
                raise self.words.expected("the end of the file behind its only class")
        else:
            self._elements("")

    def _elements(self, end: str) -> None:
        while not (self.words.is_mark(end) if end else self.words.at_end):
            start = self.words.next
            head = [self.words.name("`node` or `potential`").text]
            if self.words.skip_mark("="):  # an attribute of the class
                self.words.skip_to(";")
            elif head == ["potential"]:
                self._potential()
            elif head == ["net"]:
                self._net()
            else:
                while self.words.next.is_name:
                    head.append(self.words.take().text)
                self._node(head, start)
        if end:
            self.words.take()

    def _net(self) -> None:
        for key, _ in self._attributes():
            if key == "name":
                self.name = self.words.name("the name of the network").text
            self.words.skip_to(";")

    def _attributes(self) -> Iterator[tuple[str, Word]]:
        """Yield each attribute of a block, and the first word of its value, which is read then."""
        seen: set[str] = set()
        self.words.mark("{")
        while not self.words.skip_mark("}"):
            start = self.words.next
            key = self.words.name("an attribute or `}`").text
            if key in seen and key in _ONCE:
                raise self.words.fault(f"`{key}` is given twice", start)
            seen.add(key)
            self.words.mark("=")
            yield key, self.words.next

    def _node(self, head: list[str], start: Word) -> None:
        name = Named(head[-1], self.words.place(start))
        of = " ".join(head[:-1])
        states: list[Named] = []
        title = ""
        for key, value in self._attributes():
            if key == "states":
                self.words.mark("(")
                states = self.words.names("the name of a state", ")")
            elif key == "label" and value.is_name:
                title = value.text.replace('\\"', '"')
            self.words.skip_to(";")
        if of in {"node", "discrete node"}:
            draft = Draft(name.text, title, tuple(states), (), None, name.place, name.place)
            self.nodes.append(draft)
        else:
            self.others.setdefault(of, []).append(name)

    def _potential(self) -> None:
        self.words.mark("(")
        name = self.words.name("the name of a node")
        parents: list[Named] = []
        if self.words.skip_mark("|"):
            parents = self.words.names("the name of a parent", ")")
        else:
            self.words.mark(")")
        values, place = None, name.place
        for key, value in self._attributes():
            if key == "data":
                place = self.words.place(value)
                values = self._data()
            else:
                self.words.skip_to(";")
        if name.text in self.tables:
            self.twice.append(name)
        self.tables.setdefault(name.text, (name, tuple(parents), values, place))

    def _data(self) -> tuple[str, ...]:
        """Return the numbers; the brackets around them only repeat the shape of the table."""
        found: list[str] = []
        depth = 0
        while depth or not self.words.skip_mark(";"):
            if self.words.skip_mark("("):
                depth += 1
            elif depth and self.words.skip_mark(")"):
                depth -= 1
            else:
                found.append(self.words.name("a number").text)
        return tuple(found)
