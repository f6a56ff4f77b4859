"""Messages along a join tree: what must be computed for the outputs, and what is known before.

A message goes over an edge, away from the leaves behind it: the product of these leaves, summed
over all nodes that are only behind the edge. The posterior of an output is the message into its
leaf. A message with constants behind it only is computed once; one that depends on few inputs is
tabulated over their states and "not observed".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.clique_tree import TABLE, UNIT, Tree
from eddi_scaffold.kinds.bayesian_network.structure import Component, bits, mask_of, size_of

Edge = tuple[int, int]
"""(from, to): numbers of a tree."""

MAX_CASES = 1024
"""Cases of a tabulated message; each is a view of 100 bytes."""
MAX_NUMBERS = 16_384
"""Numbers in a tabulated message: 128 KiB."""
_MAX_WORK = 2_000_000
"""Multiplications for one tabulated message when the model is loaded: some milliseconds."""
_OPERATION_NS = 600
_LOOKUP_NS = 80


class Message(NamedTuple):
    """One message.

    Attributes:
        edge: which way it goes.
        mask: the nodes it has an axis for.
        inputs: observable nodes that it depends on.
        parts: the messages it is the product of; empty for a leaf.
        leaf: number of the leaf, -1 for a product.
        kind: of the leaf, empty for a product.
    """

    edge: Edge
    mask: int
    inputs: int
    parts: tuple[Edge, ...]
    leaf: int
    kind: str


class Program(NamedTuple):
    """What is to be done for some outputs.

    Attributes:
        messages: by edge; each comes after its parts.
        answers: output -> the message into its leaf.
        evidence: for a part without outputs: the two messages whose product, summed, is the
            probability of the evidence (one of them for a single leaf).
        tabulated: the messages that depend on few inputs.
        cases: of each node that may be observed: its states, and "not observed" where that may be.
    """

    messages: dict[Edge, Message]
    answers: dict[int, Edge]
    evidence: tuple[Edge, ...]
    tabulated: set[Edge]
    cases: dict[int, int]


def make_program(tree: Tree, part: Component, cards: Sequence[int]) -> Program:
    """Return all messages that the outputs of a part need."""
    around = _neighbours(tree)
    targets: dict[int, Edge] = {}
    for number, leaf in enumerate(tree.leaves):
        if leaf.node in part.outputs and leaf.kind != TABLE:
            targets[leaf.node] = (around[number][0], number)
    evidence: tuple[Edge, ...] = ()
    if not targets:
        one, other = tree.top
        evidence = ((one, other),) if one == other else ((one, other), (other, one))
    messages: dict[Edge, Message] = {}
    for edge in (*targets.values(), *evidence):
        _collect(edge, tree, around, messages)
    given = frozenset(part.given)
    cases = {node: cards[node] + (node not in given) for node in (*part.inputs, *part.given)}
    return Program(messages, targets, evidence, _tabulated(messages, cards, cases), cases)


def costs(program: Program, cards: Sequence[int]) -> tuple[int, int, int]:
    """Return (nanoseconds with hard evidence, with any evidence, operations with any evidence).

    Estimates for comparing: 0.6 us for an operation and 1 ns for a multiplication.
    """
    hard, full, operations = 0, 0, 0
    looked_up: set[Edge] = set()
    for edge, message in program.messages.items():
        if not message.parts or not message.inputs or alias_of(program.messages, message):
            continue
        price = _OPERATION_NS + work(program.messages, message, cards)
        full += price
        operations += 1
        if edge not in program.tabulated:
            hard += price
            looked_up.update(part for part in message.parts if part in program.tabulated)
    return hard + _LOOKUP_NS * len(looked_up), full, operations


def joint_mask(messages: dict[Edge, Message], message: Message) -> int:
    """Return the nodes over which a product runs: its clique."""
    return mask_of(node for part in message.parts for node in bits(messages[part].mask))


def work(messages: dict[Edge, Message], message: Message, cards: Sequence[int]) -> int:
    """Return the multiplications of one message."""
    return size_of(joint_mask(messages, message), cards)


def _neighbours(tree: Tree) -> list[list[int]]:
    around: list[list[int]] = [[] for _ in tree.masks]
    for number, pair in enumerate(tree.joins, len(tree.leaves)):
        for below in pair:
            around[below].append(number)
            around[number].append(below)
    one, other = tree.top
    if one != other:
        around[one].append(other)
        around[other].append(one)
    return around


def _collect(
    edge: Edge, tree: Tree, around: list[list[int]], messages: dict[Edge, Message]
) -> None:
    """Add a message and all it needs; without recursion, a chain may have thousands."""
    todo = [edge]
    while todo:
        source, target = todo[-1]
        if (source, target) in messages:
            todo.pop()
            continue
        parts: tuple[Edge, ...] = ()
        if source >= len(tree.leaves):
            parts = tuple((one, source) for one in around[source] if one != target)
        missing = [part for part in parts if part not in messages]
        if missing:
            todo.extend(missing)
            continue
        messages[todo.pop()] = _message((source, target), tree, parts, messages)


def _message(
    edge: Edge, tree: Tree, parts: tuple[Edge, ...], messages: dict[Edge, Message]
) -> Message:
    # A join has a higher number than what it joins; over the top edge both masks are equal.
    mask = tree.masks[min(edge)]
    if parts:
        inputs = 0
        for part in parts:
            inputs |= messages[part].inputs
        return Message(edge, mask, inputs, parts, -1, "")
    leaf = tree.leaves[edge[0]]
    return Message(edge, mask, leaf.seen, (), edge[0], leaf.kind)


def _tabulated(
    messages: dict[Edge, Message], cards: Sequence[int], cases_of_each: Mapping[int, int]
) -> set[Edge]:
    found: set[Edge] = set()
    for edge, message in messages.items():
        ready = all(part in found or not messages[part].inputs for part in message.parts)
        if not message.inputs or not ready:
            continue
        cases = size_of(message.inputs, cases_of_each)
        numbers = cases * size_of(message.mask, cards)
        effort = cases * work(messages, message, cards)
        small = cases <= MAX_CASES and numbers <= MAX_NUMBERS and effort <= _MAX_WORK
        if small or not message.parts:
            found.add(edge)
    return found


def alias_of(messages: dict[Edge, Message], message: Message) -> Edge | None:
    """Return the part that a product is equal to: the other part is the place of an output."""
    for part, other in (message.parts, message.parts[::-1]) if message.parts else ():
        if messages[other].kind == UNIT and messages[part].mask == message.mask:
            return part
    return None
