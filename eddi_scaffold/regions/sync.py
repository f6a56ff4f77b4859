"""Bring a package to a new rendering: every region keeps its body, nothing else is merged.

A person's text and generated text share a file only in regions. What was edited outside of them is
kept as a copy, and said. Planning changes nothing; what was planned is written in one go.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from pathlib import Path

from . import choosing, package
from .choosing import WORD, Body, Chosen, Placed
from .git import version
from .marked_file import MarkedFile, parse
from .markers import encode_id, normal, tail_of, text_digest, with_tail
from .package import ANSWERS, KEPT, MANIFEST, Note, PackageFile, Plan, Step

_DEFINED = re.compile(r"self\.(\w+)|\b(?:def|class|import|as)\s+(\w+)|<arg\s+name=[\"'](\w+)[\"']")
_MOST_LINES = 6


def plan_sync(
    root: Path,
    rendering: Path,
    records: Mapping[str, bytes | None] | None = None,
    adopted: Sequence[Body] = (),
    kept: Mapping[str, bytes] | None = None,
    renamed: Mapping[str, str] | None = None,
) -> Plan:
    """Plan to bring a package to a rendering.

    Args:
        root: the package; it need not be there.
        rendering: folder with all its generated files.
        records: files of ours that have no place in it, such as the answers; ``None``: it goes.
        adopted: bodies of a former package, which count as saved ones.
        kept: more texts of a person to keep, by name.
        renamed: new id of a region -> old one, for this time: the rendering does not tell it.
    """
    bodies = {body.region.id: body for body in adopted}
    return _Sync(root, rendering, records or {}, bodies).plan(kept or {}, renamed or {})


class _Sync:
    def __init__(
        self,
        root: Path,
        rendering: Path,
        records: Mapping[str, bytes | None],
        adopted: dict[str, Body],
    ) -> None:
        self.root, self.records, self.adopted = root, records, adopted
        self.manifest, self.kept = package.manifest_of(root), package.kept_texts(root)
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
        saved = {body.region.id: body for body in self.kept.values() if body} | self.adopted
        before = self._present()
        present = {id_: body for id_, body in before.items() if id_ not in renamed.values()}
        for new, old in renamed.items():
            if old in before:
                present[new] = before[old]._replace(region=before[old].region._replace(id=new))
        edited = [name for name in sorted(self.files) if self._is_edited(name)]
        if self.refusals:
            return Plan(self.root, self.refusals)
        chosen = choosing.choose(self.rendered, present, saved)
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

    def _read(self) -> None:
        """Read all files that are, or were, generated; refuse what is none, or damaged."""
        ours = [*self.records, MANIFEST, f"{KEPT}/*"]
        for name in sorted({*self.new, *self.manifest.files, *ours}):
            if obstacle := package.obstacle(self.root, name):
                hint = "move it away, nothing is written through it or over it"
                self._refuse(name, None, f"{obstacle}; {hint}")
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
        """Return the bodies in the files of the package by id; in two files it is the one at home.

        A region moves from file to file: a run was killed in between, or branches did it.
        """
        present: dict[str, Body] = {}
        for name, file in self.files.items():
            for id_, body in self._regions(name, file).items():
                if id_ in present and self.home.get(id_) != name:
                    self.doubles.append(body)
                    continue
                self.doubles += [present[id_]] if id_ in present else []
                present[id_] = body
        return present

    def _regions(self, name: str, file: PackageFile) -> dict[str, Body]:
        """Return the regions of a file; of a conflict, those that one side alone has written."""
        ours, *others = (
            {id_: Body(region, name) for id_, region in side.regions.items()} for side in file.sides
        )
        if not others:
            return ours
        (theirs,) = others
        merged = {**theirs, **ours}
        ancestor = parse(package.text_of(version(self.root, name, ":1")))[0].regions
        for id_ in ours.keys() & theirs.keys():
            a, b = ours[id_].region, theirs[id_].region
            before = [normal(ancestor[id_].body)] if id_ in ancestor else []
            known = set(ancestor[id_].was) if id_ in ancestor else set()
            one_meaning = {*a.was} - known == {*b.was} - known
            if b.untouched or normal(a.body) == normal(b.body):
                continue
            if one_meaning and (a.untouched or normal(a.body) in before):
                merged[id_] = theirs[id_]
            elif normal(b.body) not in before:
                line = 1 + file.text[: max(file.text.find(f": {encode_id(id_)}"), 0)].count("\n")
                wrote = f"both branches wrote in region {id_!r}"
                renamed = f"region {id_!r} has another meaning in each branch"
                reason = wrote if one_meaning else renamed
                self._refuse(name, line, f"{reason}; resolve this conflict by hand")
        return merged

    def _is_edited(self, name: str) -> bool:
        """Return whether a file is not as it was made; refuse one that is a person's."""
        known = self.manifest.files.get(name, frozenset())
        new = self.new[name].digests if name in self.new else ()
        if package.is_as_made(self.root, name, self.files[name].digests, known, new):
            return False
        if not known and self.manifest.exists and name in self.new:
            reason = "this file is yours, and a generated one has this name now; give yours another"
            self._refuse(name, None, reason)
        return True

    def _content(self, chosen: Chosen) -> dict[str, Placed]:
        names: set[str] = set()
        words: set[str] = set()
        if any(body and not body.region.untouched for body, _ in chosen.values()):
            names = {
                name
                for path, file in self.files.items()
                if path not in self.new or file.digests != self.new[path].digests
                for part in file.marked.parts
                if isinstance(part, str) or part.untouched
                for names in _DEFINED.findall(part if isinstance(part, str) else part.body)
                for name in names
            }
            for part in (part for new in self.new.values() for part in new.marked.parts):
                words.update(WORD.findall(part if isinstance(part, str) else part.body))
        content = {}
        for id_, region in self.rendered.items():
            body, former = chosen[id_]
            new = content[id_] = choosing.placed(region, body, names, words)
            if body is not None and body.kept and id_ not in self.adopted:
                self._note(self.home[id_], f"region {id_!r} is back", attention=False)
            if new.now is not None:
                reasons = choosing.look_reasons(new.digests, new.now, former)
                self._note(self.home[id_], f"region {id_!r}: look at it: {reasons}")
        return content

    def _keep_file(self, name: str) -> None:
        file, new = self.files[name], self.new.get(name)
        what, where = ", and is not generated any more", ""
        if new is not None:
            regions = ", ".join([*new.marked.regions][:_MOST_LINES])
            what = _other_lines(file.marked, new.marked)
            where = f"; write it in a {f'region: {regions}' if regions else 'file of your own'}"
        kept = self._keep(name, file.data)
        self._note(name, f"edited outside regions{what}; your file is kept in {kept}{where}")

    def _keep_bodies(
        self, present: Iterable[Body], chosen: Chosen, content: Mapping[str, Placed]
    ) -> None:
        """Save the written bodies that have no place, and forget the saved ones that have one."""
        used = {id(body) for body, _ in chosen.values()}
        held = {
            (name, normal(new.body))
            for id_, new in content.items()
            for name in (id_, *self.rendered[id_].was)
        }
        for body in [*present, *self.doubles]:
            id_ = body.region.id
            moved = (id_, normal(body.region.body)) in held  # by a run that was killed
            if id(body) not in used and not body.region.untouched and not moved:
                gone = "has another body now" if id_ in content else "is not generated any more"
                text = f"region {id_!r} {gone}; your text is kept in {self._keep_region(body)}"
                self._note(body.file, text, body.region.line)
        for id_, new in content.items():  # a body is kept while it moves from file to file
            if new.source and new.source.file in self.new.keys() - {self.home[id_]}:
                self.last.append(Step(self._keep_region(new.source), None))
        for name, saved in self.kept.items():
            if saved is not None and (saved.region.id, normal(saved.region.body)) in held:
                self.stamps[name] = package.stamp_of(self.root / name)
                self.last.append(Step(name, None))

    def _keep_region(self, body: Body) -> str:
        id_, region = body.region.id, body.region
        begin = with_tail(region.begin, id_, tail_of(region.digests, region.was))
        text = f"{begin}\n{region.body}{with_tail(region.end, id_, '')}\n"
        return self._keep(f"{encode_id(id_)}.region", package.bytes_of(text))

    def _keep(self, name: str, data: bytes) -> str:
        """Plan to keep a text; return where it is then."""
        place = package.free_name(self.root, name, data, [step.path for step in self.first])
        if place is not None:
            self.first.append(Step(place, data))
        return place or f"{KEPT}/{name}"

    def _written(self, content: Mapping[str, Placed]) -> Iterator[Step]:
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
                composed = choosing.compose(new.marked, content, choosing.eol_of(text))
                data = package.bytes_of(text[: text.startswith("\ufeff")] + composed)
                if old is not None and text_digest(package.text_of(data)) == text_digest(text):
                    data = old.data  # no more than blanks at line ends
            if old is not None:  # permissions stay, but a program can be run
                mode = old.mode | ((old.mode & 0o444) >> 2 if new.mode & 0o100 else 0)
            if old is None or (old.data, old.mode) != (data, mode):
                yield Step(name, data, mode)

    def _plan(self, middle: list[Step]) -> Plan:
        """Put the steps into their order; while files change the manifest lists both renderings."""
        read = (*self.records, ANSWERS, MANIFEST)
        there = {name: package.bytes_at(self.root, name) for name in read}
        records = [Step(name, data) for name, data in self.records.items() if data != there[name]]
        answers = self.records.get(ANSWERS) or there[ANSWERS] or b""
        now = {name: new.digests[0] for name, new in self.new.items()}
        leaves = not self.new and bool(self.records)
        final = None if leaves else package.manifest_text(now, package.text_of(answers)).encode()
        old = there[MANIFEST]
        listed = {line for text in (final, old) if text for line in text.decode().splitlines()}
        mixed = "".join(f"{line}\n" for line in sorted(listed)).encode()
        between = [Step(MANIFEST, mixed)] if middle and old != final else []
        manifest = [Step(MANIFEST, final)] if old != final else []
        new = [step for step in records if step.data is not None]
        gone = [step for step in reversed(records) if step.data is None]  # the answers last of all
        steps = [*new, *self.first, *between, *middle, *self.last, *manifest, *gone]
        told = " ".join([*(f"{n.text} {n.file}" for n in self.notes), *(s.path for s in self.last)])
        for name in sorted(self.kept):
            if name not in told:
                self._note(name, "it is kept there until you remove it")
        return Plan(self.root, (), self.notes, steps, self.stamps)


def _rendered(path: Path) -> PackageFile:
    data = path.read_bytes()
    if path.suffix == ".py" and b"fmt: off" not in data[:500]:  # formatters leave the file alone
        program = data[: data.index(b"\n") + 1] if data.startswith(b"#!") else b""
        data = program + b"# fmt: off\n" + data[len(program) :]
    return PackageFile(data, 0o755 if path.stat().st_mode & 0o100 else 0o644)


def _other_lines(mine: MarkedFile, new: MarkedFile) -> str:
    """Return which lines of a file are not in its new rendering, for people."""
    numbers = [1]
    for part in mine.parts:
        lines = 1 if isinstance(part, str) else part.body.count("\n") + 2
        numbers.append(numbers[-1] + lines)
    a, b = ([text.rstrip() for text in file.outside] for file in (mine, new))
    blocks = SequenceMatcher(None, a, b, autojunk=False).get_matching_blocks()
    same = {at for block in blocks for at in range(block.a, block.a + block.size)}
    other = [numbers[at] for at in range(len(a)) if at not in same]
    shown = ", ".join(map(str, other[:_MOST_LINES])) + (", ..." if other[_MOST_LINES:] else "")
    return f" (line{'s' if other[1:] else ''} {shown})" if other else ""
