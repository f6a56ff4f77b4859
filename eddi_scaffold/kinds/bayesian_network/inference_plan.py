"""What is inferred how, and what it costs, before a number is computed.

Small parts of a network become tables, the others operations of numpy.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.joint_tables import JointTable, JointTables, added, fits
from eddi_scaffold.kinds.bayesian_network.message_passing import Plan, plan_of
from eddi_scaffold.kinds.bayesian_network.network import (
    NumberedNetwork,
    Shape,
    bits,
    components,
    mask_of,
    size_of,
    with_all_observed,
)

LARGE = 100_000  # Entries of the largest table from which a step takes about a millisecond (B301)
TOO_LARGE = 10_000_000  # Entries above which a network is refused (B301)
_TRIALS = 8
MAX_CASES = 1024  # Cases whose posteriors are written out
_LEAST_EXPONENT = -900
"""Powers of two down to which a product stays an exact double, with some room."""

Posterior = tuple[tuple[float, ...], ...]


class Width(NamedTuple):
    """The cost of inference."""

    largest: int  # entries of the largest table, the product of the states of `nodes`
    nodes: tuple[str, ...]  # names of the nodes of that table

    @property
    def too_large(self) -> bool:
        """Whether such a network is refused."""
        return self.largest > TOO_LARGE


def width_of(shape: Shape, outputs: Sequence[int], observable: Sequence[int]) -> Width:
    """Return what inference costs for nodes with these numbers; no array is made."""
    return _width(shape, _plans(shape, _set(outputs), _set(observable), _TRIALS))


def _set(nodes: Iterable[int]) -> tuple[int, ...]:
    return tuple(sorted({*nodes}))


def _width(shape: Shape, plans: Sequence[Plan]) -> Width:
    widest, largest = 0, 0
    for plan in plans:
        masks = [plan.program.joint_mask(message) for message in plan.program.messages.values()]
        for mask in (*masks, *(mask_of(shape.family(node)) for node in plan.part.nodes)):
            size = size_of(mask, shape.cards)
            if size > largest:
                widest, largest = mask, size
    return Width(largest, tuple(shape.names[bit] for bit in bits(widest)))


@lru_cache(maxsize=16)
def _plans(
    shape: Shape, outputs: tuple[int, ...], observable: tuple[int, ...], trials: int
) -> tuple[Plan, ...]:
    """Search once for a command that configures and compiles: it takes longer than all else."""
    return tuple(plan_of(shape, part, trials) for part in components(shape, outputs, observable))


class Part(NamedTuple):
    """A part that can matter."""

    plan: Plan  # how it is inferred
    tables: tuple[JointTable, ...] | None  # of its outputs; None: it is too large for tables
    least: int  # lower bound of the exponent of any product of its non-zero probabilities


class Program(NamedTuple):
    """Inference for some outputs and observable nodes."""

    outputs: tuple[int, ...]  # nodes whose posteriors can be asked for, ascending
    observable: tuple[int, ...]  # nodes that may be observed, ascending
    parts: tuple[Part, ...]  # all that can matter
    # in place of them in steps in which each observable node is observed
    when_observed: tuple[Part, ...]

    def is_short(self, cards: Sequence[int]) -> bool:
        """Return whether the cases are few, and likelihoods short sums: all is written out."""
        tables = [part.tables for part in self.parts]
        if not all(of is not None and all(table.few() for table in of) for of in tables):
            return False
        return math.prod(cards[node] + 1 for node in self.observable) <= MAX_CASES

    def cases(self, cards: Sequence[int]) -> Iterator[tuple[tuple[int, ...], Posterior | None]]:
        """Yield the posteriors for each case of states; None where it is impossible."""
        tables = [table for part in self.parts for table in part.tables or ()]
        for case in itertools.product(*(range(cards[node] + 1) for node in self.observable)):
            states = dict(zip(self.observable, case, strict=True))
            posteriors: dict[int, tuple[float, ...]] = {}
            for table in tables:
                pairs = zip(table.inputs, table.strides(), strict=True)
                row: Sequence[float] = table.rows[sum(states[node] * by for node, by in pairs)]
                state = states.get(table.output, table.card)
                if state != table.card:
                    row = [p if k == state else 0.0 for k, p in enumerate(row)]
                if not (total := added(row)):
                    yield case, None
                    break
                posteriors[table.output] = tuple(p / total for p in row)
            else:
                yield case, tuple(posteriors[node] for node in self.outputs)


def foreseen(
    network: NumberedNetwork,
    outputs: Iterable[int],
    observable: Iterable[int],
    *,
    tables: bool = True,
) -> Program:
    """Return the inference for nodes that are known beforehand, by number."""
    shape, parts, when_observed = network.shape, [], []
    asked_for, observed = _set(outputs), _set(observable)
    for plan in _plans(shape, asked_for, observed, _TRIALS):
        own = _parts(network, [plan], tables=tables)
        faster = own
        if own and own[0].tables is None:
            split = [plan_of(shape, part, _TRIALS) for part in with_all_observed(shape, plan.part)]
            costs = [other.program.costs(shape.cards)[0] for other in split]
            is_cheaper = sum(costs) < plan.program.costs(shape.cards)[0]
            faster = _parts(network, split, tables=tables) if is_cheaper and split else own
        parts += own
        when_observed += faster
    return Program(asked_for, observed, tuple(parts), tuple(when_observed))


def everything(network: NumberedNetwork, instead_of: Program) -> Program | None:
    """Return the inference for all nodes, None where it is too wide or the same as another one."""
    nodes = tuple(range(len(network.shape.cards)))
    if instead_of.outputs == instead_of.observable == nodes:
        return None
    plans = _plans(network.shape, nodes, nodes, 2)
    if _width(network.shape, plans).largest > LARGE:
        return None
    plans = tuple(plan._replace(program=plan.program._replace(tabulated=set())) for plan in plans)
    parts = tuple(_parts(network, plans, tables=True))
    return Program(nodes, nodes, parts, parts)


def _parts(network: NumberedNetwork, plans: Sequence[Plan], *, tables: bool) -> list[Part]:
    """Return the parts that can matter: others have no outputs and are always possible."""
    parts = []
    for plan in plans:
        numbers = [network.tables[node] for node in plan.part.nodes]
        is_evidence_alone = not plan.part.outputs
        if is_evidence_alone and all(min(table) > 0.0 for table in numbers):
            continue
        smallest = [min((p for p in table if p > 0.0), default=1.0) for table in numbers]
        least = math.floor(math.fsum(map(math.log2, smallest)))
        joint = None
        if tables and least > _LEAST_EXPONENT and fits(plan.program, network, plan.part):
            joint = JointTables(network, plan).tables()
            if is_evidence_alone and all(min(row) > 0.0 for table in joint for row in table.rows):
                continue
        parts.append(Part(plan, joint, least))
    return parts
