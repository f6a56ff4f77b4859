"""Nodes of a YAML document, and the meaning of a scalar at its place in YAML 1.2."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property

from eddi_scaffold.common.problems import Place

MAX_DIGITS = 64
_BOOLEANS = {word: word[0] in "tT" for word in ("true", "True", "TRUE", "false", "False", "FALSE")}
_DECIMAL = re.compile(r"[-+]?(?!0[0-9])(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]*)")
_NULLS = frozenset({"", "~", "null", "Null", "NULL"})
_OTHER_BASE = re.compile(r"0x[0-9a-fA-F]+|0o[0-7]+")
_SPECIAL = re.compile(r"(?P<sign>[-+]?)\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


@dataclass(frozen=True)
class Scalar:
    """A text in a document.

    Attributes:
        text: content without quotes and escapes.
        plain: written without quotes, so that its form may determine its type.
    """

    text: str
    plain: bool
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Items:
    """A list."""

    items: tuple[Node, ...]
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Map:
    """A map; of a repeated key the first entry is kept.

    Attributes:
        entries: key and value in the order of the file.
    """

    entries: tuple[tuple[Scalar, Node], ...]
    place: Place = field(default=Place(), compare=False)

    def get(self, key: str) -> Node | None:
        """Return the value of a key, ``None`` when it is absent."""
        return self._values.get(key)

    @cached_property
    def _values(self) -> dict[str, Node]:
        return {name.text: value for name, value in reversed(self.entries)}

    def keys(self) -> list[str]:
        """Return the keys in the order of the file."""
        return [name.text for name, _ in self.entries]


Node = Scalar | Items | Map


@dataclass(frozen=True)
class Number:
    """A number as written, beside its double: comparisons stay exact."""

    text: str
    value: float


def describe(node: Node) -> str:
    """Describe the kind of a node, for messages."""
    if isinstance(node, Items):
        return "a list"
    if isinstance(node, Map):
        return "a map"
    if is_null(node):
        return "nothing (null)"
    if not node.plain:
        return f"the quoted text {shown(node.text)}"
    if as_number(node) is not None or as_bool(node) is not None:
        return node.text
    return f"the text {shown(node.text)}"


def shown(text: str) -> str:
    """Return a text in quotes for a message, shortened where it is long."""
    return repr(text if len(text) <= 60 else f"{text[:57]}...")


def is_null(node: Node) -> bool:
    """Return whether a node is a plain ``null`` or empty."""
    return isinstance(node, Scalar) and node.plain and node.text in _NULLS


def as_text(node: Node) -> str | None:
    """Return the text of a scalar other than null, ``None`` for anything else."""
    return node.text if isinstance(node, Scalar) and not is_null(node) else None


def as_number(node: Node) -> Number | None:
    """Return the number that a plain scalar is in YAML 1.2 (may be NaN).

    ``None`` for anything else, and for numbers that no double can hold or that have more than
    :data:`MAX_DIGITS` characters: exact arithmetic with ``1e999999999`` would not end.
    """
    if not isinstance(node, Scalar) or not node.plain:
        return None
    text = node.text
    if len(text) > MAX_DIGITS:
        return None
    if _DECIMAL.fullmatch(text):
        return _decimal(text)
    if _OTHER_BASE.fullmatch(text):
        return _decimal(str(int(text, 0)))
    special = _SPECIAL.fullmatch(text)
    if special is None:
        return None
    if special["sign"] is None:
        return Number("nan", float("nan"))
    sign = special["sign"].replace("+", "")
    return Number(f"{sign}inf", float(f"{sign}inf"))


def _decimal(text: str) -> Number | None:
    value = float(text)
    too_large = value in (float("inf"), float("-inf"))
    too_small = value == 0.0 and re.search("[1-9]", re.split("[eE]", text)[0])
    return None if too_large or too_small else Number(text, value)


def as_bool(node: Node) -> bool | None:
    """Return the Boolean that a plain scalar is in YAML 1.2, ``None`` for others."""
    return _BOOLEANS.get(node.text) if isinstance(node, Scalar) and node.plain else None


def as_integer(node: Node) -> int | None:
    """Return the decimal integer (up to 18 digits) that a plain scalar is, ``None`` for others."""
    if not isinstance(node, Scalar) or not node.plain or not _INTEGER.fullmatch(node.text):
        return None
    return int(node.text) if len(node.text) <= 19 else None


def value_12(node: Scalar) -> str | int | float | bool | None:
    """Return the value of a plain scalar as YAML 1.2 has it."""
    if is_null(node):
        return None
    truth, number = as_bool(node), as_number(node)
    if truth is not None:
        return truth
    if number is None:
        return node.text
    whole = as_integer(node)
    is_whole = whole is not None or _OTHER_BASE.fullmatch(node.text)
    return int(number.text) if is_whole else number.value
