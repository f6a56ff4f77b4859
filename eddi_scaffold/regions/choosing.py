"""Which body each region of a rendering gets, and the text of a file with it. Pure functions."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Mapping
from typing import NamedTuple

from .marked_file import MarkedFile, Region, split_lines
from .markers import Digests, Look, digest, indent_of, normal, tail_of, with_tail

WORD = re.compile(r"\w+")


class Body(NamedTuple):
    """A region as it is in a package."""

    region: Region
    file: str  # relative to the package
    kept: bool = False  # whether it is a saved one, in `.eddi/kept`
    fits: bool = False  # whether nobody need look: it was written for what is generated now


Chosen = Mapping[str, tuple[Body | None, str | None]]
"""Region -> its body, ``None`` for the generated one; and the other id that this had."""


def choose(
    rendered: Mapping[str, Region], present: Mapping[str, Body], kept: Mapping[str, Body]
) -> Chosen:
    """Choose a body for each region of a rendering, from the files and the saved ones.

    Each body is used once. A declared rename goes first, all at once, and only until the marker
    has it: so swaps, chains and a new element of an old name need no further rule.
    """
    chosen: dict[str, tuple[Body | None, str | None]] = {}
    taken: set[str] = set()
    taken_kept: set[str] = set()

    def rename(id_: str, source: Mapping[str, Body], used: set[str], other: Container[str]) -> None:
        before = present.get(id_) or kept.get(id_)
        known = {id_, *(before.region.was if before is not None else ())}
        for former in rendered[id_].was:
            if former in source and not (former in known or former in used or former in other):
                chosen[id_] = source[former], former
                used.add(former)
                return

    for id_ in rendered:
        rename(id_, present, taken, ())
    for id_ in rendered:
        own = present.get(id_)
        if id_ not in chosen and (own is None or own.region.untouched or id_ in taken):
            rename(id_, kept, taken_kept, present)
    for id_ in rendered:
        own = present.get(id_) if id_ not in taken else None
        back = kept.get(id_) if id_ not in present and id_ not in taken_kept else None
        chosen.setdefault(id_, (own or back, None))
    return chosen


class Placed(NamedTuple):
    """What a region of a new text holds."""

    body: str
    digests: Digests  # as its marker gets them
    source: Body | None = None  # of what a person wrote
    now: Look | None = None


def placed(
    region: Region, body: Body | None, former_names: Iterable[str], new_words: set[str]
) -> Placed:
    """Return what a region of a rendering holds with the body that was chosen for it.

    Names that the generated text before defined, and the new one does not have, are missed.
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
    doubted = {*former_names, *(own.now.missing if own.now else ())}
    missing = tuple(sorted(doubted.intersection(WORD.findall(own.body)) - new_words))
    look = Look(today, missing) if own.digests != today or missing else None
    return Placed(own.body, own.digests, body, look)


def look_reasons(digests: Digests, now: Look, former: str | None = None) -> str:
    """Return why a person must look at a body, with the other id that it had."""
    reasons = [f"it was written for {former!r}"] if former else []
    if digests.of is None:
        reasons.append("it is not known what it was written for")
    elif digests.uses != now.digests.uses:
        reasons.append("what it may use has changed")
    elif digests.of != now.digests.of:
        reasons.append("the generated text in its place has changed")
    reasons += [f"it uses {name}, which is not generated any more" for name in now.missing]
    return "; ".join(reasons)


def compose(rendering: MarkedFile, content: Mapping[str, Placed], eol: str) -> str:
    """Return the text of a file, whose lines end so: rendering, regions with content, markers."""
    lines: list[str] = []
    for part in rendering.parts:
        if isinstance(part, str):
            lines.append(part.replace("\n", eol))
            continue
        new = content[part.id]
        body = new.body
        if new.source is not None:
            body = reindented(body, new.source.region.indent, part.indent)
        if new.source is None or eol_of(body) != eol:
            body = body.replace("\r\n", "\n").replace("\n", eol)
        begin = with_tail(part.begin, part.id, tail_of(new.digests, part.was, new.now))
        lines += [begin, eol, body, part.end, eol]
    return "".join(lines)


def eol_of(text: str) -> str:
    """Return how most lines of a text end."""
    crlf = text.count("\r\n")
    return "\r\n" if crlf and 2 * crlf > text.count("\n") else "\n"


def reindented(body: str, old: str, new: str) -> str:
    """Return a body as it stands behind a marker with another indentation."""
    if old == new:
        return body
    import ast  # noqa: PLC0415 - seldom

    inside: set[int] = set()  # the lines that begin inside a text over several lines of Python
    lines = body if indent_of(body) else "".join(f" {line}" for line in split_lines(body))
    try:
        for node in ast.walk(ast.parse(f"if 1:\n{lines}")):
            if isinstance(node, ast.Constant | ast.JoinedStr):
                inside.update(range(node.lineno, node.end_lineno or 0))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        pass
    return "".join(
        new + line[len(old) :] if number not in inside and line.startswith(old) else line
        for number, line in enumerate(split_lines(body), 1)
    )
