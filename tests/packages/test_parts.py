"""Only what the monitors of a workspace need lies in its shared packages."""

from __future__ import annotations

import ast
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jinja2
import pytest

from eddi_scaffold.program.runtime_parts import PARTS, requirements_of, with_needed
from eddi_scaffold.regions.check import list_regions
from tests.cli.command import run

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
RUNTIME = ROOT / "runtime_lib" / "src" / "eddi_runtime"
ALWAYS = {"inputs", "monitor", "node", "plain_values", "why"}
ALWAYS |= {"__init__", "__pycache__", "py", "ros1", "transports"}
"""What of the runtime is always there."""
OWN = {"ConSertOutput", "ConSertStatus", "Guarantee", "GuaranteeStatus"}
OWN |= {"Cause", "ClaimWhy", "Why"}


def generate(place: Path, example: str, model: str, config: str) -> None:
    files = [EXAMPLES / example / model, "-c", EXAMPLES / example / config]
    done = run("generate", "-w", place, "-m", *files, cwd=place)
    assert done.status == 0, done.err


def parts(packages: Path) -> set[str]:
    runtime = packages / "eddi_runtime" / "src" / "eddi_runtime"
    return {path.stem for path in runtime.iterdir()} - ALWAYS


def messages(packages: Path) -> set[str]:
    return {path.stem for path in (packages / "eddi_messages" / "msg").iterdir()}


@pytest.fixture
def place(tmp_path: Path) -> Path:
    (tmp_path / "src").mkdir()
    generate(tmp_path, "two-conserts", "two_conserts.xml", "consert_a_config.yml")
    return tmp_path


@pytest.mark.slow
def test_parts_come_and_go_with_the_monitors(place: Path) -> None:
    packages = place / "src" / "eddi_monitor"
    assert parts(packages) == {"consert", "testing"}
    assert messages(packages) == OWN
    manifest = packages / "eddi_runtime" / "package.xml"
    end = "<!-- Manual edit end"
    edited = manifest.read_text().replace(f"  {end}", f"  <!-- ours -->\n  {end}", 1)
    assert "ours" in edited
    manifest.write_text(edited)

    generate(place, "motor-watch", "motor_watch.events", "motor_config.yml")
    assert parts(packages) == {"consert", "event", "expressions", "testing"}
    assert messages(packages) == {*OWN, "EventOutput"}
    assert "<!-- ours -->" in manifest.read_text()

    shutil.rmtree(packages / "motor_watch")
    generate(place, "two-conserts", "two_conserts.xml", "consert_b_config.yml")
    assert parts(packages) == {"consert", "testing"}
    assert messages(packages) == OWN
    assert "<!-- ours -->" in manifest.read_text()
    assert not [one for one in list_regions(packages / "eddi_runtime") if one.review]


def template() -> Any:
    return jinja2.Template((ROOT / "copier_templates" / "parts.jinja").read_text("utf-8")).module


@pytest.mark.parametrize("part", PARTS)
def test_what_parts_import_travels_with_them(part: str) -> None:
    absent = [one for one in PARTS if one not in with_needed([part])]
    paths = [f"/eddi_runtime/{one}{ending}" for one in absent for ending in ("", ".py")]
    assert template().others([part], "/eddi_runtime").split() == paths


def test_the_templates_know_the_same_parts() -> None:
    known = template().ALL
    assert {part: tuple(needs) for part, needs in known.items()} == dict(PARTS)
    assert {path.stem for path in RUNTIME.iterdir()} - ALWAYS == {p for p in PARTS if "/" not in p}
    assert all((RUNTIME / f"{part}.py").is_file() for part in PARTS if "/" in part)


def files_of(part: str) -> Iterator[Path]:
    """Yield the modules of a part, without those that are a part of their own."""
    place = RUNTIME / part
    for file in place.glob("*.py") if place.is_dir() else [place.with_suffix(".py")]:
        if file.relative_to(RUNTIME).with_suffix("").as_posix() not in {*PARTS} - {part}:
            yield file


@pytest.mark.parametrize("part", PARTS)
def test_a_part_imports_no_other_than_it_says(part: str) -> None:
    absent = set(PARTS) - set(with_needed([part]))
    for file in files_of(part):
        for module in imported(ast.parse(file.read_text("utf-8")), file):
            name = module.relative_to(RUNTIME).as_posix()
            assert not [one for one in absent if f"{name}/".startswith(f"{one}/")], (file, name)


@pytest.mark.parametrize("part", PARTS)
def test_numpy_is_required_where_a_part_imports_it(part: str) -> None:
    parts = with_needed([part])
    texts = [file.read_text("utf-8") for part in parts for file in files_of(part)]
    assert bool(requirements_of(parts)) == any("import numpy" in text for text in texts)


def imported(tree: ast.AST, file: Path) -> Iterator[Path]:
    """Yield the places of the modules that a file of the runtime imports where it runs."""
    if isinstance(tree, ast.If) and ast.unparse(tree.test) == "TYPE_CHECKING":
        return
    if isinstance(tree, ast.ImportFrom) and tree.level:
        place = file.parents[tree.level - 1].joinpath(*(tree.module or "").split("."))
        yield from (place / one.name if place.is_dir() else place for one in tree.names)
    for child in ast.iter_child_nodes(tree):
        yield from imported(child, file)
