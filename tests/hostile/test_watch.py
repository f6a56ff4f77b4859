"""The watch sees what a command could change."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.hostile.watch import changes, look


def replaced(folder: Path) -> None:
    times = (folder / "file").stat()
    (folder / "file").write_text("B")
    os.utime(folder / "file", ns=(times.st_atime_ns, times.st_mtime_ns))


def same_again(folder: Path) -> None:
    (folder / "file").write_text("A")
    os.utime(folder / "file", ns=(1, 1))


def come_and_gone(folder: Path) -> None:
    os.utime(folder / "below", ns=(1, 1))  # as coming and going do, on a clock that is fine enough


def executable(folder: Path) -> None:
    (folder / "file").chmod(0o755)


def linked_elsewhere(folder: Path) -> None:
    (folder / "link").unlink()
    (folder / "link").symlink_to("below")


def a_new_pipe(folder: Path) -> None:
    os.mkfifo(folder / "below" / "pipe")


@pytest.mark.parametrize(
    ("change", "names"),
    [
        (replaced, {"file"}),
        (same_again, {"file"}),
        (come_and_gone, {"below"}),
        (executable, {"file"}),
        (linked_elsewhere, {"link"}),
        (a_new_pipe, {"below/pipe"}),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_every_change_is_seen(
    change: Callable[[Path], None], names: set[str], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("A")
    (tmp_path / "below").mkdir()
    (tmp_path / "link").symlink_to("file")
    before = look(tmp_path)
    assert changes(before, look(tmp_path)) == []
    change(tmp_path)
    assert names <= set(changes(before, look(tmp_path)))
