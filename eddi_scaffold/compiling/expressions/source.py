"""Straight-line Python for an intermediate form: one line for each of its operations.

Numbers are floats, NaN is UNKNOWN; truth values are 0 < 1 < 2 (strong Kleene: AND is the minimum,
OR the maximum); values of an ENUM are its numbers, -1 is UNKNOWN. Code holds numbers and the given
names only, all else of a model is in comments.
"""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.compiling.expressions.form import (
    BOOL,
    BUFFERED,
    ENUM,
    NUMBER,
    WINDOWS,
    Form,
    Node,
    Variable,
)
from eddi_scaffold.compiling.expressions.lists import OPERATIONS, reduction_lines
from eddi_scaffold.compiling.expressions.sampling import Sampling
from eddi_scaffold.compiling.expressions.words import words_of
from eddi_scaffold.compiling.text import (
    WIDTH,
    Item,
    Part,
    assignment,
    call,
    number,
    text_literal,
    tuple_of,
    variables,
)

CLASSES = {
    "average": "stacks.Average",
    "sum": "stacks.Sum",
    "max": "windows.Maximum",
    "min": "windows.Minimum",
    "median": "windows.Median",
    "stddev": "stacks.Deviation",
    "rate": "windows.Rate",
    "count": "windows.Count",
    "time": "windows.Hold",
    "once": "windows.Hold",
}
"""Operation -> class of the runtime."""
_STATES = {
    "rise": ("1",),
    "fall": ("1",),
    "edge": ("1",),
    "latch": ("0",),
    "hysteresis": ("1",),
    "elapsed": ("1", "None"),
}
"""Operation -> what it remembers, as it is at the start."""
_ARITHMETIC = {"add": "+", "sub": "-", "mul": "*"}
_ENUMS = {
    "eq_enum": "1 if {0} < 0 or {1} < 0 else 2 if {0} == {1} else 0",
    "ne_enum": "1 if {0} < 0 or {1} < 0 else 0 if {0} == {1} else 2",
    "known_enum": "0 if {0} < 0 else 2",
    "and": "{0} if {0} < {1} else {1}",
    "or": "{0} if {0} > {1} else {1}",
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


class Source:
    """Prints one form.

    Args:
        form: what to evaluate.
        names: an identifier for each variable; of at most 24 characters, so that lines are short.
        copied: what is called is in the same module, else in ``expressions`` and its modules.
    """

    def __init__(self, form: Form, names: Sequence[str], *, copied: bool = False) -> None:
        self._form = form
        self._names = names
        self._copied = copied
        self._windows = [k for k, node in enumerate(form.nodes) if node.op in WINDOWS]
        self._state = _states(form)
        self._checked = must_be_finite(form)
        self._words = [
            f"{node.at[0]}:{node.at[1]} {words}"
            for node, words in zip(form.nodes, words_of(form), strict=True)
        ]

    def members(self) -> list[str]:
        """Return the methods beside the step: what is remembered, and reductions."""
        lines = []
        if self._windows:
            rows = (Item(self._new(k), behind=self._words[k]) for k in self._windows)
            lines += ["", "    def __init__(self):"]
            lines += assignment("self.windows", tuple_of(rows), 8)
            lines += [
                f"        self.w{k} = self.windows[{i}].push" for i, k in enumerate(self._windows)
            ]
            lines += ["        super().__init__()"]
        if self._state:
            lines += ["", "    def restart(self):", "        super().restart()"]
            lines += [f"        self.{field} = {start}" for field, start in self._state.items()]
        for k, variable in enumerate(self._form.variables):
            if variable.reduction is not None:
                prefix = "" if self._copied else "lists."
                lines += ["", *reduction_lines(k, variable.name, variable.reduction, prefix)]
        return lines

    def evaluation(self, *, raw: bool) -> list[str]:
        """Return the lines of a step from given values on, to the return of those of the outputs.

        Args:
            raw: the values are those of a robot, else what the form computes with.
        """
        lines = self._begin()
        for k, variable in enumerate(self._form.variables):
            converted = self._converted(k, variable) if raw else []
            lines += _indented([*converted, *self._variable(k, variable)])
        for k, node in enumerate(self._form.nodes):
            lines += self._commented(self._node(k, node), self._words[k])
        values = tuple_of(self._value(output.node) for output in self._form.outputs)
        return [
            *lines,
            *assignment("outputs", values, 8),
            "        self.outputs = outputs",
            "        return outputs",
        ]

    def parameters(self) -> list[str]:
        """Return the names of the values, time stamps behind those that are stamped."""
        found: list[str] = []
        for name, variable in zip(self._names, self._form.variables, strict=True):
            found += [name, stamp_name(name)] if variable.stamped else [name]
        return found

    def _begin(self) -> list[str]:
        if not self._windows and not self._state:
            return _indented(
                ["if t == self.last:", "    return self.outputs", "self.last = t"],
            )
        lines = ["last = self.last"]
        if self._windows:
            # More than 2.5 periods without a step: windows fill again.
            gap = f"    if 2 * (t - last) > {5 * self._form.period}:  # a gap: windows fill again"
            lines += ["if last is not None and t > last:", gap, "        self.since = t"]
            lines += ["elif t == last:", "    return self.outputs"]
            lines += ["else:", "    self.restart()", "    self.since = t"]
        else:
            lines += ["if t == last:", "    return self.outputs"]
            lines += ["if last is not None and t < last:", "    self.restart()"]
        lines += ["self.last = t"]
        return _indented([*lines, "age = t - self.since"] if self._windows else lines)

    def _new(self, k: int) -> Part:
        node = self._form.nodes[k]
        # AND is decided by a false sample, OR by a true one.
        last = node.capacity if node.op in BUFFERED else 0 if node.op == "time" else 2
        numbers = (node.window, node.window - self._form.period, last)
        made = call(self._called(CLASSES[node.op]), map(str, numbers))
        if node.coverage is None:
            return made
        return call(self._called("windows.Covered"), [made, number(node.coverage)])

    def _called(self, name: str) -> str:
        """Return what is called in the runtime, or its copy."""
        module, _, name = name.rpartition(".")
        return name if self._copied else f"{module}.{name}"

    def _converted(self, k: int, variable: Variable) -> list[str]:
        """Return the lines that make a raw value one of the form; a float needs no call."""
        name = self._names[k]
        if variable.type == ENUM:
            literals = map(text_literal, variable.literals)
            value = call(self._called("expressions.literal"), [name, tuple_of(literals)])
            return [line[8:] for line in assignment(name, value, 8)]
        if variable.type == BOOL:
            return [f"{name} = {self._called('expressions.truth')}({name})"]
        if variable.text:
            return [f"{name} = {self._called('lists.number_in')}({name})"]
        converted = f"{name} = {self._called('expressions.number')}({name})"
        return [f"if type({name}) is not float:", f"    {converted}"]

    def _variable(self, k: int, variable: Variable) -> list[str]:
        name, unknown = self._names[k], _UNKNOWN[variable.type]
        lines = []
        if variable.type == NUMBER:
            lines += self._bounded(name, variable)
        if not variable.stamped:
            return lines
        stamp = stamp_name(name)
        lines += [f"if {stamp} > t:"]  # a clock that is a little ahead, or another clock
        lines += [f"    if {stamp} - t > {self._form.period}:", f"        {name} = {unknown}"]
        lines += [f"    {stamp} = t"]
        if f"s{k}" in self._state:
            known = _KNOWN[variable.type].format(name)
            lines += [f"if {known}:", f"    self.s{k} = {stamp}"]
        if variable.timeout is not None:
            lines += [f"if t - {stamp} > {variable.timeout}:", f"    {name} = {unknown}"]
        return lines

    def _bounded(self, name: str, variable: Variable) -> list[str]:
        limits = variable.range
        finite = f"{name} - {name} == 0.0"
        inside = f"{number(limits[0])} <= {name} <= {number(limits[1])}" if limits else ""
        if variable.infinite:
            lines = [f"if {finite} and not {inside}:", f"    {name} = NAN"] if inside else []
        else:
            lines = [f"if not {inside or finite}:", f"    {name} = NAN"]
        if lines and len(lines[0]) > WIDTH - 8:  # bounds with all their digits
            return [f"a = {name}", lines[0].replace(name, "a"), lines[1]]
        return lines

    def _value(self, k: int) -> str:
        """Return the text of a node's value."""
        node = self._form.nodes[k]
        if node.op == "variable":
            return str(self._names[node.value])
        if node.op == "number":
            text = "NAN" if node.value is None else number(node.value)
            return f"({text})" if text.startswith("-") else text
        return f"{node.value}" if node.op in ("truth", "literal") else f"r{k}"

    def _node(self, k: int, node: Node) -> list[str]:
        values = [self._value(arg) for arg in node.args]
        lines = self._printed(k, node, values)
        if all(len(line) <= WIDTH - 8 for line in lines):
            return lines
        short = "abc"[: len(values)]
        return [f"{', '.join(short)} = {', '.join(values)}", *self._printed(k, node, short)]

    def _printed(self, k: int, node: Node, values: Sequence[str]) -> list[str]:
        a, b, c = [*values, "", "", ""][:3]
        r, op = f"r{k}", node.op
        if op in _ENUMS:
            return [f"{r} = {_ENUMS[op].format(a, b)}"]
        if op in _ARITHMETIC:
            return [f"{r} = {a} {_ARITHMETIC[op]} {b}", *self._finite(k)]
        if op == "neg":
            return [
                f"{r} = -{a}",
                *(self._finite(k) if self._form.nodes[node.args[0]].infinite else []),
            ]
        if op == "div":
            divisor = self._form.nodes[node.args[1]]
            zero = f"{b} and {b} - {b} == 0.0" if divisor.infinite else b
            return [f"{r} = {a} / {b} if {zero} else NAN", *self._finite(k)]
        if op == "sqrt":
            return [f"{r} = {self._called('lists.root')}({a})"]
        if op in OPERATIONS:
            return [f"{r} = {OPERATIONS[op].format(a, b)}"]
        if op in WINDOWS:
            sample = f"NAN if {a} == 1 else {a}" if op == "count" else a
            if self._form.nodes[node.args[0]].infinite and not node.infinite and op in BUFFERED:
                sample = f"{a} if {a} - {a} == 0.0 else NAN"
            return [f"{r} = self.w{k}(t, age, {sample})"]
        return self._stateful(k, op, a, b, c)

    def _stateful(self, k: int, op: str, a: str, b: str, c: str) -> list[str]:
        r, p = f"r{k}", f"self.p{k}"
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
            stamp = f"self.s{self._form.nodes[k].value}"
            return [f"{r} = NAN if {stamp} is None else (t - {stamp}) / 1e9"]
        return []  # a leaf

    def _finite(self, k: int) -> list[str]:
        return [f"if r{k} - r{k} != 0.0:", f"    r{k} = NAN"] if k in self._checked else []

    def _commented(self, lines: list[str], words: str) -> list[str]:
        """Return the lines of a node with its words behind the first, or above where they fit."""
        if not lines:
            return []
        first, *rest = _indented(lines)
        behind = f"{first}  # {words}"
        return [behind, *rest] if len(behind) <= WIDTH else [f"        # {words}", first, *rest]


def class_lines(form: Form, names: Sequence[str]) -> list[str]:
    """Return the lines of a class with ``restart()`` and ``evaluate(t, ...)``.

    ``evaluate`` takes the time in nanoseconds, then for each variable its value, and its time
    stamp where it is stamped; it returns the values of the outputs. What it calls is beside it.

    Args:
        form: what to evaluate.
        names: an identifier for each variable.
    """
    source = Source(form, names, copied=True)
    arguments = ", ".join(["self", "t", *source.parameters()])
    lines = ["class Engine(Conditions):", *source.members(), "", f"    def evaluate({arguments}):"]
    return [*lines, *source.evaluation(raw=False)]


def names_of(form: Form, sampling: Sampling) -> tuple[list[str], list[str]]:
    """Return an identifier for each value of the host, and one for each variable.

    A variable is the value itself, unless it is a reduction, or another variable is the same value.
    Longer ids than 24 characters are left out, so that no line of the text is too long.
    """
    given = [one.name for one in sampling.inputs]
    own: dict[int, int] = {}  # input -> the variable that it is
    for k, used in enumerate(sampling.uses):
        if form.variables[k].reduction is None:
            own.setdefault(used[0], k)
    values = {k: one for one, k in own.items()}
    more = [k for k in range(len(form.variables)) if k not in values]
    ids = [*given, *(f"variable {k} of the form" for k in more)]
    reserved = {*RESERVED, *(f"r{k}" for k in range(len(form.nodes)))}
    reserved.update(stamp_name(one) for one in (*given, *(f"v{k}" for k in range(len(ids)))))
    reserved.update(one for one in given if len(one) > _LONGEST_NAME)
    names = variables(ids, reserved)
    values.update(zip(more, range(len(given), len(ids)), strict=True))
    return names[: len(given)], [names[values[k]] for k in range(len(form.variables))]


def stamp_name(name: str) -> str:
    """Return the name of the time stamp of a variable."""
    return f"{name}_stamp"


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"        {line}" for line in lines]


def _states(form: Form) -> dict[str, str]:
    """Return the fields of what functions remember, and how they start."""
    fields: dict[str, str] = {}
    for k, node in enumerate(form.nodes):
        for prefix, start in zip("pe", _STATES.get(node.op, ()), strict=False):
            fields[f"{prefix}{k}"] = start
        if node.op == "age":
            fields[f"s{node.value}"] = "None"
    return fields


def must_be_finite(form: Form) -> frozenset[int]:
    """Return the nodes where an overflow must become NaN at once.

    Inside of sums and products it need not: infinity ends as infinity or NaN whatever follows.
    """
    absorbing = ("add", "sub", "mul")
    used = {output.node for output in form.outputs}
    for node in form.nodes:
        if node.op not in absorbing:
            used.update(node.args)
    return frozenset(used)
