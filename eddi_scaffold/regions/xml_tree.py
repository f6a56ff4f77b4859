"""XML text, a manifest or a launch file, as a tree of elements with their lines."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from itertools import accumulate
from xml.parsers import expat

from .items import Item, Leaf, Piece, items_of, numbered
from .marked_file import placeholder_id

_DEEPEST = 40
_MARKUP = re.compile(
    r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[.*?\]\]>"
    r"|<(?P<end>/?)(?P<tag>[^\s/>!?]+)(?P<rest>(?:[^\"'>]|\"[^\"]*\"|'[^']*')*)>",
    re.DOTALL,
)
_OPENED, _CLOSED = re.compile(r"<([^\s/>!?]+)"), re.compile(r"</([^\s>]+)")
_ATTRIBUTE = re.compile(r"([^\s=]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
_NAMES = {"node": ("type", "name"), "test": ("test-name", "name")}
_ANY_NAME = ("name", "file", "from", "ns")


def split(lines: Sequence[str]) -> tuple[Item, ...]:
    """Return the elements of a document; their lines joined give the input again.

    Raises:
        SyntaxError: it is not well-formed, or has a document type.
    """
    text = "".join(lines)
    _check(text)
    root = _pieces(text, lines)
    start = (Leaf("<prolog>", tuple(lines[: root.start])),) if root.start else ()
    end = (Leaf("<tail>", tuple(lines[root.stop + 1 :])),) if root.stop + 1 < len(lines) else ()
    return (*start, *numbered(items_of([root], lines, root.start, _DEEPEST)), *end)


def parses(lines: Sequence[str]) -> bool:
    """Return whether lines are whole elements, or what opens or closes one."""
    text = "".join(lines)
    forms = [f"<r>{text}</r>", f"{text}<r/>"]
    opened, closed = _OPENED.search(text), _CLOSED.search(text)
    forms += [f"<r>{text}</{opened[1]}></r>"] if opened else []
    forms += [f"<{closed[1]}>{text}"] if closed else []
    return any(map(_is_well_formed, forms))


def lead(lines: Sequence[str]) -> int:
    """Return how many comments and blank lines are above the first other line."""
    inside = False
    for number, line in enumerate(lines):
        rest = line.strip()
        while rest and (inside or rest.startswith("<!--")):
            _, sign, rest = rest.partition("-->")
            inside, rest = not sign, rest.strip()
        if rest:
            return number
    return 0


def _check(text: str) -> None:
    def refuse(*_: object) -> None:
        raise SyntaxError("a document type")

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(text.encode(), True)
    except (expat.ExpatError, ValueError) as problem:
        raise SyntaxError(str(problem)) from None


def _is_well_formed(text: str) -> bool:
    try:
        _check(text)
    except SyntaxError:
        return False
    return True


def _pieces(text: str, lines: Sequence[str]) -> Piece:
    starts = list(accumulate((len(line) for line in lines), initial=0))[: len(lines)]

    def line_of(place: int) -> int:
        return bisect_right(starts, place) - 1

    top = Piece("", 0, 0)
    open_: list[Piece] = [top]
    at = 0
    for markup in _MARKUP.finditer(text):
        around, first, last = open_[-1], line_of(markup.start()), line_of(markup.end() - 1)
        _take_text(around, text[at : markup.start()], line_of(at))
        words = text[at : markup.start()].strip()
        at = markup.end()
        if markup["tag"] is None:
            around.solid |= markup[0].startswith("<![")
            if around.inner and around.inner[-1].stop == first:
                around.inner[-1].extend(last)
            elif around.opened == first:
                around.opened = last
        elif markup["end"]:
            around.closes, around.stop = first, last
            if around.key.endswith("depend>"):  # one of a list
                around.key = f"{around.key[:-1]} {words}>"
            open_.pop()
        else:
            piece = Piece(_key(markup["tag"], markup["rest"]), first, last, last, last)
            around.inner.append(piece)
            open_ += [piece] if not markup["rest"].endswith("/") else []
    return top.inner[0]


def _take_text(around: Piece, text: str, line: int) -> None:
    for number, words in enumerate(text.split("\n"), line):
        region = placeholder_id(f"{words}\n")
        if region is not None:
            around.inner.append(Piece(f"region {region}", number, number, number, number))
        elif words.strip():
            around.solid = True


def _key(tag: str, rest: str) -> str:
    given = {found[1]: found[2] or found[3] or "" for found in _ATTRIBUTE.finditer(rest)}
    names: Iterable[str] = _NAMES.get(tag, _ANY_NAME)
    name = next((given[one] for one in names if one in given), None)
    return f"<{tag}>" if name is None else f"<{tag} {name}>"
