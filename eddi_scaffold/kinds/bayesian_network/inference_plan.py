"""What is inferred how: tables for small parts of a network, operations of numpy for the others."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.joint_tables import JointTable, added, fits, joint_tables
from eddi_scaffold.kinds.bayesian_network.structure import NumberedNetwork
from eddi_scaffold.kinds.bayesian_network.width import (
    LARGE,
    Plan,
    adapted_plan,
    make_plans,
    plans_when_observed,
    untabulated,
    width,
)

MAX_CASES = 1024
"""Cases whose posteriors are written out."""
_LEAST_EXPONENT = -900
"""Powers of two down to which a product stays an exact double, with some room."""

Posterior = tuple[tuple[float, ...], ...]


class Part(NamedTuple):
    """A part that can matter.

    Attributes:
        plan: how it is inferred.
        tables: of its outputs; None: it is too large for tables.
        least: lower bound of the exponent of any product of its non-zero probabilities.
        adapted: for steps in which most inputs are observed, where the part is wide.
    """

    plan: Plan
    tables: tuple[JointTable, ...] | None
    least: int
    adapted: Plan | None = None


class Program(NamedTuple):
    """Inference for some outputs and observable nodes.

    Attributes:
        outputs: nodes whose posteriors can be asked for, ascending.
        observable: nodes that may be observed, ascending.
        parts: all that can matter.
        when_observed: in place of them in steps in which each observable node is observed.
    """

    outputs: tuple[int, ...]
    observable: tuple[int, ...]
    parts: tuple[Part, ...]
    when_observed: tuple[Part, ...]


def foreseen(
    network: NumberedNetwork,
    outputs: Iterable[int],
    observable: Iterable[int],
    *,
    tables: bool = True,
    trials: int = 8,
) -> Program:
    """Return the inference for nodes that are known beforehand.

    Args:
        network: the network.
        outputs: numbers of the nodes whose posterior is wanted.
        observable: numbers of the nodes that may be observed.
        tables: use joint tables where they are small; False is for tests.
        trials: of the search for a good order.
    """
    shape = network.shape
    wanted, seen = tuple(sorted({*outputs})), tuple(sorted({*observable}))
    plans = make_plans(shape, wanted, seen, trials)
    parts: list[Part] = []
    when_observed: list[Part] = []
    for plan in plans:
        own = _parts(network, [plan], tables=tables)
        faster: Sequence[Plan] = ()
        if own and own[0].tables is None:
            faster = plans_when_observed(shape, plan, trials)
            own = [own[0]._replace(adapted=adapted_plan(shape, plan, trials))]
        parts += own
        when_observed += _parts(network, faster, tables=tables) if faster else own
    return Program(wanted, seen, tuple(parts), tuple(when_observed))


def everything(network: NumberedNetwork, instead_of: Program) -> Program | None:
    """Return the inference for all nodes, None where it is too wide or the same as another one."""
    nodes = tuple(range(len(network.shape.cards)))
    if instead_of.outputs == instead_of.observable == nodes:
        return None
    plans = make_plans(network.shape, nodes, nodes, trials=2)
    if width(network.shape, plans).largest > LARGE:
        return None
    plans = tuple(plan._replace(program=untabulated(plan.program)) for plan in plans)
    parts = tuple(_parts(network, plans, tables=True))
    return Program(nodes, nodes, parts, parts)


def few(cards: Sequence[int], program: Program) -> bool:
    """Return whether the cases are few, and likelihoods short sums: all is written out."""
    short = all(
        part.tables is not None and all(table.few() for table in part.tables)
        for part in program.parts
    )
    return short and math.prod(cards[node] + 1 for node in program.observable) <= MAX_CASES


def cases_of(
    cards: Sequence[int], program: Program
) -> list[tuple[tuple[int, ...], Posterior | None]]:
    """Return the posteriors for each case of states; None where it is impossible.

    Args:
        cards: number of states of each node.
        program: of few cases.
    """
    counts = (range(cards[node] + 1) for node in program.observable)
    return [(case, _posterior(program, case)) for case in itertools.product(*counts)]


def _posterior(program: Program, case: Sequence[int]) -> Posterior | None:
    states = dict(zip(program.observable, case, strict=True))
    found: dict[int, tuple[float, ...]] = {}
    for part in program.parts:
        for table in part.tables or ():
            pairs = zip(table.inputs, table.strides(), strict=True)
            row: Sequence[float] = table.rows[sum(states[node] * by for node, by in pairs)]
            state = states.get(table.output, table.card)
            if state != table.card:
                row = [one if k == state else 0.0 for k, one in enumerate(row)]
            total = added(row)
            if not total:
                return None
            found[table.output] = tuple(one / total for one in row)
    return tuple(found[node] for node in program.outputs)


def _parts(network: NumberedNetwork, plans: Sequence[Plan], *, tables: bool) -> list[Part]:
    """Return the parts that can matter: others have no outputs and are always possible."""
    found = []
    for plan in plans:
        alone = not plan.part.outputs
        if alone and all(min(network.tables[node]) > 0.0 for node in plan.part.nodes):
            continue
        least = math.floor(_least_exponent(network, plan))
        made = None
        if tables and least > _LEAST_EXPONENT and fits(plan.program, network, plan.part):
            made = joint_tables(network, plan)
            if alone and all(one.positive for one in made):
                continue
        found.append(Part(plan, made, least))
    return found


def _least_exponent(network: NumberedNetwork, plan: Plan) -> float:
    return math.fsum(
        math.log2(min((one for one in network.tables[node] if one > 0.0), default=1.0))
        for node in plan.part.nodes
    )
