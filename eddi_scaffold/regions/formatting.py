"""Tell a formatter's work from a person's: black and ruff must not make every line an edit."""

from __future__ import annotations

import ast
import hashlib
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


def meaning_digest(data: bytes) -> str | None:
    """Return the SHA-256 of what a Python file says, in any layout; comments count.

    The same on every version of Python; ``None`` where the file does not parse.
    """
    try:
        text = data.decode()
        meaning = _as_text(parse_shallow(text)), *_comments(text)
    except (UnicodeDecodeError, SyntaxError, tokenize.TokenError):
        return None
    return hashlib.sha256("\n".join(meaning).encode("utf-8", "surrogatepass")).hexdigest()


def _as_text(part: object) -> str:
    """Return a syntax tree as text, without what is empty: later versions of Python have more."""
    if isinstance(part, list):
        return f"[{','.join(map(_as_text, part))}]"
    if not isinstance(part, ast.AST):
        return ascii(part)
    if isinstance(part, ast.JoinedStr):  # Python 3.12.1 adds empty text to a format
        part.values = [one for one in part.values if getattr(one, "value", None) != ""]
    fields = ((name, getattr(part, name, None)) for name in part._fields if name != "kind")
    kept = (f"{name}={_as_text(value)}" for name, value in fields if value not in (None, []))
    return f"{type(part).__name__}({','.join(kept)})"


def _meaning(lines: Sequence[str]) -> tuple[str, list[str]] | None:
    text = framed(lines)
    try:
        tree = parse_shallow(text)
        # The frame belongs to the dump: pieces of different depth are never compared.
        return ast.dump(tree), _comments(text)
    except (SyntaxError, tokenize.TokenError):
        return None


def _comments(text: str) -> list[str]:
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return [t.string.lstrip("# \t") for t in tokens if t.type == tokenize.COMMENT]
