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
from itertools import accumulate, islice
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.conditions.definition import Factor, History, Sample, Value

if TYPE_CHECKING:
    from eddi_scaffold.program.instructions import Operation, Program, Read
    from eddi_scaffold.program.lists import Reduction

_TRIES = 80  # for each fault
_MOST_WORK = 800_000  # values that are computed for one result
_MOST_STEPS = 600  # of a run
_MOST_OPERATIONS = 120  # of a result
_ERROR = 1e-11  # of sums that are rounded, above that of any way to add up
_ALIKE = (
    *(("lt", "le", "gt", "ge"), ("eq", "ne"), ("eq_bool", "ne_bool"), ("eq_enum", "ne_enum")),
    *(("and", "or", "xor", "implies"), ("add", "sub", "mul", "div"), ("least", "greatest")),
    *(("time", "once"), ("rise", "fall", "edge"), ("list_any", "list_all")),
    ("average", "sum", "max", "min", "median", "stddev", "rate"),
    tuple(f"list_{op}" for op in ("min", "max", "median", "sum", "average", "stddev")),
)
_ARITHMETIC = ("add", "sub", "mul", "div", "sum")
_STATEFUL = ("rise", "fall", "edge", "latch", "hysteresis", "elapsed")
_ENDS = (-math.inf, math.inf)
_ODD = (None, math.nan, *_ENDS, object(), True, "1")

See = Callable[[Sample], Sample]
Pools = tuple[Sequence[Any], Sequence[Any]]  # values that count, and others


class Run(NamedTuple):
    """What is given, and the result that must come out at each step."""

    shows: str  # the faults that it shows, each with the place of its operation
    steps: Sequence[Sample]
    results: Sequence[Value]


class _Fault(NamedTuple):
    name: str
    place: str  # of its operation in the text
    # it shows where any of these differs from the history
    histories: Sequence[Callable[[History, Sequence[Sample]], History]]
    deltas: Sequence[int]  # times that it needs
    values: Mapping[str, Sequence[Any]]  # values that it needs


class Drawing:
    """Draws the runs of one result of a program.

    Args:
        program: the checked conditions.
        number: of the result.
        factors: of values that come in another unit.
        see: what the conditions see of what is given.
        faulty: what they would see with a fault, by its name, and an age that shows it.
    """

    def __init__(
        self,
        program: Program,
        number: int,
        factors: Mapping[str, Factor] | None = None,
        see: See = lambda sample: sample,
        faulty: Mapping[str, tuple[See, int]] | None = None,
    ) -> None:
        self.program, self.factors = _part(program, number), factors or {}
        self.see, self.faulty = see, faulty or {}
        rows = self.program.operations
        rests: list[set[int]] = []  # of each operation, on what it rests
        for k, row in enumerate(rows[:_MOST_OPERATIONS]):
            rests.append({k}.union(*(rests[arg] for arg in row.args)))
        numbers = range(len(rests))
        self.above = [[n for n in numbers if k in rests[n] and k != n] for k in numbers]
        self.random = random.Random(program.results[number].id).random  # noqa: S311 - always alike
        self.complete, self.missed, self.work = False, "", 0
        self.known: dict[str, list[Mapping[str, Any]]] = {}  # result -> values that gave it
        used = sorted({row.value for row in rows if row.op in ("variable", "age")})
        self.reads = [program.reads[k] for k in used]
        self.pools = dict(self._pools())
        self.pools |= {
            name: self._in_unit(name, *self.pools[name])
            for name in self.factors.keys() & self.pools
        }
        self.period = period = program.period or 10**8
        self.jumps = (5 * period // 2, 5 * period // 2 + 1)
        lengths = sorted({row.window for row in rows if row.window})
        self.deltas = [period, *self.jumps, *lengths, *(n - period for n in lengths if n > period)]
        most = max([0, *lengths]) * 3 // _MOST_STEPS
        self.fillers = [n for n in (period, 2 * period) if n > most] + [self.jumps[0]]
        timed = [row.value for row in rows if row.op == "number" and row.value is not None]
        timed = timed if {"age", "elapsed"} & {row.op for row in rows} else []
        limits = {round(x * 1e9) for x in timed if 0 < x < 1e4}
        self.deltas += sorted(limits)
        limits.update(read.timeout for read in self.reads if read.timeout is not None)
        limits.update(age for _, age in self.faulty.values())
        late = [limit + n for limit in sorted(limits) for n in (0, 1)]
        self.ages = [0, -1, -period, -period - 1, *late]
        self.aged = [
            read.name if read.reduction is None else read.reduction.inputs[0].name
            for read in self.reads
            if read.stamped
        ]

    def runs(self) -> Iterator[Run]:
        """Yield runs until each fault shows, or is one of those ``missed``.

        Afterwards, ``complete`` says whether something shows of every operation.
        """
        is_long = 2 * max(self.deltas) > _MOST_STEPS * self.jumps[0]
        is_small = len(self.program.operations) <= _MOST_OPERATIONS and not is_long
        left, missed = [*self._faults()] if is_small else [], list[_Fault]()
        hidden = {fault.place for fault in left}
        while left:
            for _ in range(_TRIES if self.work < _MOST_WORK else 0):
                given = self._drawn(left[0])
                history = self._history(given)
                rows = history.results()
                if self._shown(left[0], history, given, rows) is None:
                    continue
                rows = rows[: self.certain(given)]
                ends = [self._shown(fault, history, given, rows) for fault in left]
                if ends[0] is None:
                    continue
                pairs = [*zip(left, ends, strict=True)]
                shown = [fault for fault, end in pairs if end is not None]
                last = max(end for end in ends if end is not None) + 1
                results = [value for (value,) in rows[:last]]
                for sample, value in zip(given, results, strict=False):
                    self.known.setdefault(str(value), []).append(sample.values)
                yield Run(_listed(shown), given[:last], results)
                hidden -= {fault.place for fault in shown}
                left = [fault for fault, end in pairs if end is None]
                break
            else:
                missed.append(left.pop(0))
        self.complete = is_small and self.work < _MOST_WORK and not hidden
        self.missed = _listed(missed)

    def _history(self, given: Iterable[Sample], see: See | None = None, **more: Any) -> History:
        history = History(self.program, map(see or self.see, given), self.factors, **more)
        self.work += len(history.steps) * len(self.program.operations)
        return history

    def certain(self, given: Sequence[Sample]) -> int:
        """Return at how many steps the result is the same however sums are rounded."""
        rows = self.program.operations
        if not any(row.op in ("average", "sum", "stddev") for row in rows):
            return len(given)
        pairs = zip(
            *(self._history(given, error=n).results() for n in (-_ERROR, _ERROR)), strict=True
        )
        differ = (k for k, ((low,), (high,)) in enumerate(pairs) if not _equal(low, high))
        return next(differ, len(given))

    def _shown(
        self, fault: _Fault, history: History, given: Sequence[Sample], rows: Sequence[Any]
    ) -> int | None:
        """Return the first step at which a fault shows in the result."""
        for faulty in fault.histories:
            pairs = zip(rows, faulty(history, given).results(), strict=False)
            for k, ((value,), (other,)) in enumerate(pairs):
                if not _equal(value, other):
                    return k
        return None

    # what is drawn

    def _pick(self, items: Sequence[Any]) -> Any:
        return items[int(self.random() * len(items))]

    def _drawn(self, fault: _Fault) -> list[Sample]:
        filler, odd, t = self._pick(self.fillers), self._pick((0.0, 0.0, 0.1, 0.5)), 10**9
        values: Mapping[str, Any]
        values = {name: self._pick(pool[0]) for name, pool in self.pools.items()}
        if self.known and self.random() < 0.7:
            values = self._pick(self._pick([*self.known.values()]))
        ages, names = dict.fromkeys(self.aged, 0), [*self.pools]
        steps = [Sample(t, values, ages)]
        for _ in range(2 + int(self.random() * 6)):
            is_needed = fault.deltas and self.random() < 0.6
            delta = self._pick(fault.deltas if is_needed else self.deltas)
            while delta > filler and delta not in self.jumps and len(steps) < _MOST_STEPS:
                t, delta = t + filler, delta - filler
                steps.append(Sample(t, values, ages))
            t, before = t + delta, (values, ages)
            for name in names if not names or self.random() < 0.3 else [self._pick(names)]:
                pool = self.pools[name][self.random() < odd]
                pool = fault.values.get(name, pool) if self.random() < 0.4 else pool
                values = {**values, name: self._pick(pool)}
            is_aged = fault.name in ("ahead", "timeout", *self.faulty)
            if self.aged and self.random() < (0.5 if is_aged else 2 * odd):
                ages = ages | {self._pick(self.aged): self._pick(self.ages)}
            if delta or None not in values.values():  # where a clock stands, silence shows
                steps.append(Sample(t, values, ages))
            values, ages = before if self.random() < 0.5 else (values, ages)
        return steps

    def _in_unit(self, name: str, *pools: Iterable[Any]) -> Any:
        """Return values in the unit in which they come."""
        num, den = self.factors.get(name, (1, 1))
        return [
            [
                float(Fraction(x) * den / num) if type(x) is float and math.isfinite(x) else x
                for x in pool
            ]
            for pool in pools
        ]

    def _pools(self) -> Iterator[tuple[str, Pools]]:
        lists = [read.reduction for read in self.reads if read.reduction is not None]
        numbers = [row.value for row in self.program.operations if row.op == "number"]
        numbers += [node.value for of in lists for node in of.nodes if node.op == "constant"]
        for of in (*self.reads, *(part for reduction in lists for part in reduction.inputs)):
            numbers += of.range or ()
        exact = {0.0, *(float(x) for x in numbers if x is not None and math.isfinite(x))}
        if len(exact) < 8 and any(row.op in _ARITHMETIC for row in self.program.operations):
            exact |= {a + sign * b for a in exact for b in exact for sign in (-1, 1)}
        plain = [x + more for x in sorted(exact) for more in (0.0, -1.0, 1.0)]
        near = [math.nextafter(x, to) for x in sorted(exact) for to in _ENDS]
        whole = sorted({int(x) for x in exact if abs(x) < 2**31})
        pools: dict[str, Pools] = {
            "number": (plain, [*near, *_ODD, *whole]),
            "bool": ([True, False], [None, 1, 0, "True", *_ODD[1:5]]),
            "text": ([*map(repr, plain)], ["", "x", "1_0", "inf", 1.0, *_ODD[:5]]),
        }
        for read in self.reads:
            if read.reduction is not None:
                yield from _list_pools(read.reduction, pools)
            elif read.type == "enum":
                wrong = ["", "-", *map(str.swapcase, read.literals), *_ODD]
                yield read.name, (read.literals, [x for x in wrong if x not in read.literals])
            else:
                yield read.name, pools["text" if read.text else read.type]

    # faults

    def _faults(self) -> Iterator[_Fault]:
        """Yield what can be wrong with each operation, and with the run of time."""
        rows, period = self.program.operations, self.period
        for k, row in enumerate(rows):
            ends = [row.window + n - m for n in (-1, 0, 1) for m in (0, period) if row.window]
            reads = [self.program.reads[row.value]] if row.op == "variable" else self.reads
            names = [read.name for read in reads if read.type == "number" or row.op == "variable"]
            for name, values, *changes in self._changed(row):
                histories = [
                    lambda of, _, k=k, change=change: self._replaced(of, k, change)
                    for change in changes
                ]
                needed = {of: self._in_unit(of, values)[0] for of in names if values}
                yield _Fault(name, row.about, histories, [n for n in ends if n > 0], needed)

        def of_time(name: str, deltas: Sequence[int], history: Any) -> _Fault:
            return _Fault(name, rows[-1].about, [history], deltas, {})

        for n in (-1, 1) if any(row.window for row in rows) else ():
            yield of_time("gap", self.jumps, lambda _, of, n=n: self._history(of, gap=n))
        if any(row.window or row.op in _STATEFUL for row in rows):
            back = [-1, -1, *self.deltas]  # as little as can be: whatever is kept is still inside
            yield of_time("back", back, lambda _, of: self._history(_onward(of, period)))
        yield of_time("same time", [0, period], lambda _, of: self._history(_onward(of, 0)))
        for name, (see, _) in self.faulty.items():
            yield of_time(name, (), lambda _, of, see=see: self._history(of, see))

    def _replaced(self, history: History, k: int, change: Any) -> History:
        self.work += len(history.times) * len(self.above[k])
        return history.replaced(k, change(history), self.above[k])

    def _changed(self, row: Operation) -> Iterator[tuple[Any, ...]]:
        """Yield faults of an operation: name, values that it needs, what gives its series."""
        op, value, k = row.op, row.value, self.program.operations.index(row)

        def as_(shift: int = 0, **changes: Any) -> Any:
            return lambda history: history.value(row._replace(**changes), shift)

        if op == "number" and value is not None:
            for to, times in zip(_ENDS, (0.99, 1.01), strict=True):
                near, far = math.nextafter(value, to), value * times or math.copysign(0.1, to)
                yield "limit", (value, near), as_(value=near), as_(value=far)
        if op in ("number", "truth", "literal"):
            return
        for n in (2, 1, 0) if row.type == "bool" else ():
            yield "decides", (), as_(op="truth", args=(), value=n, window=0)
        yield "unknown", (), as_(op="number", args=(), value=None, window=0)
        yield from (("operator", (), as_(op=other)) for other in _others(op))
        if op in ("sub", "div", "implies", "latch"):
            yield "order", (), as_(args=row.args[::-1])
        for n in (-1, 1) if row.window else ():
            yield "window", (), as_(window=row.window + n)
            yield "full", (), as_(n)
            if row.coverage is not None:
                shares = [row.coverage + n * share for share in (0.01, 0.1, 0.3)]
                yield ("coverage", (), *[as_(coverage=share) for share in shares])
        if row.window and row.coverage is None:
            yield "unknown inside", (), as_(coverage=1e-9)
        if op == "latch":
            s, r = row.args
            yield (
                "both",
                (),
                lambda of: [
                    q and not (of.series[s][step] and of.series[r][step])
                    for step, q in enumerate(of.series[k])
                ],
            )
        if op in ("hysteresis", "elapsed"):
            yield (
                "unknown",
                (),
                lambda of: [
                    *accumulate(of.series[k], lambda before, now: before if now is None else now)
                ],
            )
        if op == "variable":
            yield from self._of_read(row, k, self.program.reads[value])

    def _of_read(self, row: Operation, k: int, read: Read) -> Iterator[tuple[Any, ...]]:
        def as_(shift: int = 0, **changes: Any) -> Any:
            other = row._replace(value=read._replace(**changes))
            return lambda history: history.value(other, shift)

        low, high = read.range or (0.0, 0.0)
        for to in _ENDS if read.range is not None else ():
            for ends in ((math.nextafter(low, to), high), (low, math.nextafter(high, to))):
                yield "range", (low, high, *ends), as_(range=ends)
        if read.stamped and read.reduction is None:
            yield (
                "ahead",
                (),
                lambda of: [
                    None if sample.ages.get(read.name) == -1 else value
                    for value, sample in zip(of.series[k], of.samples, strict=True)
                ],
            )
        for n in (-1, 1) if read.stamped else ():
            yield "ahead", (), as_(n)
            if read.timeout is not None:
                yield "timeout", (), as_(timeout=read.timeout + n)
        if read.type == "number":
            yield "infinity", _ENDS, as_(infinite=not read.infinite)
        if read.reduction is not None:
            yield from (("list", (), as_(reduction=of)) for of in _other_reductions(read.reduction))
            return
        for raw in self.pools[read.name][1]:
            if type(raw) is not float or not math.isfinite(raw):
                yield "type", (raw,), lambda of, raw=raw: _misread(of, k, read.name, raw)


def _list_pools(reduction: Reduction, pools: Mapping[str, Pools]) -> Iterator[tuple[str, Pools]]:
    low, high = reduction.sector or (0.0, 1.0)
    half = (high - low) / 2
    angles = dict(zip(reduction.angles, (low - half, high + half, half), strict=False))
    least, most = reduction.length or (1, 3)
    lengths = [5] if angles else sorted({max(least - 1, 0), least, 2, min(most, 50), most + 1})
    for k, part in enumerate(reduction.inputs):
        plain, odd = pools[part.type]
        if k in angles:
            yield part.name, ([angles[k]] * 9 + [2 * angles[k] + 1], [None])
        elif not part.is_list:
            yield part.name, (plain, odd)
        else:  # a truth in a list may be a number, too
            near = [x for x in odd if type(x) is float and math.isfinite(x)]
            mixed = [*plain, None, *plain, *(() if part.type == "bool" else odd)]
            lists = [
                [
                    [of[(n + m * step) % len(of)] for m in range(length)]
                    for length in lengths
                    for step in (0, 1, 2)
                    for n in range(len(of))
                    if length <= 51
                ]
                for of in ([*plain, *near], mixed)
            ]
            if reduction.coverage is not None and not angles:
                lists[0] += [[x] * n + [None] * (10 - n) for x in plain for n in range(11)]
            yield part.name, (lists[0], [None, "1", [], *lists[1]])


def _other_reductions(reduction: Reduction) -> Iterator[Reduction]:
    yield from (replace(reduction, op=op) for op in _others(reduction.op))
    if reduction.coverage is not None:
        yield from (replace(reduction, coverage=reduction.coverage + n) for n in (-0.1, 0.1))
    for k, node in enumerate(reduction.nodes):
        others = [replace(node, op=op) for op in _others(node.op)]
        if type(node.value) is float and node.op == "constant":
            others += [replace(node, value=math.nextafter(node.value, to)) for to in _ENDS]
        for other in others:
            nodes = (*reduction.nodes[:k], other, *reduction.nodes[k + 1 :])
            yield replace(reduction, nodes=nodes)


def in_turn(drawings: Iterable[Drawing]) -> Iterator[tuple[int, Run]]:
    """Yield the runs of each in turn, with its number: the first of each show most."""
    waiting = [(number, drawing.runs()) for number, drawing in enumerate(drawings)]
    while waiting:
        number, runs = waiting.pop(0)
        for run in islice(runs, 1):
            yield number, run
            waiting.append((number, runs))


def _listed(faults: Iterable[_Fault]) -> str:
    """Return faults in words, by the place of their operation."""
    places: dict[str, dict[str, None]] = {}
    for fault in faults:
        places.setdefault(fault.place, {})[fault.name] = None
    return "; ".join(f"{', '.join(names)} of {place}" for place, names in places.items())


def _part(program: Program, number: int) -> Program:
    """Return the program of one result."""
    result = program.results[number]
    below = {result.operation}
    for k in range(result.operation, -1, -1):
        below.update(program.operations[k].args if k in below else ())
    new = {old: k for k, old in enumerate(sorted(below))}
    rows = (program.operations[old] for old in new)
    operations = tuple(row._replace(args=tuple(new[arg] for arg in row.args)) for row in rows)
    return program._replace(
        operations=operations, results=(result._replace(operation=len(new) - 1),)
    )


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
