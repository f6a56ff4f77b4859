"""Merge two branches of a file by its regions, for git. Pure.

Bodies are merged with the body of the same region only, and the text around them as if a region
were one line, so that no hand-written line gets into another method. What cannot be merged is
marked as git marks it, and stays on both sides.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from .bases import bases_of, text_of
from .bodies import reindent, same_body
from .lines import mark_lines
from .manifest import OF_TWO_BRANCHES
from .marked_file import MarkedFile, Region, parse, placeholder_id, split_lines
from .markers import indent_of, with_sig
from .merge import LANGUAGES, check_text, kind_of
from .outside import Language, merge_items, regions_in

_WRITTEN = "  # written"


class Joined(NamedTuple):
    """The text with the changes of both branches, and whether a person must resolve it."""

    text: str
    conflict: bool


def join_branches(path: str, base: str, ours: str, theirs: str) -> Joined:
    """Return an editable file with the changes of two branches.

    Args:
        path: the file, for its kind.
        base: its text where the branches part.
        ours: its text on this branch.
        theirs: its text on the other.
    """
    for one, other, chosen in ((base, ours, theirs), (base, theirs, ours), (ours, theirs, ours)):
        if one == other:
            return Joined(chosen, conflict=False)
    parsed = [parse(text) for text in (base, ours, theirs)]
    if any(faults for _, faults in parsed):
        return _join_lines(*(split_lines(text) for text in (base, ours, theirs)))
    return _join_parsed(path, *(document for document, _ in parsed))


def join_text(base: str, ours: str, theirs: str) -> Joined:
    """Return a file without regions with the changes of two branches."""
    return _join_lines(*(split_lines(text) for text in (base, ours, theirs)))


def join_renderings(path: str, base: str, ours: str, theirs: str) -> str:
    """Return a rendering for the file of two branches: nobody wrote in it, so ours wins."""
    joined = join_branches(path, base, ours, theirs)
    return ours if joined.conflict else joined.text


def join_bases(base: str, ours: str, theirs: str) -> str:
    """Return the bases of two branches: each that both have anew is merged."""
    old, own, new = map(bases_of, (base, ours, theirs))
    joined = {}
    for name in {*own, *new}:
        sides = old.get(name), own.get(name), new.get(name)
        if sides[0] in sides[1:] or None in sides[1:]:
            text = _chosen(*sides)
            text = sides[2] if text is None and sides[0] != sides[2] else text
        else:
            text = join_renderings(name, sides[0] or "", sides[1] or "", sides[2] or "")
        if isinstance(text, str):
            joined[name] = text
    return text_of(joined)


def join_manifests(base: str, ours: str, theirs: str) -> str | None:
    """Return the digests of two branches, ``None`` where one is damaged.

    That of the whole rendering fits no package where both branches have a new one: their answers
    are not merged. A base that both have anew is merged, and has none of their digests.
    """
    try:
        old, own, new = ({} if not text else json.loads(text) for text in (base, ours, theirs))
        was, mine, other = (one.get("rendering") for one in (old, own, new))
        both_new = was not in {mine, other} and mine != other
        record = {"rendering": OF_TWO_BRANCHES if both_new else _chosen(was, mine, other)}
        for part in ("meaning", "sha256"):
            before, mine, other = (dict(one.get(part, {})) for one in (old, own, new))
            record[part] = {
                name: digest
                for name in {*mine, *other}
                if (digest := _chosen(before.get(name), mine.get(name), other.get(name)))
            }
        before, mine, other = (dict(one.get("base", {})) for one in (old, own, new))
        record["base"] = {
            name: digests if other.get(name) in (digests, before.get(name)) else None
            for name in {*mine, *other}
            if (digests := _chosen(before.get(name), mine.get(name), other.get(name)))
        }
    except (ValueError, TypeError, AttributeError, RecursionError):
        return None
    return json.dumps(record, indent=1, sort_keys=True) + "\n"


def _chosen(base: object, ours: object, theirs: object) -> object:
    return theirs if base == ours else ours


def _join_lines(base: Sequence[str], ours: Sequence[str], theirs: Sequence[str]) -> Joined:
    lines, conflict = mark_lines(base, ours, theirs)
    return Joined("".join(lines), conflict)


def _join_parsed(path: str, base: MarkedFile, ours: MarkedFile, theirs: MarkedFile) -> Joined:
    python = kind_of(path) == "python"
    regions, torn = _regions(base.regions, ours.regions, theirs.regions)
    contested = _contested(base.regions, ours.regions, theirs.regions)
    sides = (base.skeleton, _changed(ours, contested), _changed(theirs, contested))
    language = LANGUAGES.get(kind_of(path))
    lines = _by_definition(language, *sides) if language and not contested else None
    conflict = False
    if lines is None:
        lines, conflict = mark_lines(*sides)
    text = _expanded(lines, regions, python=python)
    if not conflict and not torn and (parse(text)[1] or check_text(path, text) is not None):
        whole = mark_lines((), *sides[1:])[0]
        return Joined(_expanded(whole, regions, python=python), conflict=True)
    return Joined(text, conflict or torn)


def _by_definition(
    language: Language, base: Sequence[str], ours: Sequence[str], theirs: Sequence[str]
) -> list[str] | None:
    """Return the merged skeleton, ``None`` where that is not without doubt."""
    # The second side gives the order: that of the new rendering, if there is one.
    if regions_in(theirs) == regions_in(base):
        ours, theirs = theirs, ours
    try:
        lines, rejects = merge_items(language, base, ours, theirs, both=True)
    except SyntaxError:
        return None
    old, own, new = (set(regions_in(one)) for one in (base, ours, theirs))
    wanted = (own & new) | (own - old) | (new - old)
    return lines if not rejects and sorted(regions_in(lines)) == sorted(wanted) else None


def _regions(
    base: Mapping[str, Region], ours: Mapping[str, Region], theirs: Mapping[str, Region]
) -> tuple[dict[str, Region], bool]:
    """Return each region with the merged body, and whether a body has a conflict."""
    found, torn = {}, False
    for key in {**ours, **theirs}:
        sides = [side[key] for side in (ours, theirs) if key in side]
        found[key] = sides[0]
        if len(sides) == 2:
            found[key], conflict = _both(base.get(key), *sides)
            torn = torn or conflict
    return found, torn


def _both(base: Region | None, ours: Region, theirs: Region) -> tuple[Region, bool]:
    """Return a region with the body that was written, or both merged, and its signature."""
    old, conflict = base or replace(ours, body="", begin=""), False
    marks = theirs if ours.begin.strip() == old.begin.strip() else ours
    if same_body(ours.body, theirs.body):
        return replace(marks, body=ours.body, begin=marks.indent + ours.begin.strip()), False
    if same_body(theirs.body, old.body):
        source, body = ours, ours.body
    elif same_body(ours.body, old.body):
        source, body = theirs, theirs.body
    else:  # written for what it was in the base, as far as that is known
        source = ours if ours.sig == old.sig else theirs
        texts = (split_lines(one.body) for one in (old, ours, theirs))
        lines, conflict = mark_lines(*texts)
        body = "".join(lines)
    begin = source.indent + with_sig(marks.begin.strip(), source.sig)
    return replace(marks, body=body, begin=begin), conflict


def _contested(
    base: Mapping[str, Region], ours: Mapping[str, Region], theirs: Mapping[str, Region]
) -> set[str]:
    """Return the regions that one branch removed while the other one wrote in them."""
    pairs = ((ours, theirs), (theirs, ours))
    return {
        key
        for gone, kept in pairs
        for key in kept.keys() & base.keys() - gone.keys()
        if not same_body(kept[key].body, base[key].body)
    }


def _changed(document: MarkedFile, regions: Collection[str]) -> list[str]:
    """Return the skeleton with a change where a body was written, so that a removal meets it."""
    return [
        line.rstrip("\n") + _WRITTEN + "\n" if placeholder_id(line) in regions else line
        for line in document.skeleton
    ]


def _expanded(lines: Sequence[str], regions: Mapping[str, Region], *, python: bool) -> str:
    out: list[str] = []
    for line in lines:
        key = placeholder_id(line.removesuffix(_WRITTEN + "\n"))
        region = regions.get(key) if key is not None else None
        if region is None:
            out.append(line)
            continue
        indent = indent_of(line)
        body = reindent(region.body, region.indent, indent, python=python)
        out += [indent + region.begin.strip() + "\n", body, indent + region.end.strip() + "\n"]
    return "".join(out)
