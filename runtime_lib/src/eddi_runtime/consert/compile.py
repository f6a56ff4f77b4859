"""Compiling a graph to one function: read the inputs, judge them, evaluate, return active flags.

The source text holds generated identifiers and numbers only. Ids, categories and types are in the
function's namespace; attribute names are in the text when they are plain ASCII identifiers
(LOAD_ATTR is several times faster than getattr), else they are read by getattr with a constant.
"""

from __future__ import annotations

import keyword
import math
import re
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

from ..plain_values import type_name
from .graph import Graph
from .values import (
    ABSENT,
    FAULT,
    Absent,
    BinaryLeaf,
    CategoricalLeaf,
    Interval,
    Leaf,
    judge,
)

Step = Callable[[object], Tuple[bool, ...]]
Filter = Callable[[Sequence[int]], Sequence[int]]

STRAIGHT_LINE_LIMIT = 20_000
"""Inputs + edges + gates up to which straight-line code is made.

Compiling takes 15 us each on load, so up to 0.3 s (some 3,000 gates), but 10 s and 2 GB for
300,000. Beyond the limit a loop does the same: 10 times slower per step, but loaded at once.
"""

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_MAX_RANGES = 8
"""Ranges of a leaf that are written out; more are judged by the general function."""


class Record:
    """What the last step saw; explanations and reports are made from it when asked for.

    Attributes:
        raw: values of the attributes, ``Absent`` where one could not be read.
        source: the object they were read from.
        fault_counts: how often each leaf was given a value of a wrong type so far.
    """

    __slots__ = ("fault_counts", "raw", "source")

    def __init__(self, leaves: int) -> None:
        self.raw: Sequence[object] = (ABSENT,) * leaves
        self.source: object = None
        self.fault_counts = [0] * leaves


def compile_step(
    graph: Graph,
    leaves: Sequence[Leaf],
    attributes: Sequence[Tuple[str, str]],
    record: Record,
    apply_filter: Optional[Filter],
    *,
    limit: int = STRAIGHT_LINE_LIMIT,
) -> Step:
    """Return the step function of a graph.

    Args:
        graph: the graph.
        leaves: its leaves by number.
        attributes: (attribute, input id) of each leaf.
        record: what the function writes down in each call.
        apply_filter: truth values of the leaves -> filtered ones; ``None`` for no filter.
        limit: size above which a loop is used instead of straight-line code.
    """
    judges = [_counting(leaf, record.fault_counts, k) for k, leaf in enumerate(leaves)]
    read = _reader(attributes)
    size = len(leaves) + sum(len(node.inputs) + 1 for node in graph.nodes)
    if size > limit:
        return _loop(graph, judges, read, record, apply_filter)
    names: Dict[str, Any] = {
        "read": read,
        "record": record,
        "filtered": apply_filter,
        "INF": math.inf,
        "__builtins__": {"Exception": Exception, "type": type, "float": float, "int": int},
        "text": str,
        "getattr": getattr,
    }
    lines = ["def step(source):", *_reading(attributes, names)]
    if leaves:
        lines.append(f"    {_targets(len(leaves))} = raw")
    for k, leaf in enumerate(leaves):
        names[f"judge{k}"] = judges[k]
        lines.append(f"    v{k} = {_judgement(k, leaf, names)}")
    if apply_filter is not None and leaves:
        targets = _targets(len(leaves))
        lines.append(f"    {targets} = filtered(({targets}))")
    lines += _evaluation(graph)
    exec(compile("\n".join(lines), "<ConSert>", "exec"), names)  # noqa: S102 - our own text
    step: Step = names["step"]
    return step


def compile_rows(ids: Sequence[str]) -> Callable[[Tuple[bool, ...]], List[Dict[str, object]]]:
    """Return flags -> a new list of ``{'id': ..., 'active': ...}`` (SESAME D7.2 Fig 9)."""
    if not 0 < len(ids) <= STRAIGHT_LINE_LIMIT:
        return lambda flags: [{"id": one, "active": flag} for one, flag in zip(ids, flags)]
    names: Dict[str, Any] = {f"id{k}": one for k, one in enumerate(ids)}
    rows = ", ".join(f"{{'id': id{k}, 'active': v{k}}}" for k in range(len(ids)))
    text = f"def rows(flags):\n    {_targets(len(ids))} = flags\n    return [{rows}]"
    exec(compile(text, "<ConSert>", "exec"), names)  # noqa: S102 - our own text
    made: Callable[[Tuple[bool, ...]], List[Dict[str, object]]] = names["rows"]
    return made


def _counting(leaf: Leaf, counts: List[int], k: int) -> Callable[[object], int]:
    def judge_and_count(raw: object) -> int:
        value, why = judge(leaf, raw)
        if why == FAULT:
            counts[k] += 1
        return value

    return judge_and_count


def _reader(attributes: Sequence[Tuple[str, str]]) -> Callable[[object], Tuple[object, ...]]:
    """Return the careful way to read the attributes, one by one; it never raises."""

    def read_one(source: object, attribute: str, input_id: str) -> object:
        try:
            return getattr(source, attribute)
        except AttributeError:
            # An object that was not generated may hold an id that is no identifier as it is.
            return ABSENT if attribute == input_id else read_one(source, input_id, input_id)
        except Exception as problem:  # noqa: BLE001 - a property may raise anything
            return Absent(f"reading it raised {type_name(problem)}")

    return lambda source: tuple([read_one(source, *names) for names in attributes])


def _targets(count: int) -> str:
    return "".join(f"v{k}, " for k in range(count)).rstrip()


def _reading(attributes: Sequence[Tuple[str, str]], names: Dict[str, Any]) -> List[str]:
    parts = []
    for k, (attribute, _) in enumerate(attributes):
        if _IDENTIFIER.fullmatch(attribute) and not keyword.iskeyword(attribute):
            parts.append(f"source.{attribute}, ")
        else:
            names[f"name{k}"] = attribute
            parts.append(f"getattr(source, name{k}), ")
    return [
        "    try:",
        f"        raw = ({''.join(parts)})",
        "    except Exception:",
        "        raw = read(source)",
        "    record.raw = raw",
        "    record.source = source",
    ]


def _judgement(k: int, leaf: Leaf, names: Dict[str, Any]) -> str:
    """Return the expression that judges ``v<k>``: common values here, the rest by the function."""
    value = f"v{k}"
    if isinstance(leaf, BinaryLeaf):
        return (
            f"2 if {value} is True else 0 if {value} is False "
            f"else 1 if {value} is None else judge{k}({value})"
        )
    if isinstance(leaf, CategoricalLeaf):
        names[f"covered{k}"] = leaf.covered
        known = f"2 if {value} in covered{k} else 0"
        return f"({known}) if type({value}) is text else judge{k}({value})"
    if not 0 < len(leaf.ranges) <= _MAX_RANGES:
        return f"judge{k}({value})"
    inside = " or ".join(_inside(value, interval) for interval in leaf.ranges)
    known = f"2 if {inside} else 0 if {value} == {value} else 1"  # NaN is not equal to itself
    return f"({known}) if type({value}) is float or type({value}) is int else judge{k}({value})"


def _inside(value: str, interval: Interval) -> str:
    end = "<=" if interval.closed else "<"
    return f"{_number(interval.start)} <= {value} {end} {_number(interval.end)}"


def _number(value: float) -> str:
    """Return the literal of a double: digits, sign, point and exponent, or a name we chose."""
    if math.isinf(value):
        return "INF" if value > 0 else "-INF"
    return float.__repr__(value)


def _evaluation(graph: Graph) -> List[str]:
    lines: List[str] = []
    held = [f"v{k}" for k in range(graph.leaves)]
    for k, (is_and, inputs) in enumerate(graph.nodes, graph.leaves):
        if k not in graph.needed:
            held.append("")
        elif not inputs:
            held.append("2" if is_and else "0")
        elif len(inputs) == 1:
            held.append(held[inputs[0]])
        else:
            held.append(f"v{k}")
            lines += _extreme(f"v{k}", "<" if is_and else ">", [held[one] for one in inputs])
    flags = "".join(f"{held[k]} == 2, " for k in graph.guarantees)
    return [*lines, f"    return ({flags})"]


def _extreme(target: str, sign: str, values: List[str]) -> List[str]:
    first, second, *rest = values
    lines = [f"    {target} = {first} if {first} {sign} {second} else {second}"]
    return lines + [f"    if {one} {sign} {target}: {target} = {one}" for one in rest]


def _loop(
    graph: Graph,
    judges: Sequence[Callable[[object], int]],
    read: Callable[[object], Tuple[object, ...]],
    record: Record,
    apply_filter: Optional[Filter],
) -> Step:
    def step(source: object) -> Tuple[bool, ...]:
        raw = read(source)
        record.raw = raw
        record.source = source
        values: Sequence[int] = [one(value) for one, value in zip(judges, raw)]
        if apply_filter is not None:
            values = apply_filter(values)
        found = graph.evaluate(values)
        return tuple([found[k] == 2 for k in graph.guarantees])

    return step
