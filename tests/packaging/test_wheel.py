"""The wheel alone, with the sources absent, does the main job, and its packages can be updated."""

from __future__ import annotations

import importlib.util
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from eddi_scaffold import __version__
from tests.checkouts import Checkout, assert_licensed, checkout, git, run, tree

OLD, NOW = "v0.0.1", f"v{__version__}"
SHELF = "~/.local/share/eddi-scaffold/templates.bundle"
pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Installed:
    """A wheel in a folder of its own, with a private home.

    Attributes:
        folder: beside ``home`` and ``site``.
        source: what it was built from.
        wheel: the file.
    """

    folder: Path
    source: Checkout
    wheel: Path

    @property
    def env(self) -> dict[str, str]:
        home = self.folder / "home"
        return {"PYTHONPATH": str(self.folder / "site"), "HOME": str(home), "XDG_DATA_HOME": ""}

    def eddi(self, *words: object) -> str:
        command = [sys.executable, "-m", "eddi_scaffold", *map(str, words)]
        done = run(command, self.folder, self.env)
        return done.stdout + done.stderr

    def copier(self, *words: object) -> None:
        """Run Copier, which finds nothing of ours but the bundle in the home folder."""
        env = {**self.env, "PYTHONPATH": ""}
        run([sys.executable, "-m", "copier", *map(str, words)], self.folder, env)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    if importlib.util.find_spec("build") is None:
        pytest.skip("the package `build` is not installed")
    folder = tmp_path_factory.mktemp("packaging")
    source = checkout(folder / "source", OLD)
    readme = source.path / "copier_templates/ros1_monitor/.eddi/new/{{ stage }}/README.md.jinja"
    readme.write_text(f"{readme.read_text('utf-8')}\nNew in {NOW}.\n", "utf-8")
    git(source.path, "commit", "--quiet", "--all", "--message", "Release")
    git(source.path, "tag", NOW)
    own = ["--no-isolation"] if importlib.util.find_spec("hatchling") else []
    # first the sdist, then the wheel from the sdist, where there is no .git
    run([sys.executable, "-m", "build", *own, "--outdir", str(folder / "dist")], source.path)
    (wheel,) = (folder / "dist").glob("*.whl")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    run([*pip, "--target", str(folder / "site"), str(wheel)], folder)
    (folder / "home").mkdir()
    elsewhere = source.path.rename(folder / "sources that nobody finds")
    return Installed(folder, Checkout(elsewhere), wheel)


def test_contents(installed: Installed) -> None:
    names = zipfile.ZipFile(installed.wheel).namelist()
    roots = {name.partition("/")[0] for name in names}
    assert roots == {"eddi_scaffold", "eddi_runtime", f"eddi_scaffold-{__version__}.dist-info"}
    assert "eddi_scaffold/_examples/two-conserts/two_conserts.xml" in names
    assert_licensed(installed.wheel.parent, "eddi_scaffold")
    assert not [name for name in names if "/expected/" in name or "/tests/" in name]
    assert installed.wheel.stat().st_size < 1_900_000


def test_the_codes_are_explained(installed: Installed) -> None:
    assert "What to do: " in installed.eddi("explain", "X007")


def test_the_bundle_holds_every_release(installed: Installed) -> None:
    bundle = installed.folder / "site" / "eddi_scaffold" / "templates.bundle"
    heads = git(installed.folder, "ls-remote", "--tags", str(bundle))
    assert {line.rpartition("/")[2] for line in heads.splitlines()} == {OLD, NOW}


def test_main_job(installed: Installed, tmp_path: Path) -> None:
    where = (
        "import eddi_runtime, eddi_scaffold; print(eddi_runtime.__file__, eddi_scaffold.__file__)"
    )
    found = run([sys.executable, "-c", where], tmp_path, installed.env).stdout.split()
    assert all(Path(file).is_relative_to(installed.folder / "site") for file in found), found
    installed.eddi("example", "two-conserts", tmp_path / "example")
    (tmp_path / "src").mkdir()
    sources = ("-m", tmp_path / "example" / "two_conserts.xml")
    config = ("-c", tmp_path / "example" / "consert_a_config.yml")
    before = tree(installed.folder / "home")
    installed.eddi("generate", "-w", tmp_path, *sources, *config, "--dry-run")
    assert tree(installed.folder / "home") == before
    installed.eddi("generate", "-w", tmp_path, *sources, *config)
    package = tmp_path / "src" / "eddi_monitor" / "conserta"
    answers = (package / ".copier-answers.yml").read_text("utf-8")
    assert f"_commit: {NOW}\n_src_path: {SHELF}\n" in answers
    installed.eddi("upgrade", "-w", tmp_path)
    installed.eddi("status", "-w", tmp_path)
    installed.eddi("answers", *sources, *config, "-o", tmp_path / "answers.yml")
    words = ("--trust", "--defaults", "--quiet", "--data-file", tmp_path / "answers.yml")
    installed.copier("copy", *words, SHELF, tmp_path / "plain")
    assert tree(tmp_path / "plain") == tree(package)


def test_a_package_of_an_old_release_is_updated(installed: Installed, tmp_path: Path) -> None:
    example = installed.source.example
    sources = ("-m", example / "two_conserts.xml", "-c", example / "consert_b_config.yml")
    installed.eddi("answers", *sources, "-o", tmp_path / "answers.yml")
    package = tmp_path / "consertb"
    words = ("--trust", "--defaults", "--quiet", "--data-file", tmp_path / "answers.yml")
    installed.eddi(
        "generate", "--platform", "plain", "-o", tmp_path / "shelves the bundle", *sources
    )
    installed.copier("copy", *words, "--vcs-ref", OLD, SHELF, package)
    source = package / "src" / "consertb" / "EDDIInput.py"
    text = source.read_text("utf-8")
    edited = text.replace("self.RtE_A_E0 = RtE_E0.data", "self.RtE_A_E0 = bool(RtE_E0.data)")
    assert edited != text
    source.write_text(edited, "utf-8")
    git(package, "init", "--quiet")
    git(package, "add", "--all")
    git(package, "commit", "--quiet", "--message", "Old")
    installed.copier("update", "--trust", "--defaults", "--quiet", package)
    assert f"New in {NOW}." in (package / "README.md").read_text("utf-8")
    assert f"_commit: {NOW}\n" in (package / ".copier-answers.yml").read_text("utf-8")
    assert source.read_text("utf-8") == edited
