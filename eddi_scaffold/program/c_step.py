"""The step of a monitor in C99: the same straight line as in Python."""

from __future__ import annotations

import string
from collections.abc import Sequence

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.program.instructions import (
    BUFFERED,
    LEAVES,
    STARTS,
    WINDOWS,
    Interval,
    Operation,
    Program,
    must_be_finite,
)
from eddi_scaffold.program.standalone import StandaloneMonitor

_ARITHMETIC = {"add": "+", "sub": "-", "mul": "*"}
_COMPARISONS = {
    "lt": "less({0}, {1})",
    "le": "less_or_equal({0}, {1})",
    "gt": "less({1}, {0})",
    "ge": "less_or_equal({1}, {0})",
    "eq": "equal({0}, {1})",
    "ne": "2 - equal({0}, {1})",
    "eq_bool": "same_truth({0}, {1})",
    "ne_bool": "2 - same_truth({0}, {1})",
    "xor": "2 - same_truth({0}, {1})",
    "eq_enum": "same_literal({0}, {1})",
    "ne_enum": "2 - same_literal({0}, {1})",
    "not": "2 - {0}",
    "implies": "greatest(2 - {0}, {1})",
    "abs": "fabs({0})",
    "sqrt": "(0.0 <= {0} && {0} < (double)INFINITY) ? sqrt({0}) : (double)NAN",
    "least": "(isnan({0}) || isnan({1})) ? (double)NAN : ({1} < {0}) ? {1} : {0}",
    "greatest": "(isnan({0}) || isnan({1})) ? (double)NAN : ({1} > {0}) ? {1} : {0}",
    "is_true": "{0}",
    "is_false": "2 - {0}",
    "known": "isnan({0}) ? 0 : 2",
    "known_bool": "{0} == 1 ? 0 : 2",
    "known_enum": "{0} < 0 ? 0 : 2",
}
_PLAIN = frozenset(f"{string.ascii_letters}{string.digits} _.,:;+*/")
"""What stands for itself in a literal: neither trigraphs nor markers of regions can be made of it.
"""
_EXTREMES = {"and": "least", "or": "greatest"}
_UNKNOWN = {"number": "NAN", "bool": "1", "enum": "-1", "text": "NULL"}


def fields(model: StandaloneMonitor) -> list[str]:
    """Return the members of the struct for windows and function states."""
    lines = []
    for k, node in enumerate(model.program.operations):
        size = f"[{node.capacity}]"
        if node.op in ("time", "once"):
            lines.append(f"event_hold w{k};")
        if node.op in BUFFERED:
            lines += [f"event_ring w{k};", f"int64_t w{k}_t{size};"]
            arrays = "" if node.op == "count" else "x"
            arrays += "s" if node.op == "median" else ""
            arrays += "hl" if node.op in ("sum", "average", "stddev") else ""
            lines += [f"double w{k}_{array}{size};" for array in arrays]
        if node.coverage is not None:
            lines += [f"event_ring c{k};", f"int64_t c{k}_t{size};", f"bool c{k}_k{size};"]
        if node.op in STARTS:
            lines.append(f"int p{k};")
        if node.op == "debounce":
            lines += [f"int p{k};", f"uint32_t n{k};"]
        if node.op == "majority":
            lines += [f"uint32_t n{k}[4];", f"unsigned char w{k}[{node.value}];"]
        if node.op == "elapsed":
            lines += [f"int64_t e{k};", f"bool has_e{k};"]
        if node.op == "age":
            lines += [f"int64_t s{node.value};", f"bool has_s{node.value};"]
    return lines


def resets(model: StandaloneMonitor) -> list[str]:
    """Return the statements that make windows and function states as they are at the start."""
    lines = []
    for k, node in enumerate(model.program.operations):
        if node.op in ("time", "once"):
            lines += [f"m->w{k}.last = INT64_MIN;", f"m->w{k}.unknown = INT64_MIN;"]
        if node.op in BUFFERED:
            lines.append(f"ring_reset(&m->w{k});")
        if node.coverage is not None:
            lines.append(f"ring_reset(&m->c{k});")
        if node.op in STARTS:
            lines.append(f"m->p{k} = {STARTS[node.op]};")
        if node.op == "debounce":
            lines += [f"m->p{k} = 1;", f"m->n{k} = 0u;"]
        if node.op == "majority":
            lines += [f"m->n{k}[{i}] = 0u;" for i in range(4)]
        if node.op == "elapsed":
            lines += [f"m->e{k} = 0;", f"m->has_e{k} = false;"]
        if node.op == "age":
            lines += [f"m->s{node.value} = 0;", f"m->has_s{node.value} = false;"]
    return lines


def statements(model: StandaloneMonitor) -> list[str]:
    """Return the statements that read the arguments and compute every node."""
    printer = _Printer(model)
    lines = []
    for k in range(len(model.program.reads)):
        lines += printer.variable(k)
    for k, node in enumerate(model.program.operations):
        made = printer.node(k, node)
        if made:
            lines += [f"/* {c_comment(node.about)} */", *made]
    return [*lines, *_unused(model.program)]


def _unused(program: Program) -> list[str]:
    """Return the statements that tell a compiler which values no result depends on."""
    used = {result.operation for result in program.results}
    used.update(k for operation in program.operations for k in operation.args)
    operations = enumerate(program.operations)
    return [
        f"(void)r{k};"
        for k, operation in operations
        if k not in used and operation.op not in LEAVES
    ]


def declarations(model: StandaloneMonitor) -> list[str]:
    """Return the registers."""
    kinds = {"number": "double", "bool": "int", "enum": "int"}
    return [
        f"{kinds[node.type]} r{k};"
        for k, node in enumerate(model.program.operations)
        if node.op not in LEAVES
    ]


def value(model: StandaloneMonitor, k: int) -> str:
    """Return the text of a node's value."""
    node = model.program.operations[k]
    if node.op == "variable":
        return f"v_{model.variables[node.value]}"
    if node.op == "number":
        text = "(double)NAN" if node.value is None else repr(node.value)
        return f"({text})" if text.startswith(("-", "(")) else text
    return str(node.value) if node.op in ("truth", "literal") else f"r{k}"


def int64(number: int) -> str:
    """Return a 64 bit constant."""
    return f"INT64_C({number})"


class _Printer:
    def __init__(self, model: StandaloneMonitor) -> None:
        self._model = model
        self._program = model.program
        self._checked = must_be_finite(model.program)
        self._aged = {node.value for node in model.program.operations if node.op == "age"}

    def variable(self, k: int) -> list[str]:
        variable = self._program.reads[k]
        name, unknown = f"v_{self._model.variables[k]}", _UNKNOWN[variable.type]
        wrong = []
        if variable.type == "bool":
            wrong.append(f"{name} < 0 || {name} > 2")
        elif variable.type == "enum":
            wrong.append(f"{name} < 0 || {name} >= {len(variable.literals)}")
        elif variable.type == "number":
            limits = variable.range
            outside = limits and f"!({limits[0]!r} <= {name} && {name} <= {limits[1]!r})"
            if variable.infinite:
                wrong += [f"isfinite({name}) && {outside}"] if outside else []
            else:
                wrong.append(f"!isfinite({name})")
                wrong += [outside] if outside else []
        lines = [f"if ({one}) {{ {name} = {unknown}; }}" for one in wrong]
        if not variable.stamped:
            return lines
        stamp = f"{name}_stamp"
        known = {"number": f"!isnan({name})", "bool": f"{name} != 1", "enum": f"{name} >= 0"}
        lines += [f"if ({stamp} > t) {{"]
        lines += [f"    if ({stamp} - t > {int64(self._program.period)}) {{ {name} = {unknown}; }}"]
        lines += [f"    {stamp} = t;", "}"]
        if k in self._aged:
            test = known[variable.type]
            lines += [f"if ({test}) {{ m->s{k} = {stamp}; m->has_s{k} = true; }}"]
        if variable.timeout is not None:
            old = f"t - {stamp} > {int64(variable.timeout)}"
            lines += [f"if ({old}) {{ {name} = {unknown}; }}"]
        return lines

    def node(self, k: int, node: Operation) -> list[str]:
        a, b, c = ([value(self._model, arg) for arg in node.args] + ["", "", ""])[:3]
        r, op = f"r{k}", node.op
        if op in _EXTREMES:
            values = [value(self._model, arg) for arg in node.args]
            firsts = [a, *[r] * (len(values) - 2)]
            pairs = zip(firsts, values[1:], strict=True)
            return [f"{r} = {_EXTREMES[op]}({one}, {other});" for one, other in pairs]
        if op == "is_within":
            tests = [_inside(a, one) for one in node.value]
            return _judged(r, f"isnan({a})", tests)
        if op == "is_covered":
            tests = [f"strcmp({a}, {one}) == 0" for one in map(_c_text, node.value) if one]
            return _judged(r, f"{a} == NULL", tests)
        if op == "debounce":
            return [f"{r} = debounced(&m->n{k}, &m->p{k}, {node.value}u, {a});"]
        if op == "majority":
            return [f"{r} = majority(m->n{k}, m->w{k}, {node.value}u, {a});"]
        if op in _COMPARISONS:
            return [f"{r} = {_COMPARISONS[op].format(a, b)};"]
        if op in _ARITHMETIC:
            return [f"{r} = {a} {_ARITHMETIC[op]} {b};", *self._finite(k)]
        if op == "neg":
            return [f"{r} = -{a};", *self._finite(k)]
        if op == "div":
            return [
                f"{r} = ({b} != 0.0 && !isinf({b})) ? {a} / {b} : (double)NAN;",
                *self._finite(k),
            ]
        if op in WINDOWS:
            return self._window(k, node, a)
        return self._stateful(k, op, a, b, c)

    def _finite(self, k: int) -> list[str]:
        return [f"if (!isfinite(r{k})) {{ r{k} = NAN; }}"] if k in self._checked else []

    def _window(self, k: int, node: Operation, a: str) -> list[str]:
        start, need = f"start = t - {int64(node.window)};", node.window - self._program.period
        full = f"age >= {int64(need)}"
        if node.op in ("time", "once"):
            dominant = 0 if node.op == "time" else 2
            return [start, f"r{k} = hold_push(&m->w{k}, start, t, {full}, {dominant}, {a});"]
        w, size = f"&m->w{k}", f"{node.capacity}u"
        known = f"{a} != 1" if node.op == "count" else f"!isnan({a})"
        if self._program.operations[node.args[0]].infinite and not node.infinite:
            known = f"isfinite({a})"
        ready = f"{full} && m->w{k}.bad <= start"
        lines = [start]
        if node.coverage is not None:
            lines.append(f"covered_add(&m->c{k}, m->c{k}_t, m->c{k}_k, {size}, t, start, {known});")
            share = f"(double)m->c{k}.known / (double)m->c{k}.size >= {node.coverage!r}"
            ready += f" && m->c{k}.bad <= start && {share}"
        expire, add, found = _parts(node.op, k, w, size, a)
        lines += [f"{expire};", f"if ({known}) {{", f"    {add};"]
        lines += ["} else {", f"    m->w{k}.bad = t;"] if node.coverage is None else []
        return [*lines, "}", f"r{k} = ({ready}) ? {found} : (double)NAN;"]

    def _stateful(self, k: int, op: str, a: str, b: str, c: str) -> list[str]:
        r, p = f"r{k}", f"m->p{k}"
        if op == "rise":
            return [f"{r} = least({a}, 2 - {p});", f"{p} = {a};"]
        if op == "fall":
            return [f"{r} = least(2 - {a}, {p});", f"{p} = {a};"]
        if op == "edge":
            both = f"greatest(least({a}, 2 - {p}), least(2 - {a}, {p}))"
            return [f"{r} = {both};", f"{p} = {a};"]
        if op == "latch":
            return [f"{r} = greatest({a}, least({p}, 2 - {b}));", f"{p} = {r};"]
        if op == "hysteresis":
            unknown = " || ".join(f"isnan({x})" for x in (a, b, c))
            rest = f"{a} >= {c} ? 2 : {a} <= {b} ? 0 : {p}"
            return [f"{r} = ({unknown}) ? 1 : {rest};", f"{p} = {r};"]
        if op == "elapsed":
            return [
                f"if ({a} == 1) {{ m->has_e{k} = false; }}",
                f"else if ({a} == 2 && {p} == 0) {{ m->e{k} = t; m->has_e{k} = true; }}",
                f"{p} = {a};",
                f"{r} = m->has_e{k} ? (double)(t - m->e{k}) / 1e9 : (double)NAN;",
            ]
        if op == "age":
            number = self._program.operations[k].value
            return [f"{r} = m->has_s{number} ? (double)(t - m->s{number}) / 1e9 : (double)NAN;"]
        return []


def _judged(target: str, unknown: str, tests: Sequence[str]) -> list[str]:
    """Return the statements that make a value UNKNOWN, TRUE by one of the tests, else FALSE."""
    whens = [f"if ({unknown}) {{ {target} = 1; }}"]
    whens += [f"else if ({test}) {{ {target} = 2; }}" for test in tests]
    return [*whens, f"else {{ {target} = 0; }}"]


def _inside(name: str, one: Interval) -> str:
    sign = "<=" if one.closed else "<"
    return f"{_number(one.start)} <= {name} && {name} {sign} {_number(one.end)}"


def _number(number: float) -> str:
    return repr(number).replace("inf", "(double)INFINITY")


def _c_text(text: str) -> str:
    """Return a text as a literal in UTF-8, empty for one that no text of C can be."""
    plain = "".join(
        chr(one) if chr(one) in _PLAIN else f"\\{one:03o}"
        for one in text.encode("utf-8", "surrogatepass")
    )
    return "" if "\0" in text else f'"{plain}"'


def _parts(op: str, k: int, w: str, size: str, x: str) -> tuple[str, str, str]:
    """Return how a window drops old samples, takes a new one, and what its value is."""
    t, xs = f"m->w{k}_t", f"m->w{k}_x"
    expire = f"ring_expire({w}, {t}, {size}, start)"
    if op == "count":
        add = f"if ({x} == 2) {{ (void)ring_append({w}, {t}, {size}, t); }}"
        return expire, add, f"(double)m->w{k}.size"
    if op in ("max", "min"):
        return expire, f"{op}_add({w}, {t}, {xs}, {size}, t, {x})", f"{xs}[m->w{k}.head]"
    if op == "rate":
        add = f"queue_add({w}, {t}, {xs}, {size}, t, {x})"
        return expire, add, f"rate_value({w}, {t}, {xs}, {size})"
    if op == "median":
        arrays = f"{w}, {t}, {xs}, m->w{k}_s, {size}"
        add = f"median_add({arrays}, t, {x})"
        return f"median_expire({arrays}, start)", add, f"median_value({w}, m->w{k}_s)"
    kind = "stddev" if op == "stddev" else "sum"
    arrays = f"{w}, {t}, {xs}, m->w{k}_h, m->w{k}_l, {size}"
    found = f"{kind}_value({w}, m->w{k}_h, m->w{k}_l)"
    if op == "average":
        found += f" / (double)m->w{k}.size"
    return f"{kind}_expire({arrays}, start)", f"{kind}_add({arrays}, t, {x})", found
