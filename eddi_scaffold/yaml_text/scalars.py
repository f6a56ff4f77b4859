"""Characters that a word processor puts in place of those that YAML knows."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass, field
from functools import cached_property

from eddi_scaffold.common.problems import Place

_QUOTES = "\u201c\u201d\u201e\u201f\u00ab\u00bb\u2018\u2019\u201a\u201b\u2039\u203a"
_DASHES = "\u2010\u2011\u2012\u2013\u2014\u2212"
_SPACES = "\u00a0\u2002\u2003\u2007\u2009\u202f\u3000"
_NOTHING = "\u200b\u2060\ufeff"
_TYPED = {
    _QUOTES: 'type " or nothing',
    _DASHES: "type -",
    _SPACES: "type a space",
    _NOTHING: "delete",
}
_BLANK = f"[{_SPACES}{_NOTHING}]"
_MEANT_FOR_YAML = re.compile(
    rf"^ *(?P<indent>{_BLANK})|[-:,\[{{] *(?P<after>{_BLANK})|(?P<before>{_BLANK}) *:"
    rf"|^ *(?P<item>[{_DASHES}])[ {_SPACES}]|(?:^|[-:,\[{{]) *(?P<quote>[{_QUOTES}])"
)
_COMMENT = re.compile(r"(^|[ \t])#.*")


def advice(text: str) -> str | None:
    """Return what to type in place of the first such character of a text, ``None`` without one."""
    return next((found for char in text if (found := _advice(char)) is not None), None)


def misplaced(line: str) -> tuple[int, str] | None:
    """Return where a line has one in the place of a sign of YAML, from 0, and what to type."""
    match = _MEANT_FOR_YAML.search(_COMMENT.sub("", line))
    if match is None:
        return None
    at = match.start(match.lastgroup or 0)
    return at, _advice(line[at]) or ""


def _advice(char: str) -> str | None:
    typed = next((words for chars, words in _TYPED.items() if char in chars), None)
    if typed is None:
        return None
    name = unicodedata.name(char).lower()
    seen = "" if char in _SPACES + _NOTHING else f" {char}"
    place = "" if char in _NOTHING else " in place of"
    return f"{typed}{place}{seen} U+{ord(char):04X}, {name}"


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
    is_value = as_number(node) is not None or as_bool(node) is not None
    if is_value:
        return node.text
    odd = advice(node.text)
    return f"the text {shown(node.text)}" + (f" ({odd})" if odd else "")


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
