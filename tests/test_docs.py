"""The commands in the documentation run as they are printed, in the order in which they stand."""

from __future__ import annotations

import importlib
import pkgutil
import re
import shlex
import subprocess
import sys
from glob import glob
from itertools import chain
from pathlib import Path

import pytest

from eddi_scaffold.kinds import kinds
from eddi_scaffold.regions.marked_file import parse
from tests.cli.command import run

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(
    r"(?P<shown><!-- shown only: [^\n]+ -->\n)?```console\n(?P<text>.*?)```"
    r"|<!-- (?P<file>(?:region: \S+ in|file:|edit:) [\w./]+) -->\n```\w+\n(?P<content>.*?)```",
    re.DOTALL,
)
CONTINUES = re.compile(r"<!-- continues: (\S+) -->")
WRITE, BETWEEN, EDIT = "file: ", "region: ", "edit: "
PROGRAM = "eddi-scaffold "
OPERATORS = {"2>&1", ">", "|"}


def commands(page: Path) -> list[tuple[str, str]]:
    """Return (command, printed output) of every block that is not marked as shown only.

    A block that is marked as a file is the command ``file: FILE`` with its content, one that is
    marked as the body of a region ``region: ID in FILE``, and lines before and after that are
    marked as an edit ``edit: FILE``.
    """
    found = []
    for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
        if block["file"]:
            found.append((block["file"], block["content"]))
        if block["shown"] or block["file"]:
            continue
        for part in re.split(r"^\$ ", block["text"], flags=re.MULTILINE)[1:]:
            command, _, output = part.partition("\n")
            found.append((command, output))
    return found


def story(page: Path) -> list[Path]:
    """Return the pages read in one folder: those that this one goes on from, and itself."""
    before = CONTINUES.search(page.read_text(encoding="utf-8"))
    return [*(story((page.parent / before[1]).resolve()) if before else []), page]


STORIES = [story(page) for page in PAGES]


@pytest.mark.parametrize(
    "pages",
    [
        one
        for one in STORIES
        if not any(one == other[: len(one)] for other in STORIES if other != one)
    ],
    ids=lambda pages: str(pages[-1].relative_to(ROOT)),
)
def test_the_commands_of_a_page_run(pages: list[Path], tmp_path: Path) -> None:
    folder = tmp_path
    for command, output in chain.from_iterable(map(commands, pages)):
        if command.startswith("cd "):
            folder /= command.removeprefix("cd ")
        elif command.startswith(WRITE):
            (folder / command.removeprefix(WRITE)).write_text(output, encoding="utf-8")
        elif command.startswith(EDIT):
            edit(folder / command.removeprefix(EDIT), output)
        elif command.startswith(BETWEEN):
            put(*command.removeprefix(BETWEEN).split(" in "), output, folder)
        else:
            printed = run_line(command, folder)
            if output:
                assert printed == output, command


def edit(path: Path, changes: str) -> None:
    """Do what lines before (``-``) and after (``+``) say; an empty line is between two changes."""
    text = path.read_text("utf-8")
    for change in changes.split("\n\n"):
        lines = change.strip("\n").splitlines(keepends=True)
        old = "".join(line[1:].rstrip("\n") + "\n" for line in lines if line[0] != "+")
        new = "".join(line[1:].rstrip("\n") + "\n" for line in lines if line[0] != "-")
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path.write_text(text, "utf-8")


def put(region: str, name: str, body: str, folder: Path) -> None:
    """Write between two marker lines."""
    text = (folder / name).read_text("utf-8")
    one = parse(text)[0].regions[region]
    lines = text.splitlines(keepends=True)
    lines[one.line : one.line + one.body.count("\n")] = [body]
    (folder / name).write_text("".join(lines), "utf-8")


def run_line(line: str, folder: Path) -> str:
    """Run a line of a shell and return what it prints: commands of ours in this process, fast.

    Of the shell, such a line may have ``2>&1``, ``> FILE`` or a pipe to anything else, and an
    expected exit status in the comment at its end: ``# status 3``. What it prints is data, or words
    where it has none.
    """
    command, _, comment = line.partition("  #")
    if not command.startswith(PROGRAM):
        return shell(command, folder)
    words = shlex.split(command.removeprefix(PROGRAM))
    cut = next((at for at, word in enumerate(words) if word in OPERATORS), len(words))
    found = [sorted(glob(one, root_dir=folder)) or [one] for one in words[:cut]]  # noqa: PTH207
    done = run(*chain.from_iterable(found), cwd=folder)
    if "|" in words[cut:]:
        both = done.err if words[cut] == "2>&1" else ""
        return shell(command.partition(" | ")[2], folder, done.out + both)
    status = re.search(r"status (\d)", comment)
    assert done.status == int(status[1] if status else 0), f"{line}\n{done.err}"
    if words[cut:]:
        (folder / words[-1]).write_text(done.out, encoding="utf-8")
        return ""
    return done.out or done.err


def shell(command: str, folder: Path, given: str = "") -> str:
    done = subprocess.run(
        command, shell=True, cwd=folder, input=given, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{command}\n{done.stderr}"
    return done.stdout


INNER = {
    *("judge", "look", "published", "read", "reduce"),
    *("restart", "sources", "stamp", "step"),
}
"""What compiled text or another module of the runtime calls, not people."""


@pytest.mark.parametrize("kind", sorted(kinds()))
def test_the_methods_of_each_kind_of_monitor_are_listed(kind: str) -> None:
    part = importlib.import_module(f"eddi_runtime.{kind}")
    folder = getattr(part, "__path__", [])  # else a module
    names = [part.__name__]
    names += [module.name for module in pkgutil.iter_modules(folder, f"{part.__name__}.")]
    found = [one for name in names for one in vars(importlib.import_module(name)).values()]
    monitors = [one for one in found if getattr(one, "kind", None) == kind]
    there = {
        name
        for monitor in monitors
        for name in {*dir(monitor)} - INNER
        if not name.startswith("_") and callable(getattr(monitor, name))
    }
    text = (ROOT / "docs" / "reference" / "runtime.md").read_text(encoding="utf-8")
    rows = re.findall(r"(?m)^\| `(\w+)\([^|]*\)` \| ([^|]+) \|", text)
    told = {name for name, kinds_of in rows if kinds_of == "all" or f"`{kind}`" in kinds_of}
    assert told == there


def test_the_site_builds(tmp_path: Path) -> None:
    """Every page is in a list of the first one, and every link between pages holds.

    All are written for that, one of them as HTML, which takes longer.
    """
    read = tmp_path / "read"
    command = [sys.executable, "-m", "sphinx", "-q", "-c", "docs", "-d", str(read), "."]
    for words in (["-W", "-b", "dummy"], []):
        more = [] if words else [str(PAGES[0])]
        subprocess.run([*command, str(tmp_path), *words, *more], cwd=ROOT, check=True, timeout=300)
    for page in PAGES:
        assert (read / page.relative_to(ROOT).with_suffix(".doctree")).is_file()
    assert (tmp_path / "README.html").is_file()


def words(page: Path) -> int:
    """Return the number of words of a page; of the README, what stands before "More"."""
    return len(page.read_text("utf-8").partition("\n## More\n")[0].split())


def test_pages_are_short() -> None:
    """What a newcomer reads one after the other, the pages that are looked up, and all of them."""
    tutorials = ("first-guarantee", "why-not", "robot-by-hand", "living-with-it")
    path = [PAGES[0], *(ROOT / f"docs/tutorials/{name}.md" for name in tutorials)]
    assert words(PAGES[0]) <= 700
    assert sum(map(words, path)) <= 4_000
    pages = [page for page in PAGES[1:] if page.name != "python.md"]  # written from docstrings
    looked_up = [page for page in pages if page.parent.name == "reference"]
    assert [page.name for page in looked_up if words(page) > 1_200] == []
    assert sum(map(words, pages)) <= 36_000
