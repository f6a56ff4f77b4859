"""``run PACKAGE``: with the lines that people wrote in it, which nothing else executes."""

import shutil
from pathlib import Path

import pytest

from eddi_scaffold.platforms import chosen  # noqa: F401 - loads what commands load
from tests.cli.command import EXAMPLE, ROOT, example, files_below, run
from tests.data_files import tabled
from tests.diagnosed import assert_reported
from tests.rows import changes

SOURCES = ("two_conserts.xml", "-c", "consert_a_config.yml")
BODY = "self.RtE_A_E0 = RtE_E0.data"
DEMAND = "self.RtE_A_D0 = given(by_id(consertb.guarantees, 'System_A_G0_c2').active, True)"
ANY_DEMAND = "self.RtE_A_D0 = any(one.active for one in consertb.guarantees)"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the example and its expected workspace, which saves generating it."""
    shutil.copytree(EXAMPLE / "expected", tmp_path / "ws")
    return example(tmp_path)


@pytest.fixture
def package(folder: Path) -> Path:
    return folder / "ws" / "src" / "eddi_monitor" / "conserta"


def write(package: Path, old: str, new: str, name: str = "EDDIInput.py") -> None:
    (file,) = (p for p in package.rglob(name) if ".eddi" not in p.parts)
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


def states(out: str) -> list[str]:
    return [state for _, state in changes(out)]


def test_an_untouched_package_says_what_its_configuration_says(folder: Path, package: Path) -> None:
    by_config = run("run", *SOURCES, "--inputs", "recording.csv", cwd=folder)
    before = files_below(package)
    by_package = run("run", package, "--inputs", "recording.csv", cwd=folder)
    assert (by_package.status, by_package.out) == (0, by_config.out), by_package.err
    assert (by_config.err, by_package.err.count("\n")) == ("", 1)  # that its code runs
    without = run("run", package, "--no-code", "--inputs", "recording.csv", cwd=folder)
    assert (without.out, without.err) == (by_config.out, "")
    assert files_below(package) == before  # no __pycache__ either


def test_hand_written_lines_get_the_message_of_a_value(folder: Path, package: Path) -> None:
    write(package, BODY, "print('seen'); self.RtE_A_E0 = not RtE_E0.data")
    (folder / "r.csv").write_text("t,RtE_A_D0,RtE_A_E0\n0,true,true\n0.1,true,false\n")
    result = run("run", package, "--inputs", "r.csv", cwd=folder)
    assert states(result.out) == ["00", "11"], result.err
    assert result.err.count("seen") == 2  # what it prints is no data of ours


def test_lines_that_need_more_than_a_value_are_named(folder: Path, package: Path) -> None:
    write(package, DEMAND, ANY_DEMAND)
    result = run("run", package, "--inputs", "recording.csv", cwd=folder)
    assert_reported("I001", result.err)
    assert states(result.out)[2] == "11"


def test_a_bag_reaches_every_line(folder: Path, package: Path) -> None:
    pytest.importorskip("rosbags", reason="the extra `bags` is not installed")
    from tests.recordings.test_bags import demand, healthy, written

    write(package, DEMAND, ANY_DEMAND)
    written(folder / "a.bag", [healthy(0, True), demand(0, False), demand(0.1, False)])
    by_config = run("run", *SOURCES, "--bag", "a.bag", cwd=folder)
    assert states(by_config.out) == ["1?"]
    result = run("run", package, "--bag", "a.bag", cwd=folder)
    assert states(result.out) == ["11"], result.err  # another guarantee is active


def test_a_configuration_says_that_lines_are_not_used_and_executes_none(
    folder: Path, package: Path
) -> None:
    trap = folder / "executed"
    write(package, BODY, f"open({str(trap)!r}, 'w'); self.RtE_A_E0 = False")
    result = run("run", *SOURCES, "--inputs", "recording.csv", cwd=folder)
    assert_reported("I014", result.err)
    assert states(result.out)[1] == "10"
    assert not trap.exists()
    assert run("run", package, "--inputs", "recording.csv", cwd=folder).status == 0
    assert trap.exists()


@pytest.mark.slow
def test_the_methods_of_a_network_are_asked(tmp_path: Path) -> None:
    for file in (ROOT / "examples" / "pedestrian").glob("*.*"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    words = ("pedestrian.xml", "-c", "eddi_config.yml")
    made = run("generate", "--platform", "plain", "-o", "out", "-m", *words, cwd=tmp_path)
    assert made.status == 0, made.err
    package = tmp_path / "out" / "pedestrian_prediction_example"
    begin = "# region: node_Distance_to_Pedestrian"
    (module,) = package.glob("*_config.py")
    line = next(line for line in module.read_text().splitlines() if begin in line)
    new = f"{line}\n        outcome_range_0_to_1_m = 1.0"
    write(package, f"{line}\n        pass", new, module.name)
    by_config = run("run", *words, "--inputs", "recording.csv", cwd=tmp_path)
    assert "are not used here: node_Distance_to_Pedestrian [I014]" in by_config.err
    result = run("run", package, "--inputs", "recording.csv", cwd=tmp_path)
    assert result.status == 0, result.err
    first = result.out.splitlines()[0]
    assert first != by_config.out.splitlines()[0]
    assert first.endswith("status partial")  # a person observes one of both nodes


@tabled
def test_code_that_cannot_be_loaded(change, words, folder, package):
    write(package, *change)
    result = run("run", package, "--inputs", "recording.csv", cwd=folder)
    assert (result.status, result.out) == (2, "")
    assert "[I020]" in result.err
    assert words in result.err
