"""Run eddi-scaffold in this process, as a user would in some folder."""

import atexit
import contextlib
import io
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from unittest.mock import patch

import typer.main

from eddi_scaffold import cli
from eddi_scaffold.cli.console import console
from eddi_scaffold.packages import rendering
from eddi_scaffold.packages.unpacking import PATHS

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "two-conserts"


@cache
def template() -> rendering.Template:
    """Copy the templates as they lie there: faster than git, no note on uncommitted changes."""
    from tests.quick_copier import render_faster  # half a second, only where needed

    render_faster()
    folder = Path(tempfile.mkdtemp(prefix="eddi-templates-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name in PATHS:
        if (ROOT / name).is_dir():
            skip = shutil.ignore_patterns("__pycache__")
            shutil.copytree(ROOT / name, folder / name, symlinks=True, ignore=skip)
        else:
            shutil.copy(ROOT / name, folder / name)
    return rendering.Template(str(folder), None)


_COMMANDS = cache(typer.main.get_command)
"""Typer makes all commands anew for each call, which takes as long as a short one."""


@dataclass(frozen=True)
class Result:
    """What a command left behind."""

    status: int
    out: str
    err: str


def run(*words: object, cwd: Path) -> Result:
    """Run one command in a folder."""
    console.quiet, console.verbose, console.colour = False, False, None
    out, err = io.StringIO(), io.StringIO()
    before = Path.cwd()
    os.chdir(cwd)
    try:
        with (
            patch.object(sys, "argv", ["eddi-scaffold", *map(str, words)]),
            patch.object(rendering, "own_template", template),
            patch.object(typer.main, "get_command", _COMMANDS),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            cli.main()
    except SystemExit as end:
        return Result(int(end.code or 0), out.getvalue(), err.getvalue())
    finally:
        os.chdir(before)
    raise AssertionError("a command ends with an exit status")


def scaffold(
    *words: object, cwd: Path, env: Mapping[str, str] | None = None, umask: int = -1
) -> subprocess.Popen[str]:
    """Start a command as a process of its own."""
    code = (
        "import sys; from eddi_scaffold.packages import rendering; "
        "from tests.cli.command import template; rendering.own_template = template; "
        "from eddi_scaffold.cli import main; main()"
    )
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, words)],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(ROOT), **(env or {})},
        umask=umask,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def generate(place: Path, letter: str, *words: object, status: int = 0) -> Result:
    """Generate a monitor of the example into a workspace."""
    files = ("-m", EXAMPLE / "two_conserts.xml", "-c", EXAMPLE / f"consert_{letter}_config.yml")
    done = run("generate", "-w", place, *files, *words, cwd=place)
    assert done.status == status, done.err
    return done


def example(folder: Path) -> Path:
    """Put the files of the example into a folder, and an empty workspace."""
    (folder / "ws" / "src").mkdir(parents=True, exist_ok=True)
    for file in (path for path in EXAMPLE.iterdir() if path.is_file()):
        shutil.copy(file, folder / file.name)
    return folder


def edit(path: Path, old: str, new: str) -> None:
    """Replace a text of a file that must be there."""
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")


def files_below(folder: Path) -> dict[str, bytes]:
    """Return every file below a folder."""
    start = len(f"{folder}/")
    paths = sorted(f"{place}/{name}" for place, _, names in os.walk(folder) for name in names)
    return {path[start:]: Path(path).read_bytes() for path in paths if Path(path).is_file()}


XML_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<integration_:DDIPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
    ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
    ' xmlns:consert_="http://www.deis-project.eu/ode/consert"'
    ' xmlns:integration_="http://www.deis-project.eu/ode/integration" name="Small">\n'
    '<odeProductPackages xsi:type="consert_:ConSertPackage" name="ConSerts">\n'
)
"""An EDDI up to where its ConSerts stand."""
XML_TAIL = "\n</odeProductPackages></integration_:DDIPackage>\n"
