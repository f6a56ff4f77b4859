"""Continuous-time Markov chains without subtractions, so that 1e-18 keeps its digits.

Plain loops, products, quotients, and sums that are rounded once, as ``sum`` is not before Python
3.12: the same digits on every machine. Sources: uniformisation (Jensen 1953), scaling and squaring
of non-negative matrices, and the elimination of Grassmann, Taksar and Heyman (1985).

Rotors: which sets of failed motors an airframe survives. Source: Aslansefat et al., "SafeDrones:
Real-Time Reliability Evaluation of UAVs" and the paper of 2019 on multirotor reliability by the
same group; motors are numbered as in the name, from 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

Arc = tuple[int, int, float]
Matrix = list[list[float]]
_TERMS = 25


class Chain(NamedTuple):
    """A chain.

    Attributes:
        states: their names, for people.
        initial: number of the state at the start.
        fail: numbers of the fail states; failure is first passage.
        arcs: (from, to, rate in 1/h); parallel ones add up.
        age: hours that it had run, unobserved, before the start of the mission.
    """

    states: tuple[str, ...]
    initial: int
    fail: tuple[int, ...]
    arcs: tuple[Arc, ...]
    age: float = 0.0


def rates_of(chain: Chain) -> Matrix:
    """Return the rates in 1/h from row to column; those from fail states are left out."""
    rates = [[0.0] * len(chain.states) for _ in chain.states]
    for source, target, rate in _used(chain):
        rates[source][target] += rate
    return rates


def propagator(rates: Matrix, hours: float) -> Matrix:
    """Return the probabilities of transitions in some hours: an exponential of a matrix.

    By Horner in a non-negative matrix and squarings. Entries are non-negative and rows sum to one
    by construction; each entry keeps its relative accuracy, however small it is.
    """
    exits = [math.fsum(row) for row in rates]
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
    """Return the mean time to failure in hours from each state; 0 in a fail state.

    ``inf`` where failure is not certain: some reachable state cannot fail. Without subtractions,
    so that rates of any ratio lose nothing.
    """
    rates, fail = rates_of(chain), sorted(set(chain.fail))
    sure = certain(chain)
    tau = [math.inf] * len(rates)
    for state in fail:
        tau[state] = 0.0
    order = [state for state in range(len(rates)) if state in sure and state not in chain.fail]
    cost = [1.0] * len(rates)
    exits = {}
    for position in range(len(order) - 1, -1, -1):
        state, rest = order[position], order[:position]
        exits[state] = math.fsum(rates[state][other] for other in (*rest, *fail))
        for other in rest:
            share = rates[other][state] / exits[state]
            if share:
                cost[other] += share * cost[state]
                rates[other] = [
                    mine + share * its for mine, its in zip(rates[other], rates[state], strict=True)
                ]
    for position, state in enumerate(order):
        later = math.fsum(rates[state][other] * tau[other] for other in order[:position])
        tau[state] = (cost[state] + later) / exits[state]
    return tau


def certain(chain: Chain) -> set[int]:
    """Return the states from which failure is certain in the long run."""
    states = set(range(len(chain.states)))
    return states - reaching(chain, states - reaching(chain, chain.fail))


def reaching(chain: Chain, targets: Iterable[int]) -> set[int]:
    """Return the states from which one of the targets can be reached."""
    return _connected(((b, a) for a, b, _ in _used(chain)), targets)


def reached(chain: Chain) -> set[int]:
    """Return the states that can be reached from the initial one."""
    return _connected(((a, b) for a, b, _ in _used(chain)), [chain.initial])


def _used(chain: Chain) -> Iterable[Arc]:
    fail = set(chain.fail)
    return (arc for arc in chain.arcs if arc[0] not in fail and arc[0] != arc[1] and arc[2] > 0.0)


def _connected(pairs: Iterable[tuple[int, int]], starts: Iterable[int]) -> set[int]:
    after: dict[int, list[int]] = {}
    for source, target in pairs:
        after.setdefault(source, []).append(target)
    found = set(starts)
    waiting = list(found)
    while waiting:
        new = set(after.get(waiting.pop(), ())) - found
        found |= new
        waiting += new
    return found


def _product(one: Matrix, other: Sequence[Sequence[float]]) -> Matrix:
    columns = list(zip(*other, strict=True))
    found = []
    for row in one:
        used = [(k, value) for k, value in enumerate(row) if value]
        found.append([math.fsum([value * column[k] for k, value in used]) for column in columns])
    return found


def _normalised(matrix: Matrix) -> Matrix:
    wholes = map(math.fsum, matrix)
    return [[value / whole for value in row] for row, whole in zip(matrix, wholes, strict=True)]


Failed = frozenset[int]
_RING = (frozenset({0, 2, 4}), frozenset({1, 3, 5}))
CONFIGURATIONS = {"PNPN": 4, "PNPNPN": 6, "PPNNPN": 6, "PPNNPPNN": 8}
"""Name by direction of rotation (P and N) -> number of motors."""


def motors_of(configuration: str) -> int | None:
    """Return the number of motors of a configuration, None for an unknown one.

    The mirrored frame, where P and N are exchanged, is the same structure.
    """
    return CONFIGURATIONS.get(_usual(configuration))


def operational(configuration: str, failed: Failed) -> bool:
    """Return whether a frame flies with these motors failed."""
    name = _usual(configuration)
    if name == "PNPN":
        return not failed
    if name == "PNPNPN":
        if len(failed) < 2 or any(failed <= half for half in _RING):
            return True
        a, b = sorted(failed)[:2]
        return len(failed) == 2 and b - a not in (1, 5)
    pairs = ({0, 1}, {2, 3}) if name == "PPNNPN" else ({0, 1}, {2, 3}, {4, 5}, {6, 7})
    critical = {4, 5} if name == "PPNNPN" else set()
    return not failed & critical and not any(pair <= failed for pair in pairs)


def _usual(configuration: str) -> str:
    mirrored = configuration.translate(str.maketrans("PN", "NP"))
    return configuration if configuration in CONFIGURATIONS else mirrored


def rotors_chain(configuration: str, rates: Sequence[float]) -> Chain:
    """Return the chain over sets of failed motors; the last state is the loss of the frame."""
    sets = survived(configuration)
    number = {failed: i for i, failed in enumerate(sets)}
    loss = len(sets)
    arcs: list[Arc] = []
    for failed, i in number.items():
        for motor, rate in enumerate(rates):
            if motor not in failed:
                arcs.append((i, number.get(failed | {motor}, loss), rate))
    names = [", ".join(map(str, sorted(failed))) or "none" for failed in sets]
    return Chain((*names, "loss"), 0, (loss,), tuple(arcs))


@cache
def survived(configuration: str) -> tuple[Failed, ...]:
    """Return the sets of failed motors that one failure after the other can lead to."""
    found: dict[Failed, None] = {frozenset(): None}
    waiting: list[Failed] = [frozenset()]
    while waiting:
        failed = waiting.pop(0)
        for motor in range(motors_of(configuration) or 0):
            after = failed | {motor}
            if after not in found and operational(configuration, after):
                found[after] = None
                waiting.append(after)
    return tuple(found)
