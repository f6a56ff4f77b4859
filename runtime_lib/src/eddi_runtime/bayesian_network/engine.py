"""Exact inference, compiled once: evidence in, posteriors of the outputs out."""

from __future__ import annotations

import math
from operator import eq
from typing import (
    TYPE_CHECKING,
    FrozenSet,
    Iterable,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    Union,
)

from .joint import JointTables, fits
from .model import Network
from .width import Plan, TooWideError, Width, make_plans, plans_when_observed, width

if TYPE_CHECKING:
    from .schedule import Schedule

Posteriors = List[List[float]]
_TINY = 1e-200
"""A sum below this may have lost terms to underflow."""
_LEAST_EXPONENT = -900.0
"""Powers of two down to which a product stays an exact double, with some room."""
_NO_WEIGHTS: Mapping[int, Sequence[float]] = {}


class _Slot(NamedTuple):
    """Where the row of an output goes.

    Attributes:
        output: its place among the outputs, -1 for the probability of the evidence alone.
        position: its place among the observable nodes, -1 if it is none.
        card: number of its states.
    """

    output: int
    position: int
    card: int


_ALONE = _Slot(-1, -1, 1)


class _Part(NamedTuple):
    """A compiled part of the network.

    Attributes:
        compiled: its tables or its schedule.
        positions: of its observable nodes.
        slots: where its rows go.
        least: lower bound of the exponent of any product of its non-zero probabilities.
    """

    compiled: Union[JointTables, Schedule]
    positions: FrozenSet[int]
    slots: Tuple[_Slot, ...]
    least: float


class Engine:
    """A network compiled for fixed outputs and observable nodes. Not thread-safe.

    Which of the observable nodes are observed may differ from step to step.

    Attributes:
        network: the network.
        outputs: numbers of the outputs, ascending.
        observable: numbers of the observable nodes, ascending; evidence goes by position here.
        missing: "not observed" for each of them: the number of its states.
        width: what a step costs.
        lookup_only: each part is small enough for tables, numpy is not used.
    """

    def __init__(
        self,
        network: Network,
        outputs: Iterable[int],
        observable: Iterable[int],
        *,
        tables: bool = True,
        trials: int = 8,
    ) -> None:
        """Compile.

        Args:
            network: the network.
            outputs: numbers of the nodes whose posterior is wanted.
            observable: numbers of the nodes that may be observed.
            tables: use joint tables where they are small; False is for tests.
            trials: of the search for a good order.

        Raises:
            TooWideError: a table would be too large.
            ImportError: a part needs numpy and it is not installed.
        """
        self.network = network
        self.outputs: Tuple[int, ...] = tuple(sorted(set(outputs)))
        self.observable: Tuple[int, ...] = tuple(sorted(set(observable)))
        cards = network.shape.cards
        self.missing: Tuple[int, ...] = tuple(cards[node] for node in self.observable)
        plans = make_plans(network.shape, self.outputs, self.observable, trials)
        self.width: Width = width(network.shape, plans)
        if self.width.too_large:
            raise TooWideError(self.width)
        self._positions = {node: k for k, node in enumerate(self.observable)}
        self._places = {node: k for k, node in enumerate(self.outputs)}
        self.lookup_only = True
        self._parts: List[_Part] = []
        self._when_observed: List[_Part] = []
        for plan in plans:
            parts = self._compiled([plan], tables=tables)
            faster: Sequence[Plan] = ()
            if parts and not isinstance(parts[0].compiled, JointTables):
                faster = plans_when_observed(network.shape, plan, trials)
            self._parts += parts
            self._when_observed += self._compiled(faster, tables=tables) if faster else parts

    def infer(
        self, states: Sequence[int], weights: Mapping[int, Sequence[float]] = _NO_WEIGHTS
    ) -> Optional[Posteriors]:
        """Return the posterior of each output, None if the evidence has probability zero.

        Args:
            states: state of each observable node; ``missing`` for one that is not observed, or
                that has virtual evidence.
            weights: position among the observable nodes -> one likelihood per state: finite, not
                negative, the largest 1. Not for an observed state: that is hard evidence.
        """
        parts = self._parts
        if not (self.lookup_only or weights) and True not in map(eq, states, self.missing):
            parts = self._when_observed
        found: Posteriors = [[]] * len(self.outputs)
        for part in parts:
            compiled, mine, slots, _ = part
            soft = bool(weights) and not mine.isdisjoint(weights)
            rows = compiled.soft(states, weights) if soft else compiled.hard(states)
            for number, slot in enumerate(slots):
                row = rows[number]
                if slot.position >= 0:
                    row = _weighted(row, slot, states, weights)
                total = sum(row)
                if total < _TINY:
                    if _may_underflow(part, weights):
                        row = compiled.scaled(states, weights)[number]
                        row = _weighted(row, slot, states, weights)
                        total = sum(row)
                    if not total:
                        return None
                if slot.output >= 0:
                    found[slot.output] = [one / total for one in row]
        return found

    def _compiled(self, plans: Sequence[Plan], *, tables: bool) -> List[_Part]:
        """Return the parts that can matter: others have no outputs and are always possible."""
        network, positions = self.network, self._positions
        parts = []
        for plan in plans:
            if not plan.part.outputs and _positive(network, plan):
                continue
            least = _least_exponent(network, plan)
            small = fits(plan.program, network, plan.part)
            compiled: Union[JointTables, Schedule]
            if tables and small and least > _LEAST_EXPONENT:
                compiled = JointTables(network, plan.part, plan.tree, plan.program, positions)
                if not plan.part.outputs and compiled.positive:
                    continue
            else:
                from .schedule import Schedule  # noqa: PLC0415 - numpy takes 0.1 s and 25 MB

                self.lookup_only = False
                compiled = Schedule(network, plan.part, plan.tree, plan.program, positions)
            slots = [
                _Slot(self._places[node], positions.get(node, -1), network.shape.cards[node])
                for node in plan.part.outputs
            ]
            mine = frozenset(positions[node] for node in plan.part.inputs)
            parts.append(_Part(compiled, mine, tuple(slots) or (_ALONE,), least))
        return parts


def _weighted(
    row: List[float], slot: _Slot, states: Sequence[int], weights: Mapping[int, Sequence[float]]
) -> List[float]:
    """Take into the row of an output what was seen of the output itself."""
    position = slot.position
    if position < 0:
        return row
    weight = weights.get(position)
    if weight is not None:
        return [one * other for one, other in zip(row, weight)]
    state = states[position]
    if state == slot.card:
        return row
    return [one if k == state else 0.0 for k, one in enumerate(row)]


def _least_exponent(network: Network, plan: Plan) -> float:
    return sum(
        math.log2(min((one for one in network.tables[node] if one > 0.0), default=1.0))
        for node in plan.part.nodes
    )


def _positive(network: Network, plan: Plan) -> bool:
    return all(min(network.tables[node]) > 0.0 for node in plan.part.nodes)


def _may_underflow(part: _Part, weights: Mapping[int, Sequence[float]]) -> bool:
    """Return whether a product that is zero or tiny may be so by rounding alone."""
    least = part.least
    for position in part.positions.intersection(weights):
        least += math.log2(min(one for one in weights[position] if one > 0.0))
    return least <= _LEAST_EXPONENT
