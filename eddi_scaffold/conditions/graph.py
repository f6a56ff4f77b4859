"""The program of conditions in the making: equal operations are one, constants are computed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from eddi_scaffold.conditions.definition import TRUTHS, combined
from eddi_scaffold.program.instructions import (
    BOOL,
    BUFFERED,
    ENUM,
    NUMBER,
    SIGNATURES,
    STARTS,
    WINDOWS,
    Operation,
    Program,
    Read,
    Result,
)

_CONSTANTS = {"number": NUMBER, "truth": BOOL, "literal": ENUM}
_KEEPS_INFINITY = ("abs", "least", "greatest", "max", "min", "median")
"""Operations whose value can be infinite when an argument is."""


class At(NamedTuple):
    """Where an operation stands in the text."""

    about: str = ""  # its place and its own part of the text
    at: tuple[int, int] = (0, 0)  # line and column


class GraphBuilder:
    """Collects operations; what adds one returns its number."""

    def __init__(self, period: int = 0) -> None:
        self.period = period
        self.used: dict[str, int] = {}  # variables in the order of their first use
        self.operations: list[Operation] = []
        self._known: dict[str, int] = {}

    def leaf(self, op: str, value: float | None, at: At) -> int:
        """Add a constant, ``None`` for an UNKNOWN number, or what is read: its number."""
        return self.add(Operation(op, (), "", value, **at._asdict()))

    def variable(self, name: str, at: At) -> int:
        """Add what is read."""
        return self.leaf("variable", self.used.setdefault(name, len(self.used)), at)

    def operation(self, op: str, args: Sequence[int], at: At) -> int:
        """Add an operation, or a constant where its value is the same in every step."""
        if op in _FOLDED and all(self.is_constant(k) for k in args):
            rows = [self.operations[k] for k in args]
            value = combined(op, [TRUTHS[r.value] if r.op == "truth" else r.value for r in rows])
            is_truth = SIGNATURES[op][1] == BOOL
            return (
                self.leaf("truth", TRUTHS.index(value), at)
                if is_truth
                else self.leaf("number", value, at)
            )
        return self.add(Operation(op, tuple(args), "", **at._asdict()))

    def window(self, op: str, arg: int, length: int, coverage: float | None, at: At) -> int:
        """Add a window."""
        samples = capacity(length, self.period) if op in BUFFERED else 0
        more = {"window": length, "capacity": samples, "coverage": coverage, **at._asdict()}
        return self.add(Operation(op, (arg,), "", **more))

    def is_constant(self, node: int) -> bool:
        """Return whether the value of a node never changes."""
        return self.operations[node].op in _CONSTANTS

    def program(self, reads: Sequence[Read], results: Sequence[Result]) -> Program:
        """Return the program; operations that nothing uses are omitted."""
        operations, new = self.needed(result.operation for result in results)
        aged = {row.value for row in operations if row.op == "age"}
        stamped = [k in aged or read.timeout is not None for k, read in enumerate(reads)]
        reads = [read._replace(stamped=of) for read, of in zip(reads, stamped, strict=True)]
        typed: list[Operation] = []
        for row in operations:
            if row.op == "variable":
                type_, infinite = reads[row.value].type, reads[row.value].infinite
            else:
                type_ = _CONSTANTS.get(row.op) or SIGNATURES[row.op][1]
                infinite = row.op in _KEEPS_INFINITY and any(typed[k].infinite for k in row.args)
            typed.append(row._replace(type=type_, infinite=infinite))
        renumbered = (result._replace(operation=new[result.operation]) for result in results)
        return Program(self.period, tuple(reads), tuple(typed), tuple(renumbered))

    def needed(self, nodes: Iterable[int]) -> tuple[list[Operation], dict[int, int]]:
        """Return the operations that some nodes need, and the new number of each."""
        used = set(nodes)
        for number in range(len(self.operations) - 1, -1, -1):
            if number in used:
                used.update(self.operations[number].args)
        new = {old: k for k, old in enumerate(sorted(used))}
        operations = (self.operations[old] for old in new)
        return [row._replace(args=tuple(new[k] for k in row.args)) for row in operations], new

    def add(self, row: Operation) -> int:
        """Add an operation unless there is an equal one."""
        # repr: 0.0 and -0.0, 1 and True are not the same
        key = repr((row.op, row.args, row.value, row.window, row.coverage))
        if key not in self._known:
            self._known[key] = len(self.operations)
            self.operations.append(row)
        return self._known[key]


def capacity(length: int, period: int) -> int:
    """Return how many samples a window has room for: a power of two, twice what it needs."""
    return 1 << (2 * -(-length // period) + 7).bit_length()


_FOLDED = SIGNATURES.keys() - {*WINDOWS, *STARTS, "age"}
"""What gives the same value in every step when its operands do."""
