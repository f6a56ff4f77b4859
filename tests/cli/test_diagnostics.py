"""Each diagnostic that the command line can give: the files that earn it, and its exact text.

The cases stand in ``diagnostics/*.txt``::

    ### CODE what it is about
    $ command                    (several: all but the last prepare)
    == FILE                      a file beside those of the example; with a line `->` in it, an
    text                         edit of the file: what stands before it is replaced by the rest
    >>> STATUS
    what is printed: data, then words

``UPDATE_DIAGNOSTICS=1 pytest tests/cli/test_diagnostics.py`` writes what is printed now; read the
difference before you commit it.
"""

import os
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.cli.command import ROOT, example, files_below, run

FOLDER = Path(__file__).with_name("diagnostics")


@dataclass(frozen=True)
class Case:
    title: str
    commands: list[str]
    files: list[tuple[str, str]]
    status: int
    printed: str

    @property
    def code(self) -> str:
        return self.title.partition(" ")[0]


def read_cases(path: Path) -> list[Case]:
    return [read_case(part) for part in re.split(r"(?m)^### ", path.read_text("utf-8"))[1:]]


def read_case(text: str) -> Case:
    head, _, rest = text.partition("\n>>> ")
    title, _, given = head.partition("\n")
    first, *sections = re.split(r"(?m)^== ", f"{given}\n")
    commands = [line.removeprefix("$ ") for line in first.splitlines()]
    status, _, printed = rest.partition("\n")
    files = [(name, body) for name, _, body in (s.partition("\n") for s in sections)]
    return Case(title, commands, files, int(status or 0), printed.strip("\n"))


def lay(case: Case, folder: Path) -> None:
    example(folder)
    for name, body in case.files:
        change(folder / name, body)


def change(path: Path, body: str) -> None:
    old, arrow, new = body.partition("->\n")
    path.parent.mkdir(parents=True, exist_ok=True)
    if not arrow:
        path.write_text(body, encoding="utf-8")
        return
    text = path.read_text(encoding="utf-8")
    assert text.count(old) >= 1, f"{path.name} does not hold {old!r}"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def play(case: Case, folder: Path) -> tuple[int, str]:
    """Play a case; commands that prepare may be shell-like `edit FILE` lines for later files."""
    lay(Case(case.title, [], [f for f in case.files if "~" not in f[0]], 0, ""), folder)
    for command in case.commands[:-1]:
        run(*shlex.split(command), cwd=folder)
    for name, body in case.files:
        if "~" in name:  # edited after the commands that prepare
            change(folder / name.replace("~", ""), body)
    before = files_below(folder)
    result = run(*shlex.split(case.commands[-1]), cwd=folder)
    if result.status == 2:
        assert files_below(folder) == before, "bad input, but something was written"
    printed = f"{result.out}{result.err}".replace(str(folder), "HERE").replace(str(ROOT), "REPO")
    return result.status, printed.strip("\n")


CASES = [case for path in sorted(FOLDER.glob("*.txt")) for case in read_cases(path)]


SLOW = {"B301 a table that takes long"}
PLAYED = [
    pytest.param(case, marks=[pytest.mark.slow] if case.title in SLOW else []) for case in CASES
]


@pytest.mark.parametrize("case", PLAYED, ids=[case.title.replace(" ", "_") for case in CASES])
def test_text_of_the_diagnostic(case: Case, tmp_path: Path) -> None:
    status, printed = play(case, tmp_path)
    if os.environ.get("UPDATE_DIAGNOSTICS"):
        update(case, status, printed)
        return
    assert f"[{case.code}]" in printed or f'"code": "{case.code}"' in printed
    assert printed == case.printed
    assert status == case.status


def update(case: Case, status: int, printed: str) -> None:
    for path in FOLDER.glob("*.txt"):
        parts = re.split(r"(?m)^(?=### )", path.read_text("utf-8"))
        path.write_text("".join(updated(part, case, status, printed) for part in parts), "utf-8")


def updated(part: str, case: Case, status: int, printed: str) -> str:
    if not part.startswith(f"### {case.title}\n"):
        return part
    head = part.partition("\n>>> ")[0].rstrip("\n")
    return f"{head}\n>>> {status}\n{printed}\n\n"
