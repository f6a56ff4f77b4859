"""Evidence judged in Python: common values by the text, all others by the runtime's function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eddi_scaffold.program.instructions import (
    BOOL,
    BUFFERED,
    ENUM,
    FILTERS,
    NUMBER,
    STARTS,
    WINDOWS,
    Interval,
    Operation,
    Program,
    Read,
    Sampling,
    must_be_finite,
)
from eddi_scaffold.program.lists import ON_VALUES, reduction_lines
from eddi_scaffold.program.python_text import (
    WIDTH,
    Item,
    Part,
    assignment,
    call,
    number,
    returned,
    text_literal,
    tuple_of,
    unpacked,
    variables,
)

JUDGEMENTS = ("is_true", "is_false", "is_covered", "is_within")

_MAX_RANGES = 8
"""Ranges that are written out; more are judged by the general function."""


def judgement(one: Operation, place: int, value: str, target: str) -> list[str]:
    """Return the lines that judge a raw value.

    Args:
        one: the operation.
        place: number of what is read.
        value: name of the raw value.
        target: name of the truth value.
    """
    judged = f"1 if {value} is None else self.judge({place}, {value})"
    if one.op in ("is_true", "is_false"):
        good, bad = ("True", "False") if one.op == "is_true" else ("False", "True")
        return [
            f"if {value} is {good}:",
            f"    {target} = 2",
            "else:",
            f"    {target} = 0 if {value} is {bad} else {judged}",
        ]
    if one.op == "is_covered":
        return _covered(one.value, value, target, judged)
    if not 0 < len(one.value) <= _MAX_RANGES:
        return [f"{target} = {judged}"]
    lines = [f"if type({value}) is float or type({value}) is int:"]
    for k, interval in enumerate(one.value):
        lines.append(f"    {'elif' if k else 'if'} {_inside(value, interval)}:")
        lines.append(f"        {target} = 2")
    lines += ["    else:", f"        {target} = 0 if {value} == {value} else 1  # NaN is unknown"]
    return [*lines, "else:", f"    {target} = {judged}"]


def _covered(texts: Sequence[str], value: str, target: str, judged: str) -> list[str]:
    known = f"{target} = 2 if {value} in {{{', '.join(map(text_literal, texts))}}} else 0"
    if not texts or len(known) > 88:
        return [f"{target} = {judged}"]
    return [f"if type({value}) is str:", f"    {known}", "else:", f"    {target} = {judged}"]


def _inside(value: str, interval: Interval) -> str:
    end = "<=" if interval.closed else "<"
    return f"{number(interval.start)} <= {value} {end} {number(interval.end)}"


CLASSES = {
    "average": "stacks.Average",
    "sum": "stacks.Sum",
    "max": "windows.Maximum",
    "min": "windows.Minimum",
    "median": "windows.Median",
    "stddev": "stacks.Deviation",
    "rate": "windows.Rate",
    "count": "windows.Count",
    "time": "hold.Hold",
    "once": "hold.Hold",
}
"""Operation -> class of the runtime."""
_ARITHMETIC = {"add": "+", "sub": "-", "mul": "*"}
_ENUMS = {
    "eq_enum": "1 if {0} < 0 or {1} < 0 else 2 if {0} == {1} else 0",
    "ne_enum": "1 if {0} < 0 or {1} < 0 else 0 if {0} == {1} else 2",
    "known_enum": "0 if {0} < 0 else 2",
    "implies": "2 - {0} if 2 - {0} > {1} else {1}",
}
"""What elements of lists have not, or not written out for speed."""
_UNKNOWN = {NUMBER: "NAN", BOOL: "1", ENUM: "-1"}
_KNOWN = {NUMBER: "{0} == {0}", BOOL: "{0} != 1", ENUM: "{0} >= 0"}

_LONGEST_NAME = 24

RESERVED = frozenset(
    {"INF", "NAN", "a", "abs", "age", "ages", "b", "c", "expressions", "float", "getattr", "last"}
    | {"lists", "max", "messages", "min", "outputs", "raw", "self", "source", "t", "type", "values"}
)
"""Names with a meaning in the text."""


class Printer:
    """Prints one program.

    Args:
        program: what to print.
        names: an identifier for each read; of at most 24 characters, so that lines are short.
        elements: operation -> identifier, for elements of the model, whose words stand above them.
        copied: what is called is in the same module, else in ``expressions`` and its modules.
    """

    def __init__(
        self,
        program: Program,
        names: Sequence[str],
        elements: Mapping[int, str] | None = None,
        *,
        copied: bool = False,
    ) -> None:
        self._program = program
        self._operations = program.operations
        self._names = names
        self._elements = elements or {}
        self._copied = copied
        self._windows = [
            k for k, operation in enumerate(program.operations) if operation.op in WINDOWS
        ]
        self._state = _states(program)
        self._checked = must_be_finite(program)

    def members(self) -> list[str]:
        """Return the methods beside the step: what is remembered, and reductions."""
        lines = []
        if self._windows:
            about = (self._operations[k].about for k in self._windows)
            made = zip(map(self._new, self._windows), about, strict=True)
            rows = (Item(part, behind=words) for part, words in made)
            lines += ["", "    def __init__(self):"]
            lines += assignment("self.windows", tuple_of(rows), 8)
            lines += [
                f"        self.w{k} = self.windows[{i}].push" for i, k in enumerate(self._windows)
            ]
            lines += ["        super().__init__()"]
        if self._state:
            lines += ["", "    def restart(self):", "        super().restart()"]
            lines += [f"        self.{field} = {start}" for field, start in self._state.items()]
        for k, read in enumerate(self._program.reads):
            if read.reduction is not None:
                prefix = "" if self._copied else "lists."
                lines += ["", *reduction_lines(k, read.name, read.reduction, prefix)]
        return lines

    def evaluation(self, *, raw: bool) -> list[str]:
        """Return the lines of a step from given values on, to the return of those of the results.

        Args:
            raw: the values are those of a robot, else what the program computes with.
        """
        lines = self._begin()
        for k, read in enumerate(self._program.reads):
            converted = self._converted(k, read) if raw else []
            lines += _indented([*converted, *self._bound(k, read)])
        values = tuple_of(self._value(result.operation) for result in self._program.results)
        return [
            *lines,
            *self.operations(),
            *assignment("outputs", values, 8),
            "        self.outputs = outputs",
            "        return outputs",
        ]

    def operations(self) -> list[str]:
        """Return the lines of all operations."""
        lines: list[str] = []
        for k, operation in enumerate(self._operations):
            if operation.op in FILTERS:
                lines += self._filters(k)
            else:
                lines += self._commented(k, self._operation(k, operation))
        return lines

    def flags(self) -> list[str]:
        """Return the lines that return which results are TRUE."""
        rows = (
            Item(f"{self._value(result.operation)} == 2", behind=result.about)
            for result in self._program.results
        )
        return returned(tuple_of(rows), 8)

    def parameters(self) -> list[str]:
        """Return the names of the values, time stamps behind those that are stamped."""
        found: list[str] = []
        for name, read in zip(self._names, self._program.reads, strict=True):
            found += [name, stamp_name(name)] if read.stamped else [name]
        return found

    def _begin(self) -> list[str]:
        if not self._windows and not self._state:
            return _indented(
                ["if t == self.last:", "    return self.outputs", "self.last = t"],
            )
        lines = ["last = self.last"]
        if self._windows:
            # More than 2.5 periods without a step: windows fill again.
            limit = 5 * self._program.period
            gap = f"    if 2 * (t - last) > {limit}:  # a gap: windows fill again"
            lines += ["if last is not None and t > last:", gap, "        self.since = t"]
            lines += ["elif t == last:", "    return self.outputs"]
            lines += ["else:", "    self.restart()", "    self.since = t"]
        else:
            lines += ["if t == last:", "    return self.outputs"]
            lines += ["if last is not None and t < last:", "    self.restart()"]
        lines += ["self.last = t"]
        return _indented([*lines, "age = t - self.since"] if self._windows else lines)

    def _new(self, k: int) -> Part:
        one = self._operations[k]
        # AND is decided by a false sample, OR by a true one.
        last = one.capacity if one.op in BUFFERED else 0 if one.op == "time" else 2
        numbers = (one.window, one.window - self._program.period, last)
        made = call(self._called(CLASSES[one.op]), map(str, numbers))
        if one.coverage is None:
            return made
        return call(self._called("window.Covered"), [made, number(one.coverage)])

    def _called(self, name: str) -> str:
        """Return what is called in the runtime, or its copy."""
        module, _, name = name.rpartition(".")
        return name if self._copied else f"{module}.{name}"

    def _converted(self, k: int, read: Read) -> list[str]:
        """Return the lines that make a raw value one of the program; a float needs no call."""
        name = self._names[k]
        if read.type == ENUM:
            literals = map(text_literal, read.literals)
            value = call(self._called("expressions.literal"), [name, tuple_of(literals)])
            return [line[8:] for line in assignment(name, value, 8)]
        if read.type == BOOL:
            return [f"{name} = {self._called('expressions.truth')}({name})"]
        if read.text:
            return [f"{name} = {self._called('lists.number_in')}({name})"]
        converted = f"{name} = {self._called('expressions.number')}({name})"
        return [f"if type({name}) is not float:", f"    {converted}"]

    def _bound(self, k: int, read: Read) -> list[str]:
        name, unknown = self._names[k], _UNKNOWN[read.type]
        lines = []
        if read.type == NUMBER:
            lines += self._bounded(name, read)
        if not read.stamped:
            return lines
        stamp = stamp_name(name)
        lines += [f"if {stamp} > t:"]  # a clock that is a little ahead, or another clock
        lines += [f"    if {stamp} - t > {self._program.period}:", f"        {name} = {unknown}"]
        lines += [f"    {stamp} = t"]
        if f"s{k}" in self._state:
            known = _KNOWN[read.type].format(name)
            lines += [f"if {known}:", f"    self.s{k} = {stamp}"]
        if read.timeout is not None:
            lines += [f"if t - {stamp} > {read.timeout}:", f"    {name} = {unknown}"]
        return lines

    def _bounded(self, name: str, read: Read) -> list[str]:
        limits = read.range
        finite = f"{name} - {name} == 0.0"
        inside = f"{number(limits[0])} <= {name} <= {number(limits[1])}" if limits else ""
        if read.infinite:
            lines = [f"if {finite} and not {inside}:", f"    {name} = NAN"] if inside else []
        else:
            lines = [f"if not {inside or finite}:", f"    {name} = NAN"]
        if lines and len(lines[0]) > WIDTH - 8:  # bounds with all their digits
            return [f"a = {name}", lines[0].replace(name, "a"), lines[1]]
        return lines

    def _value(self, k: int) -> str:
        """Return the text of the value of an operation."""
        one = self._operations[k]
        if one.op == "variable":
            return str(self._names[one.value])
        if one.op == "number":
            text = "NAN" if one.value is None else number(one.value)
            return f"({text})" if text.startswith("-") else text
        return f"{one.value}" if one.op in ("truth", "literal") else self._elements.get(k, f"r{k}")

    def _operation(self, k: int, one: Operation) -> list[str]:
        values = [self._value(arg) for arg in one.args]
        lines = self._printed(k, one, values)
        if k in self._elements or all(len(line) <= WIDTH - 8 for line in lines):
            return lines
        short = "abc"[: len(values)]
        return [f"{', '.join(short)} = {', '.join(values)}", *self._printed(k, one, short)]

    def _printed(self, k: int, one: Operation, values: Sequence[str]) -> list[str]:
        a, b, c = [*values, "", "", ""][:3]
        r, op = self._value(k), one.op
        if op in ("and", "or"):
            return _extreme(r, "<" if op == "and" else ">", values)
        if op in JUDGEMENTS:
            return judgement(one, self._operations[one.args[0]].value, a, r)
        if op in _ENUMS:
            return [f"{r} = {_ENUMS[op].format(a, b)}"]
        if op in _ARITHMETIC:
            return [f"{r} = {a} {_ARITHMETIC[op]} {b}", *self._finite(k)]
        if op == "neg":
            return [
                f"{r} = -{a}",
                *(self._finite(k) if self._operations[one.args[0]].infinite else []),
            ]
        if op == "div":
            divisor = self._operations[one.args[1]]
            zero = f"{b} and {b} - {b} == 0.0" if divisor.infinite else b
            return [f"{r} = {a} / {b} if {zero} else NAN", *self._finite(k)]
        if op == "sqrt":
            return [f"{r} = {self._called('lists.root')}({a})"]
        if op in ON_VALUES:
            return [f"{r} = {ON_VALUES[op].format(a, b)}"]
        if op in WINDOWS:
            sample = f"NAN if {a} == 1 else {a}" if op == "count" else a
            if self._operations[one.args[0]].infinite and not one.infinite and op in BUFFERED:
                sample = f"{a} if {a} - {a} == 0.0 else NAN"
            return [f"{r} = self.w{k}(t, age, {sample})"]
        return self._stateful(k, op, a, b, c)

    def _stateful(self, k: int, op: str, a: str, b: str, c: str) -> list[str]:
        r, p = self._value(k), f"self.p{k}"
        if op == "rise":
            return [f"{r} = min({a}, 2 - {p})", f"{p} = {a}"]
        if op == "fall":
            return [f"{r} = min(2 - {a}, {p})", f"{p} = {a}"]
        if op == "edge":
            return [f"{r} = max(min({a}, 2 - {p}), min(2 - {a}, {p}))", f"{p} = {a}"]
        if op == "latch":
            return [f"{r} = {p} = max({a}, min({p}, 2 - {b}))"]
        if op == "hysteresis":
            known = " and ".join(f"{x} == {x}" for x in (a, b, c))
            held = f"2 if {a} >= {c} else 0 if {a} <= {b} else {p}"
            return [f"if {known}:", f"    {r} = {held}", "else:", f"    {r} = 1", f"{p} = {r}"]
        if op == "elapsed":
            return [
                f"if {a} == 1:",
                f"    self.e{k} = None",
                f"elif {a} == 2 and {p} == 0:",
                f"    self.e{k} = t",
                f"{p} = {a}",
                f"{r} = NAN if self.e{k} is None else (t - self.e{k}) / 1e9",
            ]
        if op == "age":
            stamp = f"self.s{self._operations[k].value}"
            return [f"{r} = NAN if {stamp} is None else (t - {stamp}) / 1e9"]
        return []  # a leaf

    def _finite(self, k: int) -> list[str]:
        return [f"if r{k} - r{k} != 0.0:", f"    r{k} = NAN"] if k in self._checked else []

    def _filters(self, k: int) -> list[str]:
        """Return the lines of all filters, which are one call, where the last of them is."""
        if any(operation.op in FILTERS for operation in self._operations[k + 1 : k + 2]):
            return []
        filters = [i for i, operation in enumerate(self._operations) if operation.op in FILTERS]
        values = tuple_of(self._value(self._operations[i].args[0]) for i in filters)
        names = [self._value(i) for i in filters]
        return [*assignment("values", values, 8), *unpacked(names, "self.filter.apply(values)")]

    def _commented(self, k: int, lines: list[str]) -> list[str]:
        """Return the lines of an operation with its words behind the first, or above it."""
        if not lines:
            return []
        first, *rest = _indented(lines)
        about = self._operations[k].about
        behind = f"{first}  # {about}"
        if k in self._elements or len(behind) > WIDTH:
            return [f"        # {about}", first, *rest]
        return [behind, *rest]


def class_lines(program: Program, names: Sequence[str]) -> list[str]:
    """Return the lines of a class with ``restart()`` and ``evaluate(t, ...)``.

    ``evaluate`` takes the time in nanoseconds, then for each read its value, and its time stamp
    where it is stamped; it returns the values of the results. What it calls is beside it.

    Args:
        program: what to evaluate.
        names: an identifier for each read.
    """
    printer = Printer(program, names, copied=True)
    arguments = ", ".join(["self", "t", *printer.parameters()])
    lines = ["class Engine(Conditions):", *printer.members(), "", f"    def evaluate({arguments}):"]
    return [*lines, *printer.evaluation(raw=False)]


def names_of(program: Program, sampling: Sampling) -> tuple[list[str], list[str]]:
    """Return an identifier for each value of the host, and one for each read.

    A read is the value itself, unless it is a reduction, or another read is the same value.
    Longer ids than 24 characters are left out, so that no line of the text is too long.
    """
    given = [input_.name for input_ in sampling.inputs]
    own: dict[int, int] = {}  # input -> the read that it is
    for k, used in enumerate(sampling.uses):
        if program.reads[k].reduction is None:
            own.setdefault(used[0], k)
    values = {k: one for one, k in own.items()}
    more = [k for k in range(len(program.reads)) if k not in values]
    ids = [*given, *(f"variable {k} of the form" for k in more)]
    reserved = {*RESERVED, *(f"r{k}" for k in range(len(program.operations)))}
    reserved.update(stamp_name(one) for one in (*given, *(f"v{k}" for k in range(len(ids)))))
    reserved.update(one for one in given if len(one) > _LONGEST_NAME)
    names = variables(ids, reserved)
    values.update(zip(more, range(len(given), len(ids)), strict=True))
    return names[: len(given)], [names[values[k]] for k in range(len(program.reads))]


def stamp_name(name: str) -> str:
    """Return the name of the time stamp of a read."""
    return f"{name}_stamp"


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"        {line}" for line in lines]


def _states(program: Program) -> dict[str, str]:
    """Return the fields of what functions remember, and how they start."""
    fields: dict[str, str] = {}
    for k, operation in enumerate(program.operations):
        if operation.op in STARTS:
            fields[f"p{k}"] = str(STARTS[operation.op])
        if operation.op == "elapsed":
            fields[f"e{k}"] = "None"
        if operation.op == "age":
            fields[f"s{operation.value}"] = "None"
    return fields


def _extreme(target: str, sign: str, values: Sequence[str]) -> list[str]:
    first, second, *rest = values
    lines = [f"{target} = {first} if {first} {sign} {second} else {second}"]
    for one in rest:
        lines += [f"if {one} {sign} {target}:", f"    {target} = {one}"]
    return lines
