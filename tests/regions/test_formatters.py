"""Formatters over a package: what only they changed was not edited, and the merge leaves it so."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import autopep8
import black
import pytest
from hypothesis import settings

from eddi_scaffold.regions.generated import as_placed
from eddi_scaffold.regions.manifest import digests_of
from eddi_scaffold.regions.merge import merge
from eddi_scaffold.regions.result import Merged
from tests.checkouts import HERE, PLAIN_PACKAGES

ROS1 = HERE / "examples" / "two-conserts" / "expected" / "src" / "eddi_monitor"
RUNTIME = HERE / "runtime_lib" / "src" / "eddi_runtime"


def ruff(folder: Path, *options: str) -> None:
    command = [sys.executable, "-m", "ruff", "format", "--isolated", "-q", *options, str(folder)]
    subprocess.run(command, check=True, capture_output=True)


def each_file(layout: Callable[[str], str]) -> Callable[[Path], None]:
    """A formatter in this process: one of Python takes longer to start than to run."""

    def format_folder(folder: Path) -> None:
        for path in folder.rglob("*.py"):
            path.write_text(layout(path.read_text("utf-8")), "utf-8")

    return format_folder


def yapf(text: str) -> str:
    # Its import writes a cache in place: workers that collect at once would read half of it.
    from yapf.yapflib.yapf_api import FormatCode

    return str(FormatCode(text, style_config="pep8")[0])


FORMATTERS: dict[str, Callable[[Path], None]] = {
    "ruff": ruff,
    "ruff-40": lambda folder: ruff(folder, "--line-length", "40"),
    "black": each_file(lambda text: black.format_str(text, mode=black.Mode())),
    "yapf": each_file(yapf),
    "autopep8": each_file(autopep8.fix_code),
}
EDITS = {
    "nothing": ("", ""),
    "import": ("EDDIInputBase\n", "EDDIInputBase\nimport mine\n"),
    "import apart": ("EDDIInputBase\n", "EDDIInputBase\n\nimport mine\n"),
    "import first": ("\nfrom ", "\nimport mine\n\nfrom "),
    "constant": ("EDDIInputBase\n", "EDDIInputBase\n\nimport mine\n\nLIMIT = {'a': 1}\n"),
    "method": ("    def processing(", "    def mine(self): return 'mine'\n\n    def processing("),
    "body": ("self.MapKnown = MapKnown\n", "self.MapKnown = (MapKnown!='old')\n"),
}
each = pytest.mark.parametrize("name", FORMATTERS)


def library(name: str, folder: Path) -> None:
    """Write files of the library; every seventh for the slow ones, all in the long profile."""
    some = 1 if name.startswith("ruff") or settings.default.max_examples > 1000 else 7
    for path in sorted(RUNTIME.rglob("*.py"))[::some]:
        place = folder / path.relative_to(RUNTIME.parent)
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, place)


@each
def test_only_the_layout_of_library_files_changes(name: str, tmp_path: Path) -> None:
    library(name, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.py")}
    FORMATTERS[name](tmp_path)
    changed = [path for path in before if path.read_bytes() != before[path]]
    assert changed
    assert not [p for p in changed if not digests_of(p.name, before[p]).fit(p.name, p.read_bytes())]


@each
def test_formatters_leave_what_is_written_for_generated_files(name: str, tmp_path: Path) -> None:
    library(name, tmp_path)
    for source in (*PLAIN_PACKAGES, ROS1):
        shutil.copytree(source, tmp_path / source.name, ignore=shutil.ignore_patterns(".eddi"))
    for path in (tmp_path / RUNTIME.name).rglob("*.py"):
        path.write_bytes(as_placed(path.name, path.read_bytes()))
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.py")}
    FORMATTERS[name](tmp_path)
    changed = {path for path in before if path.read_bytes() != before[path]}
    editable = {path for path in before if b"Manual edit" in before[path]}
    assert changed & editable
    assert changed <= editable


@each
@pytest.mark.parametrize("edit", EDITS)
def test_merge_and_formatter_do_not_undo_each_other(name: str, edit: str, tmp_path: Path) -> None:
    base = (HERE / "tests/golden/plain/rover/EDDIInput.py").read_text("utf-8")
    place = tmp_path / "EDDIInput.py"
    place.write_text(base.replace(*EDITS[edit], 1), "utf-8")
    assert (place.read_text("utf-8") == base) == (edit == "nothing")
    FORMATTERS[name](tmp_path)
    mine = place.read_text("utf-8")
    for theirs in (base, base.replace('"""One attribute', '"""Now: one attribute')):
        merged = merge("EDDIInput.py", base, mine, theirs)
        assert isinstance(merged, Merged)
        assert not merged.notes
        assert merged.text is not None
        place.write_text(merged.text, "utf-8")
        FORMATTERS[name](tmp_path)
        assert place.read_text("utf-8") == merged.text
        assert (merged.text == mine) == (theirs == base)
