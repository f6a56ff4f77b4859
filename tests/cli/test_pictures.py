"""Models on the command line: as pictures, and by the configuration that names them."""

from pathlib import Path
from xml.etree import ElementTree as ET

from tests.cli.command import ROOT, example, files_below, run

DIAGRAM = ("diagram", "two_conserts.xml", "--name", "ConSertA")


def test_one_model_goes_to_the_standard_output_or_to_a_file(tmp_path: Path) -> None:
    folder = example(tmp_path)
    drawn = run(*DIAGRAM, cwd=folder)
    assert (drawn.status, drawn.err) == (0, "")
    words = {"".join(node.itertext()).strip() for node in ET.fromstring(drawn.out).iter()}
    assert {"System_A_G0", "RtE_A_D0"} <= words
    written = run(*DIAGRAM, "-o", "a.svg", cwd=folder)
    assert (written.status, written.out, written.err.strip()) == (0, "", "a.svg")
    assert (folder / "a.svg").read_text("utf-8") == drawn.out


def test_a_configuration_is_as_good_as_the_model_that_it_names(tmp_path: Path) -> None:
    robot = ROOT / "examples" / "warehouse-robot"
    for command in ("diagram", "export"):
        (tmp_path / command).mkdir()
        of_model, of_config = tmp_path / command / "model", tmp_path / command / "config"
        run(command, robot / "warehouse.yml", "-o", of_model, cwd=tmp_path)
        words = (robot / "robot.yml", "--name", "warehouse", "-o", of_config)
        result = run(command, *words, cwd=tmp_path)
        assert result.status == 0, result.err
        assert files_below(of_config) == files_below(of_model) != {}
