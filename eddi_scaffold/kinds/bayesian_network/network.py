"""The Bayesian network as data: nodes with states, parents and conditional probability tables.

One order everywhere: a table is flat, in C order of shape (states of the first parent, ..., states
of the last parent, own states): the first parent varies slowest, the node's own state fastest.
Source: SESAME D7.2 section 3.2; Pearl, "Probabilistic Reasoning in Intelligent Systems" (1988).
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from eddi_scaffold.common.graphs import reached
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


class Shape(NamedTuple):
    """A network without its numbers: all that the cost of inference depends on."""

    names: tuple[str, ...]  # of the nodes, in file order
    cards: tuple[int, ...]  # number of states of each node
    # numbers of the parents of each node, in the order of its table
    parents: tuple[tuple[int, ...], ...]

    def family(self, node: int) -> tuple[int, ...]:
        """Return the axes of the table of a node."""
        return (*self.parents[node], node)


class NumberedNetwork(NamedTuple):
    """A network with its numbers."""

    shape: Shape
    states: tuple[tuple[str, ...], ...]
    # P(node | parents) of each node: first parent slowest, own state fastest
    tables: tuple[tuple[float, ...], ...]


class Component(NamedTuple):
    """Nodes whose probabilities depend on each other for some evidence; nothing else does."""

    nodes: tuple[int, ...]  # numbers of those whose tables belong here, ascending
    inputs: tuple[int, ...]  # those that may be observed
    outputs: tuple[int, ...]  # those whose posterior is asked for, else any


def numbered(network: Network) -> NumberedNetwork:
    """Return a network by numbers of its nodes."""
    number = {name: k for k, name in enumerate(network.names())}
    nodes = network.nodes
    cards = tuple(len(node.states) for node in nodes)
    parents = tuple(tuple(number[parent] for parent in node.parents) for node in nodes)
    return NumberedNetwork(
        Shape(tuple(number), cards, parents),
        tuple(node.states for node in nodes),
        tuple(node.table for node in nodes),
    )


def bits(mask: int) -> Iterator[int]:
    """Yield the numbers in a set, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def mask_of(numbers: Iterable[int]) -> int:
    """Return the set of some numbers."""
    mask = 0
    for number in numbers:
        mask |= 1 << number
    return mask


def size_of(mask: int, cards: Sequence[int] | Mapping[int, int]) -> int:
    """Return the number of entries of a table over a set of nodes."""
    size = 1
    while mask:
        low = mask & -mask
        size *= cards[low.bit_length() - 1]
        mask ^= low
    return size


def components(
    shape: Shape, outputs: Collection[int], observable: Collection[int]
) -> tuple[Component, ...]:
    """Split a network into parts that no evidence connects.

    Descendants that are neither observable nor an output sum to one and are left out ("barren"
    nodes). The rest falls into the connected parts of the moral graph: the probability of the
    evidence is the product over the parts, so each is inferred for itself. One without outputs may
    be contradictory, too: any posterior of it tells.
    """
    relevant = reached(dict(enumerate(shape.parents)), [*outputs, *observable])
    linked: dict[int, list[int]] = {node: [*shape.parents[node]] for node in relevant}
    for node in relevant:
        for parent in shape.parents[node]:
            linked[parent].append(node)
    parts = []
    for node in sorted(relevant):
        if node in linked:
            group = sorted(reached(linked, [node]))
            for member in group:
                del linked[member]
            inputs = tuple(member for member in group if member in observable)
            shown = tuple(member for member in group if member in outputs)
            parts.append(Component(tuple(group), inputs, shown or (node,)))
    return tuple(parts)
