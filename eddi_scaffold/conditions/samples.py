"""Runs of samples that tell a condition from those that it could be mistaken for.

For every operation there are faults: another operator, a limit that is one double or nanosecond
off, a value that never changes, a state that is not forgotten. Runs are drawn until each fault
shows in the result; what must come out is by definition.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import accumulate, zip_longest
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.conditions.definition import STATEFUL, Factor, History, Sample, Value

if TYPE_CHECKING:
    from eddi_scaffold.program.instructions import Operation, Program

_TRIES = 120  # without a fault that shows
_MOST_WORK = 2_000_000  # values that are looked at, for all results of a program
_MOST_STEPS = 300  # of a run
_ERROR = 1e-11  # of sums that are rounded, above that of any way to add up
_ALIKE = (
    *(("lt", "le", "gt", "ge"), ("eq", "ne"), ("eq_bool", "ne_bool"), ("eq_enum", "ne_enum")),
    *(("and", "or", "xor", "implies"), ("add", "sub", "mul", "div"), ("least", "greatest")),
    *(("time", "once"), ("rise", "fall", "edge"), ("list_any", "list_all")),
    ("average", "sum", "max", "min", "median", "stddev", "rate"),
    tuple(f"list_{op}" for op in ("min", "max", "median", "sum", "average", "stddev")),
)
_ENDS = (-math.inf, math.inf)
_ODD = (None, math.nan, *_ENDS, object(), True, "1")

Series = Callable[[History], list[Value]]
Fault = tuple[str, Callable[[History], History]]  # what is wrong and where, what happens then


class Run(NamedTuple):
    """What is given, and the result that must come out at each step."""

    shows: str  # the faults that it shows, each with the place of its operation
    steps: Sequence[Sample]
    results: Sequence[Value]


class Drawing:
    """Draws the runs of one result of a program.

    ``factors``: of values that come in another unit; ``see``: what is seen of what is given.
    """

    def __init__(
        self,
        program: Program,
        number: int,
        factors: Mapping[str, Factor] | None = None,
        see: Callable[[Sample], Sample] = lambda sample: sample,
    ) -> None:
        self.program, self.factors, self.see = _part(program, number), factors or {}, see
        self.random = random.Random(program.results[number].id).random  # noqa: S311 - always alike
        self.missed = False  # whether a fault is left that no run shows
        self.work = _MOST_WORK // len(program.results)  # that is left
        self.known: dict[str, list[Mapping[str, Any]]] = {}  # result -> values that gave it
        rows = self.program.operations
        used = sorted({row.value for row in rows if row.op in ("variable", "age")})
        self.reads = [program.reads[k] for k in used]
        self.pools = dict(self._pools())  # name -> values that count, and others
        firsts = (of.reduction.inputs[0] if of.reduction else of for of in self.reads if of.stamped)
        self.aged = [of.name for of in firsts]
        period, limits = program.period or 10**8, list[int]()
        self.gaps = (5 * period // 2, 5 * period // 2 + 1)
        lengths = sorted({row.window for row in rows if row.window})
        if any(row.op in ("age", "elapsed") for row in rows):
            numbers = [row.value for row in rows if row.op == "number" and row.value]
            limits = [round(x * 1e9) for x in numbers if 0 < x < 1e4]
        ends = [n + m - k for n in lengths for m in (-1, 0, 1) for k in (0, period) if n > k]
        self.cost = len(rows) + sum(lengths) // (16 * period)  # of a step
        self.deltas = [-1, 0, period, *self.gaps, *lengths, *ends, *limits]
        limits += [of.timeout for of in self.reads if of.timeout is not None]
        self.ages = [0, -1, -period, -period - 1, *(n + m for n in limits for m in (0, 1))]
        most = 3 * max([0, *lengths]) // _MOST_STEPS
        self.fillers = [n for n in (period, 2 * period) if n > most] + [self.gaps[0]]

    def runs(self) -> Iterator[Run]:
        """Yield runs until each fault shows."""
        left, tries = [*self._faults()], 0
        is_long = 2 * max(self.deltas) > _MOST_STEPS * self.gaps[0]
        while left and not is_long and tries < _TRIES and self.work > 0:
            given, tries = self._drawn(), tries + 1
            history = self.history(given)
            ends = [self._shown(history, fault(history)) for _, fault in left]
            end = self.certain(history) if min(ends) < len(given) else 0
            if shown := [k for k in ends if k < end]:
                end, tries = 1 + max(shown), 0
                results = [value for (value,) in history.results()[:end]]
                for sample, value in zip(given, results, strict=False):
                    self.known.setdefault(str(value), []).append(sample.values)
                names = [name for (name, _), k in zip(left, ends, strict=True) if k < end]
                yield Run("; ".join(dict.fromkeys(names)), given[:end], results)
                left = [fault for fault, k in zip(left, ends, strict=True) if k >= end]
        self.missed = bool(left)

    def history(self, given: Iterable[Sample]) -> History:
        """Return what happens with samples."""
        return History(self.program, map(self.see, given), self.factors)

    def certain(self, history: History) -> int:
        """Return at how many steps the result is the same however sums are rounded."""
        return min(self._shown(history, history.again(error=n)) for n in (-_ERROR, _ERROR))

    def _shown(self, history: History, other: History) -> int:
        """Return before which step all results are equal."""
        self.work -= len(history.given) * self.cost
        pairs = enumerate(zip(history.results(), other.results(), strict=True))
        return next((k for k, ((a,), (b,)) in pairs if not _equal(a, b)), len(history.given))

    def _pick(self, items: Sequence[Any]) -> Any:
        return items[int(self.random() * len(items))]

    def _raw(self, name: str, is_odd: bool) -> Any:
        """Return a value in the unit in which it comes."""
        value, (num, den) = self._pick(self.pools[name][is_odd]), self.factors.get(name, (1, 1))
        is_number = type(value) is float and math.isfinite(value)
        return float(Fraction(value) * den / num) if is_number and num != den else value

    def _drawn(self) -> list[Sample]:
        """Return a few changes of values and ages, and between them steps without one."""
        filler, odd, t = self._pick(self.fillers), self._pick((0.0, 0.1, 0.3, 0.5)), 10**9
        values, names = {name: self._raw(name, is_odd=False) for name in self.pools}, [*self.pools]
        if self.known and self.random() < 0.7:
            values = {**self._pick(self._pick([*self.known.values()]))}
        ages = dict.fromkeys(self.aged, 0)
        steps = [Sample(t, values, ages)]
        for _ in range(2 + int(self.random() * 6)):
            delta = self._pick(self.deltas)
            while delta > filler and delta not in self.gaps and len(steps) < _MOST_STEPS:
                t, delta = t + filler, delta - filler
                steps.append(Sample(t, values, ages))
            t, before = t + delta, (values, ages)
            for name in names if not names or self.random() < 0.3 else [self._pick(names)]:
                values = {**values, name: self._raw(name, self.random() < odd)}
            if self.aged and self.random() < 2 * odd:
                ages = ages | {self._pick(self.aged): self._pick(self.ages)}
            if delta or None not in values.values():  # where a clock stands, silence shows
                steps.append(Sample(t, values, ages))
            values, ages = before if self.random() < 0.5 else (values, ages)
        return steps

    def _pools(self) -> Iterator[tuple[str, tuple[Sequence[Any], Sequence[Any]]]]:
        numbers = [row.value for row in self.program.operations if row.op == "number"]
        numbers += [end for read in self.reads for end in read.range or ()]
        lists = [node for read in self.reads if read.reduction for node in read.reduction.nodes]
        numbers += [node.value for node in lists if node.op == "constant"]
        exact = {0.0, *(x for x in numbers if x is not None and math.isfinite(x))}
        if len(exact) < 8 and any(row.op in _ALIKE[5] for row in self.program.operations):
            exact |= {a + sign * b for a in exact for b in exact for sign in (-1, 1)}
        plain = [x + more for x in sorted(exact) for more in (0.0, 0.0, -1.0, 1.0)]
        plain += [math.nextafter(x, to) for x in sorted(exact) for to in _ENDS]
        whole = sorted({int(x) for x in exact if abs(x) < 2**31})
        pools: dict[str, tuple[Sequence[Any], Sequence[Any]]] = {
            "number": (plain, [*_ODD, *whole]),
            "bool": ([True, False], [None, 1, 0, "True", *_ODD[1:5]]),
            "text": ([*map(repr, plain)], ["", "x", "1_0", "inf", 1.0, *_ODD[:5]]),
        }
        for read in self.reads:
            if read.reduction is not None:
                for part in read.reduction.inputs:
                    some, odd = pools[part.type]
                    lists = [[x, y, x] for x in some for y in some[:9]]
                    yield part.name, (lists, [None, []]) if part.is_list else (some, odd)
            elif read.type == "enum":
                wrong = ["", "-", *map(str.swapcase, read.literals), *_ODD]
                yield read.name, (read.literals, [x for x in wrong if x not in read.literals])
            else:
                yield read.name, pools["text" if read.text else read.type]

    def _faults(self) -> Iterator[Fault]:
        """Yield what can be wrong with each operation, and with the run of time."""
        rows, about = self.program.operations, self.program.operations[-1].about
        for k, row in enumerate(rows):
            for name, series in self._changed(k, row):
                yield f"{name} of {row.about}", partial(History.replaced, k=k, series=series)
        for n in (-1, 1) if any(row.window for row in rows) else ():
            yield f"gap of {about}", partial(History.again, gap=n)
        if any(row.window or row.op in STATEFUL for row in rows):
            yield f"back of {about}", lambda of: of.again(_onward(of.given, 10**8))
        yield f"same time of {about}", lambda of: of.again(_onward(of.given, 0))

    def _changed(self, k: int, row: Operation) -> Iterator[tuple[str, Series]]:
        """Yield faults of an operation: name and series."""
        op, value = row.op, row.value

        def other(shift: int = 0, **changes: Any) -> Series:
            return lambda of: of.value(row._replace(**changes), shift)

        if op == "number" and value is not None:
            for to, times in zip(_ENDS, (0.99, 1.01), strict=True):
                near = math.nextafter(value, to)
                yield "limit", other(value=near)
                yield "limit by far", other(value=value * times or math.copysign(0.1, to))
        if op in ("number", "truth", "literal"):
            return
        for n in (2, 1, 0) if row.type == "bool" else ():
            yield "decides", other(op="truth", args=(), value=n, window=0)
        if row.type != "bool":
            yield "unknown", other(op="number", args=(), value=None, window=0)
        yield from (("operator", other(op=name)) for name in _others(op))
        if op in ("sub", "div", "implies", "latch"):
            yield "order", other(args=row.args[::-1])
        for n in (-1, 1) if row.window else ():
            yield "window", other(window=row.window + n)
            yield "full", other(n)
            share = 1e-9 if row.coverage is None else row.coverage + 0.1 * n
            yield "coverage", other(coverage=share)
        if op == "latch":
            both = (k, *row.args)
            yield "both", lambda of: [q and not (s and r) for q, s, r in of.columns(*both)]
        if op in ("hysteresis", "elapsed"):
            kept = partial(accumulate, func=lambda before, now: before if now is None else now)
            yield "unknown", lambda of: [*kept(of.series[k])]
        if op != "variable":
            return
        read = self.program.reads[value]
        low, high = read.range or (0.0, 0.0)
        for to in _ENDS if read.range is not None else ():
            yield "range", other(value=read._replace(range=(math.nextafter(low, to), high)))
            yield "range", other(value=read._replace(range=(low, math.nextafter(high, to))))
        for n in (-self.program.period, -1, 1) if read.stamped else ():
            yield "ahead", other(n)
        for n in (-1, 1) if read.timeout is not None else ():
            yield "timeout", other(value=read._replace(timeout=read.timeout + n))
        if read.type == "number":
            yield "infinity", other(value=read._replace(infinite=not read.infinite))
        if read.reduction is not None:
            for name in _others(read.reduction.op):
                reduction = replace(read.reduction, op=name)
                yield "list", other(value=read._replace(reduction=reduction))
            return
        for raw in self.pools[read.name][1]:
            if type(raw) is not float or not math.isfinite(raw):
                yield "type", partial(_misread, k=k, name=read.name, raw=raw)


def in_turn(drawings: Iterable[Drawing]) -> Iterator[tuple[int, Run]]:
    """Yield the runs of each in turn, with its number: the first of each show most."""
    for runs in zip_longest(*(drawing.runs() for drawing in drawings)):
        yield from ((number, run) for number, run in enumerate(runs) if run is not None)


def _part(program: Program, number: int) -> Program:
    result = program.results[number]
    needed = [result.operation]
    for k in needed:
        needed += {*program.operations[k].args}.difference(needed)
    new = {old: k for k, old in enumerate(sorted(needed))}
    rows = [program.operations[old] for old in new]
    operations = (row._replace(args=tuple(map(new.__getitem__, row.args))) for row in rows)
    results = (result._replace(operation=len(new) - 1),)
    return program._replace(operations=tuple(operations), results=results)


def _others(op: str) -> Iterator[str]:
    yield from (other for ops in _ALIKE if op in ops for other in ops if other != op)


def _equal(value: Value, other: Value) -> bool:
    if None in (value, other) or isinstance(value, bool):
        return value is other
    return math.isclose(value, other, rel_tol=1e-8)


def _misread(history: History, k: int, name: str, raw: Any) -> list[Value]:
    """Return a series where a wrong value is as before, and a right one of its type unknown."""
    series: list[Value] = []
    for value, sample in zip(history.series[k], history.samples, strict=True):
        before = series[-1] if series and value is None else None
        series.append(before if sample.values.get(name) is raw else value)
    return series


def _onward(given: Iterable[Sample], back: int) -> Iterator[Sample]:
    """Yield a run whose clock goes on where it goes back, or (0) where it stands."""
    shift, last = 0, None
    for sample in given:
        if last is not None and (sample.t < last if back else sample.t == last):
            shift += last - sample.t + (back or 1)
        last = sample.t
        yield sample._replace(t=sample.t + shift)
