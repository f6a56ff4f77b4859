"""An old package becomes one of ours; what a person wrote is in its place, or kept and said."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from tests.adopting.old_packages import EDDI_INPUT, write_old_ros_package
from tests.cli.command import EXAMPLE, files_below, run
from tests.data_files import data_text, tabled

pytestmark = pytest.mark.slow


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """An old package of ConSertA, in a folder with a workspace."""
    (tmp_path / "ws" / "src").mkdir(parents=True)
    model = EXAMPLE / "expected/src/eddi_monitor/conserta/config/ConSertA.yml"
    return write_old_ros_package(tmp_path / "old", model.read_text("utf-8"))


def test_bodies_model_and_configuration_are_taken_over(old: Path) -> None:
    folder = old.parent
    before = files_below(old)
    result = run("adopt", "old", "-w", "ws", cwd=folder)
    assert result.status == 3, result.err  # a helper stands outside of the regions
    assert files_below(old) == before
    package = folder / "ws" / "src" / "eddi_monitor" / "conserta"
    text = (package / "src" / "conserta" / "EDDIInput.py").read_text("utf-8")
    assert (
        "        self.RtE_A_E0 = RtE_E0.data and not math.isnan(self.tilt())\n"
        "        '''-----Manual edit end-----'''  # region: process_RtE_A_E0\n"
    ) in text
    assert (
        "        for guarantee in consertb.guarantees:\n"
        "            if guarantee.id == 'System_A_G0_c2':\n"
        "                # the one that matters\n"
        "                self.RtE_A_D0 = guarantee.active\n"
        "        '''-----Manual edit end-----'''  # region: process_RtE_A_D0\n"
    ) in text
    compile(text, "EDDIInput.py", "exec")
    kept = (package / ".eddi" / "kept" / "EDDIInput.py.adopted").read_text("utf-8")
    assert "\nLIMIT = 20  # degrees; the wheels lift at 28\n" in kept
    assert "# measured on the old rover\n@staticmethod\ndef level(message):\n" in kept
    assert "\nimport math\n" in kept
    assert result.err.count("process_RtE_A_E0") == 1, result.err
    config = yaml.safe_load((folder / "ws" / "conserta_config.yml").read_text("utf-8"))
    assert config == yaml.safe_load(data_text("adopting/adopted_config.yml"))


def test_a_body_without_a_region_is_kept(old: Path) -> None:
    script = old / "scripts" / "EDDIInput.py"
    lines = EDDI_INPUT.replace("process_RtE_A_E0(self", "process_Gone(self")
    script.write_text(lines.replace("self.process_RtE_A_E0(", "self.process_Gone("), "utf-8")
    result = run("adopt", "old", "-w", "ws", cwd=old.parent)
    assert result.status == 3
    assert "not recovered: the input 'Gone', which the model does not have" in result.err
    package = old.parent / "ws" / "src" / "eddi_monitor" / "conserta"
    (kept,) = (package / ".eddi" / "kept").glob("*.region")
    assert "self.RtE_A_E0 = RtE_E0.data and not" in kept.read_text("utf-8")


def test_a_default_that_counts_as_good_evidence_is_left_out(old: Path) -> None:
    script = old / "scripts" / "EDDIInput.py"
    script.write_text(EDDI_INPUT.replace("self.RtE_A_E0 = False", "self.RtE_A_E0 = True"), "utf-8")
    result = run("adopt", "old", "-w", "ws", cwd=old.parent)
    assert "the default True of 'RtE_A_E0': it counted as good evidence" in result.err
    config = yaml.safe_load((old.parent / "ws" / "conserta_config.yml").read_text("utf-8"))
    assert "default" not in config["EDDIInputs"][1]


def test_a_dry_run_writes_nothing(old: Path) -> None:
    before = files_below(old.parent)
    result = run("adopt", "old", "-w", "ws", "--dry-run", cwd=old.parent)
    assert result.status == 3, "as it would be"
    assert files_below(old.parent) == before
    assert "+        self.RtE_A_E0 = RtE_E0.data and not" in result.out


BOMBS = {
    "DEEP": f"x = {'-' * 200_000}1\n",
    "LONG": f"x = 1{' + 1' * 900}\n",
    "DIGITS": f"x = 0x{'f' * 9000}\n",
}


@tabled
def test_what_cannot_be_adopted(change, code, words, old):
    for name, text in change.items():
        path = old / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(BOMBS.get(text, text), "utf-8")
    before = files_below(old.parent)
    result = run("adopt", "old", "-w", "ws", cwd=old.parent)
    assert (result.status, f"[{code}]" in result.err) == (2, True), result.err
    assert words in result.err
    assert files_below(old.parent) == before


def test_a_line_in_another_encoding_is_named(old: Path) -> None:
    script = old / "scripts" / "EDDIInput.py"
    script.write_bytes(script.read_bytes().replace(b"import math", b"import math  # caf\xe9"))
    result = run("adopt", "old", "-w", "ws", cwd=old.parent)
    assert result.status == 2
    assert "EDDIInput.py:1: error: this line is not UTF-8 [A001]" in result.err


def test_the_old_package_gets_nothing(old: Path) -> None:
    before = files_below(old)
    result = run("adopt", "old", "--platform", "plain", "-o", "old", cwd=old.parent)
    assert (result.status, "[G006]" in result.err) == (2, True), result.err
    assert files_below(old) == before


@pytest.mark.parametrize("end", [b"\r\n", b"\r"])
def test_line_ends_are_those_of_python(old: Path, end: bytes) -> None:
    script = old / "scripts" / "EDDIInput.py"
    script.write_bytes(script.read_bytes().replace(b"\n", end))
    result = run("adopt", "old", "--platform", "plain", "-o", "out", cwd=old.parent)
    assert "process_RtE_A_E0: the body is in its region" in result.err


def test_neither_a_second_adoption_nor_a_file_of_a_person_is_overwritten(
    old: Path, tmp_path: Path
) -> None:
    plain = ("adopt", "old", "--platform", "plain", "-o")
    run(*plain, "out", cwd=old.parent)
    result = run(*plain, "out", cwd=old.parent)
    assert (result.status, "[G003]" in result.err) == (2, True)
    written = [path.name for path in (old.parent / "out").iterdir() if path.is_file()]
    assert written
    for name in written:
        place = tmp_path / f"place {name}"
        place.mkdir()
        (place / name).write_text("mine\n")
        result = run(*plain, place, cwd=old.parent)
        assert (result.status, "[G003]" in result.err) == (2, True)
        assert files_below(place) == {name: b"mine\n"}


@tabled
def test_what_was_not_recovered_needs_a_look(file, words, old):
    script = old / "scripts" / "EDDIInput.py"
    script.write_text(EDDI_INPUT[EDDI_INPUT.index("class ") :])
    assert run("adopt", "old", "-w", "ws", "--dry-run", cwd=old.parent).status == 0
    if file == "RosNode.py":
        (old / "scripts" / file).unlink()
    else:
        script.write_text("")
    result = run("adopt", "old", "-o", "out", cwd=old.parent)
    assert result.status == 3, result.err
    for one in words:
        assert f"not recovered: {one}" in result.err
