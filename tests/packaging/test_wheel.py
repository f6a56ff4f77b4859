"""The wheel alone, with the sources absent, does the main job, and its packages can be updated."""

from __future__ import annotations

import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from eddi_scaffold import __version__
from tests.checkouts import assert_licensed, checkout, git, run, several, tree

OLD, NOW = "v0.0.1", f"v{__version__}"
SHELF = "~/.local/share/eddi-scaffold/templates.bundle"
pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Installed:
    """A wheel in a folder of its own, with a private home."""

    folder: Path
    wheel: Path

    @property
    def env(self) -> dict[str, str]:
        home = self.folder / "home"
        return {"PYTHONPATH": str(self.folder / "site"), "HOME": str(home), "XDG_DATA_HOME": ""}

    def copier(self, *words: object) -> None:
        """Run Copier, which finds nothing of ours but the bundle in the home folder."""
        env = {**self.env, "PYTHONPATH": ""}
        command = [sys.executable, "-m", "copier", *map(str, words), "--trust", "--defaults"]
        run([*command, "--quiet"], self.folder, env)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    folder = tmp_path_factory.mktemp("packaging")
    source = checkout(folder / "source", OLD)
    readme = source.path / "copier_templates/ros1_monitor/.eddi/new/{{ stage }}/README.md.jinja"
    readme.write_text(f"{readme.read_text('utf-8')}\nNew in {NOW}.\n", "utf-8")
    git(source.path, "commit", "--quiet", "--all", "--message", "Release")
    git(source.path, "tag", NOW)
    # first the sdist, then the wheel from the sdist, where there is no .git
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder / "dist")]
    run(build, source.path)
    (wheel,) = (folder / "dist").glob("*.whl")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    run([*pip, "--target", str(folder / "site"), str(wheel)], folder)
    (folder / "home").mkdir()
    source.path.rename(folder / "sources that nobody finds")
    return Installed(folder, wheel)


def test_contents(installed: Installed) -> None:
    names = zipfile.ZipFile(installed.wheel).namelist()
    roots = {name.partition("/")[0] for name in names}
    assert roots == {"eddi_scaffold", "eddi_runtime", f"eddi_scaffold-{__version__}.dist-info"}
    assert "eddi_scaffold/_examples/two-conserts/two_conserts.xml" in names
    assert_licensed(installed.wheel.parent, "eddi_scaffold")
    assert not [name for name in names if "/expected/" in name or "/tests/" in name]
    assert installed.wheel.stat().st_size < 1_900_000
    bundle = installed.folder / "site" / "eddi_scaffold" / "templates.bundle"
    heads = git(installed.folder, "ls-remote", "--tags", str(bundle))
    assert {line.rpartition("/")[2] for line in heads.splitlines()} == {OLD, NOW}


def test_the_main_job_and_the_update_of_a_package_of_an_old_release(
    installed: Installed, tmp_path: Path
) -> None:
    where = (
        "import eddi_runtime, eddi_scaffold; print(eddi_runtime.__file__, eddi_scaffold.__file__)"
    )
    found = run([sys.executable, "-c", where], tmp_path, installed.env).stdout.split()
    assert all(Path(file).is_relative_to(installed.folder / "site") for file in found), found
    (tmp_path / "src").mkdir()
    model = ("-m", "example/two_conserts.xml")
    files_a, files_b = ((*model, "-c", f"example/consert_{one}_config.yml") for one in "ab")
    looking = {
        ("explain", "X007"): 0,
        ("example", "two-conserts", "example"): 0,
        ("generate", "-w", ".", *files_a, "--dry-run"): 0,
    }
    before = tree(installed.folder / "home")
    explained, *_ = several(looking, tmp_path, installed.env)
    assert "What to do: " in explained
    assert tree(installed.folder / "home") == before
    working = {
        ("generate", "-w", ".", *files_a): 0,
        ("upgrade", "-w", "."): 0,
        ("status", "-w", "."): 0,
        ("answers", *files_b, "-o", "b.yml"): 0,
    }
    several(working, tmp_path, installed.env)
    package = tmp_path / "src" / "eddi_monitor" / "conserta"
    answers = (package / ".copier-answers.yml").read_text("utf-8")
    assert f"_commit: {NOW}\n_src_path: {SHELF}\n" in answers

    package = tmp_path / "consertb"
    words = ("--data-file", tmp_path / "b.yml", "--vcs-ref", OLD)
    installed.copier("copy", *words, SHELF, package)
    source = package / "src" / "consertb" / "EDDIInput.py"
    text = source.read_text("utf-8")
    edited = text.replace("self.RtE_A_E0 = RtE_E0.data", "self.RtE_A_E0 = bool(RtE_E0.data)")
    assert edited != text
    source.write_text(edited, "utf-8")
    git(package, "init", "--quiet")
    git(package, "add", "--all")
    git(package, "commit", "--quiet", "--message", "Old")
    installed.copier("update", package)
    assert f"New in {NOW}." in (package / "README.md").read_text("utf-8")
    assert f"_commit: {NOW}\n" in (package / ".copier-answers.yml").read_text("utf-8")
    assert source.read_text("utf-8") == edited
