"""The step of a monitor in Python: straight-line text, one line for each operation of a program.

Numbers are floats, NaN is UNKNOWN; truth values are 0 < 1 < 2 (strong Kleene: AND is the minimum,
OR the maximum); values of an ENUM are its numbers, -1 is UNKNOWN. Code holds numbers and the given
names only, all else of a model is in comments.
"""

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
_EXPRESSIONS = {
    **ON_VALUES,
    "eq_enum": "1 if {0} < 0 or {1} < 0 else 2 if {0} == {1} else 0",
    "ne_enum": "1 if {0} < 0 or {1} < 0 else 0 if {0} == {1} else 2",
    "known_enum": "0 if {0} < 0 else 2",
    "implies": "2 - {0} if 2 - {0} > {1} else {1}",
}
_STATEFUL = {
    "rise": "{r} = min({a}, 2 - {p})\n{p} = {a}",
    "fall": "{r} = min(2 - {a}, {p})\n{p} = {a}",
    "edge": "{r} = max(min({a}, 2 - {p}), min(2 - {a}, {p}))\n{p} = {a}",
    "latch": "{r} = {p} = max({a}, min({p}, 2 - {b}))",
    "hysteresis": """\
if {a} == {a} and {b} == {b} and {c} == {c}:
    {r} = 2 if {a} >= {c} else 0 if {a} <= {b} else {p}
else:
    {r} = 1
{p} = {r}""",
    "elapsed": """\
if {a} == 1:
    self.e{k} = None
elif {a} == 2 and {p} == 0:
    self.e{k} = t
{p} = {a}
{r} = NAN if self.e{k} is None else (t - self.e{k}) / 1e9""",
    "age": "{r} = NAN if self.s{value} is None else (t - self.s{value}) / 1e9",
}
_BINARY = """\
if {value} is {good}:
    {r} = 2
else:
    {r} = 0 if {value} is {bad} else {judged}"""
_UNKNOWN = {NUMBER: "NAN", BOOL: "1", ENUM: "-1"}
_KNOWN = {NUMBER: "{0} == {0}", BOOL: "{0} != 1", ENUM: "{0} >= 0"}
_MAX_RANGES = 8  # ranges that are written out; more are judged by the general function
_LONGEST_NAME = 24

RESERVED = frozenset(
    {"INF", "NAN", "a", "abs", "age", "ages", "b", "c", "expressions", "float", "getattr", "last"}
    | {"lists", "max", "messages", "min", "outputs", "raw", "self", "source", "t", "type", "values"}
)
"""Names with a meaning in the text."""


class Printer:
    """Prints one program."""

    def __init__(
        self,
        program: Program,
        # an identifier for each read; of at most 24 characters, so that lines are short
        names: Sequence[str],
        # operation -> identifier, for elements of the model, whose words stand above them
        elements: Mapping[int, str] | None = None,
        *,
        copied: bool = False,  # what is called is in the same module, else in `expressions`
        arguments: Sequence[str] = (),  # names that `__init__` takes, each by default None
    ) -> None:
        self._program = program
        self._operations = program.operations
        self._names = names
        self._elements = elements or {}
        self._copied = copied
        self._arguments = arguments
        ops = [operation.op for operation in program.operations]
        self._windows = [k for k, op in enumerate(ops) if op in WINDOWS]
        self._filters = [k for k, op in enumerate(ops) if op in FILTERS]
        self._checked = must_be_finite(program)
        self._state: dict[str, str] = {}  # field -> how it starts
        for k, operation in enumerate(self._operations):
            if operation.op in STARTS:
                self._state[f"p{k}"] = str(STARTS[operation.op])
            if operation.op == "elapsed":
                self._state[f"e{k}"] = "None"
            if operation.op == "age":
                self._state[f"s{operation.value}"] = "None"

    def members(self) -> list[str]:
        """Return the methods apart from the step: what is remembered, and reductions."""
        lines = []
        if self._windows:
            rows = (Item(self._new(k), behind=self._operations[k].about) for k in self._windows)
            taken = "".join(f", {name}=None" for name in self._arguments)
            lines += ["", f"    def __init__(self{taken}):"]
            lines += assignment("self.windows", tuple_of(rows), 8)
            pushes = enumerate(self._windows)
            lines += [f"        self.w{k} = self.windows[{place}].push" for place, k in pushes]
            lines += [f"        super().__init__({', '.join(self._arguments)})"]
        if self._state:
            lines += ["", "    def restart(self):", "        super().restart()"]
            lines += [f"        self.{field} = {start}" for field, start in self._state.items()]
        for k, read in enumerate(self._program.reads):
            if read.reduction is not None:
                prefix = "" if self._copied else "lists."
                lines += ["", *reduction_lines(k, read.name, read.reduction, prefix)]
        return lines

    def evaluation(self, *, raw: bool) -> list[str]:
        """Return the lines of a step from given values, or a robot's raw ones, to its return."""
        lines = self._begin()
        for k, read in enumerate(self._program.reads):
            lines += [*(self._converted(k, read) if raw else []), *self._bound(k, read)]
        values = tuple_of(self._value(result.operation) for result in self._program.results)
        return [
            *(f"        {line}" for line in lines),
            *self.operations(),
            *assignment("outputs", values, 8),
            "        self.outputs = outputs",
            "        return outputs",
        ]

    def operations(self) -> list[str]:
        """Return the lines of all operations, each with its words behind or above its first."""
        lines: list[str] = []
        for k, operation in enumerate(self._operations):
            if k in self._filters[-1:]:  # all filters are one call
                raw = (self._operations[place].args[0] for place in self._filters)
                lines += assignment("values", tuple_of(map(self._value, raw)), 8)
                names = [self._value(place) for place in self._filters]
                lines += unpacked(names, "self.filter.apply(values)")
            first, *rest = [f"        {line}" for line in self._operation(k, operation)] or [""]
            behind = f"{first}  # {operation.about}"
            if first and (k in self._elements or len(behind) > WIDTH):
                lines += [f"        # {operation.about}", first, *rest]
            elif first:
                lines += [behind, *rest]
        return lines

    def flags(self) -> list[str]:
        """Return the lines that return which results are TRUE."""
        rows = (
            Item(f"{self._value(result.operation)} == 2", behind=result.about)
            for result in self._program.results
        )
        return returned(tuple_of(rows), 8)

    def _begin(self) -> list[str]:
        if self._windows:
            # More than 2.5 periods without a step: windows fill again.
            return [
                "last = self.last",
                "if last is not None and t > last:",
                f"    if 2 * (t - last) > {5 * self._program.period}:  # a gap: windows fill again",
                "        self.since = t",
                "elif t == last:",
                "    return self.outputs",
                "else:",
                "    self.restart()",
                "    self.since = t",
                "self.last = t",
                "age = t - self.since",
            ]
        lines = ["if t == self.last:", "    return self.outputs", "self.last = t"]
        if self._state:
            back = ["if last is not None and t < last:", "    self.restart()"]
            return ["last = self.last", "if t == last:", lines[1], *back, lines[2]]
        return lines

    def _new(self, k: int) -> Part:
        operation, window = self._operations[k], self._operations[k].window
        # AND is decided by a false sample, OR by a true one.
        last = {"time": 0, "once": 2}.get(operation.op, operation.capacity)
        numbers = map(str, (window, window - self._program.period, last))
        new = call(self._called(CLASSES[operation.op]), numbers)
        if operation.coverage is None:
            return new
        return call(self._called("window.Covered"), [new, number(operation.coverage)])

    def _called(self, name: str) -> str:
        """Return what is called in the runtime, or its copy."""
        return name.rpartition(".")[2] if self._copied else name

    def _converted(self, k: int, read: Read) -> list[str]:
        """Return the lines that make a raw value one of the program; a float needs no call."""
        name = self._names[k]
        if read.type == ENUM:
            literals = tuple_of(map(text_literal, read.literals))
            value = call(self._called("expressions.literal"), [name, literals])
            return [line[8:] for line in assignment(name, value, 8)]
        if read.type == BOOL or read.text:
            convert = "lists.number_in" if read.text else "expressions.truth"
            return [f"{name} = {self._called(convert)}({name})"]
        converted = f"{name} = {self._called('expressions.number')}({name})"
        return [f"if type({name}) is not float:", f"    {converted}"]

    def _bound(self, k: int, read: Read) -> list[str]:
        """Return the lines that make a value UNKNOWN where it is wrong or too old."""
        name, unknown = self._names[k], _UNKNOWN[read.type]
        lines = []
        if read.type == NUMBER:
            inside = finite = f"{name} - {name} == 0.0"
            if read.range is not None:
                inside = f"{number(read.range[0])} <= {name} <= {number(read.range[1])}"
            if not read.infinite:
                lines = [f"if not {inside}:", f"    {name} = NAN"]
            elif read.range is not None:
                lines = [f"if {finite} and not {inside}:", f"    {name} = NAN"]
            if lines and len(lines[0]) > WIDTH - 8:  # bounds with all their digits
                lines = [f"a = {name}", lines[0].replace(name, "a"), lines[1]]
        if not read.stamped:
            return lines
        stamp = stamp_name(name)
        lines += [f"if {stamp} > t:"]  # a clock that is a little ahead, or another clock
        lines += [f"    if {stamp} - t > {self._program.period}:", f"        {name} = {unknown}"]
        lines += [f"    {stamp} = t"]
        if f"s{k}" in self._state:
            lines += [f"if {_KNOWN[read.type].format(name)}:", f"    self.s{k} = {stamp}"]
        if read.timeout is not None:
            lines += [f"if t - {stamp} > {read.timeout}:", f"    {name} = {unknown}"]
        return lines

    def _value(self, k: int) -> str:
        """Return the text of the value of an operation."""
        op, value = self._operations[k].op, self._operations[k].value
        if op == "variable":
            return str(self._names[value])
        if op == "number":
            text = "NAN" if value is None else number(value)
            return f"({text})" if text.startswith("-") else text
        return f"{value}" if op in ("truth", "literal") else self._elements.get(k, f"r{k}")

    def _operation(self, k: int, operation: Operation) -> list[str]:
        values = [self._value(arg) for arg in operation.args]
        lines = self._printed(k, operation, values)
        if k in self._elements or all(len(line) <= WIDTH - 8 for line in lines):
            return lines
        short = "abc"[: len(values)]
        return [f"{', '.join(short)} = {', '.join(values)}", *self._printed(k, operation, short)]

    def _printed(self, k: int, operation: Operation, values: Sequence[str]) -> list[str]:
        a, b, c = [*values, "", "", ""][:3]
        r, op = self._value(k), operation.op
        if op in ("and", "or"):
            sign = "<" if op == "and" else ">"
            lines = [f"{r} = {a} if {a} {sign} {b} else {b}"]
            for value in values[2:]:
                lines += [f"if {value} {sign} {r}:", f"    {r} = {value}"]
            return lines
        if op in JUDGEMENTS:
            return _judgement(operation, self._operations[operation.args[0]].value, a, r)
        if op in _EXPRESSIONS:
            return [f"{r} = {_EXPRESSIONS[op].format(a, b)}"]
        if op in _STATEFUL:
            names = {"r": r, "p": f"self.p{k}", "k": k, "a": a, "b": b, "c": c}
            return _STATEFUL[op].format(value=operation.value, **names).split("\n")
        finite = [f"if r{k} - r{k} != 0.0:", f"    r{k} = NAN"] if k in self._checked else []
        if op in _ARITHMETIC:
            return [f"{r} = {a} {_ARITHMETIC[op]} {b}", *finite]
        if op == "neg":
            is_finite = not self._operations[operation.args[0]].infinite
            return [f"{r} = -{a}", *([] if is_finite else finite)]
        if op == "div":
            divisor = self._operations[operation.args[1]]
            zero = f"{b} and {b} - {b} == 0.0" if divisor.infinite else b
            return [f"{r} = {a} / {b} if {zero} else NAN", *finite]
        if op == "sqrt":
            return [f"{r} = {self._called('lists.root')}({a})"]
        if op not in WINDOWS:
            return []  # a leaf, or a filter
        sample = f"NAN if {a} == 1 else {a}" if op == "count" else a
        if (
            self._operations[operation.args[0]].infinite
            and not operation.infinite
            and op in BUFFERED
        ):
            sample = f"{a} if {a} - {a} == 0.0 else NAN"
        return [f"{r} = self.w{k}(t, age, {sample})"]


def _judgement(operation: Operation, place: int, value: str, target: str) -> list[str]:
    """Return the lines that judge a raw value: common ones here, all others by the runtime."""
    judged = f"1 if {value} is None else self.judge({place}, {value})"
    general = f"{target} = {judged}"
    if operation.op in ("is_true", "is_false"):
        good, bad = ("True", "False") if operation.op == "is_true" else ("False", "True")
        names = {"r": target, "value": value, "good": good, "bad": bad, "judged": judged}
        return _BINARY.format(**names).split("\n")
    if operation.op == "is_covered":
        texts = ", ".join(map(text_literal, operation.value))
        known = f"{target} = 2 if {value} in {{{texts}}} else 0"
        if not texts or len(known) > 88:
            return [general]
        return [f"if type({value}) is str:", f"    {known}", "else:", f"    {general}"]
    if not 0 < len(operation.value) <= _MAX_RANGES:
        return [general]
    lines = [f"if type({value}) is float or type({value}) is int:"]
    for k, interval in enumerate(operation.value):
        inside = f"{number(interval.start)} <= {value} {'<=' if interval.closed else '<'} "
        lines.append(f"    {'elif' if k else 'if'} {inside}{number(interval.end)}:")
        lines.append(f"        {target} = 2")
    lines += ["    else:", f"        {target} = 0 if {value} == {value} else 1  # NaN is unknown"]
    return [*lines, "else:", f"    {general}"]


def class_lines(program: Program, names: Sequence[str]) -> list[str]:
    """Return the lines of a class with ``restart()`` and ``evaluate(t, ...)``.

    ``evaluate`` takes the time in nanoseconds, then for each read its value, and its time stamp
    where it is stamped; it returns the values of the results. What it calls is in the same module.
    """
    printer = Printer(program, names, copied=True)
    arguments = "self, t"
    for name, read in zip(names, program.reads, strict=True):
        arguments += f", {name}, {stamp_name(name)}" if read.stamped else f", {name}"
    lines = ["class Engine(Conditions):", *printer.members(), "", f"    def evaluate({arguments}):"]
    return [*lines, *printer.evaluation(raw=False)]


def names_of(program: Program, sampling: Sampling) -> tuple[list[str], list[str]]:
    """Return an identifier for each value of the host, and one for each read.

    A read is the value itself, unless it is a reduction, or another read is the same value.
    Longer ids than 24 characters are left out, so that no line of the text is too long.
    """
    host = [input_.name for input_ in sampling.inputs]
    own: dict[int, int] = {}  # input -> the read that it is
    for k, used in enumerate(sampling.uses):
        if program.reads[k].reduction is None:
            own.setdefault(used[0], k)
    values = {k: name for name, k in own.items()}
    more = [k for k in range(len(program.reads)) if k not in values]
    ids = [*host, *(f"variable {k} of the form" for k in more)]
    reserved = {*RESERVED, *(f"r{k}" for k in range(len(program.operations)))}
    reserved.update(stamp_name(name) for name in (*host, *(f"v{k}" for k in range(len(ids)))))
    reserved.update(name for name in host if len(name) > _LONGEST_NAME)
    names = variables(ids, reserved)
    values.update(zip(more, range(len(host), len(ids)), strict=True))
    return names[: len(host)], [names[values[k]] for k in range(len(program.reads))]


def stamp_name(name: str) -> str:
    """Return the name of the time stamp of a read."""
    return f"{name}_stamp"
