"""Exact probabilities of reliability models, in as many digits as the context has.

Chains by uniformisation, in which nothing cancels (Jensen 1953); fault trees as sums of products.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import combinations, pairwise
from typing import Any, NamedTuple, TypeAlias

from eddi_scaffold.common.graphs import reached, reversed_graph
from eddi_scaffold.evidence.emitted import UnprovedError
from eddi_scaffold.kinds.reliability.sums import Polynomial
from eddi_scaffold.kinds.reliability.system import DYNAMIC, FATAL, Chain, FaultTree, Law

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

    def endless(self) -> set[int]:
        """Return the states from which failure is not certain."""
        before = reversed_graph({k: [*row] for k, row in enumerate(self.rows())})
        fails = reached(before, self.fail)
        return reached(before, [k for k in range(self.size) if k not in fails])


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
    rows, states, endless = chain.rows(), range(chain.size), chain.endless()
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


def rotors(values: Mapping[str, Any]) -> tuple[Markov, Sequence[tuple[int, ...]]]:
    """Return the chain of failed motors, by place, and the sets that are no loss of the frame."""
    fatal = FATAL[values["configuration"]]
    motors = sorted(range(len(values["rates"])), key=values["positions"].__getitem__)
    sets = [of for k in range(len(motors)) for of in combinations(range(len(motors)), k)]
    sets = [of for of in sets if not any(lost <= {*of} for lost in fatal)]
    number = {frozenset(of): state for state, of in enumerate(sets)}
    arcs = [
        (state, number.get(failed | {place}, len(sets)), float(values["rates"][motor]))
        for failed, state in number.items()
        for place, motor in enumerate(motors)
        if place not in failed
    ]
    return Markov(len(sets) + 1, (len(sets),), tuple(arcs)), sets


def ordered(tree: FaultTree, key: str) -> Markov:
    """Return the chain of inputs that came in order, or another did; a SAND never happens."""
    gate = tree.gates[key]
    laws = [law for of in gate.of if gate.type != "SAND" and (law := tree.events[of].law)]
    last = 1 if gate.type != "PAND" else len(laws)
    arcs: list[tuple[int, int, float]] = []
    for k, law in enumerate(laws[:last]):
        arcs.append((k, k + 1, law.values[0]))
        arcs += [(k, last + 1, law.values[0]) for law in laws[k + 1 :]]
    return Markov(last + 2, (last,), tuple(arcs))


def leaves(tree: FaultTree) -> list[str]:
    """Return the events of a tree, and behind them its gates that ask for an order."""
    names = tree.reached()[0]
    dynamic = [key for key in names if key in tree.gates and tree.gates[key].type in DYNAMIC]
    inner = {of for key in dynamic for of in tree.gates[key].of}
    return [*(key for key in names if key in tree.events and key not in inner), *dynamic]


def chance(law: Law, start: D, end: D) -> D:
    """Return the probability that an event happens between two ages of it, in hours."""
    first, shape = D(law.values[0]), D(law.values[-1]) if law.kind == "weibull" else D(1)
    if law.kind == "fixed" or not first:
        return first
    scale = first if law.kind == "weibull" else 1 / first
    return 1 - ((start / scale) ** shape - (end / scale) ** shape).exp()


def variable(tree: FaultTree, key: str) -> str:
    """Return which event it is: the failure of a model is one, whatever number stand for it."""
    event = tree.events.get(key)
    is_model = event and event.law and event.law.model and not event.observed
    return f"model {event.law.model}" if event and event.law and is_model else f"event {key}"


def structure(tree: FaultTree, events: Mapping[str, Polynomial]) -> Polynomial:
    """Return the probability of the top event: sums of products of independent events."""

    def both(a: Polynomial, b: Polynomial) -> Polynomial:
        terms = Polynomial()
        for product, number in (a * b).items():  # an event and itself are that event
            once = tuple(sorted({*product}))
            terms[once] = terms.get(once, Fraction(0)) + number
        return terms + Polynomial()

    values = dict(events)
    for key in (key for key in tree.reached()[0] if key in tree.gates and key not in events):
        gate = tree.gates[key]
        below = [values[of] for of in gate.of]
        if gate.type == "AND" and below:
            values[key] = reduce(both, below)
        elif gate.type == "NOT" and below:
            values[key] = ONE - below[0]
        elif gate.type == "XOR":
            values[key] = reduce(lambda a, b: a + b - both(a, b) - both(a, b), below)
        else:
            row = [ONE] + [Polynomial()] * (gate.k or 1)
            for of in below:  # at least 0, 1, ... of those so far
                row = [ONE, *(b + both(of, a - b) for a, b in pairwise(row))]
            values[key] = row[-1]
    return values[tree.top]
