"""Formatters over a package: what only they changed was not edited, and the merge leaves it so."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eddi_scaffold.regions.generated import as_placed, digests_of
from eddi_scaffold.regions.merge import merge
from eddi_scaffold.regions.result import Merged
from tests.checkouts import HERE

PLAIN = HERE / "tests" / "golden" / "plain"
ROS1 = HERE / "examples" / "two-conserts" / "expected" / "src" / "eddi_monitor"
RUNTIME = HERE / "runtime_lib" / "src" / "eddi_runtime"
FORMATTERS = {
    "ruff": ("ruff", "format", "--isolated", "-q"),
    "ruff-40": ("ruff", "format", "--isolated", "-q", "--line-length", "40"),
    "black": ("black", "-q"),
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


def formatted(name: str, folder: Path) -> None:
    tool, *words = FORMATTERS[name]
    if importlib.util.find_spec(tool) is None:
        pytest.skip(f"no {tool} here")
    command = [sys.executable, "-m", tool, *words, str(folder)]
    subprocess.run(command, check=True, capture_output=True)


@each
def test_only_the_layout_of_library_files_changes(name: str, tmp_path: Path) -> None:
    shutil.copytree(RUNTIME, tmp_path / "eddi_runtime")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.py")}
    formatted(name, tmp_path)
    changed = [path for path in before if path.read_bytes() != before[path]]
    assert changed
    assert not [p for p in changed if not digests_of(p.name, before[p]).fit(p.name, p.read_bytes())]


@each
def test_formatters_leave_what_is_written_for_generated_files(name: str, tmp_path: Path) -> None:
    for source in (PLAIN, ROS1, RUNTIME):
        shutil.copytree(source, tmp_path / source.name, ignore=shutil.ignore_patterns(".eddi"))
    for path in (tmp_path / RUNTIME.name).rglob("*.py"):
        path.write_bytes(as_placed(path.name, path.read_bytes()))
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.py")}
    formatted(name, tmp_path)
    changed = {path for path in before if path.read_bytes() != before[path]}
    assert changed == {path for path in before if b"Manual edit" in before[path]}


@each
@pytest.mark.parametrize("edit", EDITS)
def test_merge_and_formatter_do_not_undo_each_other(name: str, edit: str, tmp_path: Path) -> None:
    base = (PLAIN / "rover" / "EDDIInput.py").read_text("utf-8")
    place = tmp_path / "EDDIInput.py"
    place.write_text(base.replace(*EDITS[edit], 1), "utf-8")
    assert (place.read_text("utf-8") == base) == (edit == "nothing")
    formatted(name, tmp_path)
    mine = place.read_text("utf-8")
    for theirs in (base, base.replace('"""One attribute', '"""Now: one attribute')):
        merged = merge("EDDIInput.py", base, mine, theirs)
        assert isinstance(merged, Merged)
        assert not merged.notes
        assert merged.text is not None
        place.write_text(merged.text, "utf-8")
        formatted(name, tmp_path)
        assert place.read_text("utf-8") == merged.text
        assert (merged.text == mine) == (theirs == base)
