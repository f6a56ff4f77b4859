"""Exact probabilities of reliability models, in as many digits as the context has.

Chains by uniformisation, in which nothing cancels (Jensen 1953); fault trees as sums of products.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

from eddi_scaffold.common.graphs import reached, reversed_graph
from eddi_scaffold.evidence.emitted import UnprovedError
from eddi_scaffold.evidence.sums import Polynomial
from eddi_scaffold.kinds.reliability.fault_tree import COHERENT
from eddi_scaffold.kinds.reliability.system import Chain, FaultTree, Law

D: TypeAlias = Decimal
INF = D("inf")
ONE = Polynomial({(): Fraction(1)})
_MOST_STATES, _MOST_PARTS = 90, 2_000


class Markov(NamedTuple):
    """A chain of numbered states; failure is first passage."""

    size: int
    fail: tuple[int, ...]
    arcs: tuple[tuple[int, int, float], ...]  # with rates in 1/h

    def rows(self) -> list[dict[int, D]]:
        """Return the rates from each state."""
        rows: list[dict[int, D]] = [{} for _ in range(self.size)]
        for source, target, rate in self.arcs:
            if source not in self.fail and source != target and rate > 0.0:
                rows[source][target] = rows[source].get(target, D(0)) + D(rate)
        return rows


@lru_cache(maxsize=4096)
def after(chain: Markov, hours: D, ends: frozenset[int]) -> Sequence[D]:
    """Return for each state the probability of being in some states after a time."""
    rows = [(row, sum(row.values(), D(0))) for row in chain.rows()]
    fastest = max(out for _, out in rows) or D(1)
    parts = math.ceil(fastest * hours / 10) or 1
    if parts * chain.size > _MOST_PARTS or chain.size > _MOST_STATES:
        raise UnprovedError(None, "the rates of a chain are too high")
    mean, result = fastest * hours / parts, [D(k in ends) for k in range(chain.size)]
    for _ in range(parts):
        term, weight, result = result, (-mean).exp(), [D(0)] * chain.size
        for k in range(1, chain.size + 100):
            result = [a + weight * b for a, b in zip(result, term, strict=True)]
            weight *= mean / k
            if k > chain.size + 5 and weight < D("1e-60"):
                break
            term = [
                sum((rate * term[to] for to, rate in row.items()), (fastest - out) * p) / fastest
                for (row, out), p in zip(rows, term, strict=True)
            ]
    return result


@lru_cache(maxsize=256)
def lives(chain: Markov) -> Sequence[D]:
    """Return the mean hours to failure from each state; infinite where it is not certain."""
    rows, states = chain.rows(), range(chain.size)
    before = reversed_graph({k: [*row] for k, row in enumerate(rows)})
    fails = reached(before, chain.fail)
    endless = reached(before, [k for k in states if k not in fails])
    left = [k for k in states if k not in endless and k not in chain.fail]
    table = [
        [D(sum(rows[a].values())) if a == b else -rows[a].get(b, D(0)) for b in left] + [D(1)]
        for a in left
    ]
    for k, row in enumerate(table):  # linear equations, the last column is their right side
        row[:] = [number / row[k] for number in row]
        for other in table[:k] + table[k + 1 :]:
            other[:] = [a - other[k] * b for a, b in zip(other, row, strict=True)]
    means = {k: row[-1] for k, row in zip(left, table, strict=True)}
    return [D(0) if k in chain.fail else means.get(k, INF) for k in states]


def markov(of: Chain) -> Markov:
    """Return a chain of the user's own."""
    number = of.states.index
    arcs = tuple((number(arc.source), number(arc.target), arc.rate) for arc in of.arcs)
    return Markov(len(of.states), tuple(map(number, of.fail)), arcs)


def battery(values: Mapping[str, Any]) -> Markov:
    """Return the chain of charge: three bands of use, each with recovery; empty, failed."""
    keys = ("alpha", "beta", "degradation", "failure_rate")
    alpha, beta, lower, fails = (float(values[key]) for key in keys)
    arcs: list[tuple[int, int, float]] = []
    for b in (0, 2, 4):
        arcs += [(b, b + 1, alpha), (b + 1, b, beta), (b, b + 2, lower), (b, 7, fails)]
    return Markov(8, (6, 7), tuple(arcs))


def chance(law: Law, start: D, end: D) -> D:
    """Return the probability that an event happens between two ages of it, in hours."""
    first, shape = D(law.values[0]), D(law.values[-1]) if law.kind == "weibull" else D(1)
    if law.kind == "fixed" or not first:
        return first
    scale = first if law.kind == "weibull" else 1 / first
    return 1 - ((start / scale) ** shape - (end / scale) ** shape).exp()


def variable(tree: FaultTree, key: str) -> str:
    """Return which event it is: the failure of a model is one, whatever number stand for it."""
    event = tree.events[key]
    is_model = event.law is not None and event.law.model and not event.observed
    return f"model {event.law.model}" if event.law and is_model else f"event {key}"


def structure(tree: FaultTree, events: Mapping[str, Polynomial]) -> Polynomial:
    """Return the probability of the top event: sums of products of independent events."""

    def both(a: Polynomial, b: Polynomial) -> Polynomial:
        terms = Polynomial()
        for product, number in (a * b).items():  # an event and itself are that event
            once = tuple(sorted({*product}))
            terms[once] = terms.get(once, Fraction(0)) + number
        return terms + Polynomial()

    values = dict(events)
    for key in (key for key in tree.reached()[0] if key in tree.gates):
        gate = tree.gates[key]
        below = [values[of] for of in gate.of]
        if gate.type == "AND":
            values[key] = reduce(both, below)
        elif gate.type in COHERENT:
            row = [ONE] + [Polynomial()] * (gate.k or 1)
            for of in below:  # at least 0, 1, ... of those so far
                row = [ONE, *(b + both(of, a - b) for a, b in pairwise(row))]
            values[key] = row[-1]
        else:
            raise UnprovedError(None, f"{gate.name} is a gate {gate.type}")
    return values[tree.top]
