"""Conditions by their definition: the whole history is kept, every window is looked through anew.

Written against the meaning of the language, so that it shares nothing with what is compiled. A
value is a number, a truth or the number of a literal; ``None`` is UNKNOWN.
"""

from __future__ import annotations

import math
import operator
import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from eddi_scaffold.program.instructions import Operation, Program, Read
    from eddi_scaffold.program.lists import Part, Reduction

Value = Any
Factor = tuple[int, int]
TRUTHS = (False, None, True)
COMPARISONS: Mapping[str, Callable[[Any, Any], bool]] = {
    op: getattr(operator, op) for op in ("lt", "le", "gt", "ge", "eq", "ne")
}
_EXACT: Mapping[str, Callable[..., Any]] = {
    "not": operator.not_,
    "xor": operator.ne,
    "abs": abs,
    "least": min,
    "greatest": max,
}
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_INFINITE = (math.inf, -math.inf)
STATEFUL = ("rise", "fall", "edge", "latch", "hysteresis", "elapsed")


class Sample(NamedTuple):
    """What is given at a step."""

    t: int  # nanoseconds
    values: Mapping[str, Value]  # by name of what is read, as they come
    ages: Mapping[str, int]  # nanoseconds; of others 0


class History:
    """All values of the operations of a program at the steps of a run.

    A step at the time of the one before is none; one before it begins anew. ``factors`` are of
    values that come in another unit, ``gap`` nanoseconds that a gap may last longer, ``error`` that
    of what is rounded, relative to the largest sample of a window.
    """

    def __init__(
        self,
        program: Program,
        given: Iterable[Sample],
        factors: Mapping[str, Factor] | None = None,
        gap: int = 0,
        error: float = 0.0,
    ) -> None:
        self.program, self.factors, self.error = program, factors or {}, error
        self.given = [*given]
        self.samples: list[Sample] = []  # those that are steps
        self.steps: list[int] = []  # of each given sample the number of its step
        self.begin: list[int] = []  # of each step the first one since the clock went back
        self.since: list[int] = []  # time from which on windows fill
        self.series: list[list[Value]] = []  # of each operation, its value at each step
        last: int | None = None
        for sample in self.given:
            if last != sample.t:
                number, is_new = len(self.samples), last is None or sample.t < last
                is_gap = last is not None and 2 * (sample.t - last - gap) > 5 * program.period
                self.begin.append(number if is_new else self.begin[-1])
                self.since.append(sample.t if is_new or is_gap else self.since[-1])
                self.samples.append(sample)
                last = sample.t
            self.steps.append(len(self.samples) - 1)
        self.times = [sample.t for sample in self.samples]
        for row in program.operations:
            self.series.append(self.value(row))

    def again(self, given: Iterable[Sample] = (), **changes: Any) -> History:
        """Return the history of other samples, or of these with another gap or error."""
        return History(self.program, given or self.given, self.factors, **changes)

    def replaced(self, k: int, series: Callable[[History], list[Value]]) -> History:
        """Return the history with other values of an operation."""
        other, rows = copy(self), self.program.operations
        other.series = [*self.series[:k], series(self)]
        for row, own in zip(rows[k + 1 :], self.series[k + 1 :], strict=True):
            is_same = all(other.series[arg] == self.series[arg] for arg in row.args)
            other.series.append(own if is_same else other.value(row))
        return other

    def columns(self, *operations: int) -> list[tuple[Value, ...]]:
        """Return the values of operations at each step."""
        return [*zip(*(self.series[k] for k in operations), strict=True)]

    def results(self) -> list[tuple[Value, ...]]:
        """Return the results at each sample."""
        rows = self.columns(*(of.operation for of in self.program.results))
        return [*map(rows.__getitem__, self.steps)]

    def value(self, row: Operation, shift: int = 0) -> list[Value]:
        """Return the values of an operation.

        ``shift``: nanoseconds by which a window is full later, or a sample can be farther ahead.
        """
        op, value, steps = row.op, row.value, range(len(self.times))
        args = [self.series[arg] for arg in row.args]
        if op in ("variable", "age"):
            read = self.program.reads[value] if isinstance(value, int) else value
            return [pair[op == "age"] for pair in self._sampled(read, shift)]
        if not args:
            return [TRUTHS[value] if op == "truth" else value] * len(steps)
        if row.window:
            return [self._window(row, shift, step) for step in steps]
        if op not in STATEFUL:
            return [combined(op, now) for now in zip(*args, strict=True)]
        series: list[Value] = []
        edge: int | None = None  # when the value of ELAPSED became true
        for step, t in enumerate(self.times):
            now, is_first = [arg[step] for arg in args], self.begin[step] == step
            before = None if is_first else args[0][step - 1]
            edge = None if is_first or now[0] is None else t if now[0] and before is False else edge
            state = None if is_first else series[-1]
            if op == "elapsed":
                series.append(None if edge is None else (t - edge) / 1e9)
            elif op == "latch":
                kept = combined("and", (not is_first and state, combined("not", now[1:])))
                series.append(combined("or", (now[0], kept)))
            elif op == "hysteresis":
                x, low, high = now
                inside = None if None in now else state
                series.append(inside if None in now or low < x < high else x >= high)
            else:
                rise = combined("and", (now[0], combined("not", [before])))
                fall = combined("and", (combined("not", now), before))
                edges = {"rise": rise, "fall": fall, "edge": combined("or", (rise, fall))}
                series.append(edges[op])
        return series

    def _sampled(self, read: Read, ahead: int) -> list[tuple[Value, float | None]]:
        """Return the values of what is read, each with the age of the last one in seconds."""
        name = read.name if read.reduction is None else read.reduction.inputs[0].name
        pairs: list[tuple[Value, float | None]] = []
        valid: int | None = None  # time of the last valid sample
        for step, (t, raws, ages) in enumerate(self.samples):
            value = sample_of(read, raws, self.factors.get(name))
            age, valid = ages.get(name, 0), None if self.begin[step] == step else valid
            if read.stamped and -age > self.program.period + ahead:
                value = None
            valid = valid if value is None else t - max(age, 0)
            is_old = read.timeout is not None and age > read.timeout
            pairs.append((None if is_old else value, None if valid is None else (t - valid) / 1e9))
        return pairs

    def _window(self, row: Operation, shift: int, step: int) -> Value:
        t, op = self.times[step], row.op
        first = bisect_right(self.times, t - row.window, self.begin[step], step + 1)
        values = self.series[row.args[0]][first : step + 1]
        if op in ("average", "sum", "stddev", "rate"):
            values = [None if value in _INFINITE else value for value in values]
        known = [value for value in values if value is not None]
        is_full = self.since[step] <= t - row.window + self.program.period - shift
        is_known = is_full and _is_enough(known, values, row.coverage)
        if op in ("time", "once"):
            strong = op == "once"
            return strong if strong in known else not strong if is_known else None
        if not is_known:
            return None
        if op == "rate":
            ends = [n for n, value in enumerate(values, first) if value is not None]
            seconds = (self.times[ends[-1]] - self.times[ends[0]]) / 1e9
            return finite((known[-1] - known[0]) / seconds) if seconds else None
        value, is_rounded = aggregated(op, known), op in ("average", "sum", "stddev")
        if value is None or not self.error or not is_rounded or len(set(known)) == 1:
            return value
        return value + self.error * max(map(abs, known))


def _is_enough(known: Sequence[Value], values: Sequence[Value], coverage: float | None) -> bool:
    share = 1.0 if coverage is None else coverage
    return bool(known) and len(known) / len(values) >= share


def aggregated(op: str, known: Sequence[Value]) -> Value:
    """Return one value for several that are known, without order."""
    if op == "count":
        return float(known.count(True))
    if op in ("max", "min"):
        return max(known) if op == "max" else min(known)
    if op == "median":
        ordered = sorted(known)
        low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
        middle = low if low == high else low / 2 + high / 2
        return None if math.isnan(middle) else middle
    try:
        total, left = math.fsum(known), len(known) - 1
        if op in ("sum", "average"):
            return finite(total if op == "sum" else total / len(known))
        mean = total / len(known)
        squares = math.fsum((value - mean) * (value - mean) for value in known)
        return finite(math.sqrt(squares / left)) if left else None
    except (OverflowError, ValueError):  # beyond doubles, or infinities of both signs
        return None


def finite(value: float) -> float | None:
    """Return a number, ``None`` for what is none."""
    return value if math.isfinite(value) else None


def combined(op: str, args: Sequence[Value]) -> Value:
    """Return the value of an operation of values of one time (strong Kleene)."""
    op = op.partition("_")[0]
    if op == "known":
        return args[0] is not None
    if op in ("and", "or"):
        strong = op == "or"
        return strong if strong in args else None if None in args else not strong
    if op == "implies":
        return combined("or", (combined("not", args[:1]), args[1]))
    if None in args:
        return None
    if op in COMPARISONS or op in _EXACT:
        return (COMPARISONS.get(op) or _EXACT[op])(*args)
    if not all(map(math.isfinite, args)):
        return None
    if op == "sqrt":
        return math.sqrt(args[0]) if args[0] >= 0 else None
    if op == "div":
        return finite(args[0] / args[1]) if args[1] else None
    return finite(getattr(operator, op)(*args))


def sample_of(read: Read, raws: Mapping[str, Value], factor: Factor | None = None) -> Value:
    """Return what counts of a value that is read, by its type and its range."""
    raw: Any = raws.get(read.name)
    if factor is not None and type(raw) in (int, float):
        raw = raw * factor[0] / factor[1]
    if read.reduction is not None:
        raw = reduced(read.reduction, [raws.get(part.name) for part in read.reduction.inputs])
    if read.type == "enum":
        return read.literals.index(raw) if raw in read.literals else None
    if read.text:
        text = raw.strip(" \t") if isinstance(raw, str) else ""
        raw = float(text) if _NUMBER.fullmatch(text) and len(text) <= 100 else None
    return _plain(read, raw)


def _plain(read: Read | Part, raw: Value) -> Value:
    if read.type == "bool":
        return raw if isinstance(raw, bool) else None
    if isinstance(raw, bool) or not isinstance(raw, int | float) or math.isnan(raw):
        return None
    if math.isinf(raw):
        return raw if read.infinite else None
    return float(raw) if read.range is None or read.range[0] <= raw <= read.range[1] else None


def reduced(reduction: Reduction, raws: Sequence[Value]) -> Value:
    """Return what the lists of a message are reduced to."""
    columns: list[Any] = []  # a list of values, or one value
    for part, raw in zip(reduction.inputs, raws, strict=True):
        if part.is_list and not isinstance(raw, list | tuple):
            return None
        columns.append([_plain(part, each) for each in raw] if part.is_list else _plain(part, raw))
    number, *others = (len(column) for column in columns if isinstance(column, list))
    least, most = reduction.length or (0, number)
    inside: Sequence[int] | None = range(number)
    if reduction.sector is not None:
        inside = _in_sector(number, reduction.sector, [columns[k] for k in reduction.angles])
    if {*others} - {number} or not least <= number <= most or inside is None:
        return None
    op = reduction.op.removeprefix("list_")
    if not inside:
        return {"sum": 0.0, "count": 0.0, "any": False}.get(op) if reduction.messages else None

    def value(k: int, element: int) -> Value:
        node = reduction.nodes[k]
        if node.op == "input":
            return columns[node.value][element] if node.is_list else columns[node.value]
        if node.op == "constant":
            return TRUTHS[node.value] if type(node.value) is int else finite(node.value)
        return combined(node.op, [value(arg, element) for arg in node.args])

    for place, *ends in reduction.limits:
        low, high = (value(end, inside[0]) for end in ends)
        if low is None or high is None:
            return None
        columns[place] = [
            x if x is None or x in _INFINITE or low <= x <= high else None for x in columns[place]
        ]
    values = [value(reduction.value, element) for element in inside]
    known = [each for each in values if each is not None]
    if op in ("any", "all") and (op == "any") in values:
        return op == "any"
    if not _is_enough(known, values, reduction.coverage):
        return None
    return op == "all" if op in ("any", "all") else aggregated(op, known)


def _in_sector(
    number: int, sector: tuple[float, float], angles: Sequence[float | None]
) -> list[int] | None:
    """Return which elements of a scan lie in a sector, ``None`` where it does not say."""
    start, end, step = angles
    if start is None or end is None or not step or number == 0:
        return [] if number == 0 else None
    half, last = abs(step) / 2, start + (number - 1) * step
    is_inside = min(start, last) - half <= sector[0] and sector[1] <= max(start, last) + half
    if abs(last - end) > 3 * half or not is_inside:
        return None
    return [k for k in range(number) if sector[0] - half <= start + k * step <= sector[1] + half]
