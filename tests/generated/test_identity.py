"""Plain Copier and our own command give the same bytes, in whatever order packages come."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.checkouts import Checkout, checkout, git, tree, without_origin
from tests.generated.conftest import generate
from tests.quick_copier import copier_here

pytestmark = pytest.mark.slow

SHARED = {"eddi_messages", "eddi_monitor", "eddi_monitor_launcher", "eddi_runtime"}


def answers(clone: Checkout, folder: Path, workspace: Path, letter: str) -> list[Path]:
    """Write the answers of one monitor and of the packages that all share."""
    model, config = "two_conserts.xml", f"consert_{letter}_config.yml"
    sources = ("-m", clone.example / model, "-c", clone.example / config)
    clone.eddi("-q", "answers", "--all", "-o", folder, "-w", workspace, *sources)
    return sorted(folder.iterdir())


def test_copier_renders_what_generate_renders(clone: Checkout, tmp_path: Path) -> None:
    one = generate(clone, tmp_path, "a")
    files = answers(clone, tmp_path / "answers", tmp_path / "elsewhere", "a")
    assert {file.stem for file in files} == {"conserta", *SHARED}
    for file in files[:2]:  # all of them in the slow test below
        # no --defaults and no terminal: a question without an answer would fail
        words = ("--trust", "--quiet", "--data-file", file, clone.path, file.stem)
        clone.copier("copy", *words, cwd=tmp_path)
        assert tree(tmp_path / file.stem) == tree(one / file.stem), file.stem


def test_one_after_the_other_is_both_at_once(clone: Checkout, both: Path, tmp_path: Path) -> None:
    first = tree(generate(clone, tmp_path, "a"))
    joined = tree(generate(clone, tmp_path, "b"))
    assert joined == tree(both)
    changed = {name for name, file in first.items() if joined[name] != file}
    assert {name.partition("/")[0] for name in changed} == {"eddi_monitor", "eddi_monitor_launcher"}
    clone.eddi("-q", "upgrade", "-w", tmp_path, "-m", clone.example / "two_conserts.xml")
    assert tree(tmp_path / "src" / "eddi_monitor") == joined, (
        "an upgrade to the same changes nothing"
    )


def test_own_files_stay_and_edits_of_generated_ones_are_kept(
    clone: Checkout, both: Path, tmp_path: Path
) -> None:
    packages = tmp_path / "src" / "eddi_monitor"
    shutil.copytree(both, packages)
    own = packages / "eddi_messages" / "msg" / "Own.msg"
    own.write_text("bool mine\n")
    ignored = packages / "conserta" / ".gitignore"
    ignored.write_text("*.bag\n")
    generate(clone, tmp_path, "a", status=3)
    generate(clone, tmp_path, "a", status=3)  # until somebody looks at it
    assert own.read_text() == "bool mine\n"
    kept = packages / "conserta" / ".eddi" / "kept" / ".gitignore"
    assert kept.read_text() == "*.bag\n"


def test_plain_copier_joins_the_second_monitor(clone: Checkout, both: Path, tmp_path: Path) -> None:
    packages = tmp_path / "src" / "eddi_monitor"
    packages.mkdir(parents=True)
    for letter in "ab":
        for file in answers(clone, tmp_path / letter, tmp_path, letter):
            words = ("--trust", "--quiet", "--defaults", "--overwrite", "--data-file", file)
            assert copier_here("copy", *words, clone.path, file.stem, cwd=packages).returncode == 0
    assert tree(packages) == tree(both)


@pytest.mark.parametrize("platform", ["plain", "dds"])
def test_platforms_without_a_workspace(clone: Checkout, platform: str, tmp_path: Path) -> None:
    model = ("-m", clone.example / "two_conserts.xml", "--platform", platform)
    model += ("-c", clone.example / "consert_b_config.yml")
    clone.eddi("-q", "generate", "-o", tmp_path / "ours", *model)
    file = tmp_path / "answers.yml"
    clone.eddi("-q", "answers", "-o", file, *model)
    words = ("--trust", "--quiet", "--data-file", file, clone.path, "consertb")
    clone.copier("copy", *words, cwd=tmp_path)
    assert tree(tmp_path / "consertb") == tree(tmp_path / "ours" / "consertb")


def test_plain_copier_takes_the_runtime_out_and_back(tmp_path: Path) -> None:
    clone = checkout(tmp_path / "eddi-scaffold", "v0.0.1")
    model = ("-m", clone.example / "two_conserts.xml", "--name", "ConSertB", "--platform", "plain")
    trees = {}
    for runtime in ("installed", "vendored"):
        ours, file = tmp_path / runtime, tmp_path / f"{runtime}.yml"
        clone.eddi("-q", "generate", "-o", ours, *model, "--runtime", runtime)
        clone.eddi("-q", "answers", "-o", file, *model, "--runtime", runtime)
        words = ("--trust", "--quiet", "--defaults", "--data-file", file, "--vcs-ref", "v0.0.1")
        assert copier_here("copy", *words, clone.path, "consertb", cwd=tmp_path).returncode == 0
        trees[runtime] = tree(tmp_path / "consertb")
        for one in (trees[runtime], expected := tree(ours / "consertb")):
            file, text = ".copier-answers.yml", one[".copier-answers.yml"][1]
            one[file] = (False, without_origin(text))
        assert trees[runtime] == expected
        shutil.move(tmp_path / "consertb", tmp_path / f"{runtime}_package")
    package = tmp_path / "vendored_package"
    code = package / "EDDIInput.py"
    mine = code.read_text("utf-8").replace("self.RtE_A_E0 = RtE_A_E0", "self.RtE_A_E0 = 1 == 1")
    code.write_text(mine, "utf-8")
    git(package, "init", "--quiet")
    for runtime in ("installed", "vendored"):
        git(package, "add", "--all")
        git(package, "commit", "--quiet", "--message", "Before")
        words = ("--trust", "--quiet", "--defaults", "-d", f"runtime={runtime}")
        assert copier_here("update", *words, package, cwd=tmp_path).returncode == 0
        found, wanted = tree(package, ".git"), trees[runtime]
        assert set(found) == set(wanted)
        different = {name for name in found if found[name] != wanted[name]}
        assert different == {".copier-answers.yml", "EDDIInput.py"}
        assert "self.RtE_A_E0 = 1 == 1" in code.read_text("utf-8")
