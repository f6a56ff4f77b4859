"""The program of conditions in the making: equal operations are one, constants are computed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold.conditions.definition import TRUTHS, combined
from eddi_scaffold.conditions.syntax import OPERATORS
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
from eddi_scaffold.program.python_text import comment

At = tuple[int, int]  # line and column
_CONSTANTS = {"number": NUMBER, "truth": BOOL, "literal": ENUM}
_KEEPS_INFINITY = ("abs", "least", "greatest", "max", "min", "median")
"""Operations whose value can be infinite when an argument is."""
_TRUTH_WORDS = ("FALSE", "UNKNOWN", "TRUE")


class GraphBuilder:
    """Collects operations; what adds one returns its number."""

    def __init__(self, period: int = 0) -> None:
        self.period = period
        self.used: dict[str, int] = {}  # variables in the order of their first use
        self.operations: list[Operation] = []
        self._known: dict[str, int] = {}

    def leaf(self, op: str, value: float | None, at: At) -> int:
        """Add a constant, ``None`` for an UNKNOWN number, or what is read: its number."""
        return self._add(Operation(op, (), "", value, at=at))

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
        return self._add(Operation(op, tuple(args), "", at=at))

    def window(self, op: str, arg: int, length: int, coverage: float | None, at: At) -> int:
        """Add a window."""
        samples = capacity(length, self.period) if op in BUFFERED else 0
        window = Operation(op, (arg,), "", None, "", length, samples, coverage, at=at)
        return self._add(window)

    def is_constant(self, node: int) -> bool:
        """Return whether the value of a node never changes."""
        return self.operations[node].op in _CONSTANTS

    def program(self, reads: Sequence[Read], results: Sequence[Result]) -> Program:
        """Return the program; operations that nothing uses are omitted."""
        operations, new = self.needed(result.operation for result in results)
        renumbered = [result._replace(operation=new[result.operation]) for result in results]
        return program_of(self.period, reads, operations, renumbered)

    def needed(self, nodes: Iterable[int]) -> tuple[list[Operation], dict[int, int]]:
        """Return the operations that some nodes need, and the new number of each."""
        used = set(nodes)
        for number in range(len(self.operations) - 1, -1, -1):
            if number in used:
                used.update(self.operations[number].args)
        new = {old: k for k, old in enumerate(sorted(used))}
        operations = (self.operations[old] for old in new)
        return [row._replace(args=tuple(new[k] for k in row.args)) for row in operations], new

    def _add(self, row: Operation) -> int:
        # repr: 0.0 and -0.0, 1 and True are not the same
        key = repr((row.op, row.args, row.value, row.window, row.coverage))
        if key not in self._known:
            self._known[key] = len(self.operations)
            self.operations.append(row)
        return self._known[key]


def program_of(
    period: int, reads: Sequence[Read], operations: Iterable[Operation], results: Iterable[Result]
) -> Program:
    """Return the program of operations without types, each with its type and words."""
    rows = list(operations)
    aged = {row.value for row in rows if row.op == "age"}
    reads = tuple(
        read._replace(stamped=k in aged or read.timeout is not None) for k, read in enumerate(reads)
    )
    typed: list[Operation] = []
    words: list[str] = []
    for row in rows:
        if row.op == "variable":
            type_, infinite = reads[row.value].type, reads[row.value].infinite
        else:
            type_ = _CONSTANTS.get(row.op) or SIGNATURES[row.op][1]
            infinite = row.op in _KEEPS_INFINITY and any(typed[k].infinite for k in row.args)
        words.append(comment(_words(reads, row, typed, words)))
        about = f"{row.at[0]}:{row.at[1]} {words[-1]}"
        typed.append(row._replace(type=type_, about=about, infinite=infinite))
    return Program(period, reads, tuple(typed), tuple(results))


def _words(
    reads: Sequence[Read], operation: Operation, before: Sequence[Operation], words: Sequence[str]
) -> str:
    """Return the words of an operation, as they stand in comments beside what is made of it."""
    op, value = operation.op, operation.value
    base = op.partition("_")[0]
    if op in ("variable", "age"):
        name = reads[value].name
        return name if op == "variable" else f"AGE({name})"
    if op == "number":
        return "UNKNOWN" if value is None else f"{value!r}".removesuffix(".0")
    if op == "truth":
        return _TRUTH_WORDS[value]
    if op == "literal":
        return f"literal {value}"
    arguments = [before[k] for k in operation.args]
    inner = [words[k] for k in operation.args]
    if base in OPERATORS or op in ("neg", "not"):
        pairs = zip(arguments, inner, strict=True)
        inner = [
            f"({text})" if argument.op.partition("_")[0] in OPERATORS else text
            for argument, text in pairs
        ]
    if op in ("eq_enum", "ne_enum"):  # literals by the names that the other operand has
        variables = (reads[entry.value] for entry in arguments if entry.op == "variable")
        literals = [literal for variable in variables for literal in variable.literals]
        for k, argument in enumerate(arguments):
            if argument.op == "literal" and argument.value < len(literals):
                inner[k] = literals[argument.value]
    if base in OPERATORS:
        return f"{inner[0]} {OPERATORS[base]} {inner[1]}"
    if op in ("neg", "not"):
        return f"{'-' if op == 'neg' else 'NOT '}{inner[0]}"
    if op in WINDOWS:
        inner = [*inner, f"{operation.window / 1e9:g} s"]
    if operation.coverage is not None:
        inner = [*inner, f"COVERAGE {operation.coverage!r}"]
    return f"{base.upper()}({', '.join(inner)})"


def capacity(length: int, period: int) -> int:
    """Return how many samples a window has room for: a power of two, twice what it needs."""
    return 1 << (2 * -(-length // period) + 7).bit_length()


_FOLDED = SIGNATURES.keys() - {*WINDOWS, *STARTS, "age"}
"""What gives the same value in every step when its operands do."""
