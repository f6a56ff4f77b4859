"""A package that is as it should be is not rendered again; whatever differs is put right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.rendering import Renderer, Template
from eddi_scaffold.platforms import platforms
from tests.checkouts import checkout, tree
from tests.cli.command import edit

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Template:
    return Template(str(checkout(tmp_path_factory.mktemp("templates") / "ours", "v9").path), "HEAD")


def write(template: Template, folder: Path) -> list[str]:
    """Generate a workspace; returns what was rendered."""
    rendered: list[str] = []
    render = Renderer.render

    def counted(self: Renderer, answers: Mapping[str, object], folder: Path) -> list[str]:
        rendered.append(str(answers["package"]))
        return render(self, answers, folder)

    example, ros1 = Path(template.location) / "examples" / "two-conserts", platforms()["ros1"]
    files = example / "two_conserts.xml", [example / "consert_a_config.yml"]
    monitors, problems = monitors_of(*files)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Renderer, "render", counted)
        write_packages(folder, assemble(monitors, ros1, folder, problems).packages, template)
    return sorted(rendered)


@pytest.fixture(scope="module")
def generated(template: Template, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "ws"
    assert len(write(template, folder)) == 5
    return folder


def test_nothing_is_rendered_twice(template: Template, folder: Path) -> None:
    edit(folder / "conserta/src/conserta/EDDIInput.py", "= RtE_E0.data", "= RtE_E0.data and True")
    before = tree(folder)
    assert write(template, folder) == []
    assert tree(folder) == before


CHANGES: dict[str, Callable[[Path], object]] = {
    "a generated file is gone": lambda p: (p / "setup.py").unlink(),
    "a generated file was edited": lambda p: (p / "setup.py").write_text("# mine\n"),
    "an editable file is gone": lambda p: (p / "src/conserta/EDDIInput.py").unlink(),
    "the record of files is gone": lambda p: (p / ".eddi/manifest").unlink(),
    "its answers were edited": lambda p: edit(p / ".copier-answers.yml", " 0.1.0", " 9.1.0"),
    "a program cannot be run": lambda p: (p / "scripts/RosNode.py").chmod(0o644),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_differs_is_put_right(
    template: Template, folder: Path, change: Callable[[Path], object]
) -> None:
    package = folder / "conserta"
    before = tree(package, "kept")
    change(package)
    assert write(template, folder) == ["conserta"]
    assert tree(package, "kept") == before


def test_a_package_without_its_answers_is_not_taken_for_a_strangers(
    template: Template, folder: Path
) -> None:
    (folder / "conserta" / ".copier-answers.yml").unlink()
    with pytest.raises(EddiError) as refused:
        write(template, folder)
    (problem,) = refused.value.problems
    assert (problem.code, "checkout -- .copier-answers.yml" in str(problem.hint)) == ("H012", True)
