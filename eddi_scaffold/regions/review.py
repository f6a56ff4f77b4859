"""Names that a hand-written body assigns and nothing else knows: left over after a rename."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TypeGuard

from eddi_scaffold.regions.markers import Document, Region

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def doubtful_names(text: str, document: Document) -> dict[str, tuple[str, ...]]:
    """Return for each region what its body assigns in vain.

    ``self.x`` that neither the class outside of this region assigns nor anything in it reads, and
    local names that the function never reads. Empty for a file that does not parse.

    Args:
        text: the file.
        document: the file split at its markers.
    """
    try:
        tree = ast.parse(text.removeprefix("\ufeff"))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return {}
    found = {}
    for region in document.regions.values():
        notes = tuple(dict.fromkeys(_notes(tree, region)))
        if notes:
            found[region.id] = notes
    return found


def _notes(tree: ast.Module, region: Region) -> Iterator[str]:
    first, last = region.line, region.line + region.body.count("\n")
    owner = _innermost(tree, first, last, (ast.ClassDef,))
    function = _innermost(tree, first, last, _FUNCTIONS)
    if owner is not None:
        attributes = [n for n in ast.walk(owner) if _is_own(n)]
        known = {n.attr for n in attributes if _reads(n) or not first < n.lineno <= last}
        for node in attributes:
            if node.attr not in known:
                yield f"'self.{node.attr}' is assigned, but nothing else in the class knows it"
    if function is not None:
        names = [n for n in ast.walk(function) if isinstance(n, ast.Name)]
        used = {n.id for n in names if _reads(n)}
        for name in names:
            if first < name.lineno <= last and name.id not in used and name.id[0] != "_":
                yield f"{name.id!r} is assigned, but nothing in the function uses it"


def _is_own(node: ast.AST) -> TypeGuard[ast.Attribute]:
    return (
        isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "self"
    )


def _reads(node: ast.Attribute | ast.Name) -> bool:
    return isinstance(node.ctx, ast.Load)


def _innermost(
    tree: ast.Module, first: int, last: int, kinds: tuple[type[ast.stmt], ...]
) -> ast.stmt | None:
    found = [
        node
        for node in ast.walk(tree)
        if isinstance(node, kinds) and node.lineno <= first and (node.end_lineno or 0) >= last
    ]
    return max(found, key=lambda node: node.lineno, default=None)
