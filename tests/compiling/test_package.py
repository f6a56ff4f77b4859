"""The file in a package: written from its model.json, whatever a person did to it."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eddi_scaffold.compiling.package import place_tables, write_compiled
from eddi_scaffold.compiling.sources import lost_inputs
from eddi_scaffold.regions.package import manifest_of

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "examples/two-conserts/expected/src/eddi_monitor/conserta"
RENDERED = ".eddi/new/1-2"
COMPILED = f"{RENDERED}/src/conserta/compiled.py"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Return a package with a rendering as Copier leaves it, which has no compiled monitor."""
    package = Path(shutil.copytree(PACKAGE, tmp_path / "conserta"))
    for name in manifest_of(package).files:
        (package / RENDERED / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(package / name, package / RENDERED / name)
    return package


def test_it_is_written_again(package: Path) -> None:
    before = (package / COMPILED).read_bytes()
    (package / COMPILED).unlink()
    assert write_compiled(package / RENDERED) is None
    assert (package / COMPILED).read_bytes() == before.replace(b"# fmt: off\n", b"", 1)


def test_a_damaged_model_gives_a_file_that_says_so(package: Path) -> None:
    model = package / RENDERED / "config" / "model.json"
    model.write_text(model.read_text("utf-8").replace("RtE_E0", "RtE_E1"))
    problem = write_compiled(package / RENDERED)
    assert problem is not None
    assert problem.startswith("config/model.json: the content was changed")
    code = f"import sys; sys.path.insert(0, '{RENDERED}/src'); import conserta.compiled"
    runtime = str(ROOT / "runtime_lib" / "src")
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=package,
        env={"PYTHONPATH": runtime},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "ModelError" in done.stderr.splitlines()[-1]
    assert "the content was changed" in done.stderr.splitlines()[-1]


def test_other_packages_have_none(tmp_path: Path) -> None:
    launcher = shutil.copytree(PACKAGE.parent / "eddi_monitor_launcher", tmp_path / "launcher")
    before = sorted(path.name for path in Path(launcher).rglob("*"))
    assert write_compiled(Path(launcher)) is None
    assert sorted(path.name for path in Path(launcher).rglob("*")) == before


def test_the_command_says_what_is_wrong(package: Path) -> None:
    tool = str(ROOT / "eddi_scaffold" / "compiling")

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-S", tool, *words]
        return subprocess.run(command, cwd=package, capture_output=True, text=True, check=False)

    done = run("write", RENDERED)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    (package / RENDERED / "config" / "model.json").write_text("{")
    done = run("write", RENDERED)
    assert done.returncode == 0
    assert done.stderr.startswith("error: config/model.json: the file is damaged")
    assert run("-h").returncode == 0
    assert run("read").returncode == 2


def test_tables_are_taken_from_their_folder(tmp_path: Path) -> None:
    """Copier renders no numbers: what is missing is named, what nothing reads any more leaves."""
    golden = ROOT / "examples/safeml/expected/camera_scope"
    given, root = tmp_path / "given", tmp_path / "camera_scope"
    given.mkdir()
    for name in ("model.json", "EDDIMonitor.py"):
        (root / RENDERED).mkdir(parents=True, exist_ok=True)
        shutil.copy(golden / name, root / RENDERED / name)
    table = root / RENDERED / "reference.bin"
    assert place_tables(root, root / RENDERED, None) == ["reference.bin"]
    (given / "reference.bin").write_bytes(b"another one")
    assert place_tables(root, root / RENDERED, given) == ["reference.bin"]
    assert not table.exists()
    shutil.copy(golden / "reference.bin", given)
    assert place_tables(root, root / RENDERED, given) == []
    assert table.read_bytes() == (golden / "reference.bin").read_bytes()
    table.rename(root / table.name)
    assert place_tables(root, root / RENDERED, None) == [], "so is the one that was placed before"
    assert table.exists()
    (root / table.name).unlink()
    tool = [sys.executable, "-S", str(ROOT / "eddi_scaffold" / "compiling"), "write", RENDERED]
    table.unlink()
    done = subprocess.run(tool, cwd=root, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("reference.bin of the answers is not there")) == (
        0,
        1,
    )


def test_an_input_that_loses_its_source_is_named(package: Path) -> None:
    """Plain Copier has no exit status for it; a hand-written body needs no word."""
    name = "src/conserta/EDDIInput.py"
    new = package / RENDERED / name
    assert list(lost_inputs(package, package / RENDERED)) == []
    made = "self.RtE_A_E0 = RtE_E0.data"
    text = new.read_text("utf-8")
    assert made in text
    new.write_text(text.replace(made, "# TODO: set it\n        self.RtE_A_E0 = None"), "utf-8")
    told = f"input 'RtE_A_E0' has no source any more: it was made by `{made}`"
    assert list(lost_inputs(package, package / RENDERED)) == [told]
    tool = [sys.executable, "-S", str(ROOT / "eddi_scaffold" / "compiling"), "write", RENDERED]
    done = subprocess.run(tool, cwd=package, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, f"note: {told}\n")
    mine = package / name
    mine.write_text(mine.read_text("utf-8").replace(made, f"{made} and True"), "utf-8")
    assert list(lost_inputs(package, package / RENDERED)) == []
