"""Messages along a join tree: what must be computed for the outputs, and what is known before.

A message goes over an edge, away from the leaves behind it: the product of these leaves, summed
over all nodes that are only behind the edge. The posterior of an output is the message into its
leaf. A message with constants behind it only is computed once; one that depends on few inputs is
tabulated over their states and "not observed".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.clique_tree import (
    EVIDENCE,
    PRIOR,
    TABLE,
    UNIT,
    Tree,
    trees_of,
)
from eddi_scaffold.kinds.bayesian_network.network import Component, Shape, size_of

Edge = tuple[int, int]  # (from, to): numbers of a tree

MAX_CASES = 1024  # Cases of a tabulated message; each is a view of 100 bytes
MAX_NUMBERS = 16_384  # Numbers in a tabulated message: 128 KiB
_MAX_WORK = 2_000_000
"""Multiplications for one tabulated message when the model is loaded: some milliseconds."""
_OPERATION_NS = 600
_LOOKUP_NS = 80


def with_missing(cards: Sequence[int]) -> list[int]:
    """Return the cases of each node: its states, and "not observed"."""
    return [card + 1 for card in cards]


class Message(NamedTuple):
    """One message."""

    edge: Edge  # which way it goes
    mask: int  # the nodes it has an axis for
    inputs: int  # observable nodes that it depends on
    parts: tuple[Edge, ...]  # the messages it is the product of; empty for a leaf
    kind: str  # of the leaf, or `product`
    node: int  # of the leaf, -1 for a product


class MessageProgram(NamedTuple):
    """What is to be done for some outputs."""

    messages: dict[Edge, Message]  # by edge; each comes after its parts
    answers: dict[int, Edge]  # output -> the message into its leaf
    tabulated: set[Edge]  # the messages that depend on few inputs

    def joint_mask(self, message: Message) -> int:
        """Return the nodes over which a product runs: its clique."""
        mask = 0
        for part in message.parts:
            mask |= self.messages[part].mask
        return mask

    def work(self, message: Message, cards: Sequence[int]) -> int:
        """Return the multiplications of one message."""
        return size_of(self.joint_mask(message), cards)

    def alias_of(self, message: Message) -> Edge | None:
        """Return the part that a product is equal to: the other part is the place of an output."""
        for part, other in (message.parts, message.parts[::-1]) if message.parts else ():
            if self.messages[other].kind == UNIT and self.messages[part].mask == message.mask:
                return part
        return None

    def cost(self, cards: Sequence[int]) -> int:
        """Return an estimate for comparing: 0.6 us for an operation, 1 ns for a multiplication.

        Mostly hard evidence is seen; the steps with other evidence must not be forgotten for it.
        """
        total = 0
        looked_up: set[Edge] = set()
        for edge, message in self.messages.items():
            if not message.parts or not message.inputs or self.alias_of(message):
                continue
            price = _OPERATION_NS + self.work(message, cards)
            if edge not in self.tabulated:
                price *= 5
                looked_up.update(part for part in message.parts if part in self.tabulated)
            total += price
        return total + 4 * _LOOKUP_NS * len(looked_up)


class Plan(NamedTuple):
    """How one part of a network is inferred; symbols only."""

    part: Component
    program: MessageProgram


def plan_of(shape: Shape, part: Component) -> Plan:
    """Return the cheapest plan that was found for a part."""
    programs = [_program(tree, part, shape.cards) for tree in trees_of(shape, part)]
    return Plan(part, min(programs, key=lambda of: of.cost(shape.cards)))  # the first of equals


def _program(tree: Tree, part: Component, cards: Sequence[int]) -> MessageProgram:
    """Return all messages that the outputs of a part need."""
    neighbours: list[list[int]] = [[] for _ in tree.masks]
    edges = [(n, below) for n, pair in enumerate(tree.joins, len(tree.leaves)) for below in pair]
    for above, below in [*edges, tree.top]:
        neighbours[below].append(above)
        neighbours[above].append(below)
    answers = {
        leaf.node: (neighbours[number][0], number)
        for number, leaf in enumerate(tree.leaves)
        if leaf.node in part.outputs and leaf.kind != TABLE
    }
    messages = _messages([*answers.values()], tree, neighbours)
    program, cases = MessageProgram(messages, answers, set()), with_missing(cards)
    for edge, message in messages.items():
        parts_are_known = all(
            part in program.tabulated or not messages[part].inputs for part in message.parts
        )
        if message.inputs and parts_are_known:
            count = size_of(message.inputs, cases)
            is_small = (
                count <= MAX_CASES
                and count * size_of(message.mask, cards) <= MAX_NUMBERS
                and count * program.work(message, cards) <= _MAX_WORK
            )
            if is_small or not message.parts:
                program.tabulated.add(edge)
    return program


def _messages(
    edges: Sequence[Edge], tree: Tree, neighbours: Sequence[Sequence[int]]
) -> dict[Edge, Message]:
    """Return messages and all they need; without recursion, a chain may have thousands."""
    messages: dict[Edge, Message] = {}
    waiting = [*edges[::-1]]
    while waiting:
        edge = source, target = waiting[-1]
        is_leaf = source < len(tree.leaves)
        parts: tuple[Edge, ...] = ()
        if not is_leaf:
            parts = tuple((node, source) for node in neighbours[source] if node != target)
        missing = [part for part in parts if part not in messages]
        if edge not in messages and missing:
            waiting += missing
            continue
        waiting.pop()
        if edge in messages:
            continue
        # A join has a higher number than what it joins; over the top edge both masks are equal.
        mask = tree.masks[min(edge)]
        if is_leaf:
            kind, node, own = tree.leaves[source]
            inputs = own if kind in (EVIDENCE, PRIOR) else 0
            messages[edge] = Message(edge, mask, inputs, (), kind, node)
        else:
            inputs = 0
            for part in parts:
                inputs |= messages[part].inputs
            messages[edge] = Message(edge, mask, inputs, parts, "product", -1)
    return messages
