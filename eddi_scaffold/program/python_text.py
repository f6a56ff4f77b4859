"""Python text that a reviewer reads: names, literals, comments, and brackets that fit a line.

Nothing of a model is written bare but plain ASCII identifiers: other texts are literals, in which
everything else is escaped, and comments, from which everything else is left out.
"""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

WIDTH = 120
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,39}")
_LONGEST_COMMENT = 70
_SHORT = WIDTH - 25  # what fits a line wherever it stands


class Group(NamedTuple):
    """A bracket with elements: on one line if that fits, else with one element in a line."""

    opening: str  # text up to the bracket, `Input(`
    items: tuple[Item, ...]  # the elements
    closing: str = ")"  # the other bracket


class Item(NamedTuple):
    """An element of a bracket."""

    part: Part  # what it is
    prefix: str = ""  # text before it, `unit=` or `"a": `
    above: str = ""  # comment in a line of its own above it, empty for none
    behind: str = ""  # comment behind it in the same line, empty for none


Part = str | Group


def tuple_of(items: Iterable[Part | Item]) -> Group:
    """Return a tuple."""
    return Group("(", _items(items))


def call(name: str, positional: Iterable[Part], **keywords: Part) -> Group:
    """Return a call."""
    named = [Item(part, f"{key}=") for key, part in keywords.items()]
    return Group(f"{name}(", (*_items(positional), *named))


def literal(value: object) -> Part:
    """Return a value of JSON, or a tuple of such values, as Python text (TypeError: others)."""
    if value is None or isinstance(value, bool):
        return repr(value)
    if isinstance(value, str):
        return text_literal(value)
    if isinstance(value, int):
        return int.__repr__(value)
    if isinstance(value, float):
        return number(value)
    if isinstance(value, tuple):
        return tuple_of(literal(element) for element in value)
    if isinstance(value, list):
        return Group("[", _items(literal(element) for element in value), "]")
    if isinstance(value, dict):
        pairs = (Item(literal(element), f"{text_literal(key)}: ") for key, element in value.items())
        return Group("{", tuple(pairs), "}")
    raise TypeError(f"a {type(value).__name__} has no literal here")


def numbers(values: Iterable[float]) -> Part:
    """Return a tuple of doubles; a short one as a text, since tables have thousands of them."""
    texts = [*map(number, values)]
    flat = f"({', '.join(texts)}{',' if len(texts) == 1 else ''})"
    return flat if len(flat) <= _SHORT else tuple_of(texts)


def text_literal(text: str) -> str:
    """Return the literal of a text: ASCII, in double quotes unless that takes more escapes."""
    quote = "'" if text.count('"') > text.count("'") else '"'
    escaped = text.encode("unicode_escape", "surrogatepass").decode("ascii")
    return quote + escaped.replace(quote, f"\\{quote}") + quote


def number(value: float) -> str:
    """Return the shortest literal that gives the same double; ``INF`` and ``NAN`` by name."""
    text = float.__repr__(value)
    return text.replace("e+", "e") if math.isfinite(value) else text.upper()


def comment(text: str) -> str:
    """Return a text as a comment without the sign: printable ASCII, not longer than a line."""
    plain = " ".join(text.split())
    if not (plain.isascii() and plain.isprintable()):
        plain = "".join(character if " " <= character <= "~" else "?" for character in plain)
    return plain if len(plain) <= _LONGEST_COMMENT else f"{plain[: _LONGEST_COMMENT - 3]}..."


def is_identifier(text: str) -> bool:
    """Return whether a text can be the name of an attribute or a variable as it is."""
    return _IDENTIFIER.fullmatch(text) is not None and not keyword.iskeyword(text)


def variables(ids: Sequence[str], reserved: Collection[str]) -> list[str]:
    """Return a variable for each id: the id itself where that can be, else ``v<number>``."""
    taken = {id_ for id_ in ids if is_identifier(id_)} | set(reserved)
    names = []
    for k, id_ in enumerate(ids):
        name = id_ if is_identifier(id_) and id_ not in reserved else f"v{k}"
        while name != id_ and name in taken:
            name += "_"
        taken.add(name)
        names.append(name)
    return names


def assignment(target: str, part: Part, indent: int, behind: str = "") -> list[str]:
    """Return the lines of ``target = part``, with a comment behind it or, if too long, above."""
    return _lines(Item(part, f"{target} = ", behind=behind), "", indent)


def statement(part: Part, indent: int) -> list[str]:
    """Return the lines of an expression that stands alone."""
    return _lines(Item(part), "", indent)


def returned(part: Part, indent: int, behind: str = "") -> list[str]:
    """Return the lines of ``return part``, with a comment as ``assignment`` has it."""
    return _lines(Item(part, "return ", behind=behind), "", indent)


def unpacked(names: Sequence[str], value: str, indent: int = 8) -> list[str]:
    """Return the lines that take a tuple apart; none for no names."""
    if not names:
        return []
    blanks = " " * indent
    line = f"{blanks}{', '.join(names) if len(names) > 1 else f'({names[0]},)'} = {value}"
    if len(line) <= WIDTH:
        return [line]
    return [f"{blanks}(", *(f"{blanks}    {name}," for name in names), f"{blanks}) = {value}"]


def _items(parts: Iterable[Part | Item]) -> tuple[Item, ...]:
    return tuple(part if isinstance(part, Item) else Item(part) for part in parts)


def _lines(item: Item, end: str, indent: int) -> list[str]:
    blanks = " " * indent
    if isinstance(item.part, Group) and len(item.part.items) == 1 and not item.behind:
        only = item.part.items[0]  # what is said of it is said of all
        group = item.part._replace(items=(only._replace(behind=""),))
        item = item._replace(part=group, behind=only.behind)
    above = [f"{blanks}# {item.above}"] if item.above else []
    behind = f"  # {item.behind}" if item.behind else ""
    flat = _flat(item.part)
    if flat is not None and (
        isinstance(item.part, str) or len(f"{blanks}{item.prefix}{flat}{end}") <= WIDTH
    ):
        line = f"{blanks}{item.prefix}{flat}{end}"
        if behind and len(line + behind) > WIDTH:
            return [*above, f"{blanks}# {item.behind}", line]
        return [*above, line + behind]
    assert isinstance(item.part, Group)
    inner = [line for element in item.part.items for line in _lines(element, ",", indent + 4)]
    first, last = f"{blanks}{item.prefix}{item.part.opening}", f"{blanks}{item.part.closing}{end}"
    return [*above, first + behind, *inner, last]


def _flat(part: Part) -> str | None:
    """Return a part in one line, None when a comment keeps it from that."""
    if isinstance(part, str):
        return part
    texts = []
    for item in part.items:
        flat = _flat(item.part)
        if flat is None or item.above or item.behind:
            return None
        texts.append(item.prefix + flat)
    comma = "," if part.opening == "(" and len(texts) == 1 else ""
    return f"{part.opening}{', '.join(texts)}{comma}{part.closing}"
