"""Names that a hand-written body assigns and nothing else knows: left over after a rename."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeVar

from eddi_scaffold.regions.document import Region

_Node = TypeVar("_Node", bound=ast.stmt)


def doubtful_names(text: str, regions: Iterable[Region]) -> dict[str, tuple[str, ...]]:
    """Return for each region what its body assigns in vain.

    ``self.x`` that neither the class outside of this region assigns nor anything in it reads, and
    local names that the function never reads. Empty for a file that does not parse.

    Args:
        text: the file.
        regions: its hand-written regions.
    """
    try:
        tree = ast.parse(text.removeprefix("\ufeff"))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return {}
    nodes = list(ast.walk(tree))
    classes = {n: _own_attributes(n) for n in nodes if isinstance(n, ast.ClassDef)}
    functions = [n for n in nodes if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
    found = {}
    for region in regions:
        lines = range(region.line + 1, region.line + region.body.count("\n") + 1)
        owner, function = _innermost(classes, lines), _innermost(functions, lines)
        notes = [*_attributes(classes[owner] if owner else [], lines), *_locals(function, lines)]
        if notes:
            found[region.id] = tuple(dict.fromkeys(notes))
    return found


def _attributes(attributes: Sequence[ast.Attribute], lines: range) -> Iterator[str]:
    known = {node.attr for node in attributes if _reads(node) or node.lineno not in lines}
    for node in attributes:
        if node.attr not in known:
            yield f"'self.{node.attr}' is assigned, but nothing else in the class knows it"


def _locals(function: ast.stmt | None, lines: range) -> Iterator[str]:
    names = [n for n in ast.walk(function) if isinstance(n, ast.Name)] if function else []
    used = {name.id for name in names if _reads(name)}
    for name in names:
        if name.lineno in lines and name.id not in used and name.id[0] != "_":
            yield f"{name.id!r} is assigned, but nothing in the function uses it"


def _own_attributes(owner: ast.ClassDef) -> list[ast.Attribute]:
    return [
        node
        for node in ast.walk(owner)
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "self"
    ]


def _reads(node: ast.Attribute | ast.Name) -> bool:
    return isinstance(node.ctx, ast.Load)


def _innermost(nodes: Iterable[_Node], lines: range) -> _Node | None:
    found = [
        node
        for node in nodes
        if node.lineno < lines.start and (node.end_lineno or 0) >= lines.stop - 1
    ]
    return max(found, key=lambda node: node.lineno, default=None)
