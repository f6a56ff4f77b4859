"""What a network will cost, before a single number is computed: for generation and for loading."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.clique_tree import Tree, find_tree
from eddi_scaffold.kinds.bayesian_network.message_passing import (
    Program,
    costs,
    joint_mask,
    make_program,
)
from eddi_scaffold.kinds.bayesian_network.structure import (
    Component,
    Shape,
    bits,
    components,
    mask_of,
    size_of,
    with_all_observed,
)

LARGE = 100_000
"""Entries of the largest table from which a step takes about a millisecond (B301)."""
WIDE = 200_000
"""Nanoseconds of a step from which arrays are made for each pattern of observed inputs."""
_PATTERNS = 24
TOO_LARGE = 10_000_000
"""Entries above which a network is refused (B301)."""


class Plan(NamedTuple):
    """How one part of a network will be inferred; symbols only."""

    part: Component
    tree: Tree
    program: Program


class Width(NamedTuple):
    """The cost of inference.

    Attributes:
        largest: entries of the largest table, the product of the states of ``nodes``.
        nodes: names of the nodes of that table.
        operations: numpy operations of a step when nothing can be looked up.
        nanoseconds: rough time of these on a desk computer.
    """

    largest: int
    nodes: tuple[str, ...]
    operations: int
    nanoseconds: int

    @property
    def too_large(self) -> bool:
        """Return whether such a network is refused."""
        return self.largest > TOO_LARGE


def width_of(shape: Shape, outputs: Sequence[int], observable: Sequence[int]) -> Width:
    """Return what a network costs; pure, deterministic, no array is made.

    Args:
        shape: the network.
        outputs: numbers of the nodes whose posterior is wanted.
        observable: numbers of the nodes that may be observed.
    """
    return width(shape, make_plans(shape, outputs, observable))


def make_plans(
    shape: Shape, outputs: Sequence[int], observable: Sequence[int], trials: int = 8
) -> tuple[Plan, ...]:
    """Return the cheapest plan that was found for each part."""
    return _made_plans(shape, tuple(sorted(set(outputs))), tuple(sorted(set(observable))), trials)


@lru_cache(maxsize=16)
def _made_plans(
    shape: Shape, outputs: tuple[int, ...], observable: tuple[int, ...], trials: int
) -> tuple[Plan, ...]:
    """Search once for a command that configures and compiles: it takes longer than all else."""
    return tuple(_plan(shape, part, trials) for part in components(shape, outputs, observable))


def plans_when_observed(shape: Shape, plan: Plan, trials: int = 8) -> tuple[Plan, ...]:
    """Return what replaces a plan when each of its inputs is observed; empty: nothing cheaper."""
    parts = with_all_observed(shape, plan.part)
    plans = tuple(_plan(shape, part, trials) for part in parts)
    prices = [costs(one.program, shape.cards)[0] for one in plans]
    return plans if sum(prices) < costs(plan.program, shape.cards)[0] else ()


def adapted_plan(shape: Shape, plan: Plan, trials: int = 8) -> Plan | None:
    """Return the plan for arrays without the axes of observed nodes, None for a narrow part.

    Its order of sums is the cheapest on average when one of four inputs is not observed.
    """
    part, cards = plan.part, shape.cards
    inputs = [node for node in part.inputs if node not in part.outputs]
    if costs(plan.program, cards)[0] < WIDE or len(inputs) < 2 or not part.outputs:
        return None
    patterns = [_observed(inputs, cards, seed) for seed in range(_PATTERNS)]

    def price(tree: Tree) -> int:
        program = untabulated(make_program(tree, part, cards))
        return sum(min(costs(program, pattern)[1], WIDE) for pattern in patterns)

    tree = find_tree(shape, part, price, trials, inputs)
    return Plan(part, tree, untabulated(make_program(tree, part, cards)))


def untabulated(program: Program) -> Program:
    """Return a program in which nothing is looked up."""
    return program._replace(tabulated=set())


def _observed(inputs: Sequence[int], cards: Sequence[int], seed: int) -> tuple[int, ...]:
    """Return the states of nodes, one for those that are observed in a fixed random pattern."""
    rng = random.Random(seed)  # noqa: S311 - no secret
    observed = {node for node in inputs if rng.random() < 0.75}
    return tuple(1 if node in observed else card for node, card in enumerate(cards))


def width(shape: Shape, plans: Sequence[Plan]) -> Width:
    """Return what the plans of a network cost."""
    culprit, largest, operations, nanoseconds = 0, 0, 0, 0
    for plan in plans:
        messages = plan.program.messages
        masks: list[int] = [joint_mask(messages, message) for message in messages.values()]
        masks += [mask_of((*shape.parents[node], node)) for node in plan.part.nodes]
        for mask in masks:
            size = size_of(mask, shape.cards)
            if size > largest:
                culprit, largest = mask, size
        _, full, count = costs(plan.program, shape.cards)
        operations += count
        nanoseconds += full
    return Width(largest, tuple(shape.names[bit] for bit in bits(culprit)), operations, nanoseconds)


def _plan(shape: Shape, part: Component, trials: int) -> Plan:
    def price(tree: Tree) -> int:
        # Mostly hard evidence is seen; the other schedule must not be forgotten for it.
        hard, full, _ = costs(make_program(tree, part, shape.cards), shape.cards)
        return hard if part.given else 4 * hard + full

    tree = find_tree(shape, part, price, trials)
    return Plan(part, tree, make_program(tree, part, shape.cards))
