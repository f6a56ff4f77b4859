"""A package that is as it should be is not rendered again; whatever differs is put right."""

from __future__ import annotations

import shutil
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


def write(template: Template, root: Path) -> list[str]:
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
        write_packages(root, assemble(monitors, ros1, root, problems).packages, template)
    return sorted(rendered)


@pytest.fixture(scope="module")
def generated(template: Template, tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("made") / "ws"
    assert len(write(template, root)) == 5
    return root


@pytest.fixture
def root(generated: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(generated, tmp_path / "ws"))


def test_nothing_is_rendered_twice(template: Template, root: Path) -> None:
    edit(root / "conserta/src/conserta/EDDIInput.py", "= RtE_E0.data", "= RtE_E0.data and True")
    before = tree(root)
    assert write(template, root) == []
    assert tree(root) == before


CHANGES: dict[str, Callable[[Path], object]] = {
    "a generated file is gone": lambda p: (p / "setup.py").unlink(),
    "a generated file was edited": lambda p: (p / "setup.py").write_text("# mine\n"),
    "an editable file is gone": lambda p: (p / "src/conserta/EDDIInput.py").unlink(),
    "the record of files is gone": lambda p: (p / ".eddi/manifest").unlink(),
    "its answers were edited": lambda p: edit(p / ".copier-answers.yml", "'10.0'", "'20.0'"),
    "a program cannot be run": lambda p: (p / "scripts/RosNode.py").chmod(0o644),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_differs_is_put_right(
    template: Template, root: Path, change: Callable[[Path], object]
) -> None:
    package = root / "conserta"
    before = tree(package, "kept")
    change(package)
    assert write(template, root) == ["conserta"]
    assert tree(package, "kept") == before


def test_a_package_without_its_answers_is_not_taken_for_a_strangers(
    template: Template, root: Path
) -> None:
    (root / "conserta" / ".copier-answers.yml").unlink()
    with pytest.raises(EddiError) as refused:
        write(template, root)
    (problem,) = refused.value.problems
    assert (problem.code, "checkout -- .copier-answers.yml" in str(problem.hint)) == ("H012", True)
