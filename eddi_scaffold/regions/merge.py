"""Merge one file: the last rendering, the person's text and the new rendering. Pure."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath
from typing import Literal
from xml.parsers import expat

from . import names
from .bodies import reindent
from .lines import merge_lines
from .lost import lost_markers
from .marked_file import (
    Fault,
    MarkedFile,
    Region,
    parse,
    placeholder_id,
    split_lines,
)
from .markers import indent_of, with_sig
from .outside import (
    CMAKE,
    PYTHON,
    XML,
    Language,
    Reject,
    merge_items,
    regions_in,
    same_lines,
)
from .placements import Placement, Placements, adopt_ids, claim_bodies
from .python_text import reason_of
from .result import Merged, Note, Orphan, RefusedFile, patch_text

FileFormat = Literal["python", "xml", "cmake", "lines"]
LANGUAGES: Mapping[FileFormat, Language] = {"python": PYTHON, "xml": XML, "cmake": CMAKE}
"""How the files of each format are taken apart."""
_BOM = "\ufeff"


def kind_of(path: str) -> FileFormat:
    """Return how a file is merged and checked, by its name."""
    name = PurePosixPath(path)
    if name.suffix == ".py":
        return "python"
    if name.name == "CMakeLists.txt" or name.suffix == ".cmake":
        return "cmake"
    return "xml" if name.suffix in {".xml", ".launch"} else "lines"


def merge(
    path: str, base: str | None, mine: str | None, theirs: str, orphans: Sequence[Orphan] = ()
) -> Merged | RefusedFile:
    """Return the new text of a file.

    Args:
        path: file relative to the package, ``/`` between folders.
        base: the rendering that ``mine`` was made from, ``None`` when not known.
        mine: the person's text, ``None`` when there is none.
        theirs: the new rendering.
        orphans: saved bodies that may come back, the newest last.

    Returns:
        The merged text and what had to leave it, or why nothing may be touched.
    """
    target, faults = parse(_plain(theirs))
    if faults:
        reasons = (Fault(f.line, f"in the new rendering: {f.reason}") for f in faults)
        return RefusedFile(tuple(reasons))
    own = None
    if mine is not None:
        document, faults = parse(_plain(mine))
        if faults:
            return RefusedFile(tuple(faults))
        own = adopt_ids(document, target)
    before = _base(base, target)
    if own is not None and before is not None:
        own = dissolve(own, before, target)
        faults = lost_markers(before, own)
        if faults:
            return RefusedFile(tuple(faults))
    claims = claim_bodies(path, before, own, target, orphans)
    skeleton, rejects = _outside(path, before, own, target, claims.changed)
    python = kind_of(path) == "python"
    quotes = _quotes(own) if python else ""
    text = _assemble(skeleton, claims.by_id, python=python, quotes=quotes)
    if own is not None and skeleton != target.skeleton and not _valid(path, skeleton, claims):
        skeleton, rejects = target.skeleton, [_reject_file(before or target, own)]
        text = _assemble(skeleton, claims.by_id, python=python, quotes=quotes)
    if not _placed(path, text, claims):
        return RefusedFile((Fault(1, "the merged text would lose a region; put its markers back"),))
    notes = [*claims.notes, *_reject_notes(path, rejects), *_broken_bodies(path, text)]
    if claims.changed and skeleton != target.skeleton:
        names = ", ".join(sorted(claims.changed))
        reason = f"{names} changed names; what you wrote outside of the regions was not renamed"
        notes.append(Note(path, None, reason))
    return Merged(
        _as_written(text, mine if mine is not None else theirs),
        claims.orphans,
        claims.taken,
        patch_text(path, rejects),
        tuple(notes),
    )


def retire(path: str, base: str | None, mine: str) -> Merged | RefusedFile:
    """Return what must be kept of a file that is not rendered any more."""
    own, faults = parse(_plain(mine))
    if faults:
        return RefusedFile(tuple(faults))
    before = _base(base, own)
    claims = claim_bodies(path, before, own, MarkedFile(()), ())
    known = before.skeleton if before is not None else []
    rejects = []
    if not same_lines(known, own.skeleton):
        rejects = [Reject("the file", tuple(known), tuple(own.skeleton))]
    return Merged(
        None,
        claims.orphans,
        (),
        patch_text(path, rejects),
        (*claims.notes, *_reject_notes(path, rejects)),
    )


def may_return(theirs: str, orphans: Sequence[Orphan]) -> bool:
    """Return whether a rendering has, under its id or a former one, a region of a saved body."""
    regions = parse(_plain(theirs))[0].regions.values()
    names = {name for region in regions for name in (region.id, *region.was)}
    return any(orphan.id in names for orphan in orphans)


def check_text(path: str, text: str) -> Fault | None:
    """Return why a Python or XML file is not valid, ``None`` when it is."""
    try:
        if kind_of(path) == "python":
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                compile(text.removeprefix(_BOM), path, "exec", dont_inherit=True)
        elif kind_of(path) == "xml":
            expat.ParserCreate().Parse(text.encode(), True)
    except SyntaxError as problem:
        return Fault(problem.lineno or 1, reason_of(problem))
    except expat.ExpatError as problem:
        return Fault(problem.lineno, expat.ErrorString(problem.code))
    except (RecursionError, MemoryError):
        return Fault(1, "nested too deeply")
    except ValueError as problem:
        return Fault(1, str(problem))
    return None


def _plain(text: str) -> str:
    text = text.removeprefix(_BOM)
    return text.replace("\r\n", "\n") if _all_crlf(text) else text


def _all_crlf(text: str) -> bool:
    return 0 < text.count("\n") == text.count("\r\n")


def _as_written(text: str, model: str) -> str:
    if _all_crlf(model):
        text = text.replace("\n", "\r\n")
    return _BOM + text if model.startswith(_BOM) else text


def _base(base: str | None, target: MarkedFile) -> MarkedFile | None:
    if base is None:
        return None
    document, faults = parse(_plain(base))
    return None if faults else adopt_ids(document, target)


def dissolve(mine: MarkedFile, base: MarkedFile, theirs: MarkedFile) -> MarkedFile:
    """Turn regions that a person invented into ordinary lines: the generator never knew them."""
    known = {*base.regions, *theirs.regions}
    former = {old for region in theirs.regions.values() for old in region.was}
    parts: list[str | Region] = []
    for part in mine.parts:
        if isinstance(part, str) or part.id in known or part.id in former:
            parts.append(part)
        else:
            parts += [part.begin + "\n", *split_lines(part.body), part.end + "\n"]
    return MarkedFile(tuple(parts))


def _outside(
    path: str,
    base: MarkedFile | None,
    mine: MarkedFile | None,
    theirs: MarkedFile,
    changed: Collection[str],
) -> tuple[list[str], list[Reject]]:
    new = theirs.skeleton
    if mine is None or same_lines(mine.skeleton, new):
        return new, []
    if base is None:
        return new, [_reject_file(theirs, mine)]
    if same_lines(mine.skeleton, base.skeleton):
        return new, []
    language = LANGUAGES.get(kind_of(path))
    try:
        if language is not None:
            return merge_items(language, base.skeleton, mine.skeleton, new, changed)
    except SyntaxError:
        if language is PYTHON:
            return new, [_reject_file(base, mine)]
    merged = merge_lines(base.skeleton, mine.skeleton, new)
    if merged is None or regions_in(merged) != regions_in(new):
        return new, [_reject_file(base, mine)]
    return merged, []


def _reject_file(before: MarkedFile, after: MarkedFile) -> Reject:
    return Reject("the file", tuple(before.skeleton), tuple(after.skeleton))


def _quotes(own: MarkedFile | None) -> str:
    """Return the quotes of the markers in a person's file: formatters have their own taste."""
    regions = own.regions.values() if own is not None else ()
    return next((region.begin.lstrip()[:3] for region in regions), "")


def _assemble(
    skeleton: Sequence[str],
    claims: Mapping[str, Placement],
    *,
    python: bool,
    quotes: str = "",
) -> str:
    out: list[str] = []
    for line in skeleton:
        region_id = placeholder_id(line)
        claim = claims.get(region_id) if region_id is not None else None
        if claim is None:
            out.append(line)
            continue
        indent, region = indent_of(line), claim.region
        begin = region.begin.strip()
        if claim.edited and region.sig is not None:
            begin = with_sig(begin, claim.sig)
        body, end = _moved(claim, indent, python=python), region.end.strip()
        if quotes == '"""':
            begin, end = (line.replace("'''", quotes) for line in (begin, end))
        out += [indent + begin + "\n", body, indent + end + "\n"]
    return "".join(out)


def _moved(claim: Placement, indent: str, *, python: bool) -> str:
    return reindent(claim.body, claim.indent, indent, python=python)


def _placed(path: str, text: str, claims: Placements) -> bool:
    """Check the merged text against the promise before anything is written."""
    document, faults = parse(text)
    found = [region for region in document.regions.values() if region.id in claims.by_id]
    if faults or [region.id for region in found] != list(claims.by_id):
        return False
    return all(
        region.body
        == _moved(claims.by_id[region.id], region.indent, python=kind_of(path) == "python")
        for region in found
    )


def _valid(path: str, skeleton: Sequence[str], claims: Placements) -> bool:
    """Return whether merged lines are valid whatever the bodies hold."""
    if kind_of(path) == "python":
        return check_text(path, "".join(skeleton)) is None
    defaults = {
        key: replace(claim, body=claim.region.body, indent=claim.region.indent)
        for key, claim in claims.by_id.items()
    }
    return check_text(path, _assemble(skeleton, defaults, python=False)) is None


def _reject_notes(path: str, rejects: Sequence[Reject]) -> list[Note]:
    return [
        Note(
            path,
            None,
            f"the edit in {r.where} does not fit the new text; "
            f"it is saved in {names.folder}/rejects/{path}.patch",
        )
        for r in rejects
    ]


def _broken_bodies(path: str, text: str) -> list[Note]:
    fault = check_text(path, text)
    return [Note(path, fault.line, f"the file is not valid: {fault.reason}")] if fault else []
