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
NEAR = 1e-9  # relative: two numbers that only rounding tells apart
_TRUTHS = (False, None, True)
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
COMPARISONS: Mapping[str, Callable[[Any, Any], bool]] = {
    op: getattr(operator, op) for op in ("lt", "le", "gt", "ge", "eq", "ne")
}


class Sample(NamedTuple):
    """What is there at a step."""

    t: int  # nanoseconds
    values: Mapping[str, Value]  # by name of what is read, as it comes
    stamps: Mapping[str, int]  # when it was sampled, where that is not now


class History:
    """All values of the operations of a program at the steps of a run.

    A step at the time of the one before is none; one before it begins anew.
    """

    def __init__(
        self,
        program: Program,
        samples: Sequence[Sample],
        factors: Mapping[str, Factor] | None = None,  # of what comes in another unit
        gap: int = 0,  # nanoseconds that one may last longer
    ) -> None:
        self.program, self.factors = program, factors or {}
        self.samples: list[Sample] = []  # those that are steps
        self.steps: list[int] = []  # of each sample the number of its step
        self.begin: list[int] = []  # of each step the first one since the clock went back
        self.since: list[int] = []  # time from which on windows fill
        self.rough: dict[int, set[int]] = {}  # operation -> steps where its number is rounded
        self.unsure = len(samples)  # first sample where rounding decides
        self.series: dict[int, list[Value]] = {}  # operation -> its value at each step
        last: int | None = None
        for sample in samples:
            if last != sample.t:
                number, is_new = len(self.samples), last is None or sample.t < last
                is_gap = last is not None and 2 * (sample.t - last) > 5 * program.period + 2 * gap
                self.begin.append(number if is_new else self.begin[-1])
                self.since.append(sample.t if is_new or is_gap else self.since[-1])
                self.samples.append(sample)
                last = sample.t
            self.steps.append(len(self.samples) - 1)
        self.times = [sample.t for sample in self.samples]
        self.evaluate(range(len(program.operations)))

    def evaluate(self, operations: Iterable[int]) -> None:
        """Compute the values of some operations, each after those that it rests on."""
        for k in operations:
            self.series[k] = self.value(k, self.program.operations[k])

    def replaced(
        self, k: int, new: Callable[[History], list[Value]], above: Iterable[int]
    ) -> History:
        """Return the history with other values of an operation; ``above`` is what rests on it."""
        other = copy(self)
        other.series, other.rough = dict(self.series), dict(self.rough)
        other.series[k] = new(other)
        other.evaluate(above)
        return other

    def results(self) -> list[tuple[Value, ...]]:
        """Return the results at each sample."""
        series = [self.series[result.operation] for result in self.program.results]
        rows = [*zip(*series, strict=True)]
        return [rows[step] for step in self.steps]

    def value(self, k: int, operation: Operation, full: int = 0) -> list[Value]:
        """Return the values of one operation; ``full``: later that a window is."""
        op, value, steps = operation.op, operation.value, range(len(self.times))
        args = [self.series[arg] for arg in operation.args]
        rough = [self.rough.get(arg, set()) for arg in operation.args]
        self.rough[k] = set()
        if op in ("variable", "age"):
            sampled = self.sampled(self.program.reads[value])
            return [now for now, _ in sampled] if op == "variable" else [age for _, age in sampled]
        if not args:
            return [_TRUTHS[value] if op == "truth" else value] * len(steps)
        if operation.window:
            return [self._window(k, operation, full, step) for step in steps]
        if op in ("rise", "fall", "edge", "latch", "hysteresis", "elapsed"):
            series: list[Value] = []
            for step in steps:
                now = [arg[step] for arg in args]
                if op == "hysteresis" and self._is_near(step, rough, now[:1], now[1:]):
                    self._doubt(step)
                is_first = self.begin[step] == step
                before = None if is_first else args[0][step - 1]
                state = None if is_first else series[-1]
                if op == "elapsed":
                    begun = now[0] is True and before is False
                    passed = 0.0 if begun else self._since_edge(args[0], step)
                    series.append(passed)
                else:
                    series.append(_moved(op, now, before, state, is_first=is_first))
            return series
        if op in COMPARISONS:
            for step in steps:
                if self._is_near(step, rough, args[0][step : step + 1], args[1][step : step + 1]):
                    self._doubt(step)
        elif operation.type == "number":
            self.rough[k] = set[int]().union(*rough)
        return [combined(op, now) for now in zip(*args, strict=True)]

    def _since_edge(self, series: list[Value], step: int) -> float | None:
        for k in range(step, self.begin[step], -1):
            if series[k] is None:
                return None
            if series[k] and series[k - 1] is False:
                return (self.times[step] - self.times[k]) / 1e9
        return None

    def _doubt(self, step: int) -> None:
        self.unsure = min(self.unsure, self.steps.index(step))

    def _is_near(
        self, step: int, rough: Sequence[set[int]], left: Sequence[Value], right: Sequence[Value]
    ) -> bool:
        is_rough = any(step in steps for steps in rough)
        return is_rough and any(
            None not in (a, b) and math.isclose(a, b, rel_tol=NEAR, abs_tol=1e-12)
            for a in left
            for b in right
        )

    def sampled(self, read: Read, ahead: int = 0) -> list[tuple[Value, float | None]]:
        """Return the values of what is read, each with its age in seconds."""
        name = read.name if read.reduction is None else read.reduction.inputs[0].name
        values: list[tuple[Value, float | None]] = []
        valid: int | None = None  # time of the last valid sample
        for step, (t, raw, stamps) in enumerate(self.samples):
            value = sample_of(read, raw, self.factors.get(read.name))
            stamp = stamps.get(name, t)
            valid = None if self.begin[step] == step else valid
            if read.stamped and stamp > t + self.program.period + ahead:
                value = None
            stamp = min(stamp, t)
            valid = valid if value is None else stamp
            if read.timeout is not None and t - stamp > read.timeout:
                value = None
            values.append((value, None if valid is None else (t - valid) / 1e9))
        return values

    def _window(self, k: int, operation: Operation, full: int, step: int) -> Value:
        t, op = self.times[step], operation.op
        first = bisect_right(self.times, t - operation.window, self.begin[step], step + 1)
        values = self.series[operation.args[0]][first : step + 1]
        is_full = self.since[step] <= t - operation.window + self.program.period - full
        if op in ("time", "once"):
            strong = op == "once"
            if strong in values:
                return strong
            return not strong if is_full and None not in values else None
        if op in ("average", "sum", "stddev", "rate"):
            values = [None if value in (math.inf, -math.inf) else value for value in values]
        known = [value for value in values if value is not None]
        share = 1.0 if operation.coverage is None else operation.coverage
        if not is_full or not known or len(known) / len(values) < share:
            return None
        if op == "rate":
            ends = [n for n, value in enumerate(values, first) if value is not None]
            seconds = (self.times[ends[-1]] - self.times[ends[0]]) / 1e9
            return finite((known[-1] - known[0]) / seconds) if seconds else None
        used = self.rough.get(operation.args[0], set())
        if not is_exact(op, known) or not used.isdisjoint(range(first, step + 1)):
            self.rough[k].add(step)
        return aggregated(op, known)


def _moved(op: str, now: list[Value], before: Value, state: Value, *, is_first: bool) -> Value:
    """Return the next value of an operation that remembers the step before."""
    if op == "latch":
        kept = combined("and", (not is_first and state, combined("not", now[1:])))
        return combined("or", (now[0], kept))
    if op == "hysteresis":
        x, low, high = now
        return None if None in now else True if x >= high else False if x <= low else state
    rise = combined("and", (now[0], combined("not", [before])))
    fall = combined("and", (combined("not", now), before))
    return {"rise": rise, "fall": fall, "edge": combined("or", (rise, fall))}[op]


def is_exact(op: str, known: Sequence[float]) -> bool:
    """Return whether rounding leaves no choice to who adds the numbers of a window up."""
    if op == "stddev":
        return len(set(known)) == 1
    return op not in ("average", "sum") or math.fsum([*known, -math.fsum(known)]) == 0.0


def aggregated(op: str, known: Sequence[Value]) -> Value:
    """Return one value for several that are known, without order."""
    if op == "count":
        return float(sum(value is True for value in known))
    if op in ("max", "min"):
        return max(known) if op == "max" else min(known)
    if op == "median":
        ordered = sorted(known)
        low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
        middle = low if low == high else low / 2 + high / 2
        return None if math.isnan(middle) else middle
    if not all(map(math.isfinite, known)):
        return None
    try:
        total = math.fsum(known)
        mean = total / len(known)
        squares = math.fsum((value - mean) * (value - mean) for value in known)
    except OverflowError:
        return None
    if op == "stddev":
        return None if len(known) < 2 else finite(math.sqrt(squares / (len(known) - 1)))
    return finite(total if op == "sum" else mean)


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
    if op == "not":
        return not args[0]
    if op == "xor":
        return args[0] is not args[1]
    if op in COMPARISONS:
        return COMPARISONS[op](*args)
    if op in ("least", "greatest"):
        return min(args) if op == "least" else max(args)
    if op == "abs":
        return abs(args[0])
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
    places = [k for k, part in enumerate(reduction.inputs) if part.is_list]
    lengths = {len(columns[k]) for k in places}
    number = lengths.pop()
    least, most = reduction.length or (0, number)
    if lengths or not least <= number <= most:
        return None
    inside: Sequence[int] | None = range(number)
    if reduction.sector is not None:
        inside = _in_sector(number, reduction.sector, [columns[k] for k in reduction.angles])
    if not inside:
        empty = {"list_sum": 0.0, "list_count": 0.0, "list_any": False}
        return empty.get(reduction.op) if reduction.messages and inside is not None else None

    def values(k: int, element: int) -> list[Value]:
        """Return the values of the nodes up to one, for an element."""
        row: list[Value] = []
        for node in reduction.nodes[: k + 1]:
            if node.op == "input":
                column = columns[node.value]
                row.append(column[element] if node.is_list else column)
            elif node.op == "constant":
                is_truth = isinstance(node.value, int) and not isinstance(node.value, bool)
                row.append(_TRUTHS[node.value] if is_truth else finite(node.value))
            else:
                row.append(combined(node.op, [row[arg] for arg in node.args]))
        return row

    for place, *ends in reduction.limits:
        low, high = (values(end, inside[0])[end] for end in ends)
        if low is None or high is None:
            return None
        columns[place] = [
            x if x is None or math.isinf(x) or low <= x <= high else None for x in columns[place]
        ]
    row = [values(reduction.value, k)[-1] for k in inside]
    op = reduction.op.removeprefix("list_")
    if op in ("any", "all") and (op == "any") in row:
        return op == "any"
    known = [value for value in row if value is not None]
    share = 1.0 if reduction.coverage is None else reduction.coverage
    if not known or len(known) / len(row) < share:
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
    low, high = sector[0] - half, sector[1] + half
    if abs(last - end) > 3 * half or sector[0] < min(start, last) - half:
        return None
    if sector[1] > max(start, last) + half:
        return None
    return [k for k in range(number) if low <= start + k * step <= high]
