"""How long a condition may hold after what it is about has ended: its windows and memories."""

from __future__ import annotations

import math
from collections.abc import Mapping
from heapq import heappop, heappush
from typing import NamedTuple

from eddi_scaffold.conditions.uses import SIGNS, inputs_of
from eddi_scaffold.program.instructions import BUFFERED, Operation, Program


class Lag(NamedTuple):
    """Seconds beyond one step until a condition is lost; infinite where nothing bounds them."""

    unknown: float = 0.0  # after its variable has become UNKNOWN
    value: float = 0.0  # after a bad value came, and lasts

    def plus(self, other: Lag) -> Lag:
        """Return the sum."""
        return Lag(self.unknown + other.unknown, self.value + other.value)

    def longest(self, other: Lag) -> Lag:
        """Return the longer one of each."""
        return Lag(max(self.unknown, other.unknown), max(self.value, other.value))


_NEVER = Lag(math.inf, math.inf)
_SIGNS: Mapping[str, tuple[int, ...]] = {
    **{op: tuple(1 if more else -1 for more in row) for op, row in SIGNS.items()},
    **dict.fromkeys(("add", "least", "greatest", "count", "max", "min"), (1,)),
    **dict.fromkeys(("lt", "le"), (-1, 1)), **dict.fromkeys(("gt", "ge", "sub"), (1, -1)),
    "neg": (-1,),
}  # fmt: skip
"""Operation -> for each operand, whether more of it makes more of the result."""


def lags(program: Program, root: int, wanted: int) -> dict[str, Lag]:
    """Return the lag of each variable of a condition.

    Args:
        program: it has the condition.
        root: the operation that is the condition.
        wanted: 1 where the condition is of use while it is true, -1 while it is false, 0: either.
    """
    waiting: dict[int, dict[int, Lag]] = {root: {wanted: Lag()}}  # operation -> sign -> so far
    result: dict[str, Lag] = {}
    numbers = [-root]  # a heap, the last one first: operands stand before what is made of them
    while numbers:
        number = -heappop(numbers)
        node = program.operations[number]
        for sign, above in waiting.pop(number).items():
            if node.op in ("variable", "age"):
                own = _NEVER if node.op == "age" else Lag()
                for name in inputs_of(program.reads[node.value]):
                    result[name] = result.get(name, Lag()).longest(above.plus(own))
            signs = _SIGNS.get(node.op, ())
            for place, operand in enumerate(node.args):
                lag = above.plus(_own(node, place, sign, program.period / 1e9))
                inner = sign * signs[place % len(signs)] if signs else 0
                if operand not in waiting:
                    heappush(numbers, -operand)
                signed = waiting.setdefault(operand, {})
                signed[inner] = signed.get(inner, lag).longest(lag)
    return result


def _own(node: Operation, place: int, sign: int, period_s: float) -> Lag:
    """Return what an operation adds for an operand, where its value is of use with a sign."""
    window_s = node.window / 1e9
    if node.op in ("time", "once"):  # one FALSE ends TIME at once, one TRUE holds ONCE for long
        at_once = sign == (1 if node.op == "time" else -1)
        return Lag() if at_once else Lag(window_s, window_s)
    if node.op in BUFFERED:  # UNKNOWN ends it at once, unless that is accepted
        at_once = sign == {"max": -1, "min": 1}.get(node.op)
        covered_s = 0.0 if node.coverage is None else (1 - node.coverage) * window_s
        return Lag(covered_s, 0.0 if at_once else window_s)
    if node.op in ("rise", "fall", "edge"):
        return Lag(period_s, period_s)
    if node.op == "latch":  # it is ended by the other operand alone
        return Lag() if sign == (-1, 1)[place] else _NEVER
    if node.op in ("hysteresis", "elapsed"):  # the value may lie in the band, time goes on
        return Lag(0.0, math.inf)
    if node.op.startswith("known"):
        return Lag(0.0 if sign == 1 else math.inf, math.inf)
    return Lag()
