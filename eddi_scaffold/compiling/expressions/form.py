"""The intermediate form of events: a typed expression graph in JSON, checked before it is used.

``nodes`` are in the order of evaluation, each argument before its use; equal sub-expressions are
one node. No name takes part in the evaluation: variables are numbered.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from eddi_scaffold.compiling.document import ModelError, take
from eddi_scaffold.compiling.expressions.reduction import Reduction, read_reduction

VERSION = 1
NUMBER, BOOL, ENUM = "number", "bool", "enum"
TYPES = (NUMBER, BOOL, ENUM)
MAX_CAPACITY = 1 << 20
"""Samples in one window: 16 MB in C."""
MAX_NS = 1 << 62
"""Longest duration; sums of two fit into 64 bits."""

NUMBERS = (NUMBER, NUMBER)
TRUTHS = (BOOL, BOOL)
LEAVES = ("variable", "number", "truth", "literal")
SIGNATURES: Mapping[str, tuple[tuple[str, ...], str]] = {
    "neg": ((NUMBER,), NUMBER),
    "abs": ((NUMBER,), NUMBER),
    "sqrt": ((NUMBER,), NUMBER),
    "least": (NUMBERS, NUMBER),
    "greatest": (NUMBERS, NUMBER),
    "add": (NUMBERS, NUMBER),
    "sub": (NUMBERS, NUMBER),
    "mul": (NUMBERS, NUMBER),
    "div": (NUMBERS, NUMBER),
    "lt": (NUMBERS, BOOL),
    "le": (NUMBERS, BOOL),
    "gt": (NUMBERS, BOOL),
    "ge": (NUMBERS, BOOL),
    "eq": (NUMBERS, BOOL),
    "ne": (NUMBERS, BOOL),
    "eq_bool": (TRUTHS, BOOL),
    "ne_bool": (TRUTHS, BOOL),
    "eq_enum": ((ENUM, ENUM), BOOL),
    "ne_enum": ((ENUM, ENUM), BOOL),
    "and": (TRUTHS, BOOL),
    "or": (TRUTHS, BOOL),
    "xor": (TRUTHS, BOOL),
    "implies": (TRUTHS, BOOL),
    "not": ((BOOL,), BOOL),
    "average": ((NUMBER,), NUMBER),
    "sum": ((NUMBER,), NUMBER),
    "max": ((NUMBER,), NUMBER),
    "min": ((NUMBER,), NUMBER),
    "median": ((NUMBER,), NUMBER),
    "stddev": ((NUMBER,), NUMBER),
    "rate": ((NUMBER,), NUMBER),
    "count": ((BOOL,), NUMBER),
    "time": ((BOOL,), BOOL),
    "once": ((BOOL,), BOOL),
    "rise": ((BOOL,), BOOL),
    "fall": ((BOOL,), BOOL),
    "edge": ((BOOL,), BOOL),
    "latch": (TRUTHS, BOOL),
    "hysteresis": ((NUMBER, NUMBER, NUMBER), BOOL),
    "elapsed": ((BOOL,), NUMBER),
    "known": ((NUMBER,), BOOL),
    "known_bool": ((BOOL,), BOOL),
    "known_enum": ((ENUM,), BOOL),
    "age": ((), NUMBER),
}
"""Operation -> types of its arguments and of its value; ``age`` names a variable."""

BUFFERED = ("average", "sum", "max", "min", "median", "stddev", "rate", "count")
WINDOWS = (*BUFFERED, "time", "once")
KEEPS_INFINITY = ("abs", "least", "greatest", "max", "min", "median")
"""Operations whose value can be infinite when an argument is."""


class Variable(NamedTuple):
    """One input.

    Attributes:
        name: as in the text (``motor.temps[1]``).
        type: ``number``, ``bool`` or ``enum``.
        range: least and greatest value; None for no limits.
        timeout: nanoseconds after which a sample is UNKNOWN; None for never.
        infinite: infinity is a value.
        literals: texts of an ENUM.
        stamped: the time of its sample is asked for (AGE or TIMEOUT).
        text: it comes as a text that represents a number in decimal.
        reduction: how it is made of the lists of a message; None: it comes as it is.
    """

    name: str
    type: str
    range: tuple[float, float] | None
    timeout: int | None
    infinite: bool
    literals: tuple[str, ...]
    stamped: bool
    text: bool = False
    reduction: Reduction | None = None


class Node(NamedTuple):
    """One operation.

    Attributes:
        op: see ``SIGNATURES`` and ``LEAVES``.
        args: numbers of the nodes it works on.
        type: of its value.
        value: of a constant; number of the variable or of the literal.
        window: nanoseconds.
        capacity: samples that the buffer holds.
        coverage: share of known samples that is enough; None: all.
        at: line and column in the text.
        infinite: the value can be infinite.
    """

    op: str
    args: tuple[int, ...]
    type: str
    value: Any
    window: int
    capacity: int
    coverage: float | None
    at: tuple[int, int]
    infinite: bool


class Output(NamedTuple):
    """One result.

    Attributes:
        id: name of the event.
        node: number of the node.
        hazard: UNKNOWN counts as active.
    """

    id: str
    node: int
    hazard: bool


class Form(NamedTuple):
    """A checked intermediate form.

    Attributes:
        period: nanoseconds between two steps, 0 when there is no rate.
        variables: the inputs.
        nodes: in the order of evaluation.
        outputs: the results.
    """

    period: int
    variables: tuple[Variable, ...]
    nodes: tuple[Node, ...]
    outputs: tuple[Output, ...]


def read_form(document: Mapping[str, Any]) -> Form:
    """Check an intermediate form, as ``json`` gives it.

    Raises:
        ModelError: the form is damaged or of another version.
    """
    where = "the form"
    if take(document, "version", int, where) != VERSION:
        raise ModelError("", f"the form has another version than {VERSION}")
    period = _check_bounds(take(document, "period", int, where), "period", 0)
    rows = take(document, "nodes", list, where)
    aged = {row.get("value") for row in rows if isinstance(row, dict) and row.get("op") == "age"}
    variables = tuple(
        _variable(item, f"variable {k}", aged=k in aged)
        for k, item in enumerate(take(document, "variables", list, where))
    )
    nodes: list[Node] = []
    for row in rows:
        nodes.append(_node(row, f"node {len(nodes)}", variables, nodes, period))
    outputs = tuple(
        _output(item, f"output {k}", len(nodes))
        for k, item in enumerate(take(document, "outputs", list, where))
    )
    if not outputs or len({output.id for output in outputs}) != len(outputs):
        raise ModelError("", "the outputs are none, or two have one id")
    return Form(period, variables, tuple(nodes), outputs)


def used_variables(form: Form) -> list[list[int]]:
    """Return for each output the numbers of the variables that it depends on, in order."""
    masks: list[int] = []  # of each node, whose operands are before it
    for node in form.nodes:
        mask = 1 << int(node.value) if node.op in ("variable", "age") else 0
        for k in node.args:
            mask |= masks[k]
        masks.append(mask)
    count = range(len(form.variables))
    return [[k for k in count if masks[output.node] >> k & 1] for output in form.outputs]


def _check_bounds(value: int, name: str, least: int) -> int:
    if not least <= value <= MAX_NS:
        raise ModelError("", f"{name} {value} is out of bounds")
    return value


def _finite(value: Any, where: str) -> float:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise ModelError("", f"{where} is not a finite number")


def _variable(item: Any, where: str, *, aged: bool) -> Variable:
    kind = take(item, "type", str, where)
    if kind not in TYPES:
        raise ModelError("", f"{where} has the unknown type {kind!r}")
    limits = item.get("range")
    if limits is not None:
        if not isinstance(limits, list) or len(limits) != 2:
            raise ModelError("", f"'range' of {where} is not a pair of numbers")
        limits = (_finite(limits[0], where), _finite(limits[1], where))
    timeout = item.get("timeout")
    if timeout is not None:
        _check_bounds(take(item, "timeout", int, where), "timeout", 1)
    literals = item.get("literals", [])
    if not isinstance(literals, list) or not all(isinstance(one, str) for one in literals):
        raise ModelError("", f"'literals' of {where} is not a list of texts")
    reduction = item.get("reduction")
    return Variable(
        name=take(item, "name", str, where),
        type=kind,
        range=limits,
        timeout=timeout,
        infinite=item.get("infinite") is True,
        literals=tuple(literals),
        stamped=aged or timeout is not None,
        text=item.get("text") is True,
        reduction=None if reduction is None else read_reduction(reduction, where),
    )


def _node(
    row: Any, where: str, variables: Sequence[Variable], before: Sequence[Node], period: int
) -> Node:
    op = take(row, "op", str, where)
    args = tuple(row.get("args", []))
    if not all(type(k) is int and 0 <= k < len(before) for k in args):
        raise ModelError("", f"{where} works on a node that is not before it")
    at = row.get("at", [0, 0])
    if not isinstance(at, list) or len(at) != 2 or not all(type(k) is int for k in at):
        raise ModelError("", f"'at' of {where} is not a pair of numbers")
    more: dict[str, Any] = {"window": 0, "capacity": 0, "coverage": None, "infinite": False}
    if op in LEAVES:
        kind, value = _leaf(op, row, where, variables)
        more["infinite"] = op == "variable" and variables[value].infinite
    elif op in SIGNATURES:
        kinds, kind = SIGNATURES[op]
        if tuple(before[k].type for k in args) != kinds:
            raise ModelError("", f"the arguments of {where} are not of the types of {op}")
        value = _index(row, where, len(variables)) if op == "age" else None
        more["infinite"] = op in KEEPS_INFINITY and any(before[k].infinite for k in args)
        if op in WINDOWS:
            more.update(_window(op, row, where, period))
    else:
        raise ModelError("", f"{where} has the unknown operation {op!r}")
    return Node(op=op, args=args, type=kind, value=value, at=(at[0], at[1]), **more)


def _leaf(op: str, row: Any, where: str, variables: Sequence[Variable]) -> tuple[str, Any]:
    if op == "variable":
        k = _index(row, where, len(variables))
        return variables[k].type, k
    if op == "number":
        value = row.get("value")
        return NUMBER, None if value is None else _finite(value, where)
    if op == "truth":
        return BOOL, _index(row, where, 3)
    return ENUM, _index(row, where, 1 << 16)


def _index(row: Any, where: str, end: int) -> int:
    k: int = take(row, "value", int, where)
    if not 0 <= k < end:
        raise ModelError("", f"'value' of {where} is out of bounds")
    return k


def _window(op: str, row: Any, where: str, period: int) -> dict[str, Any]:
    length = _check_bounds(take(row, "window", int, where), "window", max(1, period))
    found: dict[str, Any] = {"window": length}
    if period == 0:
        raise ModelError("", f"{where} has a window, but there is no period")
    if op in BUFFERED:
        found["capacity"] = take(row, "capacity", int, where)
        if not 2 <= found["capacity"] <= MAX_CAPACITY:
            raise ModelError("", f"'capacity' of {where} is out of bounds")
        if row.get("coverage") is not None:
            found["coverage"] = _finite(row["coverage"], where)
    return found


def _output(item: Any, where: str, nodes: int) -> Output:
    node = take(item, "node", int, where)
    if not 0 <= node < nodes:
        raise ModelError("", f"{where} is not among the nodes")
    return Output(take(item, "id", str, where), node, item.get("polarity") == "HAZARD")
