"""Bring a package to a new rendering: every region keeps its body, nothing else is merged.

A person's text and generated text share a file only in regions. What was edited outside of them is
kept as a copy, and said. Planning changes nothing; what was planned is written in one go.
"""

from __future__ import annotations

import difflib
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from . import package
from .choosing import (
    Body,
    Chosen,
    Placed,
    choose,
    compose,
    defined_names,
    eol_of,
    placed,
    saved_text,
    words_of,
)
from .git import ancestor_bytes
from .marked_file import MarkedFile, Region, parse
from .markers import Digests, Look, encode_id, normal, text_digest
from .package import ANSWERS, EDDI, KEPT, MANIFEST, NEW, PUT, PackageFile, Step

_MOST_LINES = 6


@dataclass(frozen=True)
class Note:
    """One thing that happened to a person's text, or why nothing is written."""

    file: str  # relative to the package
    line: int | None  # in the file, None when there is none
    text: str  # one sentence without a full stop
    attention: bool = True  # whether a person must look at it

    @property
    def place(self) -> str:
        """The file, and the line where there is one."""
        return self.file if self.line is None else f"{self.file}:{self.line}"


@dataclass(frozen=True)
class Plan:
    """What a sync does, or why it does nothing."""

    root: Path  # the package
    refusals: Sequence[Note] = ()  # with any of them nothing may be written
    notes: Sequence[Note] = ()
    steps: Sequence[Step] = ()  # in the order in which they are made
    stamps: Mapping[str, tuple[int, ...]] = field(default_factory=dict)  # of all that were read

    def prepare(self) -> None:
        """Write all new bytes beside their places.

        Raises:
            OSError: the disk is full, or a folder is not writable; nothing of a person changed.
            SavedError: a person saved a file meanwhile.
        """
        package.put_aside(self.root, self.steps, self.root / PUT)
        package.refuse_saved(self.root, self.stamps)

    def finish(self) -> None:
        """Move everything to its place; of a package that leaves no empty folder stays."""
        package.refuse_saved(self.root, self.stamps)
        package.move_in(self.root, self.steps)
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
    renamed: Mapping[str, str] | None = None,
) -> Plan:
    """Plan to bring a package to a rendering.

    Args:
        root: the package; it need not be there.
        rendering: folder with all its generated files.
        beside: files of ours that have no place in it, such as the answers; ``None``: it goes.
        adopted: bodies of a former package, which count as saved ones.
        kept: more texts of a person to keep, by name.
        renamed: new id of a region -> old one, for this time: the rendering does not tell it.
    """
    saved = {body.region.id: body for body in adopted}
    return _Sync(root, rendering, beside or {}, saved).plan(kept or {}, renamed or {})


class _Sync:
    def __init__(
        self,
        root: Path,
        rendering: Path,
        beside: Mapping[str, bytes | None],
        adopted: Mapping[str, Body],
    ) -> None:
        self.root, self.beside, self.adopted = root, beside, adopted
        self.manifest = package.manifest_of(root)
        names = sorted(name for name, kind in package.entries(rendering) if kind is None)
        self.new = {name: _rendered(rendering / name) for name in names}
        self.home = {id_: name for name, new in self.new.items() for id_ in new.marked.regions}
        self.rendered = {id_: self.new[name].marked.regions[id_] for id_, name in self.home.items()}
        self.files: dict[str, PackageFile] = {}
        self.stamps: dict[str, tuple[int, ...]] = {}
        self.refusals: list[Note] = []
        self.notes: list[Note] = []
        self.doubles: list[Body] = []  # in a file that is moved, where the new one has another
        self.first: list[Step] = []  # copies and saved bodies
        self.last: list[Step] = []  # saved bodies that are back in their places

    def plan(self, kept: Mapping[str, bytes], renamed: Mapping[str, str]) -> Plan:
        self._read()
        before, saved = self._present(), self._saved()
        moved = {new: before[old] for new, old in renamed.items() if old in before}
        present = {id_: one for id_, one in before.items() if id_ not in renamed.values()}
        for id_, body in moved.items():
            present[id_] = replace(body, region=replace(body.region, id=id_))
        edited = [name for name in sorted(self.files) if self._is_edited(name)]
        if self.refusals:
            return Plan(self.root, self.refusals)
        chosen = choose(self.rendered, present, saved)
        content = self._content(chosen)
        for name, data in kept.items():
            self._note(name, f"kept in {self._keep(name, data)}")
        for name in edited:
            self._keep_file(name)
        self._keep_bodies({**self.adopted, **present}.values(), chosen, content)
        gone = sorted(self.manifest.files.keys() & self.files.keys() - self.new.keys())
        return self._plan([*self._written(content), *(Step(name, None) for name in gone)])

    def _refuse(self, file: str, line: int | None, reason: str) -> None:
        self.refusals.append(Note(file, line, reason))

    def _note(self, file: str, text: str, line: int | None = None, attention: bool = True) -> None:
        self.notes.append(Note(file, line, text, attention))

    # what is there --------------------------------------------------------------------------------
    def _read(self) -> None:
        """Read all files that are, or were, generated; refuse what is none, or damaged."""
        ours = [*self.beside, MANIFEST, f"{KEPT}/*"]
        for name in sorted({*self.new, *self.manifest.files, *ours}):
            found = package.obstacle(self.root, name)
            if found is not None:
                hint = "move it away, nothing is written through it or over it"
                self._refuse(name, None, f"{found}; {hint}")
                continue
            self.stamps[name] = package.stamp_of(self.root / name)
            try:
                file = None if name in ours else package.read_file(self.root, name)
            except OSError as refused:
                self._refuse(name, None, f"cannot be read: {refused.strerror}")
                continue
            if file is not None:
                self.files[name] = file
                for fault in file.faults:
                    self._refuse(name, fault.line, fault.reason)

    def _present(self) -> dict[str, Body]:
        """Return the bodies in the files of the package by id."""
        present: dict[str, Body] = {}
        for name, file in self.files.items():
            for id_, body in self._regions(name, file).items():
                other = present.setdefault(id_, body)
                if other is body:
                    continue
                # A region moves: a run was killed in between, or a branch wrote in the old file.
                stays, goes = (body, other) if self._has(body) else (other, body)
                known = goes.region.untouched or (id_, normal(goes.region.body)) in self._held()
                if self._has(goes) or not self._has(stays) or (goes.file in self.new and not known):
                    first = f"{other.file}:{other.region.line}"
                    reason = f"second region {id_!r}, the first is in {first}; keep one"
                    self._refuse(name, body.region.line, reason)
                elif stays.region.untouched and not known:
                    stays, goes = goes, stays
                present[id_] = stays
                self.doubles.append(goes)
        return present

    def _saved(self) -> dict[str, Body]:
        saved: dict[str, Body] = {}
        for name, found in package.kept_regions(self.root):
            if found is not None:
                saved[found.region.id] = found
            else:
                self._note(name, "no region can be read in it; look at it")
        return {**saved, **self.adopted}

    def _has(self, body: Body) -> bool:
        """Whether the rendering has this region in the same file."""
        return body.file in self.new and body.region.id in self.new[body.file].marked.regions

    def _held(self) -> set[tuple[str, str]]:
        """Return the bodies that are where the rendering has their regions, by each former id."""
        regions = [
            region
            for name, file in self.files.items()
            for side in file.sides
            for region in side.regions.values()
            if self._has(Body(region, name))
        ]
        return {
            (id_, normal(region.body)) for region in regions for id_ in (region.id, *region.was)
        }

    def _regions(self, name: str, file: PackageFile) -> dict[str, Body]:
        """Return the regions of a file; of a conflict, those that one side alone has written."""
        found = [
            {id_: Body(region, name) for id_, region in side.regions.items()} for side in file.sides
        ]
        if len(found) == 1:
            return found[0]
        ours, theirs = found
        common = parse(package.text_of(ancestor_bytes(self.root, name)))[0].regions
        merged = {**theirs, **ours}
        for id_ in ours.keys() & theirs.keys():
            a, b = ours[id_], theirs[id_]
            if normal(a.region.body) == normal(b.region.body) or b.region.untouched:
                continue
            was = normal(common[id_].body) if id_ in common else None
            if a.region.untouched or normal(a.region.body) == was:
                merged[id_] = b
            elif normal(b.region.body) != was:
                line = 1 + file.text[: max(file.text.find(f": {encode_id(id_)}"), 0)].count("\n")
                reason = f"both branches wrote in region {id_!r}; resolve this conflict by hand"
                self._refuse(name, line, reason)
        return merged

    def _is_edited(self, name: str) -> bool:
        """Return whether a file is not as it was made; refuse one that is a person's."""
        file = self.files[name]
        known = self.manifest.files.get(name, frozenset())
        new = self.new[name].digests if name in self.new else ()
        if package.is_as_made(self.root, name, file.digests, known, new):
            return False
        if not known and self.manifest.exists and name in self.new:
            reason = "this file is yours, and a generated one has this name now; give yours another"
            self._refuse(name, None, reason)
        return True

    # what becomes of it ---------------------------------------------------------------------------
    def _content(self, chosen: Chosen) -> dict[str, Placed]:
        """Return what each region of the rendering holds."""
        names: set[str] = set()
        words: set[str] = set()
        if any(body and not body.region.untouched for body, _ in chosen.values()):
            changed = (
                file
                for name, file in self.files.items()
                if name not in self.new or file.digests != self.new[name].digests
            )
            names = defined_names(text for file in changed for text in _generated(file))
            parts = (part for new in self.new.values() for part in new.marked.parts)
            words = words_of(part if isinstance(part, str) else part.body for part in parts)
        content = {}
        for id_, region in self.rendered.items():
            body, former = chosen[id_]
            one = content[id_] = placed(region, body, names, words)
            if body is not None and body.kept and id_ not in self.adopted:
                self._note(self.home[id_], f"region {id_!r} is back", attention=False)
            if one.now is not None:
                reasons = look_reasons(one.digests, one.now, former)
                self._note(self.home[id_], f"region {id_!r}: look at it: {reasons}")
        return content

    def _keep_file(self, name: str) -> None:
        """Keep a copy of a file that was edited outside of its regions."""
        file, new = self.files[name], self.new.get(name)
        text = f"; your file is kept in {self._keep(name, file.data)}"
        if new is None:
            text = f", and is not generated any more{text}"
        else:
            regions = ", ".join([*new.marked.regions][:_MOST_LINES])
            where = f"in a region: {regions}" if regions else "in a file of your own"
            text = f"{_other_lines(file.marked, new.marked)}{text}; write it {where}"
        self._note(name, f"edited outside regions{text}")

    def _keep_bodies(
        self, present: Iterable[Body], chosen: Chosen, content: Mapping[str, Placed]
    ) -> None:
        """Save the written bodies that have no place, and forget the saved ones that have one."""
        used = {id(body) for body, _ in chosen.values()}
        held = {
            (name, normal(one.body))
            for id_, one in content.items()
            if one.source
            for name in (id_, *self.rendered[id_].was)
        }
        for body in [*present, *self.doubles]:
            id_ = body.region.id
            moved = (id_, normal(body.region.body)) in held  # by a run that was killed
            if id(body) not in used and not body.region.untouched and not moved:
                gone = "has another body now" if id_ in content else "is not generated any more"
                text = f"region {id_!r} {gone}; your text is kept in {self._keep_region(body)}"
                self._note(body.file, text, body.region.line)
        for id_, one in content.items():  # a body is kept while it moves from file to file
            if one.source and one.source.file in self.new.keys() - {self.home[id_]}:
                self.last.append(Step(self._keep_region(one.source), None))
        held |= {(id_, normal(one.body)) for id_, one in content.items()}
        for name, saved in package.kept_regions(self.root):
            if saved is not None and (saved.region.id, normal(saved.region.body)) in held:
                self.stamps[name] = package.stamp_of(self.root / name)
                self.last.append(Step(name, None))

    def _keep_region(self, body: Body) -> str:
        """Plan to keep a region; return where it is then."""
        name = f"{encode_id(body.region.id)}.region"
        return self._keep(name, package.bytes_of(saved_text(body.region)))

    def _keep(self, name: str, data: bytes) -> str:
        """Plan to keep a text; return where it is then."""
        place = package.free_name(self.root, name, data, [step.path for step in self.first])
        if place is not None:
            self.first.append(Step(place, data))
        return place or f"{KEPT}/{name}"

    # how it is written ----------------------------------------------------------------------------
    def _written(self, content: Mapping[str, Placed]) -> Iterator[Step]:
        """Yield the files that get new bytes."""
        for name, new in self.new.items():
            old = self.files.get(name)
            data, mode = new.data, new.mode
            if old is None and name in self.manifest.files and not self.manifest.mixed:
                regions = bool(new.marked.regions)
                yours = f"; `git log -- {name}` has yours" if regions else ""
                text = f"you removed this file; it is written again{yours}"
                self._note(name, text, attention=regions)
            if new.is_text:
                text = old.text if old is not None else ""
                composed = compose(new.marked, content, eol_of(text))
                data = package.bytes_of(text[: text.startswith("\ufeff")] + composed)
                if old is not None and text_digest(package.text_of(data)) == text_digest(text):
                    data = old.data  # no more than blanks at line ends
            if old is not None:  # permissions stay, but a program can be run
                mode = old.mode | ((old.mode & 0o444) >> 2 if new.mode & 0o100 else 0)
            if old is None or (old.data, old.mode) != (data, mode):
                yield Step(name, data, mode)

    def _plan(self, middle: list[Step]) -> Plan:
        """Put the steps into their order: answers, saved texts, files, saved texts that are back.

        Between the first and the last of the files the manifest lists both renderings.
        """
        there = {
            name: package.bytes_at(self.root, name) for name in (*self.beside, ANSWERS, MANIFEST)
        }
        beside = [Step(name, data) for name, data in self.beside.items() if data != there[name]]
        answers = self.beside.get(ANSWERS) or there[ANSWERS] or b""
        now = {name: new.digests[0] for name, new in self.new.items()}
        leaves = not self.new and bool(self.beside)
        final = None if leaves else package.manifest_text(now, package.text_of(answers)).encode()
        old = there[MANIFEST]
        listed = {line for text in (final, old) if text for line in text.decode().splitlines()}
        mixed = "".join(f"{line}\n" for line in sorted(listed)).encode()
        between = [Step(MANIFEST, mixed)] if middle and old != final else []
        manifest = [Step(MANIFEST, final)] if old != final else []
        new = [step for step in beside if step.data is not None]
        gone = [step for step in reversed(beside) if step.data is None]  # the answers last of all
        steps = [*new, *self.first, *between, *middle, *self.last, *manifest, *gone]
        return Plan(self.root, (), [*self.notes, *self._waiting()], steps, self.stamps)

    def _waiting(self) -> Iterator[Note]:
        """Yield what is kept since earlier runs."""
        told = " ".join(note.text + note.file for note in self.notes)
        gone = {step.path for step in self.last}
        for name in package.kept_names(self.root):
            if name not in gone and name not in told:
                yield Note(name, None, "it is kept there until you remove it")


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


def _rendered(path: Path) -> PackageFile:
    data = path.read_bytes()
    if path.suffix == ".py" and b"fmt: off" not in data[:500]:  # formatters leave the file alone
        program = data[: data.index(b"\n") + 1] if data.startswith(b"#!") else b""
        data = program + b"# fmt: off\n" + data[len(program) :]
    return PackageFile(data, 0o755 if path.stat().st_mode & 0o100 else 0o644)


def _generated(file: PackageFile) -> Iterator[str]:
    """Yield the text of a file that no person wrote."""
    for part in file.marked.parts:
        if isinstance(part, Region):
            yield part.body if part.untouched else ""
        else:
            yield part


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
