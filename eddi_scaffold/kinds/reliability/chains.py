"""Continuous-time Markov chains without subtractions, so that 1e-18 keeps its digits; their text.

Plain loops, products, quotients, and sums that are rounded once, as ``sum`` is not before Python
3.12: the same digits on every machine. Sources: uniformisation (Jensen 1953), scaling and squaring
of non-negative matrices, and the elimination of Grassmann, Taksar and Heyman (1985).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from math import fsum, inf
from typing import NamedTuple

from eddi_scaffold.common import graphs
from eddi_scaffold.kinds.reliability.system import FATAL, ReliabilitySystem
from eddi_scaffold.program import python_text as py

Arc = tuple[int, int, float]
Matrix = list[list[float]]
_TERMS = 25


class Chain(NamedTuple):
    """A chain of numbered states."""

    states: tuple[str, ...]
    initial: int
    fail: tuple[int, ...]  # failure is first passage
    arcs: tuple[Arc, ...]  # (from, to, rate in 1/h); parallel ones add up
    age: float = 0.0  # hours that it had run, unobserved, before the start of the mission


def rates_of(chain: Chain) -> Matrix:
    """Return the rates in 1/h from row to column; those from fail states are left out."""
    rates = [[0.0] * len(chain.states) for _ in chain.states]
    for source, target, rate in _used_arcs(chain):
        rates[source][target] += rate
    return rates


def propagator(rates: Matrix, hours: float) -> Matrix:
    """Return the probabilities of transitions in some hours; however small, they are accurate."""
    # by Horner in a non-negative matrix and squarings: rows sum to one by construction
    exits = [fsum(row) for row in rates]
    fastest = max(exits)
    size = range(len(rates))
    if fastest * hours <= 0.0:
        return [[float(i == j) for j in size] for i in size]
    mantissa, exponent = math.frexp(fastest * hours)
    squarings = max(0, exponent - (mantissa == 0.5))
    step = fastest * math.ldexp(hours, -squarings)
    jump = [[rate / fastest for rate in row] for row in rates]
    for i in size:
        jump[i][i] += max(1.0 - exits[i] / fastest, 0.0)
    result = [[float(i == j) for j in size] for i in size]
    for k in range(_TERMS, 0, -1):
        result = [[step / k * value for value in row] for row in _product(jump, result)]
        for i in size:
            result[i][i] += 1.0
    result = _normalised(result)
    for _ in range(squarings):
        result = _normalised(_product(result, result))
    return result


def mean_times(chain: Chain) -> list[float]:
    """Return the mean hours to failure from each state; ``inf`` where it is not certain."""
    rates, fail = rates_of(chain), sorted(set(chain.fail))
    sure = certain(chain)
    tau = [inf] * len(rates)
    for state in fail:
        tau[state] = 0.0
    order = [state for state in range(len(rates)) if state in sure and state not in chain.fail]
    cost = [1.0] * len(rates)
    exits = {}
    for position in range(len(order) - 1, -1, -1):
        state, rest = order[position], order[:position]
        exits[state] = fsum(rates[state][other] for other in (*rest, *fail))
        for other in rest:
            share = rates[other][state] / exits[state]
            if share:
                cost[other] += share * cost[state]
                rates[other] = [
                    mine + share * its for mine, its in zip(rates[other], rates[state], strict=True)
                ]
    for position, state in enumerate(order):
        later = fsum(rates[state][other] * tau[other] for other in order[:position])
        tau[state] = (cost[state] + later) / exits[state]
    return tau


def certain(chain: Chain) -> set[int]:
    """Return the states from which failure is certain in the long run."""
    states = set(range(len(chain.states)))
    return states - reaching(chain, states - reaching(chain, chain.fail))


def reaching(chain: Chain, targets: Iterable[int]) -> set[int]:
    """Return the states from which one of the targets can be reached."""
    return graphs.reached(graphs.reversed_graph(_following(chain)), targets)


def reached(chain: Chain) -> set[int]:
    """Return the states that can be reached from the initial one."""
    return graphs.reached(_following(chain), [chain.initial])


def _following(chain: Chain) -> dict[int, list[int]]:
    following: dict[int, list[int]] = {state: [] for state in range(len(chain.states))}
    for source, target, _ in _used_arcs(chain):
        following[source].append(target)
    return following


def _used_arcs(chain: Chain) -> Iterable[Arc]:
    fail = set(chain.fail)
    return (arc for arc in chain.arcs if arc[0] not in fail and arc[0] != arc[1] and arc[2] > 0.0)


def _product(matrix: Matrix, other: Matrix) -> Matrix:
    columns = list(zip(*other, strict=True))
    rows = ([(k, value) for k, value in enumerate(row) if value] for row in matrix)
    return [[fsum([v * column[k] for k, v in row]) for column in columns] for row in rows]


def _normalised(matrix: Matrix) -> Matrix:
    totals = map(fsum, matrix)
    return [[value / total for value in row] for row, total in zip(matrix, totals, strict=True)]


def battery_chain(failure: float, alpha: float, beta: float, degradation: float) -> Chain:
    """Return the chain of charge (rates in 1/h): bands of use and of recovery, empty, failed."""
    arcs = []
    for b in (0, 2, 4):
        arcs += [(b, b + 1, alpha), (b + 1, b, beta), (b, b + 2, degradation), (b, 7, failure)]
    return Chain(("B4", "C4", "B3", "C3", "B2", "C2", "Empty", "F"), 0, (6, 7), tuple(arcs))


def order_chain(gate: str, rates: Sequence[float], age: float) -> Chain:
    """Return the chain over orders of occurrence of a dynamic gate, PAND or POR."""
    if gate == "POR":
        arcs = ((0, 1, rates[0]), (0, 2, fsum(rates[1:])))
        return Chain(("nothing yet", "the first came first", "another did"), 0, (1,), arcs, age)
    lost = len(rates) + 1
    ordered = []
    for done in range(len(rates)):
        ordered.append((done, done + 1, rates[done]))
        ordered += [(done, lost, rate) for rate in rates[done + 1 :]]
    names = (*(f"{done} in order" for done in range(lost)), "out of order")
    return Chain(names, 0, (len(rates),), tuple(ordered), age)


def rotors_chain(configuration: str, rates: Sequence[float]) -> Chain:
    """Return the chain over sets of failed motors; the last state is the loss of the frame."""
    sets = survived(configuration)
    state_of = {failed: i for i, failed in enumerate(sets)}
    loss = len(sets)
    arcs = tuple(
        (i, state_of.get(failed | {motor}, loss), rate)
        for failed, i in state_of.items()
        for motor, rate in enumerate(rates)
        if motor not in failed
    )
    names = [", ".join(map(str, sorted(failed))) or "none" for failed in sets]
    return Chain((*names, "loss"), 0, (loss,), arcs)


def survived(configuration: str) -> list[frozenset[int]]:
    """Return the sets of failed motors with which the frame flies, small ones first."""
    motors = range(len(configuration))
    sets = (frozenset(of) for count in motors for of in combinations(motors, count))
    return [of for of in sets if not any(fatal <= of for fatal in FATAL[configuration])]


STATES_WRITTEN_OUT = 8  # States up to which the sums are written out
GRID = 256  # How many horizons are prepared when the mission's end is an input


def chain_table_lines(name: str, chain: Chain, system: ReliabilitySystem) -> Iterator[str]:
    """Yield the class of a chain whose exponentials are found when the monitor starts."""
    endless = sorted(set(range(len(chain.states))) - certain(chain) - set(chain.fail))
    yield f"class {name}(large_chain.LargeChain):"
    yield f"    count = {len(chain.states)}"
    if chain.initial:
        yield f"    initial = {chain.initial}"
    yield from py.assignment("fail", py.literal(chain.fail), 4)
    if endless:
        yield from py.assignment("endless", py.literal(tuple(endless)), 4)
    if chain.age:
        yield f"    age = {py.number(chain.age)}  # h"
    yield f"    hours = {py.number(system.quantum / 3600.0)}  # one quantum"
    part = system.horizon / GRID if system.mission_end else system.horizon
    yield f"    horizon = {py.number(part)}"
    if system.mission_end:
        yield f"    steps = {GRID}"
    yield from py.assignment("arcs", rows_of_arcs(chain), 4)


def rows_of_arcs(chain: Chain) -> py.Part:
    """Return the arcs as a tuple, with the names of their states behind them."""
    abouts = (f"{chain.states[arc[0]]} to {chain.states[arc[1]]}" for arc in chain.arcs)
    pairs = zip(chain.arcs, abouts, strict=True)
    return py.tuple_of(py.Item(py.literal(arc), behind=py.comment(about)) for arc, about in pairs)


def rows_ahead(chain: Chain, hours: float) -> list[tuple[float, float, float]]:
    """Return for each state: failed and alive at the horizon, mean life in hours."""
    rows = []
    for row, life in zip(propagator(rates_of(chain), hours), mean_times(chain), strict=True):
        failed = fsum(p for state, p in enumerate(row) if state in chain.fail)
        alive = fsum(p for state, p in enumerate(row) if state not in chain.fail)
        rows.append((min(failed, 1.0), alive, life))
    return rows


def rows_of_states(chain: Chain, rows: Iterable[tuple[float, ...] | float]) -> py.Part:
    """Return a row for each state as a tuple, with its name behind it."""
    pairs = zip(rows, chain.states, strict=True)
    return py.tuple_of(py.Item(py.literal(row), behind=py.comment(state)) for row, state in pairs)


def chain_lines(name: str, chain: Chain, system: ReliabilitySystem) -> Iterator[str]:
    """Yield the class of a chain with its numbers: one quantum, and what lies ahead."""
    rates, states = rates_of(chain), range(len(chain.states))
    yield f"class {name}(chain.Chain):"
    yield from py.assignment("fail", py.literal(chain.fail), 4)
    yield from py.assignment(
        "first", py.literal(tuple(propagator(rates, chain.age)[chain.initial])), 4
    )
    yield "    # Failed and alive at the horizon, mean life in hours."
    ahead = rows_ahead(chain, 0.0 if system.mission_end else system.horizon)
    yield from py.assignment("ahead", rows_of_states(chain, ahead), 4)
    if system.mission_end:
        grid = map(tuple, propagator(rates, system.horizon / GRID))
        yield f"    # Transitions in one of {GRID} parts of the longest horizon."
        yield from py.assignment("grid", rows_of_states(chain, grid), 4)
        yield f"    steps = {GRID}"
    names = [f"b{i}" for i in states]
    unpacked = f"        {', '.join(names)}{',' if len(names) == 1 else ''} = belief"
    step = propagator(rates, system.quantum / 3600.0)
    yield from ("", "    def quantum(self, belief):", unpacked)
    yield from sums(
        ([row[state] for row in step], py.comment(chain.states[state])) for state in states
    )
    if not system.mission_end:
        failed, alive, lives = zip(*ahead, strict=True)
        yield from ("", "    def look(self, belief, at):", unpacked)
        yield from sums(
            [
                (failed, "failed"),
                (alive, "alive"),
                ([0.0 if life == inf else life for life in lives], "mean life"),
                ([float(life == inf) for life in lives], "lives for ever"),
                ([1.0 for _ in lives], "weight"),
            ]
        )


def sums(rows: Iterable[tuple[Sequence[float], str]]) -> Iterator[str]:
    """Yield ``return`` of a tuple of sums of weighted ``b0``, ``b1``, ..., each with a comment."""
    yield "        return ("
    for weights, about in rows:
        parts = [
            f"b{i}" if weight == 1.0 else f"b{i} * {py.number(weight)}"
            for i, weight in enumerate(weights)
            if weight != 0.0
        ] or ["0.0"]
        flat = f"            {' + '.join(parts)},"
        behind = f"  # {about}" if about else ""
        if len(flat) > py.WIDTH:
            yield f"            {parts[0]}"
            yield from (f"            + {part}" for part in parts[1:-1])
            yield f"            + {parts[-1]},{behind}"
        elif len(flat + behind) > py.WIDTH:
            yield from (f"            # {about}", flat)
        else:
            yield flat + behind
    yield "        )"
