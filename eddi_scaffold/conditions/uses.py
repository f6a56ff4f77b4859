"""Which values of its variables can make a condition true, or false.

A condition that claims something good must not gain from a value that also means "nothing is
known". This walk collects, for each variable, the tests that its value may pass on the way to the
claim, with the sign of everything above it: ``NOT``, the left side of ``IMPLIES``.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import eq, ge, gt, le, lt, ne
from typing import Any

from eddi_scaffold.common.claims import Holds, Use
from eddi_scaffold.conditions.syntax import SyntaxNode

_COMPARISONS: Mapping[str, Callable[[Any, Any], bool]] = {
    "lt": lt, "le": le, "gt": gt, "ge": ge, "eq": eq, "ne": ne,
    "eq_bool": eq, "ne_bool": ne, "eq_enum": eq, "ne_enum": ne,
}  # fmt: skip
_TURNED = {"lt": "gt", "le": "ge", "gt": "lt", "ge": "le"}
_MAX_VISITS = 20_000


def uses(form: Mapping[str, Any], root: int, *, wanted: bool) -> dict[str, tuple[Use, ...]]:
    """Return the uses of each variable that can make a condition true, or false.

    Args:
        form: intermediate form (``Analysis.form``).
        root: number of the condition's node.
        wanted: the side that claims something.
    """
    found: dict[str, tuple[Use, ...]] = {}
    for variable, use in _Walk(form).uses(root, wanted=wanted):
        found[variable] = (*found.get(variable, ()), use)
    return found


class _Walk:
    def __init__(self, form: Mapping[str, Any]) -> None:
        self._nodes: Sequence[Mapping[str, Any]] = form["nodes"]
        self._variables: Sequence[Mapping[str, Any]] = form["variables"]

    def uses(self, root: int, *, wanted: bool) -> Iterator[tuple[str, Use]]:
        """Walk down from a node; a shared node is visited once for each way that matters."""
        waiting: list[tuple[int, bool, tuple[tuple[str, Holds], ...]]] = [(root, wanted, ())]
        seen: set[tuple[object, ...]] = set()
        while waiting:
            number, sign, beside = waiting.pop()
            if len(seen) > _MAX_VISITS:
                beside = ()  # the other operands only excuse, so leaving them out is safe
            key = (number, sign, beside)
            if key in seen:
                continue
            seen.add(key)
            test = self._test(number, sign)
            if test is not None:
                yield test[0], Use(test[1], beside)
                continue
            node = self._nodes[number]
            parts = self._parts(number, sign)
            if parts != [(number, sign)]:
                tests = (self._test(part, side) for part, side in parts)
                group = (*beside, *(one for one in tests if one is not None))
                waiting += [(part, side, group) for part, side in parts]
            elif (counted := self._counted(node)) is not None:
                arg, more = counted
                waiting.append((arg, sign == more, ()))
            elif node["op"] in _SIGNS:
                signs = _SIGNS[node["op"]]
                waiting += [
                    (arg, sign == same, beside if node["op"] in _NOW else ())
                    for arg, same in zip(node["args"], signs, strict=True)
                ]
            elif node["op"] not in _SILENT:
                yield from self._anything(number)

    def _parts(self, root: int, sign: bool) -> list[tuple[int, bool]]:
        """Return what must all hold: the operands of AND, or of OR where false is wanted."""
        found: list[tuple[int, bool]] = []
        waiting = [(root, sign)]
        while waiting:
            number, side = waiting.pop()
            node = self._nodes[number]
            op, args = node["op"], node.get("args", ())
            if op == "not":
                waiting.append((args[0], not side))
            elif op == ("and" if side else "or"):
                waiting += [(arg, side) for arg in reversed(args)]
            elif op == "implies" and not side:
                waiting += [(args[1], False), (args[0], True)]
            else:
                found.append((number, side))
        return list(dict.fromkeys(found))

    def _test(self, number: int, sign: bool) -> tuple[str, Holds] | None:
        """Return the variable and the test of a node that tests one variable, else ``None``."""
        node = self._nodes[number]
        while node["op"] == "not":
            node, sign = self._nodes[node["args"][0]], not sign
        if self._is_plain(node) and self._variables[node["value"]]["type"] == "bool":
            return self._name(node), lambda value: value is sign
        if node["op"] not in _COMPARISONS:
            return None
        op, (left, right) = node["op"], (self._nodes[arg] for arg in node["args"])
        if right["op"] == "variable":
            left, right, op = right, left, _TURNED.get(op, op)
        if not self._is_plain(left) or right["op"] not in ("number", "truth", "literal"):
            return None
        compare, limit = _COMPARISONS[op], self._constant(left, right)
        return self._name(left), lambda value: _compared(compare, value, limit) is sign

    def _constant(self, variable: Mapping[str, Any], constant: Mapping[str, Any]) -> object:
        if constant["op"] == "truth":
            return constant["value"] == 2
        if constant["op"] == "literal":
            return self._variables[variable["value"]]["literals"][constant["value"]]
        return constant["value"]

    def _anything(self, root: int) -> Iterator[tuple[str, Use]]:
        """Return every variable below a node, in any value."""
        for node in nodes_below(self._nodes, root, _SILENT):
            if node["op"] == "variable":
                yield from ((name, Use()) for name in inputs_of(self._variables[node["value"]]))

    def _counted(self, node: Mapping[str, Any]) -> tuple[int, bool] | None:
        """Return what a comparison counts, and whether more of it brings the comparison about."""
        op = node["op"]
        if op not in _TURNED:
            return None
        left, right = (self._nodes[arg] for arg in node["args"])
        if right["op"] == "count":
            left, right, op = right, left, _TURNED[op]
        if left["op"] != "count" or right["op"] != "number":
            return None
        return left["args"][0], op in ("gt", "ge")

    def _is_plain(self, node: Mapping[str, Any]) -> bool:
        """Return whether a node is a variable, and no reduction of a list."""
        return node["op"] == "variable" and "reduction" not in self._variables[node["value"]]

    def _name(self, node: Mapping[str, Any]) -> str:
        name: str = self._variables[node["value"]]["name"]
        return name


def _compared(compare: Callable[[Any, Any], bool], value: object, limit: object) -> bool | None:
    try:
        return compare(value, limit)
    except TypeError:  # a text compared with a number is unknown, which is neither true nor false
        return None


_SIGNS: Mapping[str, tuple[bool, ...]] = {
    "not": (False,),
    "and": (True, True),
    "or": (True, True),
    "implies": (False, True),
    "time": (True,),
    "once": (True,),
    "latch": (True, False),
}
"""Operation -> for each operand, whether more of it makes more of the result."""
_NOW = ("not", "and", "or", "implies")
"""Those whose operands count at the time of the result, so that the other operands do."""
_SILENT = ("number", "truth", "literal", "known", "known_bool", "known_enum", "age")
"""Constants, and what only asks whether something is known: reported as an acceptance."""


def inputs_of(variable: Mapping[str, Any]) -> Sequence[str]:
    """Return the names of what a variable of a form is read from: of a reduction, its lists."""
    reduction = variable.get("reduction")
    if reduction is None:
        return [variable["name"]]
    return [input_["name"] for input_ in reduction["inputs"]]


def nodes_below(
    nodes: Sequence[Mapping[str, Any]], root: int, ends: Container[str] = ()
) -> Iterator[Mapping[str, Any]]:
    """Yield a node of a form and all below it, each once, in the order of the text.

    Args:
        nodes: of the form.
        root: where to begin.
        ends: operations whose arguments are left out.
    """
    waiting, seen = [root], set()
    while waiting:
        number = waiting.pop()
        if number in seen:
            continue
        seen.add(number)
        node = nodes[number]
        yield node
        if node["op"] not in ends:
            waiting += reversed(node.get("args", ()))


@dataclass(frozen=True)
class Silence:
    """What a condition accepts of silence.

    Attributes:
        word: as in the text.
        accepts: what counts in place of what is not known.
        seconds: how long, ``None`` where only the text states it.
        at: line and column.
    """

    word: str
    accepts: str
    seconds: float | None
    at: tuple[int, int]


def accepted(form: Mapping[str, Any], root: int) -> list[Silence]:
    """Return what a condition accepts of silence.

    ``KNOWN`` and ``AGE`` take silence as an argument, ``COVERAGE`` a share of the samples for all
    of them, ``ALLOW INF`` an infinite value. Where the definition of the message makes infinity a
    measurement, nothing is missing: what is missing is NaN or no message there, hence UNKNOWN.
    """
    found: dict[Silence, None] = {}
    for node in nodes_below(form["nodes"], root):
        op, at = node["op"], (node["at"][0], node["at"][1])
        variable = form["variables"][node["value"]] if op == "variable" else {}
        coverage = node.get("coverage") or variable.get("reduction", {}).get("coverage")
        if op in ("known", "known_bool", "known_enum", "age"):
            word = op.partition("_")[0].upper()
            found[Silence(word, "silence itself as an argument", None, at)] = None
        elif coverage is not None and coverage < 1:
            window = node["window"] / 1e9 if "window" in node else None
            of = "elements" if window is None else "samples"
            text = f"{coverage:.0%} of the {of} for all of them"
            found[Silence(f"COVERAGE {coverage:g}", text, window, at)] = None
        if variable.get("infinite") and not variable.get("defined"):
            found[Silence("ALLOW INF", "an infinite value", None, at)] = None
    return list(found)


def lasts(silence: Silence) -> str:
    """Describe how long it lasts."""
    return "as its text states" if silence.seconds is None else f"for {silence.seconds:g} s"


Bounds = tuple[float, float]
_KEPT = ("average", "max", "min", "median")
_INTERVAL_COMPARISONS: dict[
    str, tuple[Callable[[Bounds, Bounds], bool], Callable[[Bounds, Bounds], bool]]
]
_INTERVAL_COMPARISONS = {
    "lt": (lambda a, b: a[1] < b[0], lambda a, b: a[0] >= b[1]),
    "le": (lambda a, b: a[1] <= b[0], lambda a, b: a[0] > b[1]),
    "gt": (lambda a, b: a[0] > b[1], lambda a, b: a[1] <= b[0]),
    "ge": (lambda a, b: a[0] >= b[1], lambda a, b: a[1] < b[0]),
    "eq": (lambda _a, _b: False, lambda a, b: a[1] < b[0] or a[0] > b[1]),
    "ne": (lambda a, b: a[1] < b[0] or a[0] > b[1], lambda _a, _b: False),
}
"""Comparison -> when it is true of all values between two bounds, and when of none."""


def bounds(
    nodes: Sequence[SyntaxNode], node: SyntaxNode, range_of: Callable[[str], Bounds | None]
) -> Bounds | None:
    """Return between which numbers an expression lies, ``None`` where that is not known.

    Args:
        nodes: of the text.
        node: the root of the expression.
        range_of: name of a variable -> its range.
    """
    signs = []
    while node.op in (*_KEPT, "neg", "abs"):
        signs += [node.op] if node.op in ("neg", "abs") else []
        node = nodes[node.args[0]]
    found = range_of(node.text) if node.op == "name" else None
    for op in reversed(signs):
        if found is not None:
            low, high = found
            least = 0.0 if low <= 0 <= high else min(abs(low), abs(high))
            found = (-high, -low) if op == "neg" else (least, max(abs(low), abs(high)))
    return found


def decided(op: str, left: Bounds | None, right: Bounds | None) -> bool | None:
    """Return what a comparison always is, ``None`` where the values decide."""
    if left is None or right is None:
        return None
    always, never = _INTERVAL_COMPARISONS[op]
    return True if always(left, right) else False if never(left, right) else None
