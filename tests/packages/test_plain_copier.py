"""Plain Copier with the answers of some files gives what `generate` gives for these files."""

from __future__ import annotations

import shutil
from pathlib import Path

import copier
import pytest
import yaml

from eddi_scaffold.packages import assembly
from tests.cli.command import EXAMPLE, ROOT, files_below, run, template
from tests.package_texts import loaded

pytestmark = pytest.mark.slow

ROS1, PLAIN = ("ros1", "ws/src/eddi_monitor", "-w"), ("plain", "ws", "-o")
DDS = ("dds", *PLAIN[1:])
ROS2 = ("ros2", *ROS1[1:])
ROBOT = ("--system", "rover.rossystem", "--models", "nodes")
CASES = [
    ("robot-models", "rover", "Rover.yml", "eddi_config.yml", ROS1),
    ("motor-watch", "motor_watch", "motor_watch.events", "motor_config.yml", PLAIN),
    ("drone", "missionloss", "drone.xml", "reliability_config.yml", PLAIN),
    ("safeml", "camera_scope", "safeml_config.yml", "perception_config.yml", PLAIN),
    ("shuttle", "shuttle", "shuttle.xml", "shuttle_config.yml", PLAIN),
    ("pedestrian", "pedestrian_prediction_example", "pedestrian.xml", "eddi_config.yml", ROS2),
    ("two-conserts", "consertb", "two_conserts.xml", "consert_b_config.yml", DDS),
]


def copied(answers: Path, to: Path) -> None:
    """Do what `copier copy --trust --defaults --data-file ANSWERS` does, its tasks included."""
    data = yaml.safe_load(answers.read_text("utf-8"))
    location = Path(template().location)
    program = location / "eddi_scaffold"
    if not program.exists():
        program.symlink_to(ROOT / "eddi_scaffold")
    copier.run_copy(str(location), to, data, defaults=True, overwrite=True, unsafe=True, quiet=True)


@pytest.mark.parametrize(("example", "package", "model", "config", "where"), CASES)
def test_every_kind_and_every_example(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    example: str,
    package: str,
    model: str,
    config: str,
    where: tuple[str, str, str],
) -> None:
    monkeypatch.setattr(assembly, "cross_checked", lambda monitor, _: monitor)  # takes seconds
    platform, packages, option = where
    folder = Path(shutil.copytree(ROOT / "examples" / example, tmp_path / "example"))
    (folder / "ws" / "src").mkdir(parents=True)
    words = ["-m", model, "-c", config, "--platform", platform]
    words += ROBOT if example == "robot-models" else ()
    assert run("generate", *words, option, "ws", cwd=folder).status == 0
    assert run("answers", *words, "-o", "a.yml", cwd=folder).status == 0
    copied(folder / "a.yml", tmp_path / package)
    ours, theirs = (
        {
            name: data
            for name, data in files_below(one / package).items()
            if "__pycache__" not in name
        }
        for one in (folder / packages, tmp_path)
    )
    assert ours.keys() == theirs.keys()
    assert [name for name in ours if ours[name] != theirs[name]] == []
    if where not in (ROS1, DDS):
        loaded(tmp_path / package)


def test_it_joins_a_second_monitor_to_the_packages_that_all_share(tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    (ours / "src").mkdir(parents=True)
    model = ("-m", EXAMPLE / "two_conserts.xml", "-c")
    generate = ("generate", "-w", ours, *model)
    assert run(*generate, EXAMPLE / "consert_a_config.yml", cwd=tmp_path).status == 0
    shutil.copytree(ours, theirs)
    config = EXAMPLE / "consert_b_config.yml"
    assert run(*generate, config, cwd=tmp_path).status == 0
    words = ("answers", "--all", "-w", theirs, "-o", tmp_path / "answers", *model, config)
    assert run(*words, cwd=tmp_path).status == 0
    for answers in sorted((tmp_path / "answers").glob("*.yml")):
        copied(answers, theirs / "src/eddi_monitor" / answers.stem)
    assert files_below(theirs) == files_below(ours)
