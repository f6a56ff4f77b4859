"""Bring a package to a new rendering: every region keeps its body, nothing else is merged.

A person's text and generated text share a file only in regions. What was edited outside of them is
kept as a copy, and said. Planning changes nothing; what was planned is written in one go.
"""

from __future__ import annotations

import difflib
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from .choosing import (
    Bodies,
    Body,
    Choice,
    Placed,
    choose,
    compose,
    defined_names,
    eol_of,
    placed,
    saved_text,
    words_of,
)
from .files import entries
from .git import ancestor_bytes
from .marked_file import MarkedFile, Region, parse
from .markers import Digests, Look, encode_id, normal, text_digest
from .package import (
    ANSWERS,
    EDDI,
    KEPT,
    MANIFEST,
    NEW,
    PUT,
    Manifest,
    PackageFile,
    bytes_of,
    digest_of,
    free_name,
    kept_names,
    kept_regions,
    made_by_git,
    manifest_of,
    manifest_text,
    obstacle,
    read_file,
    stamp_of,
    text_of,
)
from .write import Step, move_in, put_aside, refuse_saved

_MOST_LINES = 6


@dataclass(frozen=True)
class Refusal:
    """Why nothing is written.

    Attributes:
        file: relative to the package.
        line: in the file, ``None`` when there is none.
        reason: one sentence, with what to do about it.
    """

    file: str
    line: int | None
    reason: str


@dataclass(frozen=True)
class Note:
    """One thing that happened to a person's text.

    Attributes:
        file: relative to the package.
        line: in the file, ``None`` when there is none.
        text: one sentence without a full stop.
        attention: whether a person must look at it.
    """

    file: str
    line: int | None
    text: str
    attention: bool = True


@dataclass(frozen=True)
class Plan:
    """What a sync does, or why it does nothing.

    Attributes:
        root: the package.
        refusals: with any of them nothing may be written.
        notes: what happens to a person's texts.
        steps: in the order in which they are made.
        before: path -> bytes, of the files that the steps change.
        stamps: of all files that were read.
    """

    root: Path
    refusals: Sequence[Refusal] = ()
    notes: Sequence[Note] = ()
    steps: Sequence[Step] = ()
    before: Mapping[str, bytes] = field(default_factory=dict)
    stamps: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    def prepare(self) -> None:
        """Write all new bytes beside their places.

        Raises:
            OSError: the disk is full, or a folder is not writable; nothing of a person changed.
            SavedError: a person saved a file meanwhile.
        """
        put_aside(self.root, self.steps, self.root / PUT)
        refuse_saved(self.root, self.stamps)

    def finish(self) -> None:
        """Move everything to its place; of a package that leaves no empty folder stays."""
        refuse_saved(self.root, self.stamps)
        move_in(self.root, self.steps)
        shutil.rmtree(self.root / NEW, ignore_errors=True)
        for folder in (self.root / EDDI, self.root):
            if folder.is_dir() and not any(folder.iterdir()):
                folder.rmdir()


def plan_sync(
    root: Path,
    rendering: Path,
    beside: Mapping[str, bytes | None] | None = None,
    adopted: Sequence[Body] = (),
    kept: Mapping[str, bytes] | None = None,
) -> Plan:
    """Plan to bring a package to a rendering.

    Args:
        root: the package; it need not be there.
        rendering: folder with all its generated files.
        beside: files of ours that have no place in it, such as the answers; ``None``: it goes.
        adopted: bodies of a former package, which count as saved ones.
        kept: more texts of a person to keep, by name.
    """
    return _Sync(root, rendering, beside or {}, adopted).plan(kept or {})


@dataclass(frozen=True)
class _New:
    """A file of the rendering."""

    data: bytes
    marked: MarkedFile
    mode: int

    @property
    def digest(self) -> str:
        return digest_of(self.data, self.marked)

    @property
    def texts(self) -> list[str]:
        """All text that is generated."""
        return [part if isinstance(part, str) else part.body for part in self.marked.parts]


class _Sync:
    def __init__(
        self,
        root: Path,
        rendering: Path,
        beside: Mapping[str, bytes | None],
        adopted: Sequence[Body],
    ) -> None:
        self.root = root
        self.beside = beside
        self.adopted = {body.region.id: body for body in adopted}
        self.manifest: Manifest = manifest_of(root)
        self.new = {name: _new(rendering / name) for name in _names(rendering)}
        self.files: dict[str, PackageFile] = {}
        self.stamps: dict[str, tuple[int, ...]] = {}
        self.refusals: list[Refusal] = []
        self.notes: list[Note] = []
        self.doubles: list[Body] = []  # in a file that is moved, where the new one has another
        self.first: list[Step] = []  # copies and saved bodies
        self.last: list[Step] = []  # saved bodies that are back in their places

    def plan(self, kept: Mapping[str, bytes]) -> Plan:
        self._read()
        bodies = self._bodies()
        edited = [name for name in sorted(self.files) if self._is_edited(name)]
        if self.refusals:
            return Plan(self.root, self.refusals)
        rendered = {
            id_: region for new in self.new.values() for id_, region in new.marked.regions.items()
        }
        chosen = choose(rendered, bodies)
        content = self._content(rendered, chosen)
        for name, data in kept.items():
            self.notes.append(Note(name, None, f"kept in {self._keep(name, data)}"))
        self._keep_files(edited)
        self._keep_bodies(bodies, chosen, content)
        self._tell_missing()
        middle = [*self._written(rendered, chosen, content), *self._removed()]
        return self._plan(middle)

    def _refuse(self, file: str, line: int | None, reason: str) -> None:
        self.refusals.append(Refusal(file, line, reason))

    def _read(self) -> None:
        """Read all files that are, or were, generated; refuse what is none, or damaged."""
        ours = [*self.beside, MANIFEST, f"{KEPT}/x"]
        for name in sorted({*self.new, *self.manifest.files, *ours}):
            found = obstacle(self.root, name)
            if found is not None:
                hint = "move it away, nothing is written through it or over it"
                self._refuse(name, None, f"{found}; {hint}")
                continue
            self.stamps[name] = stamp_of(self.root / name)
            if name in ours:
                continue
            try:
                file = read_file(self.root, name)
            except OSError as refused:
                self._refuse(name, None, f"cannot be read: {refused.strerror}")
                continue
            if file is not None:
                self.files[name] = file
                for fault in file.faults:
                    self._refuse(name, fault.line, fault.reason)

    def _bodies(self) -> Bodies:
        """Return the bodies in the package by id."""
        present: dict[str, Body] = {}
        for name, file in self.files.items():
            for id_, body in self._regions(name, file).items():
                other = present.setdefault(id_, body)
                if other is body:
                    continue
                # A region moves: a run was killed in between, or a branch wrote in the old file.
                stays, goes = (body, other) if self._has(body) else (other, body)
                known = goes.untouched or (id_, normal(goes.region.body)) in self._held()
                if self._has(goes) or not self._has(stays) or (goes.file in self.new and not known):
                    first = f"{other.file}:{other.region.line}"
                    reason = f"second region {id_!r}, the first is in {first}; keep one"
                    self._refuse(name, body.region.line, reason)
                elif stays.untouched and not known:
                    stays, goes = goes, stays
                present[id_] = stays
                self.doubles.append(goes)
        kept: dict[str, Body] = {}
        for name, found in kept_regions(self.root):
            if found is not None:
                kept[found.region.id] = found
            else:
                self.notes.append(Note(name, None, "no region can be read in it; look at it"))
        return Bodies(present, {**kept, **self.adopted})

    def _has(self, body: Body) -> bool:
        """Whether the rendering has this region in the same file."""
        return body.file in self.new and body.region.id in self.new[body.file].marked.regions

    def _held(self) -> set[tuple[str, str]]:
        """Return the bodies that are where the rendering has their regions, by each former id."""
        found = {
            Body(one, name)
            for name, file in self.files.items()
            for side in file.sides
            for one in side.regions.values()
        }
        mine = (body.region for body in found if self._has(body))
        return {(id_, normal(one.body)) for one in mine for id_ in (one.id, *one.was)}

    def _regions(self, name: str, file: PackageFile) -> dict[str, Body]:
        """Return the regions of a file; of a conflict, those that one side alone has written."""
        found = [{id_: Body(one, name) for id_, one in side.regions.items()} for side in file.sides]
        if len(found) == 1:
            return found[0]
        ours, theirs = found
        common = parse(text_of(ancestor_bytes(self.root, name)))[0].regions
        merged = {**theirs, **ours}
        for id_ in ours.keys() & theirs.keys():
            a, b = ours[id_], theirs[id_]
            if normal(a.region.body) == normal(b.region.body) or b.untouched:
                continue
            before = common.get(id_)
            was = None if before is None else normal(before.body)
            if a.untouched or normal(a.region.body) == was:
                merged[id_] = b
            elif normal(b.region.body) != was:
                line = next(
                    (n for n, text in enumerate(file.text.split("\n"), 1) if f": {id_}" in text), 1
                )
                reason = f"both branches wrote in region {id_!r}; resolve this conflict by hand"
                self._refuse(name, line, reason)
        return merged

    def _is_edited(self, name: str) -> bool:
        """Return whether a file is not as it was made; refuse one that is a person's."""
        file = self.files[name]
        known = self.manifest.files.get(name, frozenset())
        made = known | ({self.new[name].digest} if name in self.new else frozenset())
        if made.issuperset(file.digests):
            return False
        if made_by_git(self.root, name, file.digests, known):
            return False
        if not known and self.manifest.exists and name in self.new:
            reason = "this file is yours, and a generated one has this name now; give yours another"
            self._refuse(name, None, reason)
        return True

    def _content(
        self, rendered: Mapping[str, Region], chosen: Mapping[str, Choice]
    ) -> dict[str, Placed]:
        """Return what each region of the rendering holds."""
        changed = [
            file
            for name, file in self.files.items()
            if name not in self.new or file.digests != [self.new[name].digest]
        ]
        names: set[str] = set()
        words: set[str] = set()
        if changed and any(one.body and not one.body.untouched for one in chosen.values()):
            names = defined_names(text for file in changed for text in _generated(file))
            words = words_of(text for new in self.new.values() for text in new.texts)
        content = {}
        for id_, region in rendered.items():
            choice = chosen[id_]
            one = content[id_] = placed(region, choice, names, words)
            if choice.body is not None and choice.body.kept and id_ not in self.adopted:
                self.notes.append(Note(self._file_of(id_), None, f"region {id_!r} is back", False))
            if one.now is not None:
                reasons = look_reasons(one.digests, one.now, choice.former)
                text = f"region {id_!r}: look at it: {reasons}"
                self.notes.append(Note(self._file_of(id_), None, text))
        return content

    def _file_of(self, id_: str) -> str:
        return next(name for name, new in self.new.items() if id_ in new.marked.regions)

    def _keep_files(self, edited: Sequence[str]) -> None:
        """Keep a copy of each file that was edited outside of its regions."""
        for name in edited:
            file = self.files[name]
            place = self._keep(name, file.data)
            new = self.new.get(name)
            text = f"; your file is kept in {place}"
            if new is None:
                text = f", and is not generated any more{text}"
            else:
                regions = ", ".join([*new.marked.regions][:_MOST_LINES])
                where = f"in a region: {regions}" if regions else "in a file of your own"
                text = f"{_other_lines(file.sides[0], new.marked)}{text}; write it {where}"
            self.notes.append(Note(name, None, f"edited outside regions{text}"))

    def _keep_bodies(
        self, bodies: Bodies, chosen: Mapping[str, Choice], content: Mapping[str, Placed]
    ) -> None:
        """Save the written bodies that have no place, and forget the saved ones that have one."""
        used = {id(one.body) for one in chosen.values() if one.body is not None}
        names = {
            id_: [id_, *self.new[self._file_of(id_)].marked.regions[id_].was] for id_ in content
        }
        holds = {
            (name, normal(one.body))
            for id_, one in content.items()
            if one.written
            for name in names[id_]
        }
        present = {**self.adopted, **bodies.present}.values()
        for body in [*present, *self.doubles]:
            id_ = body.region.id
            if id(body) in used or body.untouched:
                continue
            if (id_, normal(body.region.body)) in holds:
                continue  # a killed run has moved it already
            place = self._keep_region(body)
            gone = "is not generated any more" if id_ not in content else "has another body now"
            reason = f"region {id_!r} {gone}; your text is kept in {place}"
            self.notes.append(Note(body.file, body.region.line, reason))
        for id_, choice in chosen.items():  # a body is kept while it moves from file to file
            moved = choice.body if content[id_].written else None
            if moved and moved.file in self.new.keys() - {self._file_of(id_)}:
                self.last.append(Step(self._keep_region(moved), None))
        for name, saved in kept_regions(self.root):
            if saved is None:
                continue
            placed_ = (saved.region.id, normal(saved.region.body)) in holds
            default = saved.region.id in content and not content[saved.region.id].written
            same = default and normal(content[saved.region.id].body) == normal(saved.region.body)
            if placed_ or same:
                self.stamps[name] = stamp_of(self.root / name)
                self.last.append(Step(name, None))

    def _keep_region(self, body: Body) -> str:
        """Plan to keep a region; return where it is then."""
        name = f"{encode_id(body.region.id)}.region"
        return self._keep(name, bytes_of(saved_text(body.region)))

    def _keep(self, name: str, data: bytes) -> str:
        """Plan to keep a text; return where it is then."""
        place = free_name(self.root, name, data, [step.path for step in self.first])
        if place is not None:
            self.first.append(Step(place, data))
        return place or f"{KEPT}/{name}"

    def _tell_missing(self) -> None:
        """Tell of each generated file that a person removed."""
        for name in sorted(self.manifest.files.keys() & self.new.keys() - self.files.keys()):
            if not self.manifest.mixed:
                regions = bool(self.new[name].marked.regions)
                yours = f"; `git log -- {name}` has yours" if regions else ""
                text = f"you removed this file; it is written again{yours}"
                self.notes.append(Note(name, None, text, regions))

    def _written(
        self,
        rendered: Mapping[str, Region],
        chosen: Mapping[str, Choice],
        content: Mapping[str, Placed],
    ) -> Iterator[Step]:
        """Yield the files that get new bytes."""
        sources = {id_: one.body for id_, one in chosen.items() if one.body is not None}
        for name, new in sorted(self.new.items()):
            old = self.files.get(name)
            data = new.data
            if new.marked.regions or new.digest == new.marked.digest:
                text = old.text if old is not None else ""
                data = bytes_of(
                    text[: text.startswith("\ufeff")]
                    + compose(new.marked, content, sources, eol_of(text))
                )
                if old is not None and _same(text_of(data), text):
                    data = old.data
            mode = new.mode if old is None else _mode(old.mode, new.mode)
            if old is None or old.data != data or old.mode != mode:
                yield Step(name, data, mode)

    def _removed(self) -> Iterator[Step]:
        for name in sorted(self.manifest.files.keys() - self.new.keys()):
            if name in self.files:
                yield Step(name, None)

    def _plan(self, middle: list[Step]) -> Plan:
        """Put the steps into their order: answers, saved texts, files, saved texts that are back.

        Between the first and the last of the files the manifest lists both renderings.
        """
        beside = [
            Step(name, data) for name, data in self.beside.items() if data != self._bytes(name)
        ]
        answers = self.beside.get(ANSWERS) or self._bytes(ANSWERS) or b""
        now = {name: new.digest for name, new in self.new.items()}
        leaves = not self.new and bool(self.beside)
        final = None if leaves else manifest_text(now, text_of(answers)).encode()
        old = self._bytes(MANIFEST)
        listed = {line for text in (final, old) if text for line in text.decode().splitlines()}
        mixed = "".join(f"{line}\n" for line in sorted(listed)).encode()
        between = [Step(MANIFEST, mixed)] if middle and old != final else []
        manifest = [Step(MANIFEST, final)] if old != final else []
        new = [step for step in beside if step.data is not None]
        gone = [step for step in reversed(beside) if step.data is None]  # the answers last of all
        steps = [*new, *self.first, *between, *middle, *self.last, *manifest, *gone]
        before = {name: file.data for name, file in self.files.items()}
        for step in [*beside, *self.last]:
            if (data := self._bytes(step.path)) is not None:
                before[step.path] = data
        return Plan(self.root, (), self._all_notes(), steps, before, self.stamps)

    def _bytes(self, name: str) -> bytes | None:
        return (self.root / name).read_bytes() if stamp_of(self.root / name) else None

    def _all_notes(self) -> list[Note]:
        """Return the notes, and what is open since earlier runs."""
        told = " ".join(note.text + note.file for note in self.notes)
        gone = {step.path for step in self.last}
        waiting = [
            Note(name, None, "it is kept there until you remove it")
            for name in kept_names(self.root)
            if name not in gone and name not in told
        ]
        return [*self.notes, *waiting]


def look_reasons(digests: Digests, now: Look, former: str | None = None) -> str:
    """Return why a person must look at a body.

    Args:
        digests: what it was written for.
        now: what its place is now.
        former: the id of another region that it comes from.
    """
    reasons = [f"it was written for {former!r}"] if former else []
    if digests.of is None:
        reasons.append("it is not known what it was written for")
    elif digests.uses != now.digests.uses:
        reasons.append("what it may use has changed")
    elif digests.of != now.digests.of:
        reasons.append("the generated text in its place has changed")
    reasons += [f"it uses {name}, which is not generated any more" for name in now.missing]
    return "; ".join(reasons)


def _new(path: Path) -> _New:
    data = path.read_bytes()
    if path.suffix == ".py" and b"fmt: off" not in data[:500]:  # formatters leave the file alone
        program = data[: data.index(b"\n") + 1] if data.startswith(b"#!") else b""
        data = program + b"# fmt: off\n" + data[len(program) :]
    mode = 0o755 if path.stat().st_mode & 0o100 else 0o644
    return _New(data, parse(text_of(data))[0], mode)


def _names(rendering: Path) -> list[str]:
    return sorted(name for name, kind in entries(rendering) if kind is None)


def _generated(file: PackageFile) -> Iterator[str]:
    """Yield the text of a file that no person wrote."""
    for part in file.sides[0].parts:
        if isinstance(part, str):
            yield part
        elif Body(part, "").untouched:
            yield part.body


def _other_lines(mine: MarkedFile, new: MarkedFile) -> str:
    """Return which lines of a file are not in its new rendering, for people."""
    numbers: list[int] = []
    line = 1
    for part in mine.parts:
        numbers.append(line)
        line += 1 if isinstance(part, str) else part.body.count("\n") + 2
    a, b = ([one.rstrip() for one in text.outside] for text in (mine, new))
    codes = difflib.SequenceMatcher(None, a, b, autojunk=False).get_opcodes()
    changed = [range(first, last) for what, first, last, _, _ in codes if what != "equal"]
    found = [numbers[at] for lines in changed for at in lines]
    shown = ", ".join(map(str, found[:_MOST_LINES])) + (", ..." if found[_MOST_LINES:] else "")
    return f" (line{'s' if found[1:] else ''} {shown})" if found else ""


def _same(text: str, other: str) -> bool:
    """Return whether two texts differ in no more than blanks at line ends."""
    return text_digest(text) == text_digest(other)


def _mode(old: int, new: int) -> int:
    """Return the permissions of a file: those that it has; a program can be run."""
    return old | ((old & 0o444) >> 2 if new & 0o100 else 0)
