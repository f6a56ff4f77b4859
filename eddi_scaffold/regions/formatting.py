"""Tell a formatter's work from a person's: black and ruff must not make every line an edit."""

from __future__ import annotations

import ast
import hashlib
import io
import tokenize
from collections.abc import Collection, Sequence

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
        tree = _Tree()
        meaning = tree.as_text(parse_shallow(text)), *_comments(text, tree.string_lines)
    except (UnicodeDecodeError, SyntaxError, tokenize.TokenError):
        return None
    return hashlib.sha256("\n".join(meaning).encode("utf-8", "surrogatepass")).hexdigest()


class _Tree:
    """A syntax tree as text, without what is empty: later versions of Python have more.

    Attributes:
        string_lines: numbers of the lines that strings of several lines take, seen on the way.
    """

    def __init__(self) -> None:
        self.string_lines: set[int] = set()

    def as_text(self, part: object) -> str:
        """Return a tree, or a part of one, as text."""
        if isinstance(part, list):
            return f"[{','.join([self.as_text(one) for one in part])}]"
        if not isinstance(part, ast.AST):
            return ascii(part)
        if isinstance(part, (ast.Constant, ast.JoinedStr)):
            end = part.end_lineno or part.lineno
            self.string_lines.update(range(part.lineno, end + 1) if end > part.lineno else ())
        if isinstance(part, ast.JoinedStr):  # Python 3.12.1 adds empty text to a format
            part.values = [one for one in part.values if getattr(one, "value", None) != ""]
        kept = []
        for name in part._fields:
            value = getattr(part, name, None)
            if name != "kind" and value is not None and value != []:
                kept.append(f"{name}={self.as_text(value)}")
        return f"{type(part).__name__}({','.join(kept)})"


def _meaning(lines: Sequence[str]) -> tuple[str, list[str]] | None:
    text = framed(lines)
    try:
        tree = parse_shallow(text)
        # The frame belongs to the dump: pieces of different depth are never compared.
        return ast.dump(tree), _comments(text)
    except (SyntaxError, tokenize.TokenError):
        return None


def _comments(text: str, string_lines: Collection[int] | None = None) -> list[str]:
    """Return the comments of a text.

    Args:
        text: Python.
        string_lines: numbers of the lines that strings of several lines take, where they are
            known: that spares most texts from being read token by token.
    """
    found = _plain_comments(text, string_lines) if string_lines is not None else None
    if found is None:
        tokens = tokenize.generate_tokens(io.StringIO(text).readline)
        found = [token.string for token in tokens if token.type == tokenize.COMMENT]
    return [comment.lstrip("# \t") for comment in found]


def _plain_comments(text: str, string_lines: Collection[int]) -> list[str] | None:
    """Return the comments of a text where no ``#`` can be part of a string, else ``None``."""
    if "\r" in text:
        return None
    found = []
    for number, line in enumerate(text.split("\n"), 1):
        before, mark, after = line.partition("#")
        if mark:
            if number in string_lines or '"' in before or "'" in before:
                return None
            found.append(mark + after)
    return found
