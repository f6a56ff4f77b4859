"""Test vectors for a monitor in C99: a table, and a main program that runs it."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.conditions.definition import TRUTHS, Value, sample_of
from eddi_scaffold.conditions.samples import Drawing, Run, in_turn
from eddi_scaffold.program.c_files import filled
from eddi_scaffold.program.standalone import HEADER, StandaloneMonitor

_MOST_STEPS = 5000


class _Row(NamedTuple):
    """A step, and what is expected of a result; the time of the step before: no step."""

    t: int  # nanoseconds
    number: int  # of the result; -1: of none
    expected: Value
    values: Sequence[Value]  # of the reads
    ages: Sequence[int]  # of their samples, nanoseconds


def vectors_of_conditions(model: StandaloneMonitor) -> dict[str, str]:
    """Return the name and the text of the file for a monitor of conditions."""
    reads = [read._replace(range=None, infinite=True) for read in model.program.reads]
    drawings = [Drawing(model.program, k) for k in range(len(model.program.results))]

    def rows(number: int, run: Run) -> Iterator[_Row]:
        for given, result in zip(run.steps, run.results, strict=True):
            values = [sample_of(read, given.values) for read in reads]
            ages = [given.ages.get(read.name, 0) for read in reads]
            yield _Row(given.t, number, result, values, ages)

    runs = ((run.shows, rows(number, run)) for number, run in in_turn(drawings))
    return _file(model, runs, lambda: any(of.missed for of in drawings))


def vectors_of_consert(model: StandaloneMonitor, vectors: Mapping[str, Any]) -> dict[str, str]:
    """Return the name and the text of the file for a ConSert with these ``vectors.json``."""
    reads, period = model.program.reads, model.program.period or 10**9
    states = {id_: {"F": no, "U": None, "T": yes} for id_, no, yes in vectors["states"]}
    types = {read.name: read.type for read in reads}
    timeouts = {read.name: read.timeout for read in reads if read.timeout is not None}

    def rows(
        parts: Iterable[tuple[str, int, str]], own: dict[str, Value], late: Mapping[str, int]
    ) -> Iterator[_Row]:
        t = -period
        ages = [late.get(read.name, 0) for read in reads]
        for letters, times, verdicts in parts:
            pairs = zip(states.items(), letters, strict=True)
            given = {id_: _typed(types[id_], of[letter]) for (id_, of), letter in pairs} | own
            values = [given[read.name] for read in reads]
            for _ in range(times - 1):
                yield _Row(t := t + period, -1, None, values, ages)
            t += period
            for number, letter in enumerate(verdicts):
                yield _Row(t, number, TRUTHS["FUT".index(letter)], values, ages)

    def runs() -> Iterator[tuple[str, Iterable[_Row]]]:
        for row in vectors["vectors"]:
            letters, verdicts, shows = row.split(" ", 2)
            yield shows, rows([(letters, vectors["steps"], verdicts)], {}, {})
        for id_, letters, verdicts, judged in vectors["leaves"]:
            values = [(_typed(types[id_], value), letter) for value, letter in judged]
            tests = [(value, letter, 0) for value, letter in dict.fromkeys(values)]
            good, age = _typed(types[id_], states[id_]["T"]), timeouts.get(id_)
            tests += [] if age is None else [(good, "T", age), (good, "U", age + 1)]
            for value, letter, late in tests:
                parts = [(letters, vectors["steps"], verdicts[letter])]
                yield f"leaf:{id_}", rows(parts, {id_: value}, {id_: late})
        parts = [(raw, times, verdicts) for raw, times, _, verdicts in vectors["filter"]]
        yield "filter", rows(parts, {}, {})

    computed = any(has_expression for *_, has_expression, _, _ in vectors["inputs"])
    if computed or types.keys() != states.keys() or "text" in types.values():
        return {}
    return _file(model, runs(), lambda: not vectors["complete"])


def _typed(type_: str, value: object) -> Value:
    """Return a value of JSON as C has it; what is of another type is UNKNOWN there."""
    if isinstance(value, dict):  # NaN, infinity, or what is of no type
        value = {"inf": math.inf, "-inf": -math.inf}.get(value["is"])
    if isinstance(value, bool):
        return value if type_ == "bool" else None
    return float(value) if type_ == "number" and isinstance(value, int | float) else None


def _file(
    model: StandaloneMonitor,
    tests: Iterable[tuple[str, Iterable[_Row]]],
    missed: Callable[[], bool],
) -> dict[str, str]:
    """Return the name and the text of the file; nothing where there are no vectors.

    ``tests``: what each run shows, and its rows; ``missed``: whether a fault shows in none.
    """
    reads, runs, steps = model.program.reads, list[str](), list[str]()
    types = [
        type_
        for read in reads
        for type_ in ("double" if read.type == "number" else "int", "int64_t")[: 1 + read.stamped]
    ]
    result = "number" if model.numeric else "bool"
    is_cut = False
    for shows, given in tests:
        rows = [*given]
        if any(abs(row.t - age) >= 1 << 53 for row in rows for age in row.ages):
            continue  # a double cannot say it
        if is_cut := len(steps) + len(rows) > _MOST_STEPS:
            break
        for row in rows:
            expected = "NAN" if row.number < 0 else _double(result, row.expected)
            cells = [str(len(runs)), str(row.t), str(row.number), expected]
            for read, value, age in zip(reads, row.values, row.ages, strict=True):
                cells += [_double(read.type, value), str(row.t - age)][: 1 + read.stamped]
            steps.append(f"    {{{', '.join(cells)}}},\n")
        runs.append(f"    {json.dumps(c_comment(shows))},\n")
    if not steps:
        return {}
    texts = {"runs": "".join(runs), "steps": "".join(steps), "columns": str(4 + len(types))}
    texts["arguments"] = "".join(f", ({type_})s[{n}]" for n, type_ in enumerate(types, 4))
    texts["verdict"], texts["active"], texts["hazards"] = "value", "", ""
    if not model.numeric:
        event = "events[(int)s[2]]"
        active = "s[3] == 2 || (s[3] == 1 && hazards[(int)s[2]])"
        texts |= {
            "verdict": f"{event}.verdict",
            "active": f" || monitor.{event}.active != ({active})",
        }
        flags = ", ".join(str(result.hazard).lower() for result in model.program.results)
        texts["hazards"] = f"static const bool hazards[] = {{{flags}}};\n\n"
    texts["missed"] = "\n * Not all that could be wrong shows in them." * (is_cut or missed())
    text = filled("vectors.c", name=model.name, kind=model.kind, header=HEADER, **texts)
    return {f"{model.name}_vectors.c": text}


def _double(type_: str, value: Value) -> str:
    if type_ == "bool":
        return str(TRUTHS.index(value))
    if value is None:
        return "-1" if type_ == "enum" else "NAN"
    return repr(value) if math.isfinite(value) else f"{'-' * (value < 0)}INFINITY"
