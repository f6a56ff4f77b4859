"""A package that is as it should be is not rendered again; whatever differs is put right."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import Outcome, write_packages
from eddi_scaffold.packages.rendering import Renderer, Template
from eddi_scaffold.platforms import PackageAnswers, platforms
from eddi_scaffold.problems import EddiError
from eddi_scaffold.regions.check import list_regions
from tests.checkouts import checkout, git, tree

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Template:
    return Template(str(checkout(tmp_path_factory.mktemp("templates") / "ours", "v9").path), "HEAD")


@pytest.fixture
def write(template: Template, tmp_path: Path) -> Callable[[], Outcome]:
    """Return what generates a workspace in ``tmp_path / "ws"``."""
    example = Path(template.location) / "examples" / "two-conserts"

    def again() -> Outcome:
        ros1, root = platforms()["ros1"], tmp_path / "ws"
        model, config = example / "two_conserts.xml", example / "consert_a_config.yml"
        monitors, problems = monitors_of(model, [config])
        return write_packages(root, assemble(monitors, ros1, root, problems).packages, template)

    return again


@pytest.fixture
def generate(
    write: Callable[[], Outcome], monkeypatch: pytest.MonkeyPatch
) -> Callable[[], list[str]]:
    """Return what generates the workspace and tells what was rendered."""
    rendered: list[str] = []
    render = Renderer.render

    def counted(self: Renderer, answers: Mapping[str, object], folder: Path) -> list[str]:
        rendered.append(str(answers["package"]))
        return render(self, answers, folder)

    monkeypatch.setattr(Renderer, "render", counted)

    def again() -> list[str]:
        rendered.clear()
        write()
        return sorted(rendered)

    return again


def test_nothing_is_rendered_twice(generate: Callable[[], list[str]], tmp_path: Path) -> None:
    assert len(generate()) == 5
    before = tree(tmp_path / "ws")
    assert generate() == []
    assert tree(tmp_path / "ws") == before


def test_a_package_as_it_was_made_leaves(
    write: Callable[[], Outcome], template: Template, tmp_path: Path
) -> None:
    write()
    assert (tmp_path / "ws" / "eddi_runtime").is_dir()
    done = write_packages(tmp_path / "ws", [PackageAnswers("eddi_runtime", {})], template)
    assert done.notes == ["eddi_runtime: removed, nothing needs it any more"]
    assert not (tmp_path / "ws" / "eddi_runtime").exists()


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")


CHANGES: dict[str, Callable[[Path], object]] = {
    "a generated file is gone": lambda p: (p / "setup.py").unlink(),
    "a generated file was edited": lambda p: (p / "setup.py").write_text("# mine\n"),
    "the compiled monitor was edited": lambda p: (p / "src/conserta/compiled.py").write_text("#"),
    "an editable file is gone": lambda p: (p / "src/conserta/EDDIInput.py").unlink(),
    "the record of files is gone": lambda p: (p / ".eddi/manifest.json").unlink(),
    "the last rendering is gone": lambda p: (p / ".eddi/bases").unlink(),
    "its answers were edited": lambda p: edit(p / ".copier-answers.yml", "'10.0'", "'20.0'"),
    "a program cannot be run": lambda p: (p / "scripts/RosNode.py").chmod(0o644),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_differs_is_put_right(
    generate: Callable[[], list[str]], tmp_path: Path, change: Callable[[Path], object]
) -> None:
    generate()
    package = tmp_path / "ws" / "conserta"
    before = tree(package, "rejects")
    change(package)
    assert generate() == ["conserta"]
    assert tree(package, "rejects") == before


def test_a_removed_file_is_written_anew_with_a_word(
    write: Callable[[], Outcome], tmp_path: Path
) -> None:
    file = tmp_path / "ws" / "conserta" / "src" / "conserta" / "EDDIInput.py"
    said = "conserta/src/conserta/EDDIInput.py: it was missing and is written anew"

    def again() -> tuple[list[str], bool]:
        file.unlink()
        done = write()
        assert not write().attention  # it is said once
        return list(done.notes), done.attention

    write()
    assert again() == ([f"{said}, without hand edits"], False)  # nobody knows of any
    git(tmp_path / "ws", "init", "-q")
    git(tmp_path / "ws", "add", ".")
    git(tmp_path / "ws", "commit", "-qm", "as it was generated")
    assert again() == ([], False)  # what was committed, byte for byte
    edit(file, "= RtE_E0.data", "= RtE_E0.data and True")
    git(tmp_path / "ws", "commit", "-qam", "a hand edit")
    (note,), attention = again()
    assert attention
    command = re.search("`git (.*)`", note)
    assert note.startswith(f"{said}, without hand edits; ")
    assert command is not None
    git(tmp_path, *command[1].split())
    assert "= RtE_E0.data and True" in file.read_text()


def test_a_hand_edit_stays(generate: Callable[[], list[str]], tmp_path: Path) -> None:
    generate()
    file = tmp_path / "ws" / "conserta" / "src" / "conserta" / "EDDIInput.py"
    file.write_text(file.read_text().replace("= RtE_E0.data", "= RtE_E0.data and True"))
    before = tree(tmp_path / "ws")
    assert generate() == []
    assert tree(tmp_path / "ws") == before


def test_a_removed_region_is_back_with_a_word(write: Callable[[], Outcome], tmp_path: Path) -> None:
    file = tmp_path / "ws" / "conserta" / "src" / "conserta" / "EDDIInput.py"
    write()
    before = file.read_text("utf-8")
    method = re.search(r"    def process_RtE_A_E0.*?(?=    def )", before, re.DOTALL)
    assert method is not None
    file.write_text(before.replace(method[0], ""), "utf-8")
    (note,) = [one for one in list_regions(file.parents[2]) if one.state == "unfit"]
    assert "generate again, and it is back" in note.notes[-1]
    said = "the region 'input:RtE_A_E0' was missing and is back, with the generated text"
    assert [one for one in write().notes if "missing" in one] == [
        f"conserta/src/conserta/EDDIInput.py: {said}"
    ]
    assert file.read_text("utf-8") == before
    assert not write().notes


def test_a_decimal_comma_is_named(write: Callable[[], Outcome], tmp_path: Path) -> None:
    file = tmp_path / "ws" / "conserta" / "src" / "conserta" / "EDDIInput.py"
    write()
    edit(file, "self.RtE_A_E0 = ", "self.RtE_A_E0 = 1 > 0,05 if 1 else ")
    words = "'0,05': a decimal number has a point"
    (unfit,) = [one for one in list_regions(file.parents[2]) if one.state == "unfit"]
    assert words in unfit.notes[0]
    with pytest.raises(EddiError) as refused:
        write()
    assert words in refused.value.problems[0].message


def test_a_package_without_its_answers_is_not_taken_for_a_strangers(
    write: Callable[[], Outcome], tmp_path: Path
) -> None:
    write()
    (tmp_path / "ws" / "conserta" / ".copier-answers.yml").unlink()
    with pytest.raises(EddiError) as refused:
        write()
    (problem,) = refused.value.problems
    assert (problem.code, "checkout -- .copier-answers.yml" in str(problem.hint)) == ("H012", True)
