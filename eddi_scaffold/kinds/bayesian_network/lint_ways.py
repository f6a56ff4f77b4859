"""The paths through a hand-written body, as far as its text shows them."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

MOST = 256
"""Bodies with more ways than that are not followed."""


@dataclass(frozen=True)
class OutcomeAssignment:
    """An assignment ``outcome_<state> = ...``.

    Attributes:
        name: its target.
        value: the number that is assigned, ``None`` for any other expression.
        line: where it is.
    """

    name: str
    value: float | None
    line: int


@dataclass(frozen=True)
class Way:
    """One way through a body.

    Attributes:
        names: outcomes that it sets to something else than 0.
        sure: those that it sets to 1.
        lines: where it sets them.
    """

    names: frozenset[str] = frozenset()
    sure: frozenset[str] = frozenset()
    lines: frozenset[int] = frozenset()


@dataclass(frozen=True)
class IfChain:
    """``if``, ``elif`` ..., ``else``.

    Attributes:
        line: of the ``if``.
        tests: conditions, in order.
        blocks: the code below each.
        otherwise: the ``else``; empty when there is none.
    """

    line: int
    tests: tuple[ast.expr, ...]
    blocks: tuple[tuple[ast.stmt, ...], ...]
    otherwise: tuple[ast.stmt, ...]

    @property
    def sets_no_else(self) -> bool:
        """Some branch sets an outcome, and there is no ``else``."""
        return not self.otherwise and any(_real(block) for block in self.blocks)

    @property
    def else_sets(self) -> bool:
        """The ``else`` sets an outcome."""
        return bool(_real(self.otherwise))

    @property
    def orders(self) -> bool:
        """A condition compares by order."""
        kinds = ast.Lt | ast.LtE | ast.Gt | ast.GtE
        return any(
            isinstance(item, ast.Compare) and any(isinstance(op, kinds) for op in item.ops)
            for test in self.tests
            for item in ast.walk(test)
        )

    def zeros_in_else(self) -> list[OutcomeAssignment]:
        """Return assignments of 0 in an ``else`` that sets nothing else."""
        return [] if _real(self.otherwise) else [*assignments(self.otherwise)]

    def breaks(self) -> Iterator[tuple[int, float, float]]:
        """Yield line, end of one range and start of the next, where these are not equal."""
        before: tuple[str, float] | None = None
        for test in self.tests:
            limits = _limits(test)
            if limits is None:
                before = None
                continue
            what, low, high = limits
            if before is not None and low is not None and before[0] == what and low != before[1]:
                yield test.lineno, before[1], low
            before = (what, high) if high is not None else None


def statements(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield every statement of a body, those inside others too, in the order of the text."""
    for statement in body:
        for item in ast.walk(statement):
            if isinstance(item, ast.stmt):
                yield item


def assignments(body: Iterable[ast.stmt]) -> Iterator[OutcomeAssignment]:
    """Yield every assignment to an outcome in a body, those inside others too."""
    for statement in statements(body):
        found = assignment(statement)
        if found is not None:
            yield found


def assignment(statement: ast.stmt) -> OutcomeAssignment | None:
    """Return the assignment to an outcome that a statement is, ``None`` for all others."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=value) if name.startswith("outcome_"):
            return OutcomeAssignment(name, constant(value), statement.lineno)
    return None


def flags_output(statement: ast.stmt) -> bool:
    """Return whether a statement is ``is_bn_output = ...`` with something else than False."""
    if not isinstance(statement, ast.Assign) or len(statement.targets) != 1:
        return False
    target, value = statement.targets[0], statement.value
    is_flag = isinstance(target, ast.Name) and target.id == "is_bn_output"
    return is_flag and not (isinstance(value, ast.Constant) and value.value is False)


def constant(value: ast.expr) -> float | None:
    """Return the number that an expression is, ``None`` for all others."""
    if isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.USub):
        number = constant(value.operand)
        return None if number is None else -number
    written = value.value if isinstance(value, ast.Constant) else None
    if isinstance(written, int | float) and not isinstance(written, bool):
        try:
            return float(written)
        except OverflowError:
            return None
    return None


def chains(body: Sequence[ast.stmt]) -> Iterator[IfChain]:
    """Yield every ``if`` of a body with its ``elif`` and ``else``, those inside others too."""
    links: set[ast.If] = set()
    for statement in statements(body):
        if not isinstance(statement, ast.If) or statement in links:
            continue
        tests, blocks, rest = [statement.test], [tuple(statement.body)], statement.orelse
        while len(rest) == 1 and isinstance(rest[0], ast.If):
            links.add(rest[0])
            tests.append(rest[0].test)
            blocks.append(tuple(rest[0].body))
            rest = rest[0].orelse
        yield IfChain(statement.lineno, tuple(tests), tuple(blocks), tuple(rest))


def through(body: Sequence[ast.stmt]) -> frozenset[Way] | None:
    """Return the paths through a body; ``None`` when the text alone does not show them."""
    try:
        ends: set[Way] = set()
        return _follow(body, frozenset([Way()]), ends) | ends
    except _UnclearError:
        return None


class _UnclearError(Exception):
    """Loops, handlers, or too many ways."""


def _follow(body: Sequence[ast.stmt], ways: frozenset[Way], ends: set[Way]) -> frozenset[Way]:
    for one in body:
        outcome = assignment(one)
        if outcome is not None:
            ways = frozenset(_with(way, outcome) for way in ways)
        elif isinstance(one, ast.If):
            ways = _follow(one.body, ways, ends) | _follow(one.orelse, ways, ends)
        elif isinstance(one, ast.Return | ast.Raise):
            ends.update(ways)
            return frozenset()
        elif isinstance(one, ast.With):
            ways = _follow(one.body, ways, ends)
        elif any(_mentions_outcome(item) for item in ast.walk(one)):
            raise _UnclearError
        if len(ways) + len(ends) > MOST:
            raise _UnclearError
    return ways


def _with(way: Way, one: OutcomeAssignment) -> Way:
    names, sure = way.names - {one.name}, way.sure - {one.name}
    if one.value != 0.0:
        names |= {one.name}
    if one.value == 1.0:
        sure |= {one.name}
    return Way(names, sure, way.lines | {one.line})


def _mentions_outcome(item: ast.AST) -> bool:
    if not isinstance(item, ast.Name) or not isinstance(item.ctx, ast.Store):
        return False
    return item.id.startswith("outcome_")


def _real(block: Sequence[ast.stmt]) -> list[OutcomeAssignment]:
    return [one for one in assignments(block) if one.value != 0.0]


def _limits(test: ast.expr) -> tuple[str, float | None, float | None] | None:
    """Return what a condition compares, and the range it is true in."""
    parts = test.values if isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And) else [test]
    what: set[str] = set()
    low: float | None = None
    high: float | None = None
    for part in parts:
        if not isinstance(part, ast.Compare):
            return None
        terms = [part.left, *part.comparators]
        for left, op, right in zip(terms, part.ops, terms[1:], strict=False):
            ends = (left, right) if isinstance(op, ast.Lt | ast.LtE) else (right, left)
            if not isinstance(op, ast.Lt | ast.LtE | ast.Gt | ast.GtE):
                return None
            smaller, larger = constant(ends[0]), constant(ends[1])
            if (smaller is None) == (larger is None):
                return None
            if smaller is not None:
                low = smaller
            else:
                high = larger
            what.add(ast.dump(ends[1] if smaller is not None else ends[0]))
    return (what.pop(), low, high) if len(what) == 1 else None
