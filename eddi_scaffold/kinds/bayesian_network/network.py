"""The Bayesian network as data: nodes with states, parents and conditional probability tables.

One order everywhere: a table is flat, in C order of shape (states of the first parent, ..., states
of the last parent, own states): the first parent varies slowest, the node's own state fastest.
Source: SESAME D7.2 section 3.2; Pearl, "Probabilistic Reasoning in Intelligent Systems" (1988).
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from heapq import heappop, heappush

from eddi_scaffold.common.graphs import reached, reversed_graph
from eddi_scaffold.common.identifiers import free_name
from eddi_scaffold.common.problems import Place

TITLE, TARGET = "eddi.title = ", "eddi.target = true"
"""Properties by which XMLBIF holds what it has no element for: begin of the first, the second."""


@dataclass(frozen=True)
class Node:
    """One random variable."""

    id: str  # its name, unique in the network
    title: str  # what people call it (GeNIe's name); the id where there is none
    states: tuple[str, ...]  # names, in order; a node of one state is certain
    parents: tuple[str, ...]  # ids, in the order of the table
    table: tuple[float, ...]  # P(own state | states of the parents), each row sums to 1
    target: bool = False  # the file marks it as a node of interest
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Network:
    """A checked network: acyclic, complete, every row sums to 1."""

    name: str
    nodes: tuple[Node, ...]  # in the order of the file
    # nodes that the file expects to be known, each with the event that tells, or None; a draft of
    # a configuration follows it, a monitor does not
    known: tuple[tuple[str, str | None], ...] = field(default=(), kw_only=True, compare=False)
    place: Place = field(default=Place(), compare=False)

    def node(self, name: str) -> Node:
        """Return a node by id."""
        return next(node for node in self.nodes if node.id == name)

    def names(self) -> list[str]:
        """Return the ids in the order of the file."""
        return [node.id for node in self.nodes]

    def children(self) -> dict[str, tuple[str, ...]]:
        """Return node -> nodes that it is a parent of."""
        return reversed_graph({node.id: node.parents for node in self.nodes})

    def ancestors(self, names: Iterable[str]) -> set[str]:
        """Return the nodes with everything above them."""
        return reached({node.id: node.parents for node in self.nodes}, names)

    def in_order(self) -> list[Node]:
        """Return the nodes, parents first; the order of the file wherever it allows that."""
        index = {node.id: k for k, node in enumerate(self.nodes)}
        missing = [len(node.parents) for node in self.nodes]
        ready = [k for k, count in enumerate(missing) if not count]
        children = self.children()
        ordered: list[Node] = []
        while ready:
            ordered.append(self.nodes[heappop(ready)])
            for child in children[ordered[-1].id]:
                missing[index[child]] -= 1
                if not missing[index[child]]:
                    heappush(ready, index[child])
        return ordered


@dataclass(frozen=True)
class Named:
    """A name and its place."""

    text: str
    place: Place


Row = tuple[Sequence[str], Place]  # The texts of the numbers of a row, and where it stands


@dataclass(frozen=True)
class Draft:
    """A node as a reader found it, before any check."""

    id: str  # empty when the file gives none
    title: str
    states: tuple[Named, ...]
    parents: tuple[Named, ...]
    # texts of the numbers in the order of the table; `None`: the file gives rows, or no numbers
    values: tuple[str, ...] | None
    place: Place
    values_place: Place
    # states of the parents -> a row, in any order; `None`: the file gives none
    rows: Mapping[tuple[str, ...], Row] | None = None
    default: Row | None = None  # the row of all other states
    target: bool = False
    broken: bool = False  # the reader has reported what is wrong with the table


def in_digits(number: int) -> str:
    """Return a count for people; beyond 15 digits its order of magnitude."""
    if number < 10**15:
        return str(number)
    return f"about 10^{math.floor(math.log10(number))}"


_ASCII_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def identifiers(names: Iterable[str]) -> list[str]:
    """Return the part behind ``node_`` or ``outcome_`` for each name, unique, in order.

    Letters of any script stay, as in SESAME D7.2; what is not allowed in an identifier becomes an
    underscore, and who comes later to a taken name gets a number.
    """
    parts: dict[str, None] = {}
    for name in names:
        text = unicodedata.normalize("NFKC", name)
        part = "".join(char if f"_{char}".isidentifier() else "_" for char in text) or "_"
        parts[free_name(part, parts)] = None
    return list(parts)


def node_attributes(network: Network) -> dict[str, str]:
    """Return node -> the part of its method's name behind ``node_``."""
    names = network.names()
    return dict(zip(names, identifiers(names), strict=True))


def xdsl_ids(names: Iterable[str]) -> dict[str, str]:
    """Return name -> id of XDSL: ASCII letters, digits and underscores, no digit in front."""
    ids = {name: name for name in names if _ASCII_ID.fullmatch(name)}
    taken = {*ids}
    for name in names:
        if name not in ids:
            text = re.sub(r"[^A-Za-z0-9_]", "_", unicodedata.normalize("NFKC", name)) or "_"
            ids[name] = free_name(f"n_{text}" if text[0].isdigit() else text, taken)
            taken.add(ids[name])
    return ids
