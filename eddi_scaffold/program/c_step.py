"""The step of a monitor in C99: the same straight line as in Python."""

from __future__ import annotations

import string
from collections.abc import Iterator, Sequence

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.program.instructions import (
    BUFFERED,
    LEAVES,
    MAX_NS,
    STARTS,
    WINDOWS,
    Interval,
    Operation,
    must_be_finite,
)
from eddi_scaffold.program.standalone import StandaloneMonitor

_EXPRESSIONS = {
    "lt": "less({a}, {b})",
    "le": "less_or_equal({a}, {b})",
    "gt": "less({b}, {a})",
    "ge": "less_or_equal({b}, {a})",
    "eq": "equal({a}, {b})",
    "ne": "2 - equal({a}, {b})",
    "eq_bool": "same_truth({a}, {b})",
    "ne_bool": "2 - same_truth({a}, {b})",
    "xor": "2 - same_truth({a}, {b})",
    "eq_enum": "same_literal({a}, {b})",
    "ne_enum": "2 - same_literal({a}, {b})",
    "not": "2 - {a}",
    "implies": "greatest(2 - {a}, {b})",
    "abs": "fabs({a})",
    "sqrt": "(0.0 <= {a} && {a} < (double)INFINITY) ? sqrt({a}) : (double)NAN",
    "least": "(isnan({a}) || isnan({b})) ? (double)NAN : ({b} < {a}) ? {b} : {a}",
    "greatest": "(isnan({a}) || isnan({b})) ? (double)NAN : ({b} > {a}) ? {b} : {a}",
    "is_true": "{a}",
    "is_false": "2 - {a}",
    "known": "isnan({a}) ? 0 : 2",
    "known_bool": "{a} == 1 ? 0 : 2",
    "known_enum": "{a} < 0 ? 0 : 2",
    "debounce": "debounced(&m->n{k}, &m->p{k}, {value}u, {a})",
    "majority": "majority(m->n{k}, m->w{k}, {value}u, {a})",
    "age": "m->has_s{value} ? (double)(t - m->s{value}) / 1e9 : (double)NAN",
}
_ARITHMETIC = {
    "add": "{a} + {b}",
    "sub": "{a} - {b}",
    "mul": "{a} * {b}",
    "neg": "-{a}",
    "div": "({b} != 0.0 && !isinf({b})) ? {a} / {b} : (double)NAN",
}
_STATEFUL = {
    "rise": "{r} = least({a}, 2 - {p});\n{p} = {a};",
    "fall": "{r} = least(2 - {a}, {p});\n{p} = {a};",
    "edge": "{r} = greatest(least({a}, 2 - {p}), least(2 - {a}, {p}));\n{p} = {a};",
    "latch": "{r} = greatest({a}, least({p}, 2 - {b}));\n{p} = {r};",
    "hysteresis": """\
{r} = (isnan({a}) || isnan({b}) || isnan({c})) ? 1 : {a} >= {c} ? 2 : {a} <= {b} ? 0 : {p};
{p} = {r};""",
    "elapsed": """\
if ({a} == 1) {{ m->has_e{k} = false; }}
else if ({a} == 2 && {p} == 0) {{ m->e{k} = t; m->has_e{k} = true; }}
{p} = {a};
{r} = m->has_e{k} ? (double)(t - m->e{k}) / 1e9 : (double)NAN;""",
}
_RING, _QUEUE = "ring_expire({w}, {t}, {n}, start)", "{w}, {t}, {x}, {n}"
_MEDIAN, _STACKS = "{w}, {t}, {x}, m->w{k}_s, {n}", "{w}, {t}, {x}, m->w{k}_h, m->w{k}_l, {n}"
_SUM = "sum_value({w}, m->w{k}_h, m->w{k}_l)"
_ON_WINDOWS = {
    "count": (
        _RING,
        "if ({a} == 2) {{ (void)ring_append({w}, {t}, {n}, t); }}",
        "(double)m->w{k}.size",
    ),
    "max": (_RING, f"max_add({_QUEUE}, t, {{a}})", "{x}[m->w{k}.head]"),
    "min": (_RING, f"min_add({_QUEUE}, t, {{a}})", "{x}[m->w{k}.head]"),
    "rate": (_RING, f"queue_add({_QUEUE}, t, {{a}})", f"rate_value({_QUEUE})"),
    "median": (
        f"median_expire({_MEDIAN}, start)",
        f"median_add({_MEDIAN}, t, {{a}})",
        "median_value({w}, m->w{k}_s)",
    ),
    "sum": (f"sum_expire({_STACKS}, start)", f"sum_add({_STACKS}, t, {{a}})", _SUM),
    "average": (
        f"sum_expire({_STACKS}, start)",
        f"sum_add({_STACKS}, t, {{a}})",
        f"{_SUM} / (double)m->w{{k}}.size",
    ),
    "stddev": (
        f"stddev_expire({_STACKS}, start)",
        f"stddev_add({_STACKS}, t, {{a}})",
        "stddev_value({w}, m->w{k}_h, m->w{k}_l)",
    ),
}
"""Operation -> how its window drops old samples, takes a new one, and what its value is."""
_ARRAYS = {"count": "", "median": "xs", "sum": "xhl", "average": "xhl", "stddev": "xhl"}
"""Operation -> arrays apart from the times of the samples, ``x`` if it is not here."""
_PLAIN = frozenset(f"{string.ascii_letters}{string.digits} _.,:;+*/")
"""What stands for itself in a literal: neither trigraphs nor markers of regions can be made of it.
"""
_EXTREMES = {"and": "least", "or": "greatest"}
_UNKNOWN = {"number": "NAN", "bool": "1", "enum": "-1", "text": "NULL"}
_KNOWN = {"number": "!isnan({0})", "bool": "{0} != 1", "enum": "{0} >= 0"}


def int64(number: int) -> str:
    """Return a 64 bit constant."""
    return f"INT64_C({number})"


class CStep:
    """The lines of one monitor's step, and of what it remembers."""

    def __init__(self, model: StandaloneMonitor) -> None:
        self._names = model.variables
        self._program = model.program
        self._operations = model.program.operations
        self._checked = must_be_finite(model.program)
        self._aged = {operation.value for operation in self._operations if operation.op == "age"}

    def fields(self) -> list[str]:
        """Return the members of the struct for windows and function states."""
        return [field for field, _ in self._memory() if field]

    def resets(self) -> list[str]:
        """Return the statements that make windows and states as they are at the start."""
        return [reset for _, reset in self._memory() if reset]

    def declarations(self) -> list[str]:
        """Return the registers."""
        types = {"number": "double", "bool": "int", "enum": "int"}
        return [
            f"{types[operation.type]} r{k};"
            for k, operation in enumerate(self._operations)
            if operation.op not in LEAVES
        ]

    def statements(self) -> list[str]:
        """Return the statements that read the arguments and do every operation."""
        lines = [line for k in range(len(self._program.reads)) for line in self._bound(k)]
        for k, operation in enumerate(self._operations):
            if operation.op not in LEAVES:
                lines += [f"/* {c_comment(operation.about)} */", *self._operation(k, operation)]
        used = {result.operation for result in self._program.results}
        used.update(k for operation in self._operations for k in operation.args)
        unused = set(range(len(self._operations))) - used  # a compiler wants to be told
        return [*lines, *(f"(void)r{k};" for k in sorted(unused) if self.value(k) == f"r{k}")]

    def value(self, k: int) -> str:
        """Return the text of the value of an operation."""
        operation = self._operations[k]
        if operation.op == "variable":
            return f"v_{self._names[operation.value]}"
        if operation.op == "number":
            text = "(double)NAN" if operation.value is None else repr(operation.value)
            return f"({text})" if text.startswith(("-", "(")) else text
        return str(operation.value) if operation.op in ("truth", "literal") else f"r{k}"

    def _memory(self) -> Iterator[tuple[str, str]]:
        """Yield a member of the struct, and the statement that resets it."""
        for k, operation in enumerate(self._operations):
            op, size = operation.op, f"[{operation.capacity}]"
            if op in ("time", "once"):
                yield f"event_hold w{k};", f"m->w{k}.last = INT64_MIN;"
                yield "", f"m->w{k}.unknown = INT64_MIN;"
            if op in BUFFERED:
                yield f"event_ring w{k};", f"ring_reset(&m->w{k});"
                yield f"int64_t w{k}_t{size};", ""
                yield from ((f"double w{k}_{name}{size};", "") for name in _ARRAYS.get(op, "x"))
            if operation.coverage is not None:
                yield f"event_ring c{k};", f"ring_reset(&m->c{k});"
                yield from ((f"int64_t c{k}_t{size};", ""), (f"bool c{k}_k{size};", ""))
            if op in STARTS:
                yield f"int p{k};", f"m->p{k} = {STARTS[op]};"
            if op == "debounce":
                yield f"int p{k};", f"m->p{k} = 1;"
                yield f"uint32_t n{k};", f"m->n{k} = 0u;"
            if op == "majority":
                yield f"uint32_t n{k}[4];", ""
                yield f"unsigned char w{k}[{operation.value}];", ""
                yield from (("", f"m->n{k}[{i}] = 0u;") for i in range(4))
            if op in ("elapsed", "age"):
                name = f"e{k}" if op == "elapsed" else f"s{operation.value}"
                yield f"int64_t {name};", f"m->{name} = 0;"
                yield f"bool has_{name};", f"m->has_{name} = false;"

    def _bound(self, k: int) -> list[str]:
        """Return the statements that make an argument UNKNOWN where it is wrong or too old."""
        read = self._program.reads[k]
        name, unknown = f"v_{self._names[k]}", _UNKNOWN[read.type]
        wrong = []
        if read.type == "bool":
            wrong = [f"{name} < 0 || {name} > 2"]
        elif read.type == "enum":
            wrong = [f"{name} < 0 || {name} >= {len(read.literals)}"]
        elif read.type == "number":
            wrong = [] if read.infinite else [f"!isfinite({name})"]
            if read.range is not None:
                outside = f"!({read.range[0]!r} <= {name} && {name} <= {read.range[1]!r})"
                wrong += [f"isfinite({name}) && {outside}" if read.infinite else outside]
        lines = [f"if ({test}) {{ {name} = {unknown}; }}" for test in wrong]
        if not read.stamped:
            return lines
        stamp, limit = f"{name}_stamp", int64(MAX_NS - 1)  # differences fit into 64 bits
        outside = f"{stamp} > {limit} || {stamp} < -{limit}"
        lines += [f"if ({outside}) {{ {name} = {unknown}; {stamp} = t; }}"]
        lines += [f"if ({stamp} > t) {{"]
        lines += [f"    if ({stamp} - t > {int64(self._program.period)}) {{ {name} = {unknown}; }}"]
        lines += [f"    {stamp} = t;", "}"]
        if k in self._aged:
            known = _KNOWN[read.type].format(name)
            lines += [f"if ({known}) {{ m->s{k} = {stamp}; m->has_s{k} = true; }}"]
        if read.timeout is not None:
            lines += [f"if (t - {stamp} > {int64(read.timeout)}) {{ {name} = {unknown}; }}"]
        return lines

    def _operation(self, k: int, operation: Operation) -> list[str]:
        values, r, op = [self.value(arg) for arg in operation.args], f"r{k}", operation.op
        if op in _EXTREMES:
            firsts = [values[0], *[r] * (len(values) - 2)]
            pairs = zip(firsts, values[1:], strict=True)
            return [f"{r} = {_EXTREMES[op]}({first}, {second});" for first, second in pairs]
        a, b, c = [*values, "", "", ""][:3]
        if op == "is_within":
            return _judged(r, f"isnan({a})", [_inside(a, interval) for interval in operation.value])
        if op == "is_covered":
            texts = filter(None, map(_c_text, operation.value))
            return _judged(r, f"{a} == NULL", [f"strcmp({a}, {text}) == 0" for text in texts])
        if op in WINDOWS:
            return self._window(k, operation, a)
        names = {"r": r, "p": f"m->p{k}", "k": k, "value": operation.value, "a": a, "b": b, "c": c}
        if op in _STATEFUL:
            return _STATEFUL[op].format(**names).split("\n")
        if op in _EXPRESSIONS:
            return [f"{r} = {_EXPRESSIONS[op].format(**names)};"]
        finite = [f"if (!isfinite({r})) {{ {r} = NAN; }}"] if k in self._checked else []
        return [f"{r} = {_ARITHMETIC[op].format(**names)};", *finite]

    def _window(self, k: int, operation: Operation, a: str) -> list[str]:
        start = f"start = t - {int64(operation.window)};"
        full = f"age >= {int64(operation.window - self._program.period)}"
        if operation.op in ("time", "once"):
            dominant = 0 if operation.op == "time" else 2
            return [start, f"r{k} = hold_push(&m->w{k}, start, t, {full}, {dominant}, {a});"]
        known = f"{a} != 1" if operation.op == "count" else f"!isnan({a})"
        if self._operations[operation.args[0]].infinite and not operation.infinite:
            known = f"isfinite({a})"
        lines, ready = [start], f"{full} && m->w{k}.bad <= start"
        if operation.coverage is not None:
            ring = f"&m->c{k}, m->c{k}_t, m->c{k}_k, {operation.capacity}u"
            lines += [f"covered_add({ring}, t, start, {known});"]
            share = f"(double)m->c{k}.known / (double)m->c{k}.size >= {operation.coverage!r}"
            ready += f" && m->c{k}.bad <= start && {share}"
        names = {
            "w": f"&m->w{k}",
            "t": f"m->w{k}_t",
            "x": f"m->w{k}_x",
            "n": f"{operation.capacity}u",
        }
        expire, add, value = (text.format(k=k, a=a, **names) for text in _ON_WINDOWS[operation.op])
        lines += [f"{expire};", f"if ({known}) {{", f"    {add};"]
        lines += ["} else {", f"    m->w{k}.bad = t;"] if operation.coverage is None else []
        return [*lines, "}", f"r{k} = ({ready}) ? {value} : (double)NAN;"]


def _judged(target: str, unknown: str, tests: Sequence[str]) -> list[str]:
    """Return the statements that make a value UNKNOWN, TRUE by one of the tests, else FALSE."""
    whens = [f"else if ({test}) {{ {target} = 2; }}" for test in tests]
    return [f"if ({unknown}) {{ {target} = 1; }}", *whens, f"else {{ {target} = 0; }}"]


def _inside(name: str, interval: Interval) -> str:
    start, end = (
        repr(bound).replace("inf", "(double)INFINITY") for bound in (interval.start, interval.end)
    )
    return f"{start} <= {name} && {name} {'<=' if interval.closed else '<'} {end}"


def _c_text(text: str) -> str:
    """Return a text as a literal in UTF-8, empty for one that no text of C can be."""
    plain = "".join(
        chr(byte) if chr(byte) in _PLAIN else f"\\{byte:03o}"
        for byte in text.encode("utf-8", "surrogatepass")
    )
    return "" if "\0" in text else f'"{plain}"'
