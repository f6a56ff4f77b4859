"""A clean checkout of what is being tested, as a commit of its own, and commands run from it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).parents[1]
PLAIN_PACKAGES = sorted(
    file.parent
    for place in ("examples/*/expected", "tests/golden/plain")
    for file in HERE.glob(f"{place}/*/pyproject.toml")
    if file.parent.name != "eddi_runtime"
)
"""One of each kind, of an example where it needs more than a model."""
PRIVATE = ("_commit:", "_src_path:")
_PARTS = (
    ".gitignore",
    "copier.yml",
    "copier_templates",
    "eddi_scaffold",
    "runtime_lib/src",
    "examples",
    "hatch_build.py",
    "pyproject.toml",
    "README.md",
    "LICENSE",
)
_IGNORED = shutil.ignore_patterns(
    "__pycache__", "*.pyc", "*.egg-info", "templates.bundle", ".*_cache"
)
_SILENT = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}


def git(folder: Path, *words: str) -> str:
    """Run git as nobody in particular."""
    identity = ("-c", "user.name=Tester", "-c", "user.email=tester@localhost")
    return run(["git", *identity, *words], folder, _SILENT).stdout


def assert_licensed(dist: Path, name: str) -> None:
    """Assert that the wheel and the sdist of a distribution hold the text of the licence."""
    text = (HERE / "LICENSE").read_bytes()
    (wheel,) = dist.glob(f"{name}-*.whl")
    (sdist,) = dist.glob(f"{name}-*.tar.gz")
    with zipfile.ZipFile(wheel) as files, tarfile.open(sdist) as packed:
        (one,) = [file for file in files.namelist() if file.endswith("/licenses/LICENSE")]
        assert files.read(one) == text
        file = packed.extractfile(f"{sdist.name.removesuffix('.tar.gz')}/LICENSE")
        assert file is not None
        assert file.read() == text


def run(
    command: list[str],
    folder: Path,
    env: Mapping[str, str] | None = None,
) -> subprocess.CompletedProcess[str]:
    """Run a command without a terminal; it has to succeed."""
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **(env or {})},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done


_SEVERAL = """
import contextlib, io, json, sys
from eddi_scaffold import cli
from eddi_scaffold.cli.console import console

results = []
for words in json.loads(sys.argv[1]):
    sys.argv = ["eddi-scaffold", *words]
    console.quiet, console.verbose, console.colour = False, False, None
    with contextlib.redirect_stderr(io.StringIO()) as said, contextlib.redirect_stdout(said):
        try:
            cli.main()
        except SystemExit as end:
            results.append((int(end.code or 0), said.getvalue()))
print(json.dumps(results))
"""


def several(
    commands: Mapping[tuple[object, ...], int], folder: Path, env: Mapping[str, str]
) -> list[str]:
    """Run commands one after the other in one new process, and return their words."""
    lines = [list(map(str, words)) for words in commands]
    results = json.loads(
        run([sys.executable, "-c", _SEVERAL, json.dumps(lines)], folder, env).stdout
    )
    for line, status, (got, said) in zip(lines, commands.values(), results, strict=True):
        assert got == status, f"{line}\n{said}"
    return [said for _, said in results]


@dataclass(frozen=True)
class Checkout:
    """A git repository that is program and template at once."""

    path: Path
    env: Mapping[str, str] = field(default_factory=dict)

    @property
    def example(self) -> Path:
        return self.path / "examples" / "two-conserts"

    def eddi(self, *words: object, cwd: Path | None = None) -> str:
        """Run ``eddi-scaffold`` of this checkout, by default beside it; return its words."""
        return self.several({words: 0}, cwd or self.path.parent)[0]

    def several(self, commands: Mapping[tuple[object, ...], int], folder: Path) -> list[str]:
        """Run several commands of this checkout."""
        sources = os.pathsep.join([str(self.path), str(self.path / "runtime_lib" / "src")])
        return several(commands, folder, {**self.env, "PYTHONPATH": sources})

    def copier(self, *words: object, cwd: Path) -> None:
        """Run the plain ``copier`` command; from here Python finds nothing of ours."""
        run([sys.executable, "-m", "copier", *map(str, words)], cwd, {"PYTHONPATH": ""})


def keep_compiled(path: Path) -> None:
    """Give a copy of this checkout the bytecode that there is: else each program compiles anew."""
    for compiled in [*HERE.glob("eddi_scaffold/**/*.pyc"), *HERE.glob("runtime_lib/src/**/*.pyc")]:
        source = compiled.parents[1] / f"{compiled.name.partition('.')[0]}.py"
        copy = path / source.relative_to(HERE)
        if copy.is_file() and source.is_file() and copy.read_bytes() == source.read_bytes():
            target = path / compiled.relative_to(HERE)
            target.parent.mkdir(exist_ok=True)
            shutil.copy(compiled, target)
            shutil.copystat(source, copy)  # by which Python knows that it is the same


def checkout(path: Path, *tags: str) -> Checkout:
    """Commit the working tree as it is now to a new repository, and tag the commit."""
    path.mkdir(parents=True)
    for part in _PARTS:
        source, target = HERE / part, path / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, symlinks=True, ignore=_IGNORED)
        else:
            shutil.copy(source, target)
    git(path, "init", "--quiet", "--initial-branch=main")
    git(path, "add", "--all", "--force")
    git(path, "commit", "--quiet", "--message", "As it is now")
    for tag in tags:
        git(path, "tag", tag)
    keep_compiled(path)
    return Checkout(path)


def tree(folder: Path, *skip: str) -> dict[str, tuple[bool, bytes]]:
    """Read the files below a folder: path -> (executable, content), without folders in ``skip``."""
    found = {}
    for root, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if name not in {"__pycache__", *skip})
        for name in sorted(files):
            path = Path(root, name)
            executable = bool(path.stat().st_mode & 0o100)
            found[path.relative_to(folder).as_posix()] = (executable, path.read_bytes())
    return found


def without_origin(text: bytes) -> bytes:
    """Drop from an answers file where the templates lay: it differs between machines."""
    lines = text.decode().splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith(PRIVATE)).encode()
