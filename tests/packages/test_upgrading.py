"""Which packages a newer model reaches."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.monitors.compiling import from_json
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.rendering import own_template
from eddi_scaffold.packages.upgrading import groups, targets
from eddi_scaffold.platforms import platforms
from tests.data_files import data_text

pytestmark = pytest.mark.slow

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-conserts" / "two_conserts.xml"
DEFAULT = data_text("packages/default.yml")


def generated(folder: Path, model: Path, marks: tuple[str, ...] = ()) -> None:
    platform = platforms()["plain"]
    monitors, problems = monitors_of(model, [], default_guarantees=marks)
    write_packages(folder, assemble(monitors, platform, folder, problems).packages, own_template())


def test_a_file_with_one_of_the_models_leaves_the_others_alone(tmp_path: Path) -> None:
    folder, newer = tmp_path / "packages", tmp_path / "newer.xml"
    generated(folder, EXAMPLE)
    newer.write_text(EXAMPLE.read_text().replace('name="ConSertB"', 'name="Other"'))
    (group,) = groups(folder, [])
    packages, problems = targets(group, newer, [])
    files = {p.folder: p.answers["model_file"] for p in packages if "facts" in p.answers}
    assert files == {"conserta": "newer.xml", "consertb": "two_conserts.xml"}
    assert [p.code for p in problems if p.level != "info"] == []


def test_the_marks_of_the_first_reading_are_remembered(tmp_path: Path) -> None:
    model = tmp_path / "Rover.yml"
    model.write_text(DEFAULT)
    folder = tmp_path / "packages"
    generated(folder, model, ("Safe",))
    (group,) = groups(folder, [])
    (package, _), _ = targets(group, model, [])
    assert package.answers["default_guarantees"] == ["Safe"]
    facts = from_json(package.answers["facts"])
    assert [claim.rests_on for claim in facts.claims if claim.id == "Safe"] == [frozenset()]


def test_a_network_iscross_checked_as_by_generate(tmp_path: Path) -> None:
    """Its README has the result; without it `status -c` would differ for ever."""
    example = EXAMPLE.parents[1] / "pedestrian"
    model, config = example / "pedestrian.xml", example / "eddi_config.yml"
    platform, folder = platforms()["plain"], tmp_path / "packages"
    monitors, problems = monitors_of(model, [config])
    plan = assemble(monitors, platform, folder, problems)
    write_packages(folder, plan.packages, own_template())
    (group,) = groups(folder, [])
    (package, *_), _ = targets(group, None, [config])
    assert "Cross-checked" in str(package.answers["readme"])
    assert package.answers["readme"] == plan.packages[0].answers["readme"]
