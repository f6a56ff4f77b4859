"""Texts of models as parts of other languages, a function for each; Python as a tree."""

from __future__ import annotations

import ast
import json
import re
import warnings

_IN_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_XML = str.maketrans(
    {
        "&": "&amp;",
        "<": "&lt;",
        ">": "&gt;",
        '"': "&quot;",
        "\t": "&#9;",
        "\n": "&#10;",
        "\r": "&#13;",
    }
)
_MARKUP = re.compile(
    r"""[\\`*<>|~&]
    |(?<![^\W_])_|_(?![^\W_])   # inside a word it is not emphasis
    |\](?=[(\[:])               # a link
    |^[#+=-]|^[0-9]+[.)]        # a block""",
    re.VERBOSE,
)


def one_line(text: str) -> str:
    """Fold any text into one line of printable characters, which is no marker of a region."""
    folded = " ".join(text.split()).replace("Manual edit ", "manual edit ")
    return "".join(char if char.isprintable() else "?" for char in folded)


def python_literal(value: object) -> str:
    """Return a text, number, Boolean or None, or a tuple or list of them, as Python in ASCII."""
    return ascii(value)


def python_comment(text: str) -> str:
    """Return text that is safe in a comment or docstring of Python without ending it."""
    return one_line(text).replace("\\", "/").replace('"', "'").replace("'''", "'")


def c_comment(text: str) -> str:
    """Return text that is safe in a block comment of C, and in a docstring of Python."""
    plain = re.sub(r"[^ -~]+", " ", text).replace("\\", "/").replace('"', "'")
    plain = plain.replace("*/", "* /").replace("/*", "/ *")
    plain = plain.replace("Manual edit", "manual edit")  # as in :func:`one_line`
    return re.sub(r"\?(?=\?)", "? ", plain).strip()  # ??/ is a backslash


def xml_text(text: str) -> str:
    """Return text for an element or a quoted attribute; XML has no way to hold some characters."""
    return _IN_XML.sub("?", text).translate(_XML)


def toml_text(text: str) -> str:
    """Return one line as a TOML string; of printable characters, JSON is the same."""
    return json.dumps(one_line(text), ensure_ascii=False)


def markdown_text(text: str) -> str:
    """Return one line that Markdown shows as it is, in a paragraph or in a cell of a table."""
    return _MARKUP.sub(lambda match: f"{match[0][:-1]}\\{match[0][-1]}", one_line(text))


def markdown_code(text: str) -> str:
    """Return one line for between two backticks, also in a table, which both cannot be escaped."""
    return one_line(text).replace("`", "'").replace("|", "¦") or " "


DEEPEST = 150  # levels of a tree that recursive functions of `ast` get through with their callers
_MOST_BITS = 14_000  # of a number that Python writes in decimal digits


def parse_shallow(text: str | bytes) -> ast.Module:
    """Return a syntax tree that ``ast.unparse`` and its neighbours can walk.

    Raises:
        SyntaxError: it is not Python, nested deeper than :data:`DEEPEST`, or has a huge number.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(text)
    except (RecursionError, MemoryError):
        raise SyntaxError("nested too deeply") from None
    except ValueError as problem:
        raise SyntaxError(str(problem)) from None
    level: list[ast.AST] = [tree]
    for _ in range(DEEPEST):
        level = [node for parent in level for node in ast.iter_child_nodes(parent)]
        values = (node.value for node in level if isinstance(node, ast.Constant))
        if any(isinstance(value, int) and value.bit_length() > _MOST_BITS for value in values):
            raise SyntaxError("a number with too many digits")
        if not level:
            return tree
    raise SyntaxError("nested too deeply")
