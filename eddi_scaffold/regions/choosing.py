"""Which body each region of a rendering gets, and the text of a file with it. Pure functions."""

from __future__ import annotations

import io
import re
import tokenize
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from .marked_file import MarkedFile, Region, split_lines
from .markers import Digests, Look, digest, indent_of, normal, tail_of, with_tail

_DEFINED = re.compile(r"self\.(\w+)|\b(?:def|class|import|as)\s+(\w+)|<arg\s+name=[\"'](\w+)[\"']")
_WORD = re.compile(r"\w+")


@dataclass(frozen=True)
class Body:
    """A region as it is in a package.

    Attributes:
        region: with the body.
        file: where it is, relative to the package.
        kept: whether it is a saved one, in ``.eddi/kept``.
        fits: whether nobody need look at it: it was written for what is generated now.
    """

    region: Region
    file: str
    kept: bool = False
    fits: bool = False

    @property
    def untouched(self) -> bool:
        """Whether no person wrote it."""
        return digest(self.region.body) == self.region.digests.of


@dataclass(frozen=True)
class Choice:
    """The body of one region of a rendering.

    Attributes:
        body: ``None`` for the generated one.
        former: the other id that it had, ``None`` for its own.
    """

    body: Body | None = None
    former: str | None = None


@dataclass(frozen=True)
class Bodies:
    """The bodies of a package by id: in its files, and saved."""

    present: Mapping[str, Body] = field(default_factory=dict)
    kept: Mapping[str, Body] = field(default_factory=dict)


def choose(rendered: Mapping[str, Region], bodies: Bodies) -> dict[str, Choice]:
    """Choose a body for each region of a rendering; each body is used once.

    A declared rename goes first, all at once, and only until the marker has it: so swaps, chains
    and a new element of an old name need no further rule.
    """
    present, kept = bodies.present, bodies.kept
    chosen: dict[str, Choice] = {}
    declared = {id_: _declared(region, bodies) for id_, region in rendered.items()}
    taken: set[str] = set()
    for id_, names in declared.items():
        for former in names:
            if former in present and former not in taken:
                chosen[id_] = Choice(present[former], former)
                taken.add(former)
                break
    taken_kept: set[str] = set()
    for id_, names in declared.items():
        own = present.get(id_)
        if id_ in chosen or not (own is None or own.untouched or id_ in taken):
            continue
        for former in names:
            if former in kept and former not in present and former not in taken_kept:
                chosen[id_] = Choice(kept[former], former)
                taken_kept.add(former)
                break
    for id_ in rendered:
        if id_ not in chosen:
            own = present.get(id_) if id_ not in taken else None
            back = kept.get(id_) if id_ not in present and id_ not in taken_kept else None
            chosen[id_] = Choice(own or back)
    return chosen


def _declared(region: Region, bodies: Bodies) -> list[str]:
    before = bodies.present.get(region.id) or bodies.kept.get(region.id)
    known = {region.id, *(before.region.was if before is not None else ())}
    return [former for former in region.was if former not in known]


def defined_names(texts: Iterable[str]) -> set[str]:
    """Return the names that generated text defines, as far as bodies refer to such."""
    found = (match for text in texts for match in _DEFINED.findall(text))
    return {name for names in found for name in names if name}


def words_of(texts: Iterable[str]) -> set[str]:
    """Return the words in texts."""
    return {word for text in texts for word in _WORD.findall(text)}


@dataclass(frozen=True)
class Placed:
    """What a region of a new text holds.

    Attributes:
        body: the text between its markers.
        written: whether a person wrote it.
        digests: as its marker gets them.
        now: why a person must look at it.
    """

    body: str
    written: bool
    digests: Digests
    now: Look | None = None


def placed(
    region: Region, choice: Choice, former_names: Iterable[str], new_words: set[str]
) -> Placed:
    """Return what a region of a rendering holds with the body that was chosen for it.

    Args:
        region: of the rendering, with the generated body.
        choice: the body.
        former_names: what the generated text before defined.
        new_words: all words of the new rendering.
    """
    today = Digests(digest(region.body), region.digests.uses)
    body = choice.body
    if body is None:
        return Placed(region.body, False, today)
    own = body.region
    if body.untouched or normal(own.body) == normal(region.body):
        same = normal(own.body) == normal(region.body) and not body.kept
        same = same and choice.former is None and own.indent == region.indent
        return Placed(own.body if same else region.body, False, today)
    if body.fits:
        return Placed(own.body, True, today)
    used = words_of([own.body])
    doubted = {*former_names, *(own.now.missing if own.now is not None else ())}
    missing = tuple(sorted((doubted & used) - new_words))
    if own.digests != today or missing:
        return Placed(own.body, True, own.digests, Look(today, missing))
    return Placed(own.body, True, own.digests)


def compose(
    rendering: MarkedFile, content: Mapping[str, Placed], sources: Mapping[str, Body], eol: str
) -> str:
    """Return the text of a file: the rendering, with bodies and markers.

    Args:
        rendering: the new text.
        content: of each of its regions.
        sources: where written bodies come from.
        eol: how its lines end.
    """
    lines: list[str] = []
    for part in rendering.parts:
        if isinstance(part, str):
            lines.append(part.replace("\n", eol))
            continue
        one = content[part.id]
        tail = tail_of(one.digests, part.was, one.now)
        body = one.body
        if part.id in sources and one.written:
            body = reindented(body, sources[part.id].region.indent, part.indent)
        if part.id not in sources or eol_of(body) != eol:
            body = body.replace("\r\n", "\n").replace("\n", eol)
        lines += [with_tail(part.begin, part.id, tail), eol, body, part.end, eol]
    return "".join(lines)


def eol_of(text: str) -> str:
    """Return how most lines of a text end."""
    crlf = text.count("\r\n")
    return "\r\n" if crlf and 2 * crlf > text.count("\n") else "\n"


def reindented(body: str, old: str, new: str) -> str:
    """Return a body as it stands behind a marker with another indentation."""
    if old == new:
        return body
    inside = _in_texts(body)
    return "".join(
        new + line[len(old) :] if number not in inside and line.startswith(old) else line
        for number, line in enumerate(split_lines(body), 1)
    )


def _in_texts(body: str) -> set[int]:
    """Return the lines of a body that begin inside a text over several lines of Python."""
    found: set[int] = set()
    starts: list[int] = []
    source = "if 1:\n" + (body if indent_of(body) else "".join(f" {x}" for x in split_lines(body)))
    try:
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            first, last = token.start[0], token.end[0]
            name = tokenize.tok_name[token.type]
            if name == "FSTRING_START":
                starts.append(first)
            elif name == "FSTRING_END":
                found |= set(range(starts.pop(), last))
            elif name == "STRING":
                found |= set(range(first, last))
    except (tokenize.TokenError, SyntaxError):
        pass  # not Python: what was read so far
    return found


def saved_text(region: Region) -> str:
    """Return a region with its markers, as it is saved when its place is gone."""
    tail = tail_of(region.digests, region.was)
    begin = with_tail(region.begin, region.id, tail)
    end = with_tail(region.end, region.id, "")
    return f"{begin}\n{region.body}{end}\n"
