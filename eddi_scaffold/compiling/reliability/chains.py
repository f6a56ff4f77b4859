"""The class of a chain: few states as sums with numbers, more as arcs and rates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import fsum, inf

from eddi_scaffold.compiling.reliability.markov import (
    Chain,
    certain,
    mean_times,
    propagator,
    rates_of,
)
from eddi_scaffold.compiling.reliability.sums import sums
from eddi_scaffold.compiling.text import (
    Item,
    Part,
    assignment,
    comment,
    literal,
    number,
    tuple_of,
)

WRITTEN_OUT = 8
"""States up to which the sums are written out."""
GRID = 256
"""How many horizons are prepared when the mission's end is an input."""
_Numbers = Sequence[float]


@dataclass(frozen=True)
class Time:
    """Quantum and horizon, in hours; ``moving``: the mission's end is an input."""

    quantum: float
    horizon: float
    moving: bool


def as_table(name: str, chain: Chain, time: Time) -> list[str]:
    """Return the class of a chain whose exponentials are found when the monitor starts."""
    states = range(len(chain.states))
    endless = sorted(set(states) - certain(chain) - set(chain.fail))
    lines = [f"class {name}(large_chain.LargeChain):", f"    count = {len(chain.states)}"]
    if chain.initial:
        lines += [f"    initial = {chain.initial}"]
    lines += assignment("fail", literal(chain.fail), 4)
    if endless:
        lines += assignment("endless", literal(tuple(endless)), 4)
    if chain.age:
        lines += [f"    age = {number(chain.age)}  # h"]
    lines += [f"    hours = {number(time.quantum)}  # one quantum"]
    lines += [f"    horizon = {number(time.horizon / GRID if time.moving else time.horizon)}"]
    lines += [f"    steps = {GRID}"] if time.moving else []
    arcs = (Item(literal(arc), behind=_arc(chain, *arc[:2])) for arc in chain.arcs)
    return [*lines, *assignment("arcs", tuple_of(arcs), 4)]


def _arc(chain: Chain, source: int, target: int) -> str:
    return comment(f"{chain.states[source]} to {chain.states[target]}")


def rows_ahead(chain: Chain, hours: float) -> list[tuple[float, float, float]]:
    """Return for each state: failed and alive at the horizon, mean life in hours."""
    fails = [float(state in chain.fail) for state in range(len(chain.states))]
    works = [1.0 - fail for fail in fails]
    moved = propagator(rates_of(chain), hours)
    ends = [(min(_dot(row, fails), 1.0), _dot(row, works)) for row in moved]
    return [(*end, life) for end, life in zip(ends, mean_times(chain), strict=True)]


def table_ahead(chain: Chain, rows: Sequence[tuple[float, float, float]]) -> Part:
    """Return these rows as a tuple, each with its state."""
    pairs = zip(rows, chain.states, strict=True)
    return tuple_of(Item(literal(row), behind=comment(state)) for row, state in pairs)


def written_out(name: str, chain: Chain, time: Time) -> list[str]:
    """Return the class of a chain with its numbers: one quantum, and what lies ahead."""
    rates = rates_of(chain)
    states = [comment(state) for state in chain.states]
    first = propagator(rates, chain.age)[chain.initial]
    lines = [f"class {name}(chain.Chain):"]
    lines += assignment("fail", literal(chain.fail), 4)
    lines += assignment("first", literal(tuple(first)), 4)
    lines += ["    # Failed and alive at the horizon, mean life in hours."]
    ahead = rows_ahead(chain, 0.0 if time.moving else time.horizon)
    lines += assignment("ahead", table_ahead(chain, ahead), 4)
    if time.moving:
        grid = propagator(rates, time.horizon / GRID)
        lines += [f"    # Transitions in one of {GRID} parts of the longest horizon."]
        moved = (
            Item(literal(tuple(row)), behind=state) for row, state in zip(grid, states, strict=True)
        )
        lines += [*assignment("grid", tuple_of(moved), 4), f"    steps = {GRID}"]
    step = propagator(rates, time.quantum)
    columns = [
        ([(row[state], f"b{i}") for i, row in enumerate(step)], about)
        for state, about in enumerate(states)
    ]
    lines += ["", "    def quantum(self, belief):", *_unpacked(len(states))]
    lines += sums(columns)
    if time.moving:
        return lines
    failed, alive, lives = zip(*ahead, strict=True)
    finite = [0.0 if life == inf else life for life in lives]
    endless = [float(life == inf) for life in lives]
    looks = [
        ([(weight, f"b{i}") for i, weight in enumerate(weights)], about)
        for weights, about in (
            (failed, "failed"),
            (alive, "alive"),
            (finite, "mean life"),
            (endless, "lives for ever"),
            ([1.0] * len(states), "weight"),
        )
    ]
    lines += ["", "    def look(self, belief, at):", *_unpacked(len(states))]
    return [*lines, *sums(looks)]


def _unpacked(count: int) -> list[str]:
    names = [f"b{i}" for i in range(count)]
    return [f"        {', '.join(names)}{',' if count == 1 else ''} = belief"]


def _dot(one: _Numbers, other: _Numbers) -> float:
    return fsum(a * b for a, b in zip(one, other, strict=True))
