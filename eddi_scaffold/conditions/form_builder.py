"""The intermediate form in the making: equal nodes are one, constants are computed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from eddi_scaffold.program.builder import SIGNATURES, VERSION
from eddi_scaffold.program.instructions import BUFFERED

Row = dict[str, Any]
_CONSTANTS = ("number", "truth", "literal")
_U = 1
"""The truth value UNKNOWN."""


class GraphBuilder:
    """Collects the nodes of a form; every ``add`` returns the number of a node."""

    def __init__(self, period: int) -> None:
        self.period = period
        self.rows: list[Row] = []
        self._known: dict[tuple[Any, ...], int] = {}

    def number(self, value: float | None, at: tuple[int, int]) -> int:
        """Add a constant number, ``None`` for UNKNOWN."""
        return self._add({"op": "number", "value": value, "at": list(at)})

    def truth(self, value: int, at: tuple[int, int]) -> int:
        """Add a constant truth value: 0, 1, 2."""
        return self._add({"op": "truth", "value": value, "at": list(at)})

    def literal(self, value: int, at: tuple[int, int]) -> int:
        """Add a literal of an ENUM."""
        return self._add({"op": "literal", "value": value, "at": list(at)})

    def variable(self, op: str, number: int, at: tuple[int, int]) -> int:
        """Add a variable (``variable``) or its age (``age``)."""
        return self._add({"op": op, "value": number, "at": list(at)})

    def operation(self, op: str, args: tuple[int, ...], at: tuple[int, int]) -> int:
        """Add an operation; one whose value is the same in every step becomes a constant."""
        if op in _FOLDS and all(self.is_constant(k) for k in args):
            value = _FOLDS[op](*(self.rows[k]["value"] for k in args))
            if SIGNATURES[op][1] == "bool":
                return self.truth(value, at)
            return self.number(value, at)
        return self._add({"op": op, "args": list(args), "at": list(at)})

    def window(
        self, op: str, arg: int, length: int, coverage: float | None, at: tuple[int, int]
    ) -> int:
        """Add a window."""
        row: Row = {"op": op, "args": [arg], "window": length, "at": list(at)}
        if op in BUFFERED:
            row["capacity"] = capacity(length, self.period)
        if coverage is not None:
            row["coverage"] = coverage
        return self._add(row)

    def is_constant(self, node: int) -> bool:
        """Return whether the value of a node never changes."""
        return self.rows[node]["op"] in _CONSTANTS

    def value(self, node: int) -> Any:
        """Return the value of a constant."""
        return self.rows[node]["value"]

    def document(self, variables: list[Row], outputs: list[Row]) -> dict[str, Any]:
        """Return the intermediate form; nodes that nothing uses are left out."""
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
        rows = []
        for old in sorted(used):
            row = dict(self.rows[old])
            if "args" in row:
                row["args"] = [new[k] for k in row["args"]]
            rows.append(row)
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
    wanted = 2 * -(-length // period) + 8
    return 1 << (wanted - 1).bit_length()


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _unknown_if_none(compare: Any) -> Any:
    def compared(a: Any, b: Any) -> int:
        return _U if a is None or b is None else 2 if compare(a, b) else 0

    return compared


def _arithmetic(compute: Any) -> Any:
    def computed(a: float | None, b: float | None) -> float | None:
        return None if a is None or b is None else compute(a, b)

    return computed


def _xor(a: int, b: int) -> int:
    return _U if _U in (a, b) else a ^ b


_FOLDS: dict[str, Any] = {
    "neg": lambda a: None if a is None else -a,
    "abs": lambda a: None if a is None else abs(a),
    "sqrt": lambda a: None if a is None or a < 0 else math.sqrt(a),
    "least": _arithmetic(min),
    "greatest": _arithmetic(max),
    "add": _arithmetic(lambda a, b: _finite(a + b)),
    "sub": _arithmetic(lambda a, b: _finite(a - b)),
    "mul": _arithmetic(lambda a, b: _finite(a * b)),
    "div": _arithmetic(lambda a, b: _finite(a / b) if b else None),
    "lt": _unknown_if_none(lambda a, b: a < b),
    "le": _unknown_if_none(lambda a, b: a <= b),
    "gt": _unknown_if_none(lambda a, b: a > b),
    "ge": _unknown_if_none(lambda a, b: a >= b),
    "eq": _unknown_if_none(lambda a, b: a == b),
    "ne": _unknown_if_none(lambda a, b: a != b),
    "eq_enum": lambda a, b: 2 if a == b else 0,
    "ne_enum": lambda a, b: 0 if a == b else 2,
    "eq_bool": lambda a, b: _U if _U in (a, b) else 2 - (a ^ b),
    "ne_bool": _xor,
    "xor": _xor,
    "and": min,
    "or": max,
    "not": lambda a: 2 - a,
    "implies": lambda a, b: max(2 - a, b),
    "known": lambda a: 0 if a is None else 2,
    "known_bool": lambda a: 0 if a == _U else 2,
    "known_enum": lambda _: 2,
}
"""What gives the same value in every step when its operands do."""
