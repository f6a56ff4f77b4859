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
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.conditions.definition import NEAR, Factor, History, Sample, Value

if TYPE_CHECKING:
    from eddi_scaffold.program.instructions import Operation, Program, Read
    from eddi_scaffold.program.lists import Reduction

OBJECT = object()
"""A value of a type that no input has."""
_TRIES = 120  # for each fault
_MOST_WORK = 300_000  # values that are computed for one result
_MOST_STEPS = 600  # of a run
_ALIKE = (
    *(("lt", "le", "gt", "ge"), ("eq", "ne"), ("eq_bool", "ne_bool"), ("eq_enum", "ne_enum")),
    *(("and", "or", "xor", "implies"), ("add", "sub", "mul", "div"), ("least", "greatest")),
    *(("time", "once"), ("rise", "fall", "edge"), ("list_any", "list_all")),
    ("average", "sum", "max", "min", "median", "stddev", "rate"),
    tuple(f"list_{op}" for op in ("min", "max", "median", "sum", "average", "stddev")),
)
_ORDERED = ("sub", "div", "implies", "latch")
_REMEMBER = ("rise", "fall", "edge", "latch", "hysteresis", "elapsed")


class Given(NamedTuple):
    """What is given at a step: time, values by name, and ages in nanoseconds by name."""

    t: int
    raws: Mapping[str, Any]
    ages: Mapping[str, int]


See = Callable[[Given], Sample]
Series = Callable[[History], list[Value]]
Pools = tuple[list[Any], list[Any]]  # values that count, and others


def _seen(given: Given) -> Sample:
    return Sample(given.t, given.raws, {name: given.t - age for name, age in given.ages.items()})


class Run(NamedTuple):
    """What is given, and the result that must come out at each step."""

    shows: str  # the faults that it shows, each with the place of its operation
    steps: Sequence[Given]
    results: Sequence[Value]


class _Fault(NamedTuple):
    name: str
    place: str  # of its operation in the text
    # it shows where any of these differs from the history
    histories: Sequence[Callable[[History, Sequence[Given]], History]]
    deltas: Sequence[int] = ()  # times that it needs
    raws: Mapping[str, Sequence[Any]] = MappingProxyType({})  # values that it needs, by name


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
        see: See | None = None,
        faulty: Mapping[str, tuple[See, int]] | None = None,
    ) -> None:
        self.program, self.factors = _part(program, number), factors or {}
        self.see, self.faulty = see or _seen, faulty or {}
        operations = self.program.operations
        below = [_below(self.program, k) for k in range(len(operations))]
        self.above = [
            [k for k, rows in enumerate(below) if row in rows and k != row]
            for row in range(len(operations))
        ]
        self.complete, self.missed = False, ""
        self.random = random.Random(program.results[number].id).random  # noqa: S311 - always the same
        self.work = 0
        used = {row.value for row in operations if row.op in ("variable", "age")}
        self.reads = [program.reads[k] for k in sorted(used)]
        self.pools = {name: self._in_unit(name, *pools) for name, pools in self._pools()}
        self.period = period = program.period or 10**8
        gap = 5 * period // 2
        self.jumps = (gap, gap + 1)
        lengths = sorted({row.window for row in operations if row.window})
        self.deltas = [period, *self.jumps, *lengths, *(n - period for n in lengths if n > period)]
        fillers = (period, 2 * period, gap)
        self.fillers = [n for n in fillers if max([0, *lengths]) * 3 < n * _MOST_STEPS] or [gap]
        limits = {read.timeout for read in self.reads if read.timeout is not None}
        limits.update(age for _, age in self.faulty.values())
        late = [age for limit in sorted(limits) for age in (limit, limit + 1)]
        self.ages = [0, -1, -period, -period - 1, *late]
        self.aged = [_source(read) for read in self.reads if read.stamped or self.faulty]

    def runs(self) -> Iterator[Run]:
        """Yield runs until each fault shows, or is one of those ``missed``.

        Afterwards, ``complete`` says whether something shows of every operation.
        """
        left = [*self._faults()]
        hidden, missed = {fault.place for fault in left}, list[_Fault]()
        while left:
            fault, *left = left
            for _ in range(_TRIES if self.work < _MOST_WORK else 0):
                given = self._drawn(fault)
                history = self._history(given, self.see)
                end = self._shown(fault, history, given)
                if end is None:
                    continue
                ends = [end, *(self._shown(other, history, given) for other in left)]
                pairs = zip([fault, *left], ends, strict=True)
                shown = [other for other, end in pairs if end is not None]
                hidden -= {other.place for other in shown}
                last = max(end for end in ends if end is not None) + 1
                results = [row[0] for row in history.results()[:last]]
                yield Run(_listed(shown), given[:last], results)
                left = [other for other, end in zip(left, ends[1:], strict=True) if end is None]
                break
            else:
                missed.append(fault)
        self.missed = _listed(missed)
        self.complete = self.work < _MOST_WORK and not hidden

    def _history(self, given: Iterable[Given], see: See, gap: int = 0) -> History:
        history = History(self.program, [*map(see, given)], self.factors, gap)
        self.work += len(history.steps) * len(self.program.operations)
        return history

    def _shown(self, fault: _Fault, history: History, given: Sequence[Given]) -> int | None:
        """Return the first step at which a fault shows in the result."""
        rows = history.results()[: history.unsure]
        for faulty in fault.histories:
            others = faulty(history, given).results()
            for k, ((value,), (other,)) in enumerate(zip(rows, others, strict=False)):
                if not _equal(value, other):
                    return k
        return None

    # what is drawn

    def _pick(self, items: Sequence[Any]) -> Any:
        return items[int(self.random() * len(items))]

    def _drawn(self, fault: _Fault) -> list[Given]:
        filler, odd, t = self._pick(self.fillers), self._pick((0.0, 0.0, 0.1, 0.5)), 0
        raws = {name: self._pick(pool[0]) for name, pool in self.pools.items()}
        ages, deltas = dict.fromkeys(self.aged, 0), fault.deltas
        steps = [Given(0, raws, ages)]
        for _ in range(2 + int(self.random() * 6)):
            delta = self._pick(deltas if deltas and self.random() < 0.6 else self.deltas)
            while delta > filler and delta not in self.jumps and len(steps) < _MOST_STEPS:
                t, delta = t + filler, delta - filler
                steps.append(Given(t, raws, ages))
            t, before = t + delta, (raws, ages)
            names = [*self.pools]
            names = names if not names or self.random() < 0.3 else [self._pick(names)]
            raws = raws | {
                name: self._pick(self.pools[name][self.random() < odd]) for name in names
            }
            for name, values in fault.raws.items() if self.random() < 0.4 else ():
                raws = raws | {name: self._pick(values)}
            if self.aged and self.random() < 2 * odd + 0.1:
                ages = ages | {self._pick(self.aged): self._pick(self.ages)}
            if delta or None not in raws.values():  # where a clock stands, silence shows
                steps.append(Given(t, raws, ages))
            raws, ages = before if self.random() < 0.5 else (raws, ages)
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
        constants = [row.value for row in self.program.operations if row.op == "number"]
        constants += [node.value for of in lists for node in of.nodes if node.op == "constant"]
        for of in (*self.reads, *(part for reduction in lists for part in reduction.inputs)):
            constants += of.range or ()
        exact = {0.0, *(float(x) for x in constants if x is not None and math.isfinite(x))}
        if len(exact) < 8:
            exact |= {a + sign * b for a in exact for b in exact for sign in (-1, 1)}
        plain = [x + more for x in sorted(exact) for more in (0.0, -1.0, 1.0)]
        near = [math.nextafter(x, to) for x in sorted(exact) for to in (-math.inf, math.inf)]
        odd = [None, math.nan, math.inf, -math.inf, OBJECT, True, "1"]
        numbers = plain, [*near, *odd, *sorted({int(x) for x in exact if abs(x) < 2**31})]
        truths: Pools = ([True, False], [None, 1, 0, "True", math.nan, OBJECT])
        for read in self.reads:
            if read.reduction is not None:
                yield from self._lists(read.reduction, numbers, truths)
            elif read.text:
                wrong = [None, "", "x", "1_0", "inf", 1.0, OBJECT]
                yield read.name, ([repr(x) for x in plain], [*wrong, *(f" {x!r}" for x in near)])
            elif read.type == "enum":
                wrong = [None, "", "-", *map(str.swapcase, read.literals), 1, OBJECT]
                yield read.name, ([*read.literals], [x for x in wrong if x not in read.literals])
            else:
                yield read.name, truths if read.type == "bool" else numbers

    def _lists(
        self, reduction: Reduction, numbers: Pools, truths: Pools
    ) -> Iterator[tuple[str, Pools]]:
        low, high = reduction.sector or (0.0, 1.0)
        half = (high - low) / 2
        angles = dict(zip(reduction.angles, (low - half, high + half, half), strict=False))
        least, most = reduction.length or (1, 3)
        lengths = [5] if angles else [*{max(least - 1, 0), least, 2, min(most, 50), most + 1}]
        for k, part in enumerate(reduction.inputs):
            plain, odd = truths if part.type == "bool" else numbers
            if k in angles:
                yield part.name, ([angles[k]] * 9 + [2 * angles[k] + 1], [None])
            elif not part.is_list:
                yield part.name, (plain, odd)
            else:
                mixed = [*plain, *plain, None, *([] if part.type == "bool" else odd)]
                alike = [[x] * n for x in plain for n in lengths if n <= 51]
                drawn = [
                    [[self._pick(of) for _ in range(n)] for n in lengths * 6 if n <= 51]
                    for of in (plain, mixed)
                ]
                yield part.name, (alike + drawn[0], [None, "1", [], *drawn[1]])

    # faults

    def _faults(self) -> Iterator[_Fault]:
        """Yield what can be wrong with each operation, and with the run of time."""
        operations, period = self.program.operations, self.period
        for k, row in enumerate(operations):
            ends = [row.window + n - m for n in (-1, 0, 1) for m in (0, period) if row.window]
            for name, values, *series in self._of(k, row):
                histories = [
                    lambda history, _, k=k, new=new: self._replaced(history, k, new)
                    for new in series
                ]
                reads = [self.program.reads[row.value]] if row.op == "variable" else self.reads
                names = [read.name for read in reads if values and read.reduction is None]
                raws = {name: self._in_unit(name, values)[0] for name in names}
                deltas = [n for n in ends if n > 0]
                yield _Fault(name, row.about, histories, deltas, raws)

        def of_time(name: str, deltas: Sequence[int], history: Any) -> _Fault:
            return _Fault(name, operations[-1].about, [history], deltas)

        for n in (-2, 2) if any(row.window for row in operations) else ():
            yield of_time("gap", self.jumps, lambda _, of, n=n: self._history(of, self.see, n))
        if any(row.window or row.op in _REMEMBER for row in operations):
            back = [-1, -2 * period, *self.deltas]
            yield of_time("back", back, lambda _, of: self._history(_onward(of, period), self.see))
        yield of_time(
            "same time", [0, period], lambda _, of: self._history(_onward(of, 0), self.see)
        )
        for name, (see, _) in self.faulty.items():
            yield of_time(name, (), lambda _, of, see=see: self._history(of, see))

    def _replaced(self, history: History, k: int, new: Series) -> History:
        self.work += len(history.times) * len(self.above[k])
        return history.replaced(k, new, self.above[k])

    def _of(self, k: int, row: Operation) -> Iterator[tuple[Any, ...]]:
        """Yield the name of a fault, and functions for the values that an operation has with it."""
        op = row.op

        def changed(full: int = 0, **changes: Any) -> Series:
            return lambda history: history.value(k, row._replace(**changes), full)

        def always(value: Value) -> Series:
            return lambda history: [value] * len(history.times)

        if op == "number" and row.value is not None:
            for to, factor in ((-math.inf, 0.99), (math.inf, 1.01)):
                far = row.value * factor if row.value else math.copysign(0.1, to)
                near = math.nextafter(row.value, to)
                yield "limit", (row.value, near), always(near), always(far)
        if op in ("number", "truth", "literal"):
            return
        for value in (True, None, False) if row.type == "bool" else (None,):
            yield "decides", (), always(value)
        for other in _others(op):
            yield "operator", (), changed(op=other)
        if op in _ORDERED:
            yield "order", (), changed(args=row.args[::-1])
        for n in (-1, 1) if row.window else ():
            yield "window", (), changed(window=row.window + n)
            yield "full", (), changed(n)
            if row.coverage is not None:
                shares = [row.coverage + n * share for share in (0.01, 0.1, 0.3)]
                yield ("coverage", (), *(changed(coverage=share) for share in shares))
        if row.window and row.coverage is None:
            yield "unknown", (), lambda history: _unaware(history, k, row)
        if op == "latch":
            yield "both", (), lambda history: _never_both(history, k, row.args)
        if op in ("hysteresis", "elapsed"):
            yield "unknown", (), lambda history: _kept(history.series[k])
        if op == "variable":
            yield from self._of_read(self.program.reads[row.value])

    def _of_read(self, read: Read) -> Iterator[tuple[Any, ...]]:
        def changed(ahead: int = 0, **changes: Any) -> Series:
            return lambda history: [
                value for value, _ in history.sampled(read._replace(**changes), ahead)
            ]

        for ends in () if read.range is None else _moved(read.range):
            yield "range", (*read.range, *ends), changed(range=ends)
        for n in (-1, 1) if read.stamped else ():
            yield "ahead", (), changed(n)
            if read.timeout is not None:
                yield "timeout", (), changed(timeout=read.timeout + n)
        if read.type == "number":
            yield "infinity", (math.inf, -math.inf), changed(infinite=not read.infinite)
        reduction = read.reduction
        if reduction is None:
            for raw in self.pools[read.name][1]:
                if type(raw) is not float or not math.isfinite(raw):
                    yield "type", (raw,), lambda history, raw=raw: _misread(history, read, raw)
            return
        for op in _others(reduction.op):
            yield "list", (), changed(reduction=replace(reduction, op=op))
        for k, node in enumerate(reduction.nodes):
            others = [replace(node, op=op) for op in _others(node.op)]
            if type(node.value) is float and node.op == "constant":
                near = [math.nextafter(node.value, to) for to in (-math.inf, math.inf)]
                others += [replace(node, value=value) for value in near]
            for other in others:
                nodes = (*reduction.nodes[:k], other, *reduction.nodes[k + 1 :])
                yield "list", (), changed(reduction=replace(reduction, nodes=nodes))


def _listed(faults: Iterable[_Fault]) -> str:
    """Return faults in words, by the place of their operation."""
    places: dict[str, dict[str, None]] = {}
    for fault in faults:
        places.setdefault(fault.place, {})[fault.name] = None
    return "; ".join(f"{', '.join(names)} of {place}" for place, names in places.items())


def _below(program: Program, root: int) -> set[int]:
    """Return an operation and all that it rests on."""
    below = {root}
    for k in range(root, -1, -1):
        below.update(program.operations[k].args if k in below else ())
    return below


def _part(program: Program, number: int) -> Program:
    """Return the program of one result."""
    result = program.results[number]
    new = {old: k for k, old in enumerate(sorted(_below(program, result.operation)))}
    rows = (program.operations[old] for old in new)
    operations = (row._replace(args=tuple(new[arg] for arg in row.args)) for row in rows)
    result = result._replace(operation=len(new) - 1)
    return program._replace(operations=tuple(operations), results=(result,))


def _source(read: Read) -> str:
    return read.name if read.reduction is None else read.reduction.inputs[0].name


def _others(op: str) -> Iterator[str]:
    yield from (other for ops in _ALIKE if op in ops for other in ops if other != op)


def _moved(ends: tuple[float, float]) -> Iterator[tuple[float, float]]:
    low, high = ends
    for to in (-math.inf, math.inf):
        yield math.nextafter(low, to), high
        yield low, math.nextafter(high, to)


def _equal(value: Value, other: Value) -> bool:
    if None in (value, other) or isinstance(value, bool):
        return value is other
    return math.isclose(value, other, rel_tol=10 * NEAR)


def _kept(series: Iterable[Value]) -> list[Value]:
    """Return values where what is not known is as before."""
    kept: list[Value] = []
    for value in series:
        kept.append(kept[-1] if value is None and kept else value)
    return kept


def _unaware(history: History, k: int, row: Operation) -> list[Value]:
    """Return the values of a window that does not see what is not known."""
    (arg,) = row.args
    if row.op not in ("time", "once"):
        return history.value(k, row._replace(coverage=NEAR))
    weak = row.op == "time"
    values = [weak if value is None else value for value in history.series[arg]]
    return history.replaced(arg, lambda _: values, ()).value(k, row)


def _never_both(history: History, k: int, args: Sequence[int]) -> list[Value]:
    """Return the values of a LATCH that is not TRUE where it is set and reset."""
    rows = zip(*(history.series[number] for number in (k, *args)), strict=True)
    return [value and not all(now) for value, *now in rows]


def _misread(history: History, read: Read, raw: Any) -> list[Value]:
    """Return what is read where a wrong value is as before, and a right one of its type unknown."""
    series: list[Value] = []
    for (value, _), sample in zip(history.sampled(read), history.samples, strict=True):
        is_it = sample.values.get(read.name) is raw
        before = series[-1] if series and value is None else None
        series.append(before if is_it else value)
    return series


def _onward(given: Sequence[Given], back: int) -> Iterator[Given]:
    """Yield a run whose clock goes on where it goes back, or (0) where it stands."""
    shift, last = 0, None
    for one in given:
        if last is not None and (one.t < last if back else one.t == last):
            shift += last - one.t + (back or 1)
        last = one.t
        yield one._replace(t=one.t + shift)
