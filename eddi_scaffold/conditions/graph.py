"""The intermediate form in the making: equal nodes are one, constants are computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import add, eq, ge, gt, le, lt, mul, ne, sub
from typing import Any

from eddi_scaffold.program.builder import SIGNATURES, VERSION
from eddi_scaffold.program.instructions import BUFFERED

Row = dict[str, Any]
At = tuple[int, int]
"""Line and column."""


class GraphBuilder:
    """Collects the nodes of a form; what adds one returns its number."""

    def __init__(self, period: int) -> None:
        self.period = period
        self.rows: list[Row] = []
        self._known: dict[tuple[str, ...], int] = {}

    def leaf(self, op: str, value: float | None, at: At) -> int:
        """Add a constant or what is read.

        Args:
            op: ``number``, ``truth``, ``literal``, ``variable`` or ``age``.
            value: the constant, ``None`` for an UNKNOWN number, or which literal or variable.
            at: its place.
        """
        return self._add({"op": op, "value": value, "at": list(at)})

    def operation(self, op: str, args: Sequence[int], at: At) -> int:
        """Add an operation; one whose value is the same in every step becomes a constant."""
        if op in _FOLDED and all(self.is_constant(k) for k in args):
            type_ = "truth" if SIGNATURES[op][1] == "bool" else "number"
            return self.leaf(type_, _folded(op, [self.rows[k]["value"] for k in args]), at)
        return self._add({"op": op, "args": list(args), "at": list(at)})

    def window(self, op: str, arg: int, length: int, coverage: float | None, at: At) -> int:
        """Add a window."""
        row: Row = {"op": op, "args": [arg], "window": length, "at": list(at)}
        if op in BUFFERED:
            row["capacity"] = capacity(length, self.period)
        if coverage is not None:
            row["coverage"] = coverage
        return self._add(row)

    def is_constant(self, node: int) -> bool:
        """Return whether the value of a node never changes."""
        return self.rows[node]["op"] in ("number", "truth", "literal")

    def document(self, variables: list[Row], outputs: list[Row]) -> Row:
        """Return the intermediate form; nodes that nothing uses are omitted."""
        rows, new = self.needed({output["node"] for output in outputs})
        return {
            "version": VERSION,
            "period": self.period,
            "variables": variables,
            "nodes": rows,
            "outputs": [{**output, "node": new[output["node"]]} for output in outputs],
        }

    def needed(self, nodes: Iterable[int]) -> tuple[list[Row], dict[int, int]]:
        """Return the rows that some nodes need, and the new number of each."""
        used = set(nodes)
        for number in range(len(self.rows) - 1, -1, -1):
            if number in used:
                used.update(self.rows[number].get("args", ()))
        new = {old: k for k, old in enumerate(sorted(used))}
        rows = [dict(self.rows[old]) for old in new]
        for row in rows:
            if "args" in row:
                row["args"] = [new[k] for k in row["args"]]
        return rows, new

    def _add(self, row: Row) -> int:
        # repr: 0.0 and -0.0, 1 and True are not the same
        key = tuple(repr(row.get(k)) for k in ("op", "args", "value", "window", "coverage"))
        if key not in self._known:
            self._known[key] = len(self.rows)
            self.rows.append(row)
        return self._known[key]


def capacity(length: int, period: int) -> int:
    """Return how many samples a window has room for: a power of two, twice what it needs."""
    return 1 << (2 * -(-length // period) + 7).bit_length()


COMPARISONS: Mapping[str, Callable[[Any, Any], bool]]
COMPARISONS = {"lt": lt, "le": le, "gt": gt, "ge": ge, "eq": eq, "ne": ne}
_ARITHMETIC: Mapping[str, Callable[..., float]] = {
    "add": add,
    "sub": sub,
    "mul": mul,
    "div": lambda a, b: a / b if b else math.nan,
    "neg": lambda a: -a,
    "abs": abs,
    "sqrt": lambda a: math.sqrt(a) if a >= 0 else math.nan,
    "least": min,
    "greatest": max,
}
_TRUTHS: Mapping[str, Callable[..., int]] = {
    "and": min,
    "or": max,
    "not": lambda a: 2 - a,
    "implies": lambda a, b: max(2 - a, b),
    **{op: lambda a, b: 1 if 1 in (a, b) else a ^ b for op in ("xor", "ne_bool")},
    "eq_bool": lambda a, b: 1 if 1 in (a, b) else 2 - (a ^ b),
    "known_enum": lambda _: 2,
    "eq_enum": lambda a, b: 2 * (a == b),
    "ne_enum": lambda a, b: 2 * (a != b),
    "known": lambda a: 2 * (a is not None),
    "known_bool": lambda a: 2 * (a != 1),
}
"""0 is FALSE, 1 UNKNOWN, 2 TRUE; an UNKNOWN number is None."""
_FOLDED = {*_TRUTHS, *COMPARISONS, *_ARITHMETIC}
"""What gives the same value in every step when its operands do."""


def _folded(op: str, args: Sequence[Any]) -> float | None:
    if op in _TRUTHS:
        return _TRUTHS[op](*args)
    if op in COMPARISONS:
        return 1 if None in args else 2 * COMPARISONS[op](*args)
    value = math.nan if None in args else _ARITHMETIC[op](*args)
    return value if math.isfinite(value) else None
