"""Random lives of a package: what a person does, and a model of where each text must be then.

The model knows nothing of ids that move: a region belongs to an input, or to a place of the
template, and its text goes where that goes. ``Bare`` renders a small package by itself, which takes
milliseconds; ``Real`` is a workspace with our commands and Copier's.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

from hypothesis import settings

from eddi_scaffold.regions.check import list_regions, plan_accept
from eddi_scaffold.regions.marked_file import MarkedFile, Region, parse
from eddi_scaffold.regions.markers import Digests, begin_marker, digest, end_marker, normal
from eddi_scaffold.regions.package import Plan
from eddi_scaffold.regions.sync import plan_sync
from tests.data_files import write_files
from tests.updates.inputs import Input
from tests.updates.world import Result, World

IDS = ("E1", "E2", "E3", "E4", "E5")
START = (Input("E1"), Input("E2"), Input("E3"))
RECORDS = (".eddi/", ".git/", ".copier-answers.yml")


def histories(quick: int, long: int) -> int:
    """Return how many histories are run in this profile."""
    return long if settings().max_examples >= 1000 else quick


class Package(Protocol):
    """A package that can be rendered anew."""

    inputs: tuple[Input, ...]
    template: str

    @property
    def package(self) -> Path: ...

    def rendering(self) -> Mapping[str, str]:
        """Return the texts of today's rendering."""

    def bring(self, command: str) -> Result:
        """Bring the package to today's rendering: status 0, 2 or 3, and what was said."""


def render(inputs: tuple[Input, ...], template: str) -> dict[str, str]:
    """Return a small package with a region of every kind; no template looks like another."""
    second, third = template != "first", template == "third"

    def region(id_: str, style: str, *body: str, **more: object) -> list[str]:
        begin, end = begin_marker(id_, style, **more), end_marker(id_, style)  # type: ignore[arg-type]
        blanks = re.match(" *", body[0])[0] if body else ""  # type: ignore[index]
        return [blanks + begin, *body, blanks + end]

    own = "hash"
    module = [
        "# fmt: off",
        f'"""{template}."""',
        *region("EDDIInput.module", own),
        "class EDDIInput:",
    ]
    module += ["    def __init__(self):", *(f"        self.{one.id} = None" for one in inputs)]
    module += region("EDDIInput.members", own, "    def setup(self):", "        pass")
    for one in inputs:
        was = [f"process_{one.renamed_from}"] if one.renamed_from else []
        used = Digests(uses=digest(one.type + one.source))
        body = f"        self.{one.id} = S_{one.id}" + (".data" if second else "")
        module += [f"    def process_{one.id}(self, S_{one.id}):  # {one.type}"]
        module += region(f"process_{one.id}", "python", body, digests=used, was=was)
    module += ["    def processing(self):", *(f"        self.process_{x.id}()" for x in inputs)]
    node = ["  <node/>"] if not second else ["  <group>", "    <node/>", "  </group>"]
    launch = ["<launch>", *region("launch.node", "xml", *node)]
    launch += [*region("launch.own", "xml"), "</launch>"] if not third else ["</launch>"]
    depends = "  <depend>rospy</depend>" + ("<depend>numpy</depend>" if second else "")
    files = {
        "src/rover/inputs/EDDIInput.py" if third else "src/rover/EDDIInput.py": module,
        "launch/monitor.launch": launch,
        "package.xml": ["<package>", depends, *region("package.own", "xml"), "</package>"],
        "CMakeLists.txt": ["install()" if second else "project(rover)", *region("cmake.own", own)],
        "setup.cfg": ["[metadata]"],
        "model.yml": [template, *(f"{one.id} {one.type}" for one in inputs)],
        ".gitattributes": ["/.copier-answers.yml -merge", "/.eddi/manifest merge=union"],
    }
    files[".gitattributes"] += [
        "model.yml -merge",
        ".gitattributes -merge",
        "/.eddi/kept/** merge",
    ]
    files["helpers.py" if third else "version.txt"] = ["# fmt: off", template]
    return {name: "".join(f"{line}\n" for line in lines) for name, lines in files.items()}


@dataclass
class Bare:
    """A package that is synced in this process, without Copier."""

    folder: Path
    inputs: tuple[Input, ...] = START
    template: str = "first"
    killed: int | None = None

    @property
    def package(self) -> Path:
        return self.folder / "rover"

    def rendering(self) -> Mapping[str, str]:
        return render(self.inputs, self.template)

    def plan(self) -> Plan:
        place = self.folder / "rendering"
        for old in sorted(place.rglob("*"), reverse=True):
            old.rmdir() if old.is_dir() else old.unlink()
        write_files(place, self.rendering())
        answers = "".join(f"{one}\n" for one in (self.template, *self.inputs))
        return plan_sync(self.package, place, {".copier-answers.yml": answers.encode()})

    def bring(self, command: str) -> Result:
        plan = self.plan()
        said = "\n".join(f"{one.file}: {one.text}" for one in plan.refusals)
        said += "\n".join(f"{one.file}: {one.text}" for one in plan.notes)
        if plan.refusals:
            return Result(2, said)
        if command == "killed" and plan.steps:
            number = random.Random(str(plan.steps)).randrange(len(plan.steps))
            part = plan._replace(steps=plan.steps[:number])
            part.prepare()
            part.finish()
            again = self.bring("")
            return replace(again, said=f"{said}\nkilled after {number}\n{again.said}")
        plan.prepare()
        plan.finish()
        return Result(3 if any(note.attention for note in plan.notes) else 0, said)


@dataclass
class Real:
    """A workspace; its rendering is what ``generate`` writes into an empty one."""

    world: World
    inputs: tuple[Input, ...] = START
    template: str = "first"
    known: dict[object, Mapping[str, str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.world.begin()

    @property
    def package(self) -> Path:
        return self.world.package

    def rendering(self) -> Mapping[str, str]:
        key = (self.inputs, self.template)
        if key not in self.known:
            folder = self.world.folder / f"fresh{len(self.known)}"
            fresh = World(folder, self.world.templates, self.inputs, self.template)
            fresh.begin()
            self.known[key] = texts(fresh.package)
        return self.known[key]

    def bring(self, command: str) -> Result:
        self.world.inputs, self.world.template = self.inputs, self.template
        if command == "update":
            self.world.commit()
        done = self.world.run(command)
        if command in {"generate", "upgrade"}:
            return done
        checked = self.world.command("regions", "--check", self.package)
        return Result(2 if done.status else checked.status, done.said + checked.said)


def texts(package: Path) -> dict[str, str]:
    """Return the files of a package that are no records, as text."""
    paths = [path for path in package.rglob("*") if path.is_file()]
    named = {path.relative_to(package).as_posix(): path for path in paths}
    return {
        name: path.read_bytes().decode().replace("\r\n", "\n")
        for name, path in named.items()
        if not name.startswith(RECORDS) and "__pycache__" not in name
    }


def snapshot(package: Path) -> dict[str, tuple[bytes, int]]:
    """Return all bytes and permissions of a package."""
    paths = [path for path in package.rglob("*") if path.is_file()]
    return {
        path.relative_to(package).as_posix(): (path.read_bytes(), path.stat().st_mode)
        for path in paths
        if ".git" not in path.parts
    }


@dataclass
class Written:
    """A body that a person wrote: for what, and why somebody must look at it."""

    text: str
    digests: Digests
    look: bool = False
    missing: set[str] = field(default_factory=set)
    was: set[str] = field(default_factory=set)


@dataclass
class Life:
    """A package, and where everything that a person wrote must be.

    Attributes:
        place: the package.
        chance: decides what happens.
        owners: region -> what it belongs to, since the last sync; ``inputs`` are known by ``who``.
        written: by owner.
        kept: the saved bodies with their regions, the newest last.
        copies: saved files, by path.
        outside: the files that a person edited outside of regions, since the last sync.
        own: files of a person's own.
    """

    place: Package
    chance: random.Random
    who: dict[str, str] = field(default_factory=dict)
    shown: Mapping[str, str] = field(default_factory=dict)
    owners: dict[str, str] = field(default_factory=dict)
    declared: dict[str, set[str]] = field(default_factory=dict)
    written: dict[str, Written] = field(default_factory=dict)
    kept: list[tuple[str, Written]] = field(default_factory=list)
    copies: list[bytes] = field(default_factory=list)
    outside: set[str] = field(default_factory=set)
    own: dict[str, str] = field(default_factory=dict)
    removed: set[str] = field(default_factory=set)
    name: str = "mine"
    count: int = 0
    log: list[str] = field(default_factory=list)

    def begin(self, command: str = "generate") -> Life:
        self.who = {one.id: f"input {one.id}" for one in self.place.inputs}
        self.sync(command)
        return self

    def body_of(self, id_: str) -> str:
        """Return what a person wrote in a region, empty for nothing."""
        written = self.written.get(self.owners.get(id_, ""))
        return written.text if written else ""

    def new(self) -> str:
        self.count += 1
        return f"{self.name}_{self.count}_"

    def regions(self, shown: Mapping[str, str] | None = None) -> dict[str, tuple[str, Region]]:
        found = {}
        for name, text in (self.shown if shown is None else shown).items():
            found |= {id_: (name, one) for id_, one in parsed(text).regions.items()}
        return found

    def file(self, name: str) -> Path:
        return self.place.package / name

    def put(self, id_: str, body: str) -> None:
        """Replace the body of a region on disk."""
        name = self.regions()[id_][0]
        text = self.file(name).read_bytes().decode()
        one = parsed(text).regions[id_]
        lines = text.split("\n")
        first, last = one.line, one.line + one.body.count("\n")
        cr = "\r" if "\r\n" in text else ""
        lines[first:last] = [line + cr for line in body.split("\n")[:-1]]
        self.file(name).write_bytes("\n".join(lines).encode())

    def sync(self, command: str) -> None:
        """Run a command, and check everything."""
        shown = self.place.rendering()
        before = snapshot(self.place.package)
        self.copies += [self.file(name).read_bytes() for name in self.outside]
        self.outside = set()
        there = {name: text for name, text in self.shown.items() if self.file(name).exists()}
        done = self.place.bring(command)
        self.log.append(f"{command} -> {done.status}")
        stolen = [name for name in self.own if name in shown and name not in self.shown]
        if stolen:
            assert (done.status, "is yours" in done.said) == (2, True), done.said
            if isinstance(self.place, Bare) or command in {"generate", "upgrade"}:
                assert snapshot(self.place.package) == before
            for name in stolen:
                self.file(name).rename(self.file(f"{name}.own"))
                self.own[f"{name}.own"] = self.own.pop(name)
            done = self.place.bring(command)
        assert done.status in {0, 3}, done.said
        self._expect(shown, there)
        told, self.removed = self.removed & shown.keys(), set()
        self.check()
        looked = bool(self.kept or self.copies or any(one.look for one in self.written.values()))
        if not told or looked:
            assert done.status == (3 if looked else 0), done.said
        elif command != "killed":
            assert done.status == 3, done.said
        after = snapshot(self.place.package)
        again = self.place.bring("generate")
        assert again.status == (3 if looked else 0), again.said
        assert snapshot(self.place.package) == after, "a second run changes something"

    def _expect(self, shown: Mapping[str, str], there: Mapping[str, str]) -> None:
        """Move each text to where it must be with a new rendering.

        What a name was is read in the files that are ``there``: of a deleted one nobody knows it.
        """
        defining = {name: text for name, text in there.items() if name.endswith("EDDIInput.py")}
        regions = {id_: one for id_, (_, one) in self.regions(shown).items()}
        inputs = {f"process_{one.id}": one for one in self.place.inputs}
        owners = {id_: self.who[inputs[id_].id] if id_ in inputs else id_ for id_ in regions}
        here = set(self.owners.values())
        vanished = {one for one in IDS if is_named(one, defining) and not is_named(one, shown)}
        for owner, one in list(self.written.items()):
            if digest(one.text) == one.digests.of:  # somebody put the generated body back
                del self.written[owner]
        for id_, owner in owners.items():
            if owner not in here:  # new, or back
                former = inputs[id_].renamed_from if id_ in inputs else None
                source = f"process_{former}" if former else id_
                saved = [one for one in self.kept if one[0] == source]
                if saved and source not in self.owners:
                    self.kept.remove(saved[-1])
                    self.written[owner] = saved[-1][1]
        for id_, owner in self.owners.items():
            if owner not in owners.values() and owner in self.written:
                gone = replace(self.written.pop(owner), missing=set(), was=self.declared[id_])
                self.kept.append((id_, gone))
        for id_, owner in owners.items():
            if (one := self.written.get(owner)) is not None:
                if normal(one.text) == normal(regions[id_].body):
                    del self.written[owner]
                    continue
                today = Digests(digest(regions[id_].body), regions[id_].digests.uses)
                doubted = {name for name in one.missing | vanished if not is_named(name, shown)}
                one.missing = {name for name in doubted if re.search(rf"\b{name}\b", one.text)}
                one.look = one.digests != today or bool(one.missing)
        self.owners = owners
        self.declared = {id_: set(one.was) for id_, one in regions.items()}
        self.shown = shown

    def check(self) -> None:
        """Check that each text is where it must be, and nothing else is."""
        now = texts(self.place.package)
        other = now.keys() ^ (self.shown.keys() | self.own.keys())
        assert not other, f"missing or too many: {sorted(other)}"
        for name, text in self.own.items():
            assert now[name] == text
        for name, text in self.shown.items():
            mine, rendered = parsed(now[name]), parsed(text)
            assert mine.outside == rendered.outside, f"{name} is not as it is rendered"
            for id_, one in mine.regions.items():
                written = self.written.get(self.owners[id_])
                body = written.text if written else rendered.regions[id_].body
                assert one.body == body, f"{id_} holds {one.body!r}"
                assert (one.now is not None) == bool(written and written.look), (id_, written)
        kept = self.place.package / ".eddi/kept"
        found = [path for path in sorted(kept.rglob("*")) if path.is_file()]
        bodies = [parsed(p.read_bytes().decode()) for p in found if ".region" in p.name]
        held = [(one.id, normal(one.body)) for file in bodies for one in file.regions.values()]
        assert sorted(held) == sorted((id_, normal(one.text)) for id_, one in self.kept)
        copies = [path.read_bytes() for path in found if ".region" not in path.name]
        assert sorted(copies) == sorted(set(self.copies))
        assert not list((self.place.package / ".eddi").glob("new/*"))
        assert not (self.place.package / ".eddi/put").exists()
        opened = [one for one in list_regions(self.place.package) if one.review]
        looks = sum(one.look for one in self.written.values())
        assert len(opened) == looks + len(found), opened


def parsed(text: str) -> MarkedFile:
    marked, faults = parse(text)
    assert not faults
    return marked


def is_named(name: str, shown: Mapping[str, str]) -> bool:
    """Tell whether a text of a rendering has a word, outside of marker lines."""
    lines = (x for text in shown.values() for x in text.split("\n") if "Manual edit" not in x)
    return any(re.search(rf"\b{name}\b", line) for line in lines)


# What may happen between two commands: each changes the package, or what it is made of.


def add(life: Life) -> None:
    """Add an input, which may be one that was there, or one that says what it was."""
    free = [id_ for id_ in IDS if id_ not in life.who and f"process_{id_}" not in life.owners]
    if free:
        id_ = life.chance.choice(free)
        own = {saved for saved, _ in life.kept}
        gone = [x for x in IDS if f"process_{x}" in own and x not in life.who and x != id_]
        gone = [x for x in gone if f"process_{x}" not in life.owners]
        taken = {one.renamed_from for one in life.place.inputs}
        gone = [x for x in gone if f"process_{id_}" not in own and x not in taken]
        former = life.chance.choice(gone) if gone and life.chance.random() < 0.5 else None
        life.who[id_] = f"input {life.new()}"
        life.place.inputs += (Input(id_, renamed_from=former),)


def remove(life: Life) -> None:
    if len(life.place.inputs) > 1:
        one = life.chance.choice(life.place.inputs)
        life.place.inputs = tuple(x for x in life.place.inputs if x != one)
        del life.who[one.id]


def rename(life: Life) -> None:
    """Give some inputs other ids, all at once: to free ones, or in a ring among them."""
    old = [one for one in life.place.inputs if _settled(life, one)]
    life.chance.shuffle(old)
    if not (old := old[: life.chance.randint(1, 3)]):
        return
    free = [id_ for id_ in IDS if id_ not in life.who]
    ids = [one.id for one in old][1:] + [one.id for one in old][:1]
    if free and life.chance.random() < 0.6:
        ids[-1:] = [life.chance.choice(free)]
    new = {one.id: id_ for one, id_ in zip(old, ids, strict=True) if one.id != id_}
    newest = {id_: one.was for id_, one in life.kept}
    for before, after in new.items():  # a declaration that is known already says nothing
        id_ = f"process_{after}"
        if f"process_{before}" in (life.declared.get(id_) or newest.get(id_, set())):
            return
    taken = {one.renamed_from for one in life.place.inputs if one.id not in new}
    if taken & new.keys():
        return
    life.who = {new.get(id_, id_): owner for id_, owner in life.who.items()}
    life.place.inputs = tuple(
        replace(x, id=new[x.id], renamed_from=x.id) if x.id in new else x for x in life.place.inputs
    )


def _settled(life: Life, one: Input) -> bool:
    """Tell whether an input has the id that it had in the last rendering."""
    return life.owners.get(f"process_{one.id}") == life.who[one.id]


def forget(life: Life) -> None:
    """Remove the declarations that have been applied."""
    life.place.inputs = tuple(
        replace(one, renamed_from=None) if _settled(life, one) else one for one in life.place.inputs
    )


def retype(life: Life) -> None:
    one = life.chance.choice(life.place.inputs)
    other = replace(one, type="bool" if one.type == "float" else "float")
    life.place.inputs = tuple(other if x == one else x for x in life.place.inputs)


def reorder(life: Life) -> None:
    life.place.inputs = tuple(life.chance.sample(life.place.inputs, len(life.place.inputs)))


def template(life: Life) -> None:
    life.place.template = life.chance.choice(["first", "second", "third"])


def write(life: Life) -> None:
    """Write in a region of any file, or go on writing there."""
    write_in(life, life.chance.choice([one for one in life.owners if _is_there(life, one)]))


def write_in(life: Life, id_: str) -> None:
    """Write in one region; the text is a comment of the file's language."""
    name, region = life.regions()[id_]
    sign = ("<!-- ", " -->") if name.endswith((".xml", ".launch", ".md")) else ("# ", "")
    other = life.chance.choice(IDS)
    lines = [f"{region.indent}{sign[0]}{life.new()} self.{other}{sign[1]}\n" for _ in range(2)]
    owner, today = life.owners[id_], Digests(digest(region.body), region.digests.uses)
    before = life.written.get(owner) or Written("", today)
    text = before.text + lines[0] if life.chance.random() < 0.5 else "".join(lines)
    life.written[owner] = replace(before, text=text)
    life.put(id_, text)


def revert(life: Life) -> None:
    """Put the generated body back."""
    if life.written:
        owner = life.chance.choice(sorted(life.written))
        id_ = next(id_ for id_, one in life.owners.items() if one == owner)
        if _is_there(life, id_):
            life.written[owner].text = life.regions()[id_][1].body
            life.put(id_, life.written[owner].text)


def _is_there(life: Life, id_: str) -> bool:
    return life.file(life.regions()[id_][0]).exists()


def outside(life: Life) -> None:
    """Edit a generated file outside of its regions."""
    name = life.chance.choice(sorted(name for name in life.shown if life.file(name).exists()))
    with life.file(name).open("a") as file:
        file.write(f"# {life.new()}\n")
    life.outside.add(name)


def accept(life: Life) -> None:
    """Note that the bodies were looked at."""
    regions = {id_: one for id_, (_, one) in life.regions().items() if _is_there(life, id_)}
    plan, found = plan_accept(life.place.package, regions)
    plan.prepare()
    plan.finish()
    for id_ in found:
        one = life.written[life.owners[id_]]
        one.digests = Digests(digest(regions[id_].body), regions[id_].digests.uses)
        one.look, one.missing = False, set()


def own_file(life: Life) -> None:
    name = life.chance.choice(["helpers.py", "src/rover/helpers.py"])
    if name not in life.shown and not life.file(name).exists():
        life.own[name] = f"# {life.new()}\n"
        life.file(name).parent.mkdir(parents=True, exist_ok=True)
        life.file(name).write_text(life.own[name])


def tidy(life: Life) -> None:
    """Remove what is kept, as a person does who has read it."""
    for path in sorted((life.place.package / ".eddi/kept").rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    life.kept, life.copies = [], []


def line_ends(life: Life) -> None:
    """Save a file with the line ends of another system, and a byte order mark."""
    name = life.chance.choice(sorted({name for name, _ in life.regions().values()}))
    if life.file(name).exists() and name not in life.outside:
        data = life.file(name).read_bytes().removeprefix("\ufeff".encode())
        data = data.replace(b"\r\n", b"\n")
        life.file(name).write_bytes(data.replace(b"\n", life.chance.choice([b"\r\n", b"\n"])))


def delete(life: Life) -> None:
    """Delete a generated file that nobody wrote in."""
    name = life.chance.choice(sorted(life.shown))
    ids = [id_ for id_, (file, _) in life.regions().items() if file == name]
    if not any(life.owners[id_] in life.written for id_ in ids) and name not in life.outside:
        life.removed |= {name} if ids and life.file(name).exists() else set()
        life.file(name).unlink(missing_ok=True)


OPERATIONS: dict[Callable[[Life], None], int] = {
    add: 3,
    remove: 2,
    rename: 4,
    forget: 1,
    retype: 1,
    reorder: 1,
    template: 2,
    write: 8,
    revert: 1,
    outside: 1,
    accept: 2,
    own_file: 1,
    tidy: 1,
    line_ends: 1,
    delete: 1,
}


def live(
    life: Life,
    steps: int,
    commands: Sequence[str] = ("generate",),
    operations: Mapping[Callable[[Life], None], int] = OPERATIONS,
) -> None:
    """Let some things happen between two commands, several times."""
    for _ in range(steps):
        chosen = life.chance.choices(list(operations), [*operations.values()], k=3)
        for act in chosen[: life.chance.randint(1, 3)]:
            life.log.append(f"{act.__name__} {[(x.id, x.renamed_from) for x in life.place.inputs]}")
            act(life)
        life.sync(life.chance.choice(commands))
