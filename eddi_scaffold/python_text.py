"""Python text as a syntax tree: whatever the text holds, the only error is a SyntaxError."""

from __future__ import annotations

import ast
import warnings

DEEPEST = 150
"""Levels of a tree that recursive functions of ``ast`` get through with their callers."""
_MOST_BITS = 14_000  # of a number that Python writes in decimal digits


def parse_python(text: str | bytes) -> ast.Module:
    """Return the syntax tree of a text, however deep.

    Raises:
        SyntaxError: the text is not Python, or nested deeper than Python reads.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text)
    except (RecursionError, MemoryError):
        raise SyntaxError("nested too deeply") from None
    except ValueError as problem:
        raise SyntaxError(str(problem)) from None


def parse_shallow(text: str | bytes) -> ast.Module:
    """Return a syntax tree that ``ast.unparse`` and its neighbours can walk.

    Raises:
        SyntaxError: the text is not Python, nested deeper than :data:`DEEPEST`, or holds a number
            of thousands of digits.
    """
    tree = parse_python(text)
    level: list[ast.AST] = [tree]
    for _ in range(DEEPEST):
        level = [node for parent in level for node in ast.iter_child_nodes(parent)]
        if any(_is_huge(node) for node in level):
            raise SyntaxError("a number with too many digits")
        if not level:
            return tree
    raise SyntaxError("nested too deeply")


def _is_huge(node: ast.AST) -> bool:
    value = node.value if isinstance(node, ast.Constant) else None
    return isinstance(value, int) and value.bit_length() > _MOST_BITS
