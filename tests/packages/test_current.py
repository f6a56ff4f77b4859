"""A package that is as it should be is not rendered again; whatever differs is put right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import WriteResult, write_packages
from eddi_scaffold.packages.rendering import Renderer, Template
from eddi_scaffold.platforms import platforms
from tests.checkouts import checkout, tree

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Template:
    return Template(str(checkout(tmp_path_factory.mktemp("templates") / "ours", "v9").path), "HEAD")


@pytest.fixture
def write(template: Template, tmp_path: Path) -> Callable[[], WriteResult]:
    """Return what generates a workspace in ``tmp_path / "ws"``."""
    example = Path(template.location) / "examples" / "two-conserts"

    def again() -> WriteResult:
        ros1, root = platforms()["ros1"], tmp_path / "ws"
        model, config = example / "two_conserts.xml", example / "consert_a_config.yml"
        monitors, problems = monitors_of(model, [config])
        return write_packages(root, assemble(monitors, ros1, root, problems).packages, template)

    return again


@pytest.fixture
def generate(
    write: Callable[[], WriteResult], monkeypatch: pytest.MonkeyPatch
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


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")


CHANGES: dict[str, Callable[[Path], object]] = {
    "a generated file is gone": lambda p: (p / "setup.py").unlink(),
    "a generated file was edited": lambda p: (p / "setup.py").write_text("# mine\n"),
    "the compiled monitor was edited": lambda p: (p / "src/conserta/compiled.py").write_text("#"),
    "an editable file is gone": lambda p: (p / "src/conserta/EDDIInput.py").unlink(),
    "the record of files is gone": lambda p: (p / ".eddi/manifest").unlink(),
    "its answers were edited": lambda p: edit(p / ".copier-answers.yml", "'10.0'", "'20.0'"),
    "a program cannot be run": lambda p: (p / "scripts/RosNode.py").chmod(0o644),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_differs_is_put_right(
    generate: Callable[[], list[str]], tmp_path: Path, change: Callable[[Path], object]
) -> None:
    generate()
    package = tmp_path / "ws" / "conserta"
    before = tree(package, "kept")
    change(package)
    assert generate() == ["conserta"]
    assert tree(package, "kept") == before


def test_a_hand_edit_stays(generate: Callable[[], list[str]], tmp_path: Path) -> None:
    generate()
    file = tmp_path / "ws" / "conserta" / "src" / "conserta" / "EDDIInput.py"
    file.write_text(file.read_text().replace("= RtE_E0.data", "= RtE_E0.data and True"))
    before = tree(tmp_path / "ws")
    assert generate() == []
    assert tree(tmp_path / "ws") == before


def test_a_package_without_its_answers_is_not_taken_for_a_strangers(
    write: Callable[[], WriteResult], tmp_path: Path
) -> None:
    write()
    (tmp_path / "ws" / "conserta" / ".copier-answers.yml").unlink()
    with pytest.raises(EddiError) as refused:
        write()
    (problem,) = refused.value.problems
    assert (problem.code, "checkout -- .copier-answers.yml" in str(problem.hint)) == ("H012", True)
