"""Tell a formatter's work from a person's: black and ruff must not make every line an edit."""

from __future__ import annotations

import ast
import io
import tokenize
from collections.abc import Sequence

from .marked_file import split_lines
from .markers import indent_of
from .python_text import parse_shallow


def framed(lines: Sequence[str]) -> str:
    """Return lines as text that parses on its own, whatever their indentation."""
    code = (line for line in lines if line.strip() and not line.lstrip().startswith("#"))
    return ("if True:\n" if indent_of(next(code, "")) else "") + "".join(lines)


def same_meaning(one: Sequence[str], other: Sequence[str]) -> bool:
    """Return whether two pieces of Python differ in their layout only; comments count.

    ``False`` as well where one of them does not parse on its own.
    """
    meaning = _meaning(one)
    return meaning is not None and meaning == _meaning(other)


def same_code(one: str, other: str) -> bool:
    """Return :func:`same_meaning` for texts."""
    return same_meaning(split_lines(one), split_lines(other))


def same_text(name: str, one: bytes, other: bytes) -> bool:
    """Return whether two texts of a file differ at most in line ends and, of Python, in layout."""
    one, other = one.replace(b"\r\n", b"\n"), other.replace(b"\r\n", b"\n")
    if one == other or not name.endswith(".py"):
        return one == other
    try:
        return same_code(one.decode(), other.decode())
    except UnicodeDecodeError:
        return False


def _meaning(lines: Sequence[str]) -> tuple[str, list[str]] | None:
    text = framed(lines)
    try:
        tree = parse_shallow(text)
        tokens = tokenize.generate_tokens(io.StringIO(text).readline)
        comments = [t.string.lstrip("# \t") for t in tokens if t.type == tokenize.COMMENT]
        # The frame belongs to the dump: pieces of different depth are never compared.
        return ast.dump(tree), comments
    except (SyntaxError, tokenize.TokenError):
        return None
