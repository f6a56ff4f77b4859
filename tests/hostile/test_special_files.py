"""FIFOs, sockets, devices and files without end, wherever a file is expected."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from eddi_scaffold.common.files import read_regular, read_source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.regions.package import entries
from tests.cli.command import ROOT, example, run
from tests.hostile import special

MODEL, CONFIG = "two_conserts.xml", "consert_b_config.yml"


pytestmark = pytest.mark.usefixtures("limited")


def a_fifo(path: Path) -> None:
    os.mkfifo(path)


def a_device(path: Path) -> None:
    path.symlink_to("/dev/zero")


KINDS = {"a FIFO": a_fifo, "a socket": special.a_socket, "a device": a_device}


READING: dict[str, tuple[object, ...]] = {
    "model.xml": ("check", "model.xml"),
    "shown.xml": ("show", "shown.xml"),
    "config.yml": ("check", MODEL, "config.yml"),
    "newer.xml": ("generate", "--platform", "plain", "-o", "ws", "-m", "newer.xml"),
    "recorded.csv": ("run", MODEL, "-c", CONFIG, "--inputs", "recorded.csv"),
    "recorded.bag": ("run", MODEL, "-c", CONFIG, "--bag", "recorded.bag"),
    "values.csv": ("event", "x > 1", "--inputs", "values.csv"),
    "safety.events": ("check", "safety.events"),
    "robot.rossystem": ("parse-rossystem", "-s", "robot.rossystem", "-m", "."),
    "old/EDDIInput.py": ("adopt", "old", "-o", "new"),
}
"""A file, and a command that reads it."""


@pytest.mark.parametrize(
    ("name", "kind"), [(name, [*KINDS][at % 3]) for at, name in enumerate(READING)]
)
def test_a_file_that_the_user_names_is_refused_at_once(
    tmp_path: Path, name: str, kind: str
) -> None:
    if name.endswith(".bag"):
        pytest.importorskip("rosbags", reason="the extra `bags` is not installed")
    example(tmp_path)
    (tmp_path / name).parent.mkdir(exist_ok=True)
    KINDS[kind](tmp_path / name)
    result = run(*READING[name], cwd=tmp_path)
    assert result.status == (1 if name in {"model.xml", "config.yml", "safety.events"} else 2)
    assert f"{name}: error: cannot read the " in result.err
    assert f"it is {kind}, and only regular files are read" in result.err


@pytest.mark.parametrize(
    ("before", "after", "kind"),
    [
        ("requires: [RtE_E0]", "expression_file: NAME\n    event: hot", "a FIFO"),
        ("frequency: 10", "frequency: 10\n  parameters: [{model: NAME}]", "a device"),
    ],
)
def test_a_file_that_a_configuration_names(
    tmp_path: Path, before: str, after: str, kind: str
) -> None:
    example(tmp_path)
    KINDS[kind](tmp_path / "named.events")
    config = tmp_path / CONFIG
    config.write_text(config.read_text().replace(before, after.replace("NAME", "named.events")))
    result = run("check", CONFIG, cwd=tmp_path)
    assert result.status == 1
    assert f"it is {kind}, and only regular files are read [F001]" in result.err


@pytest.mark.parametrize(
    ("example", "damaged", "command"),
    [
        ("safeml", "reference_sample.csv", "check safeml_config.yml"),
        ("robot-models", "other.ros", "parse-rossystem -s rover.rossystem -m . -c c.yml"),
    ],
)
def test_a_file_beside_them(tmp_path: Path, example: str, damaged: str, command: str) -> None:
    folder = shutil.copytree(ROOT / "examples" / example, tmp_path / "example")
    (folder / damaged).unlink(missing_ok=True)
    os.mkfifo(folder / damaged)
    result = run(*command.split(), cwd=folder)
    assert "it is a FIFO, and only regular files are read" in result.err


# files without end --------------------------------------------------------------------------------
def test_no_more_than_the_limit_is_read_whatever_the_size_is_said_to_be(tmp_path: Path) -> None:
    endless = Path("/proc/self/maps")  # a regular file of no bytes, and of many
    assert endless.stat().st_size == 0
    assert len(read_regular(endless)) > 1000
    with pytest.raises(EddiError, match="it has more than the limit of 100 bytes"):
        read_source(endless, limit=100)
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(EddiError, match="it has more than the limit of 67108864 bytes"):
        read_source(tmp_path / "sparse")
    (tmp_path / "three").write_bytes(b"123")
    assert read_regular(tmp_path / "three", 3) == b"123"
    with pytest.raises(OSError, match="more than the limit of 2"):
        read_regular(tmp_path / "three", 2)


@pytest.mark.parametrize("name", ["a\0b", "missing", "."])
def test_what_is_no_file(name: str) -> None:
    with pytest.raises(EddiError, match="cannot read the file: "):
        read_source(name)


@pytest.mark.parametrize("make", KINDS.values())
def test_what_stands_there_is_told_without_opening_it(
    tmp_path: Path, make: Callable[[Path], None]
) -> None:
    make(tmp_path / "special")
    (tmp_path / "d").mkdir()
    (tmp_path / "d" / "file").touch()
    (tmp_path / "d" / "up").symlink_to("..")
    (tmp_path / ".git").mkdir()
    (tmp_path / ".git" / "config").touch()
    found = dict(entries(tmp_path, {".git"}))
    assert found.keys() == {"special", "d/file", "d/up"}
    assert (found["d/file"], found["d/up"]) == (None, "a link")
    assert found["special"] in {"no regular file", "a link"}
    assert dict(entries(tmp_path / "missing")) == {}
