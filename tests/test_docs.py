"""The commands in the documentation run as they are printed, in the order in which they stand."""

from __future__ import annotations

import importlib
import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

from eddi_scaffold.compiling.compilation import KINDS

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(
    r"(?P<shown><!-- shown only: [^\n]+ -->\n)?```console\n(?P<text>.*?)```"
    r"|<!-- file: (?P<file>[\w.]+) -->\n```\w+\n(?P<content>.*?)```",
    re.DOTALL,
)
WRITE = "write "


def commands(page: Path) -> list[tuple[str, str]]:
    """Return (command, printed output) of every block that is not marked as shown only.

    A block that is marked as a file is the command ``write FILE`` with its content.
    """
    found = []
    for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
        if block["file"]:
            found.append((f"{WRITE}{block['file']}", block["content"]))
        if block["shown"] or block["file"]:
            continue
        for part in re.split(r"^\$ ", block["text"], flags=re.MULTILINE)[1:]:
            command, _, output = part.partition("\n")
            found.append((command.partition("  #")[0].strip(), output))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_commands_of_a_page_run(page: Path, tmp_path: Path) -> None:
    program = tmp_path / "bin" / "eddi-scaffold"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m eddi_scaffold "$@"\n')
    program.chmod(0o755)
    environment = {
        **os.environ,
        "PATH": f"{program.parent}:{os.environ['PATH']}",
        "PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}",
        "HOME": str(tmp_path),
    }
    folder = tmp_path / "work"
    folder.mkdir()
    for command, output in commands(page):
        if command.startswith("cd "):
            folder /= command.removeprefix("cd ")
            continue
        if command.startswith(WRITE):
            (folder / command.removeprefix(WRITE)).write_text(output, encoding="utf-8")
            continue
        done = subprocess.run(
            command,
            shell=True,
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{page.name}: {command}\n{done.stderr}"
        if output:
            assert done.stdout == output, command


INNER = {"engine_for", "judge", "read", "reduce", "restart", "sources", "stamp", "step"}
"""What compiled text or another module of the runtime calls, not people."""


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_the_methods_of_each_kind_of_monitor_are_listed(kind: str) -> None:
    package = importlib.import_module(f"eddi_runtime.{kind}")
    names = [one.name for one in pkgutil.iter_modules(package.__path__, f"{package.__name__}.")]
    found = [one for name in names for one in vars(importlib.import_module(name)).values()]
    monitors = [one for one in found if getattr(one, "kind", None) == kind]
    there = {
        name
        for monitor in monitors
        for name in {*dir(monitor)} - INNER
        if not name.startswith("_") and callable(getattr(monitor, name))
    }
    text = (ROOT / "docs" / "runtime.md").read_text(encoding="utf-8")
    rows = re.findall(r"(?m)^\| `(\w+)\([^|]*\)` \| ([^|]+) \|", text)
    told = {name for name, kinds_of in rows if kinds_of == "all" or f"`{kind}`" in kinds_of}
    assert told == there


def test_every_link_points_somewhere() -> None:
    for page in [*PAGES, ROOT / "CONTRIBUTING.md"]:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
            if not target.startswith("https://"):
                assert (page.parent / target).exists(), f"{page.name}: {target}"
