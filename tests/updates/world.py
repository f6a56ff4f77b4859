"""A workspace with one generated package, a person who writes in it, and what must always hold."""

from __future__ import annotations

import ast
import contextlib
import io
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from unittest.mock import patch
from xml.etree import ElementTree as ET

import copier
import pytest
from copier.errors import CopierError
from hypothesis import settings

from eddi_scaffold import cli
from eddi_scaffold.identifiers import attribute
from eddi_scaffold.packages import rendering, transaction
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.platforms import chosen
from eddi_scaffold.regions.bases import read_bases
from eddi_scaffold.regions.check import broken_files
from eddi_scaffold.regions.marked_file import MarkedFile, Region, parse
from eddi_scaffold.regions.store import load_orphans
from tests.updates.inputs import Element, elements, write_inputs
from tests.updates.templates import Templates, git

EDITABLE = {
    "plain": ("EDDIInput.py",),
    "ros1": (
        "src/rover/EDDIInput.py",
        "package.xml",
        "CMakeLists.txt",
        "launch/eddi_monitor.launch",
    ),
    "ros2": ("rover/EDDIInput.py", "package.xml", "launch/eddi_monitor.launch.py"),
}
DAMAGES = 7
DONE: Counter[str] = Counter()  # what was run, for the summary
_WORD = re.compile(r"hand_\d+_line")

OPERATIONS = ("copy", "recopy", "update", "generate", "upgrade")
START = elements("alpha", "beta", "gamma")
CHANGED = (Element("new"), Element("bravo", was="beta"), Element("alpha", "pair"))


def long_profile() -> bool:
    """Tell whether ``--hypothesis-profile=long`` is on; known when tests are collected."""
    return settings().max_examples >= 1000


@dataclass
class Line:
    """One line that a person wrote.

    Attributes:
        path: file in the package.
        ids: regions in which it may ever stand or be saved under; empty: it stands outside.
        home: region in which it must stand now; ``None``: it may also be saved.
        function: innermost function of a line outside.
        above: method that follows a comment outside.
        anchored: it stands outside where no change of the model disturbs it.
        stands: it stood in its file when last looked at.
    """

    token: str
    path: str
    ids: set[str] = field(default_factory=set)
    home: str | None = None
    function: str = ""
    above: str | None = None
    anchored: bool = False
    stands: bool = True


@dataclass(frozen=True)
class Result:
    """How a command ended."""

    status: int
    words: str


def operations_of(number: int) -> tuple[str, ...]:
    """Return the operations for a case: all in the long profile, else one of each pair in turn."""
    pairs = (("copy", "recopy"), ("generate", "upgrade"))
    return OPERATIONS if long_profile() else ("update", *(pair[number % 2] for pair in pairs))


class World:
    """The workspace, the model, the templates of today, and every line written by hand."""

    def __init__(
        self,
        folder: Path,
        templates: Templates,
        platform: str = "plain",
        inputs: Sequence[Element] = (),
    ) -> None:
        self.folder, self.templates, self.platform = folder, templates, platform
        self.inputs = tuple(inputs)
        self.version = 1
        self.workspace = folder / "workspace"
        self.root = self.workspace / chosen(platform).root
        self.package = self.root / "rover"
        self.main = EDITABLE[platform][0]
        self.lines: dict[str, Line] = {}
        self.others: dict[str, str] = {}  # token -> file of a person's, or of the generator's
        self.replaced: list[str] = []  # tokens in generated lines, of records too
        self.count = 0
        self.seen: list[tuple[Element, ...]] = []  # models that the package may be at
        self.look = 0  # of the last finished operation
        self.steady = False  # the last operation finished, and so did the one before, at one look
        self.is_link = False  # the main file is one
        self.mode: int | None = None  # that a person gave the main file
        self.is_cut = False  # an operation was killed, and none has finished since
        self.twice: set[str] = set()  # tokens of bodies that were edited then
        self.workspace.mkdir()
        git(self.workspace, "init", "-q")

    # operations -----------------------------------------------------------------------------
    @property
    def tag(self) -> str:
        return self.templates.tag(self.version)

    def answers(self) -> dict[str, object]:
        """Return what `eddi-scaffold answers` writes."""
        model, config = write_inputs(self.folder / "inputs", self.inputs)
        monitors, problems = monitors_of(model, [config])
        return dict(
            assemble(monitors, chosen(self.platform), self.root, problems).packages[0].answers
        )

    def copy(self) -> Result:
        return self._copier(
            copier.run_copy, str(self.templates.path), self.package, data=self.answers()
        )

    def recopy(self) -> Result:
        return self._copier(copier.run_recopy, self.package, data=self.answers())

    def update(self) -> Result:
        self.commit()
        return self._copier(copier.run_update, self.package, data=self.answers())

    def generate(self) -> Result:
        model, config = write_inputs(self.folder / "inputs", self.inputs)
        in_workspace = chosen(self.platform).workspace is not None
        place = ["-w" if in_workspace else "-o", self.workspace]
        return self.command(
            "generate", "--platform", self.platform, *place, "-m", model, "-c", config
        )

    def upgrade(self) -> Result:
        model, config = write_inputs(self.folder / "inputs", self.inputs)
        return self.command("upgrade", self.package, "-m", model, "-c", config)

    def command(self, *words: object) -> Result:
        """Run eddi-scaffold in this process, with the templates of today as its own."""
        argv = ["eddi-scaffold", *map(str, words)]
        template = rendering.Template(str(self.templates.path), self.tag)
        said = io.StringIO()
        with (
            patch.object(sys, "argv", argv),
            patch.object(rendering, "own_template", lambda: template),
            contextlib.redirect_stderr(said),
            contextlib.redirect_stdout(said),
        ):
            try:
                cli.main()
            except SystemExit as end:
                status = end.code if isinstance(end.code, int) else int(end.code is not None)
                return Result(status, said.getvalue())
        return Result(0, said.getvalue())

    def commit(self) -> None:
        with contextlib.suppress(NotADirectoryError):  # a linked worktree
            (self.workspace / ".git/index.lock").unlink(missing_ok=True)  # left by a killed git
        git(self.workspace, "add", "-A")
        git(self.workspace, "commit", "-q", "--allow-empty", "-m", "work")

    def killed(self, operation: Callable[[], Result], delay: float) -> None:
        """Run an operation in a process of its own, and kill that and all it started."""
        child = forked(operation)
        end = time.monotonic() + delay
        while time.monotonic() < end and os.waitpid(child, os.WNOHANG) == (0, 0):
            time.sleep(0.002)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            os.waitpid(child, 0)

    def both(self, first: Callable[[], Result], second: Callable[[], Result]) -> tuple[int, int]:
        """Run two operations at once, in processes of their own; return how they ended."""
        children = []
        for operation in (first, second):
            child = os.fork()
            if child == 0:  # pragma: no cover - ends here
                nowhere = os.open(os.devnull, os.O_RDWR)
                for handle in (0, 1, 2):
                    os.dup2(nowhere, handle)
                status = 70
                try:
                    status = operation().status
                finally:
                    os._exit(status)
            children.append(child)
        one, other = (os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children)
        return one, other

    def _copier(
        self, run: Callable[..., object], *where: object, data: dict[str, object]
    ) -> Result:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                run(
                    *where,
                    data=data,
                    vcs_ref=self.tag,
                    defaults=True,
                    overwrite=True,
                    unsafe=True,
                    quiet=True,
                )
            except (CopierError, subprocess.CalledProcessError) as problem:
                return Result(1, str(problem))
        return Result(0, "")

    # the person -----------------------------------------------------------------------------
    def text(self, path: str | None = None) -> str:
        return (self.package / (path or self.main)).read_bytes().decode().replace("\r\n", "\n")

    def write(self, text: str, path: str | None = None) -> None:
        target = self.package / (path or self.main)
        crlf = b"\r\n" in target.read_bytes()
        target.write_bytes((text.replace("\n", "\r\n") if crlf else text).encode())

    def document(self) -> MarkedFile:
        document, faults = parse(self.text())
        assert not faults, faults
        return document

    def token(self) -> str:
        self.count += 1
        return f"hand_{self.count}_line"

    def edit(self, name: str, shape: int = 0, *, keep: bool = True) -> str:
        """Write into the region of an input, behind what stands there or instead of it."""
        token, region = self.token(), self.document().regions[f"input:{name}"]
        shapes = (
            f"self.{token} = 1",
            f"if self:\n    self.{token} = 2\nelse:\n    pass",
            f'text = """\n  {token}\nflush left\n"""',
            f"# only a comment: {token}",
            f"\n\nself.{token} = 1   \n",
        )
        code = shapes[shape % len(shapes)]
        lines = "".join(f"{region.indent}{line}\n" if line else "\n" for line in code.split("\n"))
        lines = lines.replace(f"{region.indent}flush", "flush").replace(
            f"{region.indent}  hand", "  hand"
        )
        if not keep:
            for old in _WORD.findall(region.body):
                self.lines.pop(old, None)
        if self.is_cut:  # what was killed may have saved the body as it was before
            self.twice.update(_WORD.findall(region.body))
        self.put(region, (region.body if keep else "") + lines)
        self.lines[token] = Line(token, self.main, {region.id}, region.id)
        self._allow(self.lines[token])
        return token

    def put(self, region: Region, body: str) -> None:
        before = f"{region.begin}\n{region.body}{region.end}\n"
        assert self.text().count(before) == 1
        self.write(self.text().replace(before, f"{region.begin}\n{body}{region.end}\n"))

    def edit_outside(self, kind: str) -> str | None:
        """Write outside of the regions; ``None`` when there is no such place now."""
        token = self.token()
        line = Line(token, self.main)
        text = self.text()
        names = [attribute(item.name) for item in self._present()]
        name = names[self.count % len(names)] if names else ""
        if kind == "import":
            new = re.sub(
                r"(\nfrom [^\n]*EDDIInputBase[^\n]*\n)", rf"\1import {token}\n", text, count=1
            )
        elif kind == "helper":
            helper = f"\n    def {token}(self):\n        return 1\n"
            new = text.replace("\n    def processing(", f"{helper}\n    def processing(", 1)
            line.function = token
        elif kind == "docstring":
            new = re.sub(
                r'(\nclass [^\n]*\n    """[^\n]*?)"""\n',
                rf'\1\n\n    {token}\n    """\n',
                text,
                count=1,
            )
        elif kind == "behind":
            end = rf"(edit end-----'''  # region: input:{name}\n)"
            new = re.sub(end, rf"\1        self.{token} = 1\n", text, count=1)
            line.function = f"process_{name}"
        elif kind == "init":
            new = re.sub(
                r"(\n        super\(\).__init__\(\)\n)",
                rf"\1        self.{token} = 1\n",
                text,
                count=1,
            )
            line.function = "__init__"
        elif kind == "default":
            head, method, rest = text.partition("\n    def process_")
            head = re.sub(rf"(\n        self.{name} = )None\n", rf"\1'{token}'\n", head)
            new = head + method + rest
            line.function = "__init__"
        elif kind == "comment":
            new = text.replace(
                f"\n    def process_{name}(", f"\n    # {token}\n    def process_{name}(", 1
            )
            line.above = f"process_{name}"
        elif kind == "last":
            new = f"{text}        self.{token}()\n"
            line.function = "processing"
        elif self.platform == "plain":
            return None
        else:
            line.path = {
                "manifest": "package.xml",
                "cmake": "CMakeLists.txt",
                "launch": "launch/eddi_monitor.launch",
            }[kind]
            text = self.text(line.path)
            new = {
                "manifest": text.replace(
                    "</package>", f"  <exec_depend>{token}</exec_depend>\n</package>", 1
                ),
                "cmake": text.replace(
                    "catkin_package()\n", f"catkin_package()\nset({token} 1)\n", 1
                ),
                "launch": text.replace(
                    "  <node ", f'  <arg name="{token}" default="1"/>\n  <node ', 1
                ),
            }[kind]
        if new == text:
            return None
        self.write(new, line.path)
        line.anchored = kind in {"import", "helper", "docstring", "manifest", "cmake", "launch"}
        self.lines[token] = line
        return token

    def change_mode(self, mode: int) -> None:
        """Give the main file, or the one that it leads to, other permissions."""
        (self.package / self.main).chmod(mode)
        self.mode = mode

    def toggle_link(self) -> None:
        """Move the main file elsewhere in the package and leave a link, or take it back."""
        place, real = self.package / self.main, self.package / "mine" / "EDDIInput.py"
        if place.is_symlink():
            place.unlink()
            real.rename(place)
        else:
            real.parent.mkdir(exist_ok=True)
            place.rename(real)
            place.symlink_to(os.path.relpath(real, place.parent))
        self.is_link = place.is_symlink()

    def write_other(self, path: str) -> None:
        """Write into a file that is not editable, or into one of the person's own."""
        token, place = self.token(), self.package / path
        place.parent.mkdir(exist_ok=True)
        with place.open("a") as file:
            file.write(f"# {token}\n")
        self.others[token] = path

    def replace_everywhere(self, chance: random.Random) -> str:
        """Change a generated line in all files of the package alike, its records too."""
        token = self.token()
        base = read_bases(self.package)[self.main].splitlines()
        known = {line.encode() for line in base if line.strip() and "Manual edit" not in line}
        lines = (self.package / self.main).read_bytes().splitlines()
        line = chance.choice([one for one in lines if one in known])
        pattern = re.compile(rb"^ ?%b(?=\r?$)" % re.escape(line), re.MULTILINE)
        for path in self.package.rglob("*"):
            if path.is_file():
                path.write_bytes(pattern.sub(rb"\g<0>  # " + token.encode(), path.read_bytes()))
        self.replaced.append(token)
        self.look = -1  # what was written next to it may go to the rejects with it
        return token

    def damage(self, kind: int) -> str:
        """Break a marker of the main file; returns the whole text, to repair it."""
        whole = self.text()
        lines = whole.split("\n")
        begins = [i for i, line in enumerate(lines) if "---Manual edit begin" in line]
        ends = [i for i, line in enumerate(lines) if "---Manual edit end" in line]
        one = kind // DAMAGES % len(begins)
        begin, end = begins[one], ends[one]
        edits: tuple[Callable[[], object], ...] = (
            lambda: lines.pop(end),
            lambda: lines.pop(begin),
            lambda: lines.__setitem__(end, f"{lines[end]}; x = 1"),
            lambda: lines.insert(begin, lines[begin]),
            lambda: lines.insert(begin, "<<<<<<< mine"),
            lambda: lines.__setitem__(end, lines[end].replace("input:", "input:other_")),
            lambda: [
                lines.__setitem__(at, lines[at].replace("Manual edit", "Manual Edit"))
                for at in (begin, end)
            ],
        )
        edits[kind % DAMAGES]()
        self.write("\n".join(lines))
        assert broken_files(self.package)
        return whole

    def _present(self) -> list[Element]:
        there = self.document().regions
        return [item for item in self.inputs if f"input:{item.name}" in there]

    # what must hold -------------------------------------------------------------------------
    def change(self, *inputs: Element) -> None:
        """Take a new model; a declared rename allows its lines to move."""
        self.inputs = inputs
        for line in self.lines.values():
            self._allow(line)

    def _allow(self, line: Line) -> None:
        line.ids |= {f"input:{i.name}" for i in self.inputs if f"input:{i.was}" in line.ids}

    def is_replaced(self) -> bool:
        """Return whether the main file is of the present model, before the operation has ended.

        Where the one before is told in the same words, no body has another heir either.
        """
        there = [(region.id, region.was) for region in self.document().regions.values()]
        new = [(f"input:{i.name}", (f"input:{i.was}",) if i.was else ()) for i in self.inputs]
        return there == new

    def settle(self, late: Collection[str] = ()) -> None:
        """Say that an operation has finished: the package is at the present model.

        ``late`` are lines that were written into the file of that model: they have no other home.
        """
        heirs = heirs_of(self.seen[0], self.inputs) if len(self.seen) == 1 else {}
        for line in self.lines.values():
            if line.home is not None and line.token not in late:
                name = line.home.removeprefix("input:")
                heir = heirs.get(name) if len(self.seen) == 1 else self._lasting(name)
                line.home = f"input:{heir}" if heir else None
        look = (self.version - 1) % 3
        self.steady = len(self.seen) == 1 and look == self.look
        self.seen, self.look, self.is_cut = [self.inputs], look, False

    def _lasting(self, name: str) -> str | None:
        """Return a name that means the same in all models that the package may be at."""
        models = [*self.seen, self.inputs]
        touched = any(name in {item.was, item.was and item.name} for m in models for item in m)
        always = all(any(item.name == name for item in model) for model in models)
        return name if always and not touched else None

    def check(self, *, finished: bool = True) -> None:
        """Hold the promise against every line; ``finished``: no operation was killed."""
        if finished:
            self._check_files()
        texts = {path: self.text(path) for path in EDITABLE[self.platform]}
        for path, text in texts.items():
            _check_valid(path, text)
        document = self.document()
        if finished:
            assert list(document.regions) == [f"input:{item.name}" for item in self.inputs]
        orphans = list(load_orphans(self.package).values())
        rejects = self.package / ".eddi/rejects"
        for token, path in self.others.items():
            places = [self.package / path, *rejects.glob(f"{path}*.edited")]
            texts_of_file = [one.read_text() for one in places if one.is_file()]
            assert any(token in text for text in texts_of_file), f"{token} of {path} is lost"
            DONE["lines of other files checked"] += 1
        saved = [
            path.read_text()
            for kind in ("orphans", "rejects")
            for path in (self.package / ".eddi" / kind).rglob("*")
            if path.is_file()
        ]
        for token in self.replaced:
            assert any(token in text for text in (texts[self.main], *saved)), f"{token} is lost"
            DONE["replaced lines checked"] += 1
        for line in self.lines.values():
            count = sum(text.count(line.token) for text in texts.values())
            assert count <= 1, f"{line} stands {count} times"
            # a whole element or command of its own does not even conflict with another template
            stays = line.anchored and (self.steady or line.path != self.main)
            if finished and stays and line.stands:
                assert count == 1, f"{line} was moved away without need"
            line.stands = count == 1
            DONE["lines checked"] += 1
            if line.ids:
                homes = [r.id for r in document.regions.values() if line.token in r.body]
                saved = [o.id for o in orphans if line.token in o.body]
                assert len(homes) == count, f"{line} left its region"
                assert homes or saved, f"{line} is lost"
                DONE["lines saved as orphans"] += not homes
                assert set(homes + saved) <= line.ids, f"{line} is in {homes}, saved in {saved}"
                if finished:
                    once = not (homes and saved) or line.token in self.twice
                    assert once, f"{line} is in {homes} and saved in {saved}"
                    assert line.home is None or homes == [line.home], f"{line} is in {homes}"
            elif count == 0:
                patches = [p.read_text() for p in rejects.glob(f"{line.path}*.patch")]
                assert any(line.token in text for text in patches), f"{line} is lost"
                DONE["lines saved as rejects"] += 1
            elif line.path == self.main:
                assert _function_of(texts[line.path], line.token) == line.function, line
                if line.above is not None:
                    after = texts[line.path].partition(line.token)[2]
                    assert re.findall(r"def (\w+)", after)[0] == line.above, line

    def _check_files(self) -> None:
        main = self.package / self.main
        assert main.is_symlink() == self.is_link
        assert self.mode in {None, main.stat().st_mode & 0o777}
        for path in sorted(self.package.rglob("*")):
            assert path.suffix != ".rej", path
            if path.is_file() and ".eddi/rejects" not in path.as_posix():
                text = path.read_bytes().decode()
                assert not re.search(r"^(<<<<<<<|>>>>>>>)", text, re.MULTILINE), path
                if ".eddi/" not in path.as_posix():
                    _check_valid(path.name, text)


def heirs_of(before: Sequence[Element], after: Sequence[Element]) -> dict[str, str]:
    """Return where the body of each input goes: by the declared renames that are news."""
    known = {item.name: item.was for item in before}
    source: dict[str, str] = {}
    wanted = [item for item in after if item.was and known.get(item.name, "") != item.was]
    while wanted:
        for item in wanted:
            if item.was in known and item.was not in source.values() and item.was != item.name:
                source.setdefault(item.name, item.was)
        # a name that passed on gets what it was declared to get some time before
        wanted = [
            item
            for item in after
            if item.was in known.keys() - {*source.values(), item.name}
            and item.name in source.values()
            and item.name not in source
        ]
    stay = {item.name for item in after} - source.keys() - set(source.values())
    return {old: new for new, old in source.items()} | {name: name for name in stay}


class Killed(BaseException):
    """Raised in the place of a step that a killed process never does."""


def killed_at(step: int, operation: Callable[[], object], context: pytest.MonkeyPatch) -> bool:
    """Run an operation and stop it at the n-th change of a folder; tell whether it came so far."""
    left, tidying = step, False
    remove = shutil.rmtree

    def guard(real: Callable[..., object]) -> Callable[..., object]:
        def one(*arguments: object, **options: object) -> object:
            nonlocal left
            left -= not tidying
            if left < 0 and not tidying:
                raise Killed
            return real(*arguments, **options)

        return one

    def tidy(path: object, *arguments: object, **options: object) -> None:
        nonlocal tidying
        if ".eddi-transaction-" not in str(path):  # a killed process leaves its journal there
            tidying = True
            remove(path, *arguments, **options)
            tidying = False

    with context.context() as inner:
        inner.setattr(transaction, "_write", guard(transaction._write))
        inner.setattr(shutil, "rmtree", tidy)
        for name in ("replace", "unlink", "rename", "mkdir", "rmdir"):
            inner.setattr(os, name, guard(getattr(os, name)))
        try:
            operation()
        except Killed:
            return True
    return False


def saved_at(
    step: int,
    operation: Callable[[], Result],
    person: Callable[[], object],
    context: pytest.MonkeyPatch,
) -> Result:
    """Run an operation; a person saves something at its n-th write, before that is in its place."""
    left = step

    def guard(real: Callable[..., object]) -> Callable[..., object]:
        def one(*arguments: object, **options: object) -> object:
            nonlocal left
            left -= 1
            if left == -1:
                person()
            return real(*arguments, **options)

        return one

    with context.context() as inner:
        inner.setattr(transaction, "_write", guard(transaction._write))
        inner.setattr(os, "fsync", guard(os.fsync))
        return operation()


def snapshot(folder: Path) -> dict[str, bytes]:
    """Return every file below a folder, without git's own."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and ".git/" not in path.as_posix()
    }


def _check_valid(path: str, text: str) -> None:
    if path.endswith(".py"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(text, path, "exec", dont_inherit=True)
    if path.endswith((".xml", ".launch")):
        ET.fromstring(text)


def _function_of(text: str, token: str) -> str:
    number = text[: text.index(token)].count("\n") + 1
    found = [
        node
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef) and node.lineno <= number <= (node.end_lineno or 0)
    ]
    return max(found, key=lambda node: node.lineno).name if found else ""


def forked(operation: Callable[[], object]) -> int:
    """Run an operation, unheard, in a process group of its own, and return its id."""
    child = os.fork()
    if child == 0:  # pragma: no cover - ends by SIGKILL
        os.setsid()
        nowhere = os.open(os.devnull, os.O_RDWR)
        for handle in (0, 1, 2):
            os.dup2(nowhere, handle)
        try:
            operation()
        finally:
            os._exit(0)
    return child


def fresh_world(
    templates: Templates,
    folder: Path,
    platform: str = "plain",
    inputs: tuple[Element, ...] = START,
) -> World:
    """Return a package as `copier copy` makes it; it is rendered once for all tests that ask."""
    place = templates.path.parent / f"fresh_{len(_FRESH)}"
    if (old := _FRESH.get((templates.path, platform, inputs))) is None:
        place.mkdir()
        old = World(place, templates, platform, inputs)
        assert old.copy().status == 0
        old.settle()
        _FRESH[templates.path, platform, inputs] = old
    new = World(folder, templates, platform, inputs)
    shutil.rmtree(new.workspace)
    shutil.copytree(old.workspace, new.workspace, symlinks=True)
    new.seen, new.look = list(old.seen), old.look
    return new


_FRESH: dict[tuple[Path, str, tuple[Element, ...]], World] = {}


def edited_world(templates: Templates, folder: Path) -> World:
    """Return a plain package of ``START`` with a hand-written body for each input."""
    world = fresh_world(templates, folder)
    for shape, item in enumerate(START):
        world.edit(item.name, shape)
    return world
