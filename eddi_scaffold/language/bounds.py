"""Between which numbers a value lies, by the declared ranges of variables."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from eddi_scaffold.language.syntax import SyntaxNode

Bounds = tuple[float, float]
_KEPT = ("average", "max", "min", "median")
_COMPARISONS: dict[str, tuple[Callable[[Bounds, Bounds], bool], Callable[[Bounds, Bounds], bool]]]
_COMPARISONS = {
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
    always, never = _COMPARISONS[op]
    return True if always(left, right) else False if never(left, right) else None
