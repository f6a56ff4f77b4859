"""The text between two markers: compare it, and move it with its markers."""

from __future__ import annotations

import io
import textwrap
import tokenize

from .formatting import same_code
from .marked_file import split_lines
from .markers import indent_of


def canonical(body: str) -> str:
    """Return the body without what editors change by themselves.

    Common indentation, blanks at line ends, carriage returns and blank lines at both ends.
    """
    lines = [line.rstrip() for line in body.split("\n")]
    return textwrap.dedent("\n".join(lines)).strip("\n")


def same_body(one: str, other: str) -> bool:
    """Return whether two bodies differ at most in what editors and formatters change."""
    return canonical(one) == canonical(other) or (
        not is_empty(one) and same_code(canonical(one), canonical(other))
    )


def is_empty(body: str) -> bool:
    """Return whether a body holds nothing worth keeping: blanks or a bare ``pass``."""
    return canonical(body).strip() in {"", "pass"}


def reindent(body: str, old: str, new: str, *, python: bool) -> str:
    """Return the body moved from one indentation to another; unchanged when nothing moves.

    Args:
        body: the text between the markers.
        old: the blanks before the begin marker where the body was written.
        new: the blanks before the begin marker where it goes.
        python: lines inside of a multi-line string keep their place, and the indentation of the
            code itself counts, because an editor may have stripped the marker's.
    """
    if old == new:
        return body
    lines = split_lines(body)
    fixed = _inside_strings(body) if python else frozenset()
    movable = [i for i, line in enumerate(lines) if line.strip() and i not in fixed]
    if python:
        code = (indent_of(lines[i]) for i in movable if not lines[i].lstrip().startswith("#"))
        old = next(code, old)
    for i in movable if old != new else ():
        if lines[i].startswith(old):
            lines[i] = new + lines[i][len(old) :]
    return "".join(lines)


def _inside_strings(body: str) -> frozenset[int]:
    """Return the lines that begin inside of a multi-line string."""
    found: set[int] = set()
    source = "if x:\n" + textwrap.indent(textwrap.dedent(body), " ", lambda _: True)
    try:
        opened: list[int] = []
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            name = tokenize.tok_name[token.type]
            if name in {"FSTRING_START", "TSTRING_START"}:  # Python 3.12 and later
                opened.append(token.start[0])
            first = token.start[0]
            if name in {"FSTRING_END", "TSTRING_END"}:
                first = opened.pop()
            if token.type == tokenize.STRING or name.endswith("STRING_END"):
                found.update(range(first - 1, token.end[0] - 1))
    except (tokenize.TokenError, SyntaxError, IndexError):
        return frozenset(found)
    return frozenset(found)
