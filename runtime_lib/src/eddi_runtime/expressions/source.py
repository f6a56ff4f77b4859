"""Straight-line Python for an intermediate form: one class whose ``evaluate`` makes a step.

Numbers are floats, NaN is UNKNOWN; truth values are 0 < 1 < 2 (strong Kleene: AND is the minimum,
OR the maximum); values of an ENUM are its numbers, -1 is UNKNOWN. The text holds numbers and the
given argument names only.
"""

from __future__ import annotations

from typing import Dict, List, Optional, Sequence

from .form import BOOL, BUFFERED, ENUM, NUMBER, WINDOWS, Form, Node, Variable

CLASSES = {
    "average": "Average",
    "sum": "Sum",
    "max": "Maximum",
    "min": "Minimum",
    "median": "Median",
    "stddev": "Deviation",
    "rate": "Rate",
    "count": "Count",
    "time": "Hold",
    "once": "Hold",
}
"""Operation -> class of ``windows``."""
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
_COMPARISONS = {
    "lt": "2 if {0} < {1} else 0 if {0} >= {1} else 1",
    "le": "2 if {0} <= {1} else 0 if {0} > {1} else 1",
    "gt": "2 if {0} > {1} else 0 if {0} <= {1} else 1",
    "ge": "2 if {0} >= {1} else 0 if {0} < {1} else 1",
    "eq": "2 if {0} == {1} else 0 if {0} < {1} or {0} > {1} else 1",
    "ne": "0 if {0} == {1} else 2 if {0} < {1} or {0} > {1} else 1",
    "eq_bool": "1 if {0} == 1 or {1} == 1 else 2 - ({0} ^ {1})",
    "ne_bool": "1 if {0} == 1 or {1} == 1 else {0} ^ {1}",
    "xor": "1 if {0} == 1 or {1} == 1 else {0} ^ {1}",
    "eq_enum": "1 if {0} < 0 or {1} < 0 else 2 if {0} == {1} else 0",
    "ne_enum": "1 if {0} < 0 or {1} < 0 else 0 if {0} == {1} else 2",
    "and": "{0} if {0} < {1} else {1}",
    "or": "{0} if {0} > {1} else {1}",
    "not": "2 - {0}",
    "abs": "abs({0})",
    "sqrt": "math.sqrt({0}) if 0.0 <= {0} < math.inf else nan",
    "least": "nan if {0} != {0} or {1} != {1} else {1} if {1} < {0} else {0}",
    "greatest": "nan if {0} != {0} or {1} != {1} else {1} if {1} > {0} else {0}",
    "known": "2 if {0} == {0} else 0",
    "known_bool": "0 if {0} == 1 else 2",
    "known_enum": "0 if {0} < 0 else 2",
}
_UNKNOWN = {NUMBER: "nan", BOOL: "1", ENUM: "-1"}


def class_lines(
    form: Form, name: str = "Engine", arguments: Optional[Sequence[str]] = None
) -> List[str]:
    """Return the lines of a class with ``reset()`` and ``evaluate(t, ...)``.

    ``evaluate`` takes the time in nanoseconds, then for each variable its value, and its time
    stamp where it is stamped; it returns the values of the outputs.

    Args:
        form: what to evaluate.
        name: of the class.
        arguments: an identifier for each variable.
    """
    return _Printer(form, name, arguments).lines()


class _Printer:
    """Prints one form."""

    def __init__(self, form: Form, name: str, arguments: Optional[Sequence[str]]) -> None:
        self._form = form
        self._name = name
        self._names = list(arguments or (f"v{k}" for k in range(len(form.variables))))
        self._windows = [k for k, node in enumerate(form.nodes) if node.op in WINDOWS]
        self._state = _states(form)
        self._checked = must_be_finite(form)

    def lines(self) -> List[str]:
        period = self._form.period
        slots = ["windows", "last", "since", "outputs", *(f"w{k}" for k in self._windows)]
        lines = [f"class {self._name}:", f"    __slots__ = {tuple(slots + list(self._state))!r}"]
        lines += ["", "    def __init__(self):", "        self.windows = ("]
        lines += [f"            {self._new(k)}," for k in self._windows]
        lines.append("        )")
        lines += [
            f"        self.w{k} = self.windows[{i}].push" for i, k in enumerate(self._windows)
        ]
        lines += ["        self.reset()", "", "    def reset(self):"]
        lines += ["        self.last = None", "        self.since = 0"]
        lines += [f"        self.{field} = {start}" for field, start in self._state.items()]
        lines += ["        for window in self.windows:", "            window.reset()", ""]
        lines += [f"    def evaluate(self, t{self._parameters()}):"]
        lines += ["        last = self.last", "        if last is not None and t > last:"]
        # More than 2.5 periods without a step: windows fill again.
        gap = f"if 2 * (t - last) > {5 * period}" if period else "if False"
        lines += [f"            {gap}:", "                self.since = t"]
        lines += ["        elif t == last:", "            return self.outputs", "        else:"]
        lines += ["            self.reset()", "            self.since = t", "        self.last = t"]
        if self._windows:
            lines.append("        age = t - self.since")
        for k, variable in enumerate(self._form.variables):
            lines += [f"        {line}" for line in self._variable(k, variable)]
        for k, node in enumerate(self._form.nodes):
            place = f"  # {node.at[0]}:{node.at[1]} {node.op}"
            lines += [f"        {line}{place}" for line in self._node(k, node)]
        values = "".join(f"{self._value(output.node)}, " for output in self._form.outputs)
        lines += [f"        self.outputs = outputs = ({values.rstrip()})", "        return outputs"]
        return lines

    def _parameters(self) -> str:
        found = ""
        for k, variable in enumerate(self._form.variables):
            found += f", {self._names[k]}"
            found += f", {self._names[k]}_stamp" if variable.stamped else ""
        return found

    def _new(self, k: int) -> str:
        node = self._form.nodes[k]
        need = node.window - self._form.period
        # AND is decided by a false sample, OR by a true one.
        last = node.capacity if node.op in BUFFERED else 0 if node.op == "time" else 2
        made = f"{CLASSES[node.op]}({node.window}, {need}, {last})"
        return made if node.coverage is None else f"Covered({made}, {node.coverage!r})"

    def _variable(self, k: int, variable: Variable) -> List[str]:
        name, unknown = self._names[k], _UNKNOWN[variable.type]
        lines = []
        if variable.type == NUMBER:
            finite = f"{name} - {name} == 0.0"
            limits = variable.range and f"{variable.range[0]!r} <= {name} <= {variable.range[1]!r}"
            if variable.infinite:
                wrong = f"{finite} and not {limits}" if limits else ""
            else:
                wrong = f"not {limits}" if limits else f"not {finite}"
            lines += [f"if {wrong}:", f"    {name} = nan"] if wrong else []
        if not variable.stamped:
            return lines
        stamp = f"{name}_stamp"
        known = {NUMBER: "{0} == {0}", BOOL: "{0} != 1", ENUM: "{0} >= 0"}[variable.type]
        lines += [f"if {stamp} > t:"]  # a clock that is a little ahead, or another clock
        lines += [f"    if {stamp} - t > {self._form.period}:", f"        {name} = {unknown}"]
        lines += [f"    {stamp} = t"]
        if f"s{k}" in self._state:
            lines += [f"if {known.format(name)}:", f"    self.s{k} = {stamp}"]
        if variable.timeout is not None:
            lines += [f"if t - {stamp} > {variable.timeout}:", f"    {name} = {unknown}"]
        return lines

    def _value(self, k: int) -> str:
        """Return the text of a node's value."""
        node = self._form.nodes[k]
        if node.op == "variable":
            return str(self._names[node.value])
        if node.op == "number":
            text = "nan" if node.value is None else repr(node.value)
            return f"({text})" if text.startswith("-") else text
        return f"{node.value}" if node.op in ("truth", "literal") else f"r{k}"

    def _node(self, k: int, node: Node) -> List[str]:
        a, b, c = ([self._value(arg) for arg in node.args] + ["", "", ""])[:3]
        r, op = f"r{k}", node.op
        if op in _COMPARISONS:
            return [f"{r} = {_COMPARISONS[op].format(a, b)}"]
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
            return [f"{r} = {a} / {b} if {zero} else nan", *self._finite(k)]
        if op == "implies":
            return [f"{r} = 2 - {a} if 2 - {a} > {b} else {b}"]
        if op in WINDOWS:
            sample = f"nan if {a} == 1 else {a}" if op == "count" else a
            if self._form.nodes[node.args[0]].infinite and not node.infinite and op in BUFFERED:
                sample = f"{a} if {a} - {a} == 0.0 else nan"
            return [f"{r} = self.w{k}(t, age, {sample})"]
        return self._stateful(k, op, a, b, c)

    def _stateful(self, k: int, op: str, a: str, b: str, c: str) -> List[str]:
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
            rest = f"2 if {a} >= {c} else 0 if {a} <= {b} else {p}"
            return [f"{r} = {p} = ({rest}) if {known} else 1"]
        if op == "elapsed":
            return [
                f"if {a} == 1:",
                f"    self.e{k} = None",
                f"elif {a} == 2 and {p} == 0:",
                f"    self.e{k} = t",
                f"{p} = {a}",
                f"{r} = nan if self.e{k} is None else (t - self.e{k}) / 1e9",
            ]
        if op == "age":
            stamp = f"self.s{self._form.nodes[k].value}"
            return [f"{r} = nan if {stamp} is None else (t - {stamp}) / 1e9"]
        return []  # a leaf

    def _finite(self, k: int) -> List[str]:
        return [f"if r{k} - r{k} != 0.0: r{k} = nan"] if k in self._checked else []


def _states(form: Form) -> Dict[str, str]:
    """Return the fields of what functions remember, and how they start."""
    fields: Dict[str, str] = {}
    for k, node in enumerate(form.nodes):
        for prefix, start in zip("pe", _STATES.get(node.op, ())):
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
