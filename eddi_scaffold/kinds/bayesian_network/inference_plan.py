"""What is inferred how, and what it costs, before a number is computed.

Small parts of a network become tables, the others messages along a join tree.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from functools import lru_cache
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.joint_tables import JointTable, JointTables, fits
from eddi_scaffold.kinds.bayesian_network.message_passing import Plan, plan_of
from eddi_scaffold.kinds.bayesian_network.network import (
    NumberedNetwork,
    Shape,
    bits,
    components,
    mask_of,
    size_of,
)

LARGE = 100_000  # Entries of the largest table from which a step takes about a millisecond (B301)
TOO_LARGE = 10_000_000  # Entries above which a network is refused (B301)
_LEAST_EXPONENT = -900
"""Powers of two down to which a product stays an exact double, with some room."""


class Width(NamedTuple):
    """The cost of inference."""

    largest: int  # entries of the largest table, the product of the states of `nodes`
    nodes: tuple[str, ...]  # names of the nodes of that table


def width_of(shape: Shape, outputs: Iterable[int], observable: Iterable[int]) -> Width:
    """Return what inference costs for nodes with these numbers; no array is made."""
    widest, largest = 0, 0
    for plan in _plans(shape, frozenset(outputs), frozenset(observable)):
        masks = [plan.program.joint_mask(message) for message in plan.program.messages.values()]
        for mask in (*masks, *(mask_of(shape.family(node)) for node in plan.part.nodes)):
            size = size_of(mask, shape.cards)
            if size > largest:
                widest, largest = mask, size
    return Width(largest, tuple(shape.names[bit] for bit in bits(widest)))


@lru_cache(maxsize=16)
def _plans(shape: Shape, outputs: frozenset[int], observable: frozenset[int]) -> tuple[Plan, ...]:
    """Search once for a command that configures and compiles: it takes longer than all else."""
    return tuple(plan_of(shape, part) for part in components(shape, outputs, observable))


class Part(NamedTuple):
    """A part that can matter."""

    plan: Plan  # how it is inferred
    tables: tuple[JointTable, ...] | None  # of its outputs; None: it is too large for tables
    least: int  # lower bound of the exponent of any product of its non-zero probabilities


def parts_of(
    network: NumberedNetwork, outputs: Collection[int], observable: Collection[int]
) -> list[Part]:
    """Return the inference for some nodes, by number.

    Parts without outputs that are always possible are left out.
    """
    parts = []
    for plan in _plans(network.shape, frozenset(outputs), frozenset(observable)):
        numbers = [network.tables[node] for node in plan.part.nodes]
        if {*plan.part.outputs}.isdisjoint(outputs) and all(min(table) > 0.0 for table in numbers):
            continue
        smallest = [min((p for p in table if p > 0.0), default=1.0) for table in numbers]
        least = math.floor(math.fsum(map(math.log2, smallest)))
        tables = None
        if least > _LEAST_EXPONENT and fits(plan.program, network):
            tables = JointTables(network, plan).tables()
        parts.append(Part(plan, tables, least))
    return parts
