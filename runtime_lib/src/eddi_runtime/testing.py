"""Runs the test vectors of a monitor, which were made from its model."""

from __future__ import annotations

import json
import logging
import math
from functools import partial
from itertools import zip_longest
from types import SimpleNamespace
from typing import Any, Callable, Dict, Iterator

_WORDS = {"T": "TRUE", "U": "UNKNOWN", "F": "FALSE"}
_NO_JSON = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf, "object": object()}
_ABSENT = _NO_JSON["absent"] = object()
_PRECISION = 1e-9  # relative, of the numbers of a result

Values = Dict[str, Any]  # by input id, as in JSON


def failures(file: str, monitor: Callable[[], Any], eddi_input: type[Any]) -> list[str]:
    """Return what differs from the vectors of a file, a line each: vector, expected, got."""
    with open(file, encoding="utf-8") as opened:  # noqa: PTH123 - as the rest of the runtime
        data = json.load(opened)
    class_ = _ConSertVectors if "guarantees" in data else _Vectors
    made = type(monitor())  # without methods of a person
    logging.disable(logging.WARNING)  # of what is not foreseen, and tried on purpose
    try:
        return [*class_(data, made, eddi_input).failures()]
    finally:
        logging.disable(logging.NOTSET)


class _Vectors:
    """Vectors of any kind: runs of steps, and messages that become too old."""

    def __init__(self, data: Any, monitor: Callable[..., Any], eddi_input: type[Any]) -> None:
        self.data, self.monitor, self.eddi_input = data, monitor, eddi_input
        self.attributes = {row[0]: row[1] for row in data["inputs"]}
        self.now: Values = {}  # in a step

    def failures(self) -> Iterator[str]:
        yield from self.tables(self.monitor())
        for name, steps in self.data["runs"]:
            monitor, other = self.new(steps), self.new(steps)
            yield from self.run(name, steps, monitor, other)
        if self.data["runs"]:
            other.reset()
            yield from self.run(f"{name}, after reset()", steps, other, monitor)
        yield from self.messages()
        yield from self.expressions()

    def new(self, steps: Any) -> Any:
        """Return a monitor for steps, in which methods that a person may write give values."""
        given = {key for _, *changes in steps if len(changes) > 1 for key in changes[0]}
        keys = given.difference(self.attributes)
        methods = {key[:-2]: partial(self.now.get, key) for key in keys}
        hooks = SimpleNamespace(update_dra_data=lambda _: None, **methods)
        return self.monitor(hooks) if keys else self.monitor()

    def run(self, name: str, steps: Any, monitor: Any, other: Any) -> Iterator[str]:
        """Compare the results of steps; another monitor beside it shares nothing."""
        unknown = dict.fromkeys(self.attributes)
        for number, (t_ns, values, expected, ages) in enumerate(_each(steps), 1):
            self.now.clear()
            self.now.update(unknown, **values)
            source = self.source(self.now)
            if ages:
                source.states = {k: SimpleNamespace(age=age) for k, age in ages.items()}
            other.execute_step(SimpleNamespace(), t_ns)
            shown = _shown(monitor, monitor.execute_step(source, t_ns))
            yield from _results(f"{name}, step {number}", expected, shown)

    def tables(self, monitor: Any) -> Iterator[str]:
        """Compare what is no function of the inputs."""
        for row, spec in zip_longest(self.data["inputs"], monitor.inputs):
            got = spec and [*spec[:7], spec.expression is not None, spec.accepts, spec.claims]
            yield from _compared(f"input {row and row[0]}", row, got)
        yield from _compared("topics", self.data["topics"], getattr(monitor, "topics", {}))

    def source(self, values: Values) -> SimpleNamespace:
        named = {name: _value(values[id_]) for id_, name in self.attributes.items()}
        return SimpleNamespace(**{k: value for k, value in named.items() if value is not _ABSENT})

    def messages(self) -> Iterator[str]:
        """Hand in messages of an age; what a person wrote is replaced."""
        # those of messages, and without an expression
        rows = [row for row in self.data["inputs"] if row[2] and not row[7]]
        sources = {name: object() for row in self.data["inputs"] for name in row[2]}
        values: Values = {}
        replaced = self.replaced(values)
        made = replaced()
        values.update(dict.fromkeys(self.attributes, "given"))
        for messages, when in (({}, "before a message"), (sources, ""), ({}, "after the last")):
            made.begin_step({}, t_ns=0)
            made.processing(messages)
            for row in rows if when else ():
                expected = row[5] if when == "before a message" else None
                got = getattr(made, row[1], "absent")
                yield from _compared(f"{row[0]} {when}", expected, got)
        for id_, given, *ends in self.data["ages"]:
            values.update(self.given(given))
            required = next(row[2] for row in rows if row[0] == id_)
            for age, results in ends:
                made = replaced()
                made.begin_step(dict.fromkeys(required, age), t_ns=0)
                made.processing(sources)
                monitor = self.monitor()
                outputs = [monitor.execute_step(made, 0) for _ in range(self.data["steps"])]
                shown = _shown(monitor, outputs[-1])
                yield from _results(f"{id_} at the age {age}", results, shown)

    def replaced(self, values: Values, computed: str = "") -> type[Any]:
        """Return an ``EDDIInput`` with these values, but for the input that is computed."""

        def process(own: Any, id_: str) -> None:
            other = values.get(id_, values.get(self.attributes[id_]))
            value = own.expression(id_) if id_ == computed else other
            setattr(own, self.attributes[id_], value)

        methods: dict[str, Any] = {"setup": lambda _: None, "processed": lambda *_: None}
        for id_, attribute in self.attributes.items():
            methods[f"process_{attribute}"] = lambda own, *_, id_=id_: process(own, id_)
        return type("Replaced", (self.eddi_input,), methods)

    def expressions(self) -> Iterator[str]:
        """Compare what expressions give; messages answer what is asked for with given values."""
        now: Values = {}
        for id_, fields, runs in self.data.get("expressions", ()):
            names = {json.dumps(asked): name for name, asked in fields.items()}

            def field(_: Any, messages: Values, *asked: Any, names: Any = names) -> Any:
                there = messages.get(asked[0]) is not None
                return _value(now[names[json.dumps(asked)]]) if there else None

            specs = [*self.monitor().inputs]
            number = [spec.id for spec in specs].index(id_)
            asking = type("Asking", (specs[number].expression,), {"field": field})
            specs[number] = specs[number]._replace(expression=asking)
            for name, steps in runs:
                made = self.replaced(now, id_)()
                made.bind(specs)
                for k, (t_ns, values, expected, ages) in enumerate(_each(steps), 1):
                    now.update(values)
                    sources = [of for spec in specs for of in spec.requires]
                    made.begin_step(ages, t_ns=t_ns)
                    made.processing(
                        {of: object() for of in sources if now.get(f"{of} is there", 1)}
                    )
                    shown = {"value": getattr(made, self.attributes[id_])}
                    yield from _results(f"{id_}: {name}, step {k}", expected, shown)

    def given(self, values: Any) -> Values:
        return {**dict.fromkeys(self.attributes), **values}


class _ConSertVectors(_Vectors):
    """Vectors of a ConSert: a letter for each input and each guarantee."""

    def __init__(self, data: Any, monitor: Callable[..., Any], eddi_input: type[Any]) -> None:
        super().__init__(data, monitor, eddi_input)
        self.values = {id_: {"T": t, "F": f, "U": None} for id_, f, t in data["states"]}

    def failures(self) -> Iterator[str]:
        for row in self.data["vectors"]:
            letters, verdicts, name = row.split(" ", 2)
            values = self.given(letters)
            yield from self.steps(self.monitor(), values, letters, verdicts, name)
        for id_, letters, verdicts, rows in self.data["leaves"]:
            for value, letter in rows:
                values = {**self.given(letters), id_: value}
                all_ = "".join(letter if k == id_ else of for k, of in zip(self.values, letters))
                name = f"{id_} = {value}"
                yield from self.steps(self.monitor(), values, all_, verdicts[letter], name)
        monitor = self.monitor()
        for letters, times, seen, verdicts in self.data["filter"]:
            name = f"filter {letters}"
            yield from self.steps(monitor, self.given(letters), seen, verdicts, name, times)
        yield from super().failures()

    def given(self, values: Any) -> Values:
        return {id_: self.values[id_][letter] for id_, letter in zip(self.values, values)}

    def tables(self, monitor: Any) -> Iterator[str]:
        yield from super().tables(monitor)
        shown = [
            [leaf.needs, leaf.unit, leaf.factor] if hasattr(leaf, "unit") else None
            for leaf in monitor.leaves
        ]
        yield from _compared("needs and units of inputs", self.data["shown"], shown)
        guarantees = [
            [g.id, g.published or g.id, g.default, g.ranking] for g in monitor.guarantees
        ]
        yield from _compared("guarantees", self.data["guarantees"], guarantees)
        yield from _compared("services", self.data["services"], monitor.services)
        monitor.execute_step(SimpleNamespace(), 0)
        for id_, paths in self.data["paths"]:
            if paths != [[]]:  # else it holds always
                yield from _compared(f"paths of {id_}", paths, monitor.explain(id_).missing)

    def steps(
        self, monitor: Any, values: Values, letters: str, verdicts: str, name: str, times: int = 0
    ) -> Iterator[str]:
        source = self.source(values)
        output = [monitor.execute_step(source, 0) for _ in range(times or self.data["steps"])][-1]
        rows = [*zip(self.data["guarantees"], verdicts)]
        flags = [{"id": row[1], "active": letter == "T"} for row, letter in rows]
        yield from _compared(name, flags, output)
        words = {row[0]: _WORDS[letter] for row, letter in rows}
        yield from _compared(f"{name}: verdicts", words, monitor.verdicts())
        words = {id_: _WORDS[letter] for id_, letter in zip(self.values, letters)}
        yield from _compared(f"{name}: inputs", words, monitor.input_verdicts())


def _each(rows: Any) -> Iterator[tuple[int, Values, Values, dict[str, float]]]:
    """Yield time, values, results and ages in seconds; each is as before where nothing is said.

    ``[until, period]`` are steps in which nothing changes.
    """
    kept: tuple[Values, Values, dict[str, int]] = ({}, {}, {})
    t = 0
    for end, *changes in rows:
        times = [end]
        if len(changes) == 1:
            times = [*range(t + changes[0], end + 1, changes[0])]
        else:
            for now, new in zip(kept, changes):
                now.update(new)
        for t in times:
            yield t, *kept[:2], {name: ns / 1e9 for name, ns in kept[2].items()}


def _value(said: Any) -> Any:
    """Return what JSON says, also what it cannot say."""
    if isinstance(said, list):
        return [_value(each) for each in said]
    return _NO_JSON[said["is"]] if isinstance(said, dict) else said


def _compared(name: str, expected: Any, got: Any) -> Iterator[str]:
    plain = json.loads(json.dumps(got, default=repr), parse_constant=str)
    if json.dumps(plain, sort_keys=True) != json.dumps(expected, sort_keys=True):
        yield f"{name}: expected {expected}, got {plain}"


def _shown(monitor: Any, output: Any) -> Values:
    known = monitor.as_json(output)
    shown = {**(known if isinstance(known, dict) else {}), **monitor.series(output)}
    rows = output if isinstance(output, list) else ()
    active = {f"{row['id']} is active": row["active"] for row in rows if isinstance(row, dict)}
    return {**shown, **active}


def _results(name: str, expected: Values, got: Values) -> Iterator[str]:
    """Compare named results, numbers with a precision."""
    for result, value in expected.items():
        other = got.get(result, "absent")
        is_number = type(value) is type(other) is float
        if not (is_number and math.isclose(value, other, rel_tol=_PRECISION)):
            yield from _compared(f"{name}: {result}", value, other)
