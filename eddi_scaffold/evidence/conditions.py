"""Whether the text of conditions over messages and time is what their reader understood of them.

The operations of the read conditions are followed in their order: each has one form, whose operands
must be the values of its own. Events, inputs with an expression and triggers have this text.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from eddi_scaffold.evidence.emitted import (
    Call,
    Class,
    Emitted,
    Lines,
    UnprovedError,
    data,
    read_inputs,
)
from eddi_scaffold.evidence.reductions import VALUES, number, reduced

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
_RESERVED = {"self", "source", "raw", "t", "age", "last", "messages", "ages", "outputs", *"abc"}
_ABSORBING = ("add", "sub", "mul")  # an overflow stays one inside of sums and products


class Step:
    """Follows the operations of conditions in a step; ``read`` takes the lines that read."""

    def __init__(self, of: Class, program: Program, lines: Lines) -> None:
        self.of, self.program, self.lines = of, program, lines
        self.names: list[str] = []  # of each read
        self.stamps: dict[int, str] = {}  # read -> name of its time
        self._values: dict[str, int] = {}  # name -> the operation whose value it has
        self._results: dict[int, str] = {}  # the same, the other way
        self._states: dict[str, str] = {}  # attribute -> its value at the start
        self._ages: dict[int, str] = {}  # read -> attribute with the time of a known sample
        self._pushes: list[str] = []  # of the windows, in their order
        self._finite = {result.operation for result in program.results}
        for of_ in program.operations:
            self._finite |= {*()} if of_.op in _ABSORBING else {*of_.args}

    def take(self, *forms: str, **expected: str) -> dict[str, str]:
        """Take the next statements if they have a form with these expressions; return all."""
        at = self.lines.rest[0] if self.lines.rest else None
        texts = {
            letter: of if isinstance(of, str) else ast.unparse(of)
            for letter, of in self.lines.take(*forms).items()
        }
        for letter, text in expected.items():
            if texts[letter] != text:
                raise UnprovedError(at, f"{texts[letter]} is not {text}")
        return texts

    def called(self, read: int, *values: Any) -> None:
        """Take the line that gives a read by a call."""
        target = self.lines.rest[0] if self.lines.rest else None
        value = self.lines.take("R = V")
        if repr(data(value["V"])) != repr(Call(values[0], values[1:])):
            raise UnprovedError(target, f"it does not read {self.program.reads[read].name}")
        self.names.append(ast.unparse(value["R"]))

    def follow(self, arguments: str = "") -> None:
        """Take all that follows the lines that read, and the methods that belong to it."""
        ops = [operation.op for operation in self.program.operations]
        has_windows = not _WINDOWS.keys().isdisjoint(ops)
        begin = "windows" if has_windows else ""
        if not has_windows and not {*_STARTS, "age"}.isdisjoint(ops):
            begin = "state"
        gap = {"N": str(5 * self.program.period)} if has_windows else {}
        self.take(_BEGINS[begin], **gap)
        if len({*self.names, *self.stamps.values()} - _RESERVED) < len([*self.names, *self.stamps]):
            raise UnprovedError(self.of.node, "a name has two meanings")
        for k, read in enumerate(self.program.reads):
            self._bound(k, read)
        for k, operation in enumerate(self.program.operations):
            self._operation(k, operation)
        outputs = self.lines.take("outputs = V\nself.outputs = outputs\nreturn outputs")["V"]
        elements = getattr(outputs, "elts", ())
        wanted = [self._text(result.operation) for result in self.program.results]
        if [ast.unparse(of) for of in elements] != wanted:
            raise UnprovedError(outputs, f"the results are {', '.join(wanted)}")
        self.lines.end()
        if self._states:
            restart = self.of.method("restart", "self")
            restart.take("super().restart()")
            for _ in self._states:
                made = restart.take("self.P = V")
                if self._states.get(made["P"]) != ast.unparse(made["V"]):
                    raise UnprovedError(made["V"], f"{made['P']} starts as another value")
            restart.end()
        for k, read in enumerate(self.program.reads):
            if read.reduction is not None:
                reduced(self.of, k, read.reduction)
        if self._pushes:
            self._constructed(arguments)

    def _constructed(self, arguments: str) -> None:
        """Take the method that makes the windows."""
        more = "".join(f", {name}=None" for name in arguments.split())
        self.lines = self.of.method("__init__", f"self{more}")
        windows, at = [], self.lines.take("self.windows = V")["V"]
        for operation in self.program.operations:
            if operation.op in _WINDOWS:
                last = _DECIDES.get(operation.op, operation.capacity)
                need = operation.window - self.program.period
                new = Call(_WINDOWS[operation.op], (operation.window, need, last))
                coverage = operation.coverage
                windows.append(new if coverage is None else Call("window.Covered", (new, coverage)))
        if repr(data(at)) != repr(tuple(windows)):
            raise UnprovedError(at, f"the windows are {tuple(windows)!r}")
        for place, push in enumerate(self._pushes):
            self.take("self.W = self.windows[N].push", W=push, N=str(place))
        self.lines.take(f"super().__init__({', '.join(arguments.split())})")
        self.lines.end()

    def _bound(self, k: int, read: Read) -> None:
        """Take the lines that make a raw value one of its type, in its range, not too old."""
        x, unknown = self.names[k], _UNKNOWN[read.type]
        literals = {"L": repr(tuple(read.literals))} if read.type == "enum" else {}
        self.take(_CONVERTED["text" if read.text else read.type], X=x, **literals)
        if read.type == "number" and not (read.infinite and read.range is None):
            ends = dict(zip("LH", map(number, read.range or ()), strict=False))
            inside = "L <= X <= H" if ends else "X - X == 0.0"
            test = f"X - X == 0.0 and not {inside}" if read.infinite else f"not {inside}"
            form = f"if {test}:\n    X = NAN"
            other = f"a = X\nif {test.replace('X', 'a')}:\n    X = NAN"  # where lines are long
            self.take(form, other, X=x, **ends)
        if not read.stamped:
            return
        named = {"X": x, "S": self.stamps[k]}
        form = f"if S > t:\n    if S - t > N:\n        X = {unknown}\n    S = t"
        self.take(form, **named, N=str(self.program.period))
        if any(of.op == "age" and of.value == k for of in self.program.operations):
            taken = self.take(f"if {_KNOWN[read.type]}:\n    self.E = S", **named)
            self._ages[k] = self._own(taken["E"])
            self._states[taken["E"]] = "None"
        if read.timeout is not None:
            form = f"if t - S > N:\n    X = {unknown}"
            self.take(form, **named, N=str(read.timeout))

    def _own(self, attribute: str) -> str:
        """Return an attribute that remembers something of one operation, and of no other."""
        if re.fullmatch("[a-z][0-9]+", attribute) is None or attribute in (
            *self._states,
            *self._pushes,
        ):
            raise UnprovedError(self.of.node, f"{attribute} has two meanings")
        return attribute

    def _text(self, k: int) -> str:
        """Return the text of the value of an operation."""
        operation = self.program.operations[k]
        if operation.op == "variable":
            return self.names[int(operation.value)]
        if operation.op == "number":
            return number(operation.value)
        if operation.op in ("truth", "literal"):
            return str(operation.value)
        return self._results.get(k, "another value")

    def _operation(self, k: int, operation: Operation) -> None:
        op, args = operation.op, operation.args
        if op in ("variable", "number", "truth", "literal"):
            return
        operands = dict(zip("ABC", map(self._text, args), strict=False))
        short = ", ".join("abc"[: len(args)])
        if args and (taken := self.lines.find(f"{short} = {', '.join(operands)}")) is not None:
            if any(ast.unparse(taken[letter]) != text for letter, text in operands.items()):
                raise UnprovedError(taken["A"])
            operands = dict(zip("ABC", short.split(", "), strict=False))  # where lines are long
        if op in _WINDOWS:
            below = self.program.operations[args[0]]
            sample = "NAN if A == 1 else A" if op == "count" else "A"
            is_kept = operation.infinite or op in _DECIDES
            if below.infinite and not is_kept:
                sample = "A if A - A == 0.0 else NAN"
            form = f"R = self.W(t, age, {sample})"
        else:
            form = _FORMS[op]
        if op == "div" and self.program.operations[args[1]].infinite:
            form = "R = A / B if B and B - B == 0.0 else NAN"
        if op in ("and", "or"):
            operands = dict([*operands.items()][:2])
        if op == "age":
            operands["E"] = self._ages[operation.value]
        taken = self.take(form, **operands)
        result = taken["R"]
        if not result.isidentifier() or {result} & {*self.names, *self.stamps.values(), *_RESERVED}:
            raise UnprovedError(self.of.node, f"{result} has two meanings")
        for more in args[2:] if op in ("and", "or") else ():
            sign = "<" if op == "and" else ">"
            self.take(f"if A {sign} R:\n    R = A", R=result, A=self._text(more))
        if "W" in taken:
            self._pushes.append(self._own(taken["W"]))
        if "P" in taken:
            self._states[self._own(taken["P"])] = _STARTS[op]
        if op == "elapsed":
            self._states[self._own(taken["E"])] = "None"
        is_finite = op == "neg" and not self.program.operations[args[0]].infinite
        if op in ("add", "sub", "mul", "div", "neg") and not is_finite and k in self._finite:
            self.take("if R - R != 0.0:\n    R = NAN", R=result)
        self._results.pop(self._values.get(result, -1), None)
        self._values[result], self._results[k] = k, result


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
    types: dict[str, Any] = {}
    limits: dict[str, Any] = {}
    for read in program.reads:
        for name, type_ in parts_of(read).items():
            types.setdefault(name, type_)
        if read.type == "number" and read.reduction is None and not read.text:
            limits[read.name] = (*(read.range or (-math.inf, math.inf)), read.infinite)
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
    step = Step(monitor, program, monitor.method("step", "self, source, t"))
    names = read_inputs(step.lines, [(of.attribute, of.factor) for of in inputs], "self.raw = raw")
    raw = {id_: Call(name) for id_, name in zip(ids, names, strict=True)}
    taken, reductions = set[str](), 0
    for k, (read, used) in enumerate(zip(program.reads, sources, strict=True)):
        if read.reduction is not None:
            step.called(k, "self.reduce", reductions, Call(f"self.reduce_{k}"), *map(raw.get, used))
            reductions += 1
        elif used[0] in taken:
            step.names.append(step.take("R = A", A=raw[used[0]].name)["R"])
        else:
            step.names.append(raw[used[0]].name)
            taken.add(used[0])
        if read.stamped:
            step.stamps[k] = step.take("S = self.stamp(t, N)", N=repr(used[0]))["S"]
    step.follow(arguments)


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

    def word(name: str) -> str:
        return name.partition(".")[0].partition("[")[0]

    def field(name: str) -> tuple[Any, ...]:
        path = paths.get(name)
        if path is None:
            pieces = name.replace("[", ".[").split(".")[1:]
            path = [int(piece[1:-1]) if piece.startswith("[") else piece for piece in pieces]
        return tuple(map(_tuple, (path, *checks.get(name, ()))))

    sources = [[*parts_of(read)] for read in program.reads]
    named = {key: tuple(value) for key, value in document["names"].items()}
    states = tuple(part["state"] for part in parts if document["type"] == "state")
    emitted.attribute(of, "type", document["type"])
    emitted.attribute(of, "hazard", True if document.get("polarity") == "HAZARD" else None)
    emitted.attribute(of, "states", states or None)
    emitted.attribute(of, "names", named)
    step = Step(of, program, of.method("step", "self, t, messages, ages"))
    for k, (read, used) in enumerate(zip(program.reads, sources, strict=True)):
        message, fields = word(used[0]), [*map(field, used)]
        if read.reduction is None:
            step.called(k, "self.field", Call("messages"), message, *fields[0])
        else:
            method = Call(f"self.reduce_{k}")
            step.called(k, "self.reduce", k, method, Call("messages"), message, *fields)
        if read.stamped:
            form = "S = expressions.stamp(t, ages.get(N))"
            step.stamps[k] = step.take(form, N=repr(message))["S"]
    step.follow()
    emitted.end(of)


def _tuple(value: Any) -> Any:
    return tuple(map(_tuple, value)) if isinstance(value, list | tuple) else value


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
    parts: dict[str, Any] = {"reads": tuple(reads), "operations": tuple(operations)}
    parts["results"] = tuple(results)
    empty: Any = SimpleNamespace(**parts)
    return programs[0]._replace(**parts) if programs else empty
