"""A workspace with one generated package, and a person who writes in it."""

from __future__ import annotations

import contextlib
import io
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from unittest.mock import patch

import yaml

from eddi_scaffold import cli
from eddi_scaffold.packages import rendering
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.platforms import chosen
from eddi_scaffold.regions.marked_file import Region, parse
from tests.quick_copier import copier_here
from tests.updates.inputs import Input, write_inputs
from tests.updates.templates import TAGS, Templates, git


@dataclass(frozen=True)
class Result:
    """How a command ended, and what it said."""

    status: int
    said: str


@cache
def answers_of(inputs: tuple[Input, ...]) -> tuple[str, Mapping[str, bytes]]:
    """Return the answers for plain Copier, and the files that it does not render."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model, config = write_inputs(folder, inputs)
        monitors, problems = monitors_of(model, [config])
        assembly = assemble(monitors, chosen("ros1"), folder / "none", problems)
    package = next(one for one in assembly.packages if one.folder == "rover")
    return yaml.safe_dump(dict(package.answers)), package.files


@cache
def begun(templates: Templates, inputs: tuple[Input, ...], template: str) -> Path:
    """Generate into an empty workspace, once."""
    world = World(Path(tempfile.mkdtemp(dir=templates.path.parent)), templates, inputs, template)
    (world.workspace / "src").mkdir(parents=True)
    git(world.workspace, "init", "-q", "-b", "main")
    done = world.run("generate")
    assert done.status == 0, done.said
    world.commit()
    return world.folder


@dataclass
class World:
    """The workspace."""

    folder: Path
    templates: Templates
    inputs: tuple[Input, ...]
    template: str = "first"
    workspace: Path = Path()

    def __post_init__(self) -> None:
        self.workspace = self.folder / "ws"

    @property
    def package(self) -> Path:
        return self.workspace / "src/eddi_monitor/rover"

    def begin(self) -> None:
        base = begun(self.templates, self.inputs, self.template)
        shutil.copytree(base, self.folder, symlinks=True, dirs_exist_ok=True)

    def run(self, command: str, flags: Sequence[str] = ()) -> Result:
        """Run one of our commands, or one of Copier's."""
        if command == "generate":
            model, config = write_inputs(self.folder / "inputs", self.inputs)
            return self.command("generate", "-w", self.workspace, "-m", model, "-c", config)
        if command == "upgrade":
            return self.command("upgrade", "-w", self.workspace)
        data = self.folder / "answers.yml"
        answers, files = answers_of(self.inputs)
        data.write_text(f"{answers}files_folder: {data}.files\n")
        for name, content in files.items():
            file = Path(f"{data}.files", Path(name).name)
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(content)
        words: list[object] = [command, "--trust", "--defaults", "--quiet", "--data-file", data]
        words += ["--vcs-ref", TAGS[self.template], *flags]
        words += [] if command == "update" else ["--overwrite"]
        places = [self.templates.path, self.package] if command == "copy" else [self.package]
        done = copier_here(*words, *places, cwd=self.workspace)
        return Result(done.returncode, done.stdout + done.stderr)

    def command(self, *words: object) -> Result:
        """Run eddi-scaffold in this process, with the templates of today as its own."""
        argv = ["eddi-scaffold", *map(str, words)]
        template = rendering.Template(str(self.templates.path), TAGS[self.template])
        said = io.StringIO()
        status = 0
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

    def commit(self) -> None:
        git(self.workspace, "add", "-A")
        git(self.workspace, "commit", "-q", "--allow-empty", "-m", "work")

    def clone(self, *settings: str) -> World:
        """Return the same in a clone."""
        there = self.folder / "clone"
        there.mkdir()
        options = [word for setting in settings for word in ("-c", setting)]
        git(self.folder, "clone", "-q", *options, str(self.workspace), str(there / "ws"))
        for setting in settings:
            git(there / "ws", "config", *setting.split("="))
        return replace(self, folder=there)

    def file(self, name: str) -> Path:
        """Return the one file of a name, which may be new beside another."""
        records = self.package / ".eddi"
        found = [one for one in self.package.rglob(name) if not one.is_relative_to(records)]
        assert len(found) == 1, (name, found)
        return found[0]

    def text(self, name: str) -> str:
        return self.file(name).read_bytes().decode()

    def region(self, region_id: str, name: str = "EDDIInput.py") -> Region:
        return parse(self.text(name))[0].regions[region_id]

    def put(self, region_id: str, body: str, name: str = "EDDIInput.py") -> None:
        """Replace the body of a region."""
        one, text = self.region(region_id, name), self.text(name)
        eol = "\r\n" if "\r\n" in text else "\n"
        before = f"{one.begin}{eol}{one.body}{one.end}"
        assert text.count(before) == 1
        self.file(name).write_bytes(
            text.replace(before, f"{one.begin}{eol}{body}{one.end}").encode()
        )

    def kept(self) -> list[str]:
        """Return the regions that are kept."""
        found = (self.package / ".eddi/kept").glob("*.region*")
        return sorted(re.sub(r"\.region(\.\d+)?$", "", path.name) for path in found)

    def imports(self) -> None:
        """Import EDDIInput, and make one."""
        module, runtime = self.file("EDDIInput.py"), Path(__file__).parents[2] / "runtime_lib/src"
        script = textwrap.dedent(f"""
            import importlib, sys
            sys.dont_write_bytecode = True
            sys.path[:0] = {[str(module.parents[1]), str(runtime)]!r}
            module = importlib.import_module("{module.parent.name}.EDDIInput")
            module.EDDIInput()
        """)
        subprocess.run([sys.executable, "-c", script], check=True)

    def remove(self, name: str) -> None:
        path = self.package / name if name.startswith(".") else self.file(name)
        shutil.rmtree(path) if path.is_dir() else path.unlink()
