"""Which body each region of a rendering gets, and the text of a file with it. Pure functions."""

from __future__ import annotations

import ast
import re
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass

from .marked_file import MarkedFile, Region, split_lines
from .markers import Digests, Look, digest, indent_of, normal, tail_of, with_tail

_DEFINED = re.compile(r"self\.(\w+)|\b(?:def|class|import|as)\s+(\w+)|<arg\s+name=[\"'](\w+)[\"']")
_WORD = re.compile(r"\w+")


@dataclass(frozen=True)
class Body:
    """A region as it is in a package."""

    region: Region
    file: str  # relative to the package
    kept: bool = False  # whether it is a saved one, in `.eddi/kept`
    fits: bool = False  # whether nobody need look at it: it was written for what is generated now


Chosen = Mapping[str, tuple[Body | None, str | None]]
"""Region -> its body, ``None`` for the generated one; and the other id that this had."""


def choose(
    rendered: Mapping[str, Region], present: Mapping[str, Body], kept: Mapping[str, Body]
) -> Chosen:
    """Choose a body for each region of a rendering; each body is used once.

    A declared rename goes first, all at once, and only until the marker has it: so swaps, chains
    and a new element of an old name need no further rule.

    Args:
        rendered: the regions by id.
        present: the bodies in the files of the package.
        kept: the saved ones.
    """
    chosen: dict[str, tuple[Body | None, str | None]] = {}
    taken: set[str] = set()
    taken_kept: set[str] = set()

    def take(id_: str, source: Mapping[str, Body], used: set[str], other: Container[str]) -> None:
        before = present.get(id_) or kept.get(id_)
        known = {id_, *(before.region.was if before is not None else ())}
        for former in rendered[id_].was:
            if former in source and not (former in known or former in used or former in other):
                chosen[id_] = source[former], former
                used.add(former)
                return

    for id_ in rendered:
        take(id_, present, taken, ())
    for id_ in rendered:
        own = present.get(id_)
        if id_ not in chosen and (own is None or own.region.untouched or id_ in taken):
            take(id_, kept, taken_kept, present)
    for id_ in rendered:
        own = present.get(id_) if id_ not in taken else None
        back = kept.get(id_) if id_ not in present and id_ not in taken_kept else None
        chosen.setdefault(id_, (own or back, None))
    return chosen


def defined_names(texts: Iterable[str]) -> set[str]:
    """Return the names that generated text defines, as far as bodies refer to such."""
    found = (match for text in texts for match in _DEFINED.findall(text))
    return {name for names in found for name in names if name}


def words_of(texts: Iterable[str]) -> set[str]:
    """Return the words in texts."""
    return {word for text in texts for word in _WORD.findall(text)}


@dataclass(frozen=True)
class Placed:
    """What a region of a new text holds."""

    body: str
    digests: Digests  # as its marker gets them
    source: Body | None = None  # of what a person wrote
    now: Look | None = None  # why a person must look at it


def placed(
    region: Region, body: Body | None, former_names: Iterable[str], new_words: set[str]
) -> Placed:
    """Return what a region of a rendering holds with the body that was chosen for it.

    Args:
        region: of the rendering, with the generated body.
        body: the one that was chosen.
        former_names: what the generated text before defined.
        new_words: all words of the new rendering.
    """
    today = Digests(digest(region.body), region.digests.uses)
    if body is None:
        return Placed(region.body, today)
    own = body.region
    same = normal(own.body) == normal(region.body)
    if own.untouched or same:
        stays = same and not body.kept and (own.id, own.indent) == (region.id, region.indent)
        return Placed(own.body if stays else region.body, today)
    if body.fits:
        return Placed(own.body, today, body)
    doubted = {*former_names, *(own.now.missing if own.now is not None else ())}
    missing = tuple(sorted((doubted & words_of([own.body])) - new_words))
    look = Look(today, missing) if own.digests != today or missing else None
    return Placed(own.body, own.digests, body, look)


def compose(rendering: MarkedFile, content: Mapping[str, Placed], eol: str) -> str:
    """Return the text of a file: the rendering, with the content of its regions, and markers.

    Args:
        rendering: the new text.
        content: of each of its regions.
        eol: how its lines end.
    """
    lines: list[str] = []
    for part in rendering.parts:
        if isinstance(part, str):
            lines.append(part.replace("\n", eol))
            continue
        one = content[part.id]
        body = one.body
        if one.source is not None:
            body = reindented(body, one.source.region.indent, part.indent)
        if one.source is None or eol_of(body) != eol:
            body = body.replace("\r\n", "\n").replace("\n", eol)
        begin = with_tail(part.begin, part.id, tail_of(one.digests, part.was, one.now))
        lines += [begin, eol, body, part.end, eol]
    return "".join(lines)


def eol_of(text: str) -> str:
    """Return how most lines of a text end."""
    crlf = text.count("\r\n")
    return "\r\n" if crlf and 2 * crlf > text.count("\n") else "\n"


def reindented(body: str, old: str, new: str) -> str:
    """Return a body as it stands behind a marker with another indentation."""
    inside = _in_texts(body) if old != new else set()
    return "".join(
        new + line[len(old) :] if number not in inside and line.startswith(old) else line
        for number, line in enumerate(split_lines(body), 1)
    )


def _in_texts(body: str) -> set[int]:
    """Return the lines of a body that begin inside a text over several lines of Python."""
    lines = body if indent_of(body) else "".join(f" {line}" for line in split_lines(body))
    try:
        tree = ast.parse(f"if 1:\n{lines}")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    texts = (node for node in ast.walk(tree) if isinstance(node, ast.Constant | ast.JoinedStr))
    return {line for text in texts for line in range(text.lineno, text.end_lineno or 0)}


def saved_text(region: Region) -> str:
    """Return a region with its markers, as it is saved when its place is gone."""
    begin = with_tail(region.begin, region.id, tail_of(region.digests, region.was))
    return f"{begin}\n{region.body}{with_tail(region.end, region.id, '')}\n"
