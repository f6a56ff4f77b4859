"""Whether the text of conditions over messages and time is what their reader understood of them.

Each operation has a form, so the step is written from the read conditions, and compared as text.
Events, inputs with an expression and triggers have this text.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from eddi_scaffold.evidence.emitted import Class, Emitted, Lines, UnprovedError, read_inputs
from eddi_scaffold.evidence.expressions import head_of, path_of
from eddi_scaffold.evidence.reductions import VALUES, number, reduction_lines

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput
    from eddi_scaffold.program.instructions import Operation, Program, Read

_FORMS = {
    **{op: f"R = {text}" for op, text in VALUES.items()},
    "and": "R = A if A < B else B",
    "or": "R = A if A > B else B",
    "eq_enum": "R = 1 if A < 0 or B < 0 else 2 if A == B else 0",
    "ne_enum": "R = 1 if A < 0 or B < 0 else 0 if A == B else 2",
    "known_enum": "R = 0 if A < 0 else 2",
    "implies": "R = 2 - A if 2 - A > B else B",
    "add": "R = A + B",
    "sub": "R = A - B",
    "mul": "R = A * B",
    "div": "R = A / B if B else NAN",
    "neg": "R = -A",
    "sqrt": "R = lists.root(A)",
    "rise": "R = min(A, 2 - self.P)\nself.P = A",
    "fall": "R = min(2 - A, self.P)\nself.P = A",
    "edge": "R = max(min(A, 2 - self.P), min(2 - A, self.P))\nself.P = A",
    "latch": "R = self.P = max(A, min(self.P, 2 - B))",
    "hysteresis": """\
if A == A and B == B and C == C:
    R = 2 if A >= C else 0 if A <= B else self.P
else:
    R = 1
self.P = R""",
    "elapsed": """\
if A == 1:
    self.E = None
elif A == 2 and self.P == 0:
    self.E = t
self.P = A
R = NAN if self.E is None else (t - self.E) / 1e9""",
    "age": "R = NAN if self.E is None else (t - self.E) / 1e9",
}
_STARTS = {"rise": "1", "fall": "1", "edge": "1", "latch": "0", "hysteresis": "1", "elapsed": "1"}
_STACKS = {"average": "Average", "sum": "Sum", "stddev": "Deviation"}
_SORTED = {"max": "Maximum", "min": "Minimum", "median": "Median", "rate": "Rate", "count": "Count"}
_WINDOWS = {
    **{op: f"stacks.{name}" for op, name in _STACKS.items()},
    **{op: f"windows.{name}" for op, name in _SORTED.items()},
    **dict.fromkeys(("time", "once"), "hold.Hold"),
}
_DECIDES = {"time": 0, "once": 2}  # the sample that decides a window, which needs no buffer
_BEGINS = {
    "windows": """\
last = self.last
if last is not None and t > last:
    if 2 * (t - last) > N:
        self.since = t
elif t == last:
    return self.outputs
else:
    self.restart()
    self.since = t
self.last = t
age = t - self.since""",
    "state": """\
last = self.last
if t == last:
    return self.outputs
if last is not None and t < last:
    self.restart()
self.last = t""",
    "": "if t == self.last:\n    return self.outputs\nself.last = t",
}
_UNKNOWN = {"number": "NAN", "bool": "1", "enum": "-1"}
_KNOWN = {"number": "X == X", "bool": "X != 1", "enum": "X >= 0"}
_CONVERTED = {
    "number": "if type(X) is not float:\n    X = expressions.number(X)",
    "bool": "X = expressions.truth(X)",
    "enum": "X = expressions.literal(X, L)",
    "text": "X = lists.number_in(X)",
}
_RESERVED = {"_", "self", "source", "raw", "t", "age", "last", "messages", "ages", "outputs"}
_RESERVED |= {"float", *"abc"}
_ABSORBING = ("add", "sub", "mul")  # an overflow stays one inside of sums and products
_LONGEST = 112  # line; in longer ones `a`, `b` and `c` stand for operands


def _filled(form: str, **texts: object) -> str:
    """Return a form with texts in place of its capital letters."""
    return re.sub(r"\b[A-Z]\b", lambda of: str(texts[of[0]]), form)


class _Step:
    """The lines of a step from what is read into ``names``, and what it remembers."""

    def __init__(self, program: Program, names: Sequence[str]) -> None:
        self.program, self.operations, self.names = program, program.operations, names
        args = (arg for of in self.operations if of.op not in _ABSORBING for arg in of.args)
        self.finite = {*args, *(result.operation for result in program.results)}
        self.states: dict[str, str] = {}  # attribute -> its value at the start
        for k, of in enumerate(self.operations):
            self.states |= {f"p{k}": _STARTS[of.op]} if of.op in _STARTS else {}
            self.states |= {f"e{k}": "None"} if of.op == "elapsed" else {}
            self.states |= {f"s{of.value}": "None"} if of.op == "age" else {}
        self.windows = {k: of for k, of in enumerate(self.operations) if of.op in _WINDOWS}

    def lines(self) -> Iterator[str]:
        begin = "windows" if self.windows else "state" if self.states else ""
        yield _filled(_BEGINS[begin], N=5 * self.program.period)
        for k, read in enumerate(self.program.reads):
            yield from self._bound(k, read)
        for k, operation in enumerate(self.operations):
            if operation.op not in ("variable", "number", "truth", "literal"):
                args = [*map(self._value, operation.args)]
                text, short = self._computed(k, operation, args), "abc"[: len(args)]
                if max(map(len, text.split("\n"))) > _LONGEST:
                    yield f"{', '.join(short)} = {', '.join(args)}"
                    text = self._computed(k, operation, short)
                yield text
        outputs = "".join(f"{self._value(of.operation)}, " for of in self.program.results)
        yield f"outputs = ({outputs})\nself.outputs = outputs\nreturn outputs"

    def _bound(self, k: int, read: Read) -> Iterator[str]:
        """Yield the lines that make a raw value one of its type, in its range, not too old."""
        x, unknown, period = self.names[k], _UNKNOWN[read.type], self.program.period
        yield _filled(_CONVERTED["text" if read.text else read.type], X=x, L=(*read.literals,))
        if read.type == "number" and not (read.infinite and read.range is None):
            low, high = map(number, read.range or (0.0, 0.0))
            inside = f"{low} <= X <= {high}" if read.range else "X - X == 0.0"
            test = f"if X - X == 0.0 and not {inside}:" if read.infinite else f"if not {inside}:"
            is_long = len(_filled(test, X=x)) > _LONGEST
            yield f"a = {x}" if is_long else ""
            yield f"{_filled(test, X='a' if is_long else x)}\n    {x} = NAN"
        stamp = f"{x}_stamp"
        if read.stamped:
            future = f"    if {stamp} - t > {period}:\n        {x} = {unknown}\n"
            yield f"if {stamp} > t:\n{future}    {stamp} = t"
            if f"s{k}" in self.states:
                yield f"if {_filled(_KNOWN[read.type], X=x)}:\n    self.s{k} = {stamp}"
            if read.timeout is not None:
                yield f"if t - {stamp} > {read.timeout}:\n    {x} = {unknown}"

    def _value(self, k: int) -> str:
        op, value = self.operations[k].op, self.operations[k].value
        if op == "variable":
            return self.names[int(value)]
        if op == "number":
            return f"({number(value)})" if number(value).startswith("-") else number(value)
        return str(value) if op in ("truth", "literal") else f"r{k}"

    def _computed(self, k: int, operation: Operation, args: Sequence[str]) -> str:
        op, result = operation.op, f"r{k}"
        below = [self.operations[arg].infinite for arg in operation.args]
        texts = dict(zip("ABC", args, strict=False)) | {"R": result, "P": f"p{k}"}
        texts["E"] = f"s{operation.value}" if op == "age" else f"e{k}"
        if op in _WINDOWS:
            sample = "NAN if A == 1 else A" if op == "count" else "A"
            if below[0] and not operation.infinite and op not in _DECIDES:
                sample = "A if A - A == 0.0 else NAN"
            return _filled(f"R = self.w{k}(t, age, {sample})", **texts)
        form = _FORMS[op]
        if op == "div" and below[1]:
            form = "R = A / B if B and B - B == 0.0 else NAN"
        is_calculated = op in ("add", "sub", "mul", "div") or (op == "neg" and below[0])
        if is_calculated and k in self.finite:
            form += "\nif R - R != 0.0:\n    R = NAN"
        sign, rest = "<" if op == "and" else ">", args[2:] if op in ("and", "or") else ()
        more = (f"\nif {of} {sign} {result}:\n    {result} = {of}" for of in rest)
        return _filled(form, **texts) + "".join(more)


def _named(lines: Lines, value: str) -> str:
    """Take the line that gives a value a name; return the name."""
    name = ast.unparse(getattr(lines.rest[0], "targets", lines.rest)[0])
    lines.expect(f"{name} = {value}")
    return name


def _follow(
    of: Class,
    program: Program,
    names: Sequence[str],
    lines: Lines,
    kept: Sequence[str] = (),
    arguments: str = "",
) -> None:
    """Take all that follows the lines that read, and the methods that belong to it.

    ``kept`` are other names that are read.
    """
    step, used = _Step(program, names), [*names, *kept]
    used += [f"{x}_stamp" for x, read in zip(names, program.reads, strict=True) if read.stamped]
    results = {f"r{k}" for k in range(len(program.operations))}
    if len({*used} - _RESERVED - results) < len(used) or not all(map(str.isidentifier, used)):
        raise UnprovedError(of.node, "a name has two meanings")
    lines.expect("\n".join(step.lines()))
    lines.end()
    if step.states:
        rows = "".join(f"self.{name} = {value}\n" for name, value in step.states.items())
        of.body("restart", "self", f"super().restart()\n{rows}")
    for k, read in enumerate(program.reads):
        if read.reduction is not None:
            given = [f"x{j}" for j in range(len(read.reduction.inputs))]
            body = "\n".join(reduction_lines(read.reduction, given))
            of.body(f"reduce_{k}", ", ".join(["self", *given]), body)
    if step.windows:
        windows, pushes = "", ""
        for place, (k, operation) in enumerate(step.windows.items()):
            last = _DECIDES.get(operation.op, operation.capacity)
            need, coverage = operation.window - program.period, operation.coverage
            new = f"{_WINDOWS[operation.op]}({operation.window}, {need}, {last})"
            windows += f"{new}, " if coverage is None else f"window.Covered({new}, {coverage}), "
            pushes += f"self.w{k} = self.windows[{place}].push\n"
        taken = "".join(f", {name}=None" for name in arguments.split())
        made = f"self.windows = ({windows})\n{pushes}"
        made += f"super().__init__({', '.join(arguments.split())})"
        of.body("__init__", f"self{taken}", made)


def parts_of(read: Read) -> dict[str, Any]:
    """Return the names of what a read is made of, each with its type."""
    if read.reduction is not None:
        return {of.name: "list" if of.is_list else of.type for of in read.reduction.inputs}
    return {read.name: "text" if read.text else read.literals or read.type}


def of_inputs(
    emitted: Emitted,
    monitor: Class,
    program: Program,
    units: Mapping[str, str],
    arguments: str = "",
) -> None:
    """Compare the tables and the step of conditions over the inputs of a monitor.

    ``arguments`` are what its constructor takes.
    """
    inputs = emitted.declared.inputs
    limits = {
        read.name: (*(read.range or (-math.inf, math.inf)), read.infinite)
        for read in program.reads
        if read.type == "number" and read.reduction is None and not read.text
    }
    types: dict[str, Any] = {}
    for read in reversed(program.reads):  # the first of an input counts
        types |= parts_of(read)
    sources = [[*parts_of(read)] for read in program.reads]
    emitted.attribute(monitor, "types", tuple(types.get(of.id, "") for of in inputs))
    emitted.attribute(monitor, "limits", tuple(limits.get(of.id) for of in inputs))
    shown = tuple(units.get(of.id, "") for of in inputs)
    emitted.attribute(monitor, "units", shown if any(shown) else None)
    ids = [of.id for of in inputs]
    firsts = [
        ids.index(of[0]) for of, read in zip(sources, program.reads, strict=True) if read.reduction
    ]
    emitted.attribute(monitor, "reductions", tuple(firsts) or None)
    lines = monitor.method("step", "self, source, t")
    given = read_inputs(lines, [(of.attribute, of.factor) for of in inputs], "self.raw = raw")
    raw = dict(zip(ids, given, strict=True))
    names: list[str] = []
    for k, (read, used) in enumerate(zip(program.reads, sources, strict=True)):
        name = raw[used[0]]
        if read.reduction is not None:
            values = ", ".join(raw[of] for of in used)
            place = sum(of.reduction is not None for of in program.reads[:k])
            name = _named(lines, f"self.reduce({place}, self.reduce_{k}, {values})")
        elif name in names:
            name = _named(lines, name)
        names.append(name)
        if read.stamped:
            lines.expect(f"{name}_stamp = self.stamp(t, {used[0]!r})")
    kept = {raw[of] for used in sources for of in used}.difference(names)
    _follow(monitor, program, names, lines, [*kept], arguments)


def needs_of(program: Program, inputs: Sequence[BoundInput]) -> list[tuple[int, ...]]:
    """Return for each result the places of the inputs that it rests on, in order of the reads."""
    ids = [input_.id for input_ in inputs]
    order = [*dict.fromkeys(name for read in program.reads for name in parts_of(read))]
    rests: list[set[int]] = []  # of each operation, the places of its inputs in this order
    for of in program.operations:
        names = parts_of(program.reads[of.value]) if of.op in ("variable", "age") else ()
        rests.append({*map(order.index, names)}.union(*(rests[k] for k in of.args)))
    used = (sorted(rests[result.operation]) for result in program.results)
    return [tuple(ids.index(order[k]) for k in places) for places in used]


def expressions(emitted: Emitted) -> Iterator[str]:
    """Compare the classes of inputs that an expression gives; yield what is proved."""
    for input_ in emitted.declared.inputs:
        if input_.expression is None:
            continue
        of = emitted.classes.pop(emitted.expressions.get(input_.id, ""), None)
        if of is None:
            raise UnprovedError(None, f"nothing computes {input_.id}")
        _expression(emitted, of, input_.expression)
        yield f"expression of {input_.id}"


def _expression(emitted: Emitted, of: Class, document: Mapping[str, Any]) -> None:
    parts, checks = document["parts"], document.get("checks", {})
    program, paths = joined([part["program"] for part in parts]), document.get("paths", {})

    def field(name: str) -> list[str]:
        path = paths[name] if name in paths else path_of(name)
        return [*map(_text, (path, *checks.get(name, ())))]

    sources = [[*parts_of(read)] for read in program.reads]
    named = {key: tuple(value) for key, value in document["names"].items()}
    states = tuple(part["state"] for part in parts if document["type"] == "state")
    emitted.attribute(of, "type", document["type"])
    emitted.attribute(of, "hazard", True if document.get("polarity") == "HAZARD" else None)
    emitted.attribute(of, "states", states or None)
    emitted.attribute(of, "names", named)
    lines, names = of.method("step", "self, t, messages, ages"), list[str]()
    for k, (read, used) in enumerate(zip(program.reads, sources, strict=True)):
        message, fields = repr(head_of(used[0])), [*map(field, used)]
        if read.reduction is None:
            value = f"self.field(messages, {message}, {', '.join(fields[0])})"
        else:
            columns = "".join(f", ({', '.join(of)},)" for of in fields)
            value = f"self.reduce({k}, self.reduce_{k}, messages, {message}{columns})"
        names.append(_named(lines, value))
        if read.stamped:
            lines.expect(f"{names[k]}_stamp = expressions.stamp(t, ages.get({message}))")
    _follow(of, program, names, lines)
    emitted.end(of)


def _text(value: Any) -> str:
    """Return data as they stand in the text."""
    if isinstance(value, list | tuple):
        return f"({''.join(f'{_text(of)}, ' for of in value)})"
    return number(value) if isinstance(value, float) else repr(value)


def joined(programs: Sequence[Program]) -> Program:
    """Return conditions in turn as one program; what is read equally is read once."""
    reads: dict[Read, int] = {}
    operations: list[Operation] = []
    results = []
    for program in programs:
        numbers = [reads.setdefault(read, len(reads)) for read in program.reads]
        base = len(operations)
        for of in program.operations:
            value = numbers[of.value] if of.op in ("variable", "age") else of.value
            args = tuple(base + arg for arg in of.args)
            operations.append(of._replace(args=args, value=value))
        result = program.results[0]
        results.append(result._replace(operation=base + result.operation))
    parts: dict[str, Any] = {"reads": tuple(reads), "results": tuple(results)}
    parts["operations"] = tuple(operations)
    empty: Any = SimpleNamespace(period=0, **parts)
    return programs[0]._replace(**parts) if programs else empty
