"""Bags of the field: channels that nothing names, no metadata, cut off, strange times."""

import shutil
from pathlib import Path

import pytest

from tests.cli.command import ROOT, Result, run
from tests.data_files import data_text

rosbags = pytest.importorskip("rosbags", reason="the extra `bags` is not installed")


FIELD = ROOT / "tests" / "data" / "oracles" / "field"
UNUSED, MESSAGES = FIELD / "bag-unused-channel", FIELD / "bag-messages"
VERDICTS = data_text("recordings/lidar_verdicts.txt")
CHANNELS = ("with_json.mcap", "service_event.mcap", "missing_type.bag")


def played(folder: Path, bag: str) -> Result:
    return run("run", "lidar_config.yml", "--bag", bag, cwd=folder)


@pytest.mark.parametrize("bag", CHANNELS)
def test_a_channel_that_nothing_names_spoils_nothing(bag: str) -> None:
    found = played(UNUSED, bag)
    assert (found.status, found.out, found.err) == (0, VERDICTS, "")


def test_a_channel_that_is_named_must_be_readable(tmp_path: Path) -> None:
    for name in ("lidar.events", "lidar_config.yml"):
        shutil.copy(UNUSED / name, tmp_path)
    config = tmp_path / "lidar_config.yml"
    text = config.read_text("utf-8").replace("std_msgs.Float32", "pump_msgs.State")
    config.write_text(text.replace("/lidar/nearest", "/other"), "utf-8")
    found = played(tmp_path, str(UNUSED / "missing_type.bag"))
    assert found.status == 2
    assert "other_msgs/msg/Thing" in found.err


def test_without_metadata_its_files_are_read() -> None:
    found = played(MESSAGES, "no_metadata")
    assert (found.status, found.out, found.err) == (0, VERDICTS, "")


def test_what_was_cut_off_can_be_saved() -> None:
    found = played(MESSAGES, "cut_off")
    assert found.status == 2
    assert "hint: of one that was cut off, `rosbag reindex`" in found.err


def test_a_message_from_before_the_clock_was_set() -> None:
    found = played(MESSAGES, "clock_zero")
    assert (found.status, found.out) == (0, VERDICTS)
    assert "warning: the first message has the time stamp 0, and is left out [I011]" in found.err
