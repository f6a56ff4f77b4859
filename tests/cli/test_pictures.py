"""Pictures from the command line: of models, and of what a monitor did with a recording."""

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from tests.cli.command import ROOT, example, files_below, run

MODEL = "two_conserts.xml"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return example(tmp_path)


def words_of(svg: str) -> set[str]:
    root = ET.fromstring(svg)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    return {"".join(one.itertext()).strip() for one in root.iter()}


def test_one_model_goes_to_the_standard_output_or_to_a_file(folder: Path) -> None:
    drawn = run("diagram", MODEL, "--name", "ConSertA", cwd=folder)
    assert (drawn.status, drawn.err) == (0, "")
    assert {"System_A_G0", "RtE_A_D0"} <= words_of(drawn.out)
    written = run("diagram", MODEL, "--name", "ConSertA", "-o", "a.svg", cwd=folder)
    assert (written.status, written.out, written.err.strip()) == (0, "", "a.svg")
    assert (folder / "a.svg").read_text("utf-8") == drawn.out


def test_a_configuration_is_as_good_as_the_model_that_it_names(tmp_path: Path) -> None:
    robot = ROOT / "examples" / "warehouse-robot"
    for command in ("diagram", "export"):
        (tmp_path / command).mkdir()
        of_model, of_config = tmp_path / command / "model", tmp_path / command / "config"
        run(command, robot / "warehouse.yml", "-o", of_model, cwd=tmp_path)
        result = run(command, robot / "warehouse_config.yml", "-o", of_config, cwd=tmp_path)
        assert result.status == 0, result.err
        assert files_below(of_config) == files_below(of_model) != {}
    without = tmp_path / "without_config.yml"
    text = (robot / "warehouse_config.yml").read_text("utf-8")
    without.write_text(text.replace("parameters: [{model: warehouse.yml}]", "mode: rate"))
    for command, code in {"diagram": "F003", "export": "G015"}.items():
        refused = run(command, without, "-o", "out", cwd=tmp_path)
        assert (refused.status, f"[{code}]" in refused.err) == (2, True), refused.err
