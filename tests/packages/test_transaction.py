"""Outputs of a command are written together: with a problem, none."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.transaction import write
from tests.cli.command import files_below

OLD = {"a": b"old a", "d/b": b"old b"}
CHANGES = {"a": b"new a", "e/f/c": b"new c"}
BEFORE = {"a": b"old a"}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    write(tmp_path / "root", OLD)
    (tmp_path / "root/d/b").chmod(0o755)
    return tmp_path / "root"


def test_files_are_written_and_replaced(root: Path) -> None:
    (root / "a").chmod(0o640)
    write(root, CHANGES, BEFORE)
    assert files_below(root) == {"a": b"new a", "d/b": b"old b", "e/f/c": b"new c"}
    modes = {name: (root / name).stat().st_mode & 0o777 for name in files_below(root)}
    assert modes == {"a": 0o640, "d/b": 0o755, "e/f/c": 0o644}


def test_a_full_disk_leaves_all_as_it_was(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real, before = Path.write_bytes, files_below(root)

    def full(path: Path, data: bytes) -> int:
        real(path, data[: len(data) // 2])
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(EddiError, match="cannot write: No space left on device") as failure:
        write(root, CHANGES, BEFORE)
    assert failure.value.problems[0].code == "F002"
    assert files_below(root) == before


@pytest.mark.parametrize("blocked", ["a/x", "d", "e"])
def test_what_stands_in_the_way_is_found_before_anything_changes(root: Path, blocked: str) -> None:
    """A file where a folder must be, a folder where a file must be."""
    if blocked == "e":
        (root / "e").write_text("a file")
    before = files_below(root)
    with pytest.raises(EddiError):
        write(root, {**CHANGES, **({} if blocked == "e" else {blocked: b"x"})}, BEFORE)
    assert files_below(root) == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_found_before_anything_changes(root: Path) -> None:
    (root / "d").chmod(0o555)
    try:
        with pytest.raises(EddiError):
            write(root, {"a": b"new", "d/b": b"new"}, BEFORE)
        assert (root / "a").read_bytes() == b"old a"
    finally:
        (root / "d").chmod(0o755)


def test_a_file_that_was_saved_meanwhile_stops_all(root: Path) -> None:
    (root / "a").write_bytes(b"mine")
    before = files_below(root)
    with pytest.raises(EddiError) as refused:
        write(root, CHANGES, BEFORE)
    (problem,) = refused.value.problems
    assert (problem.code, problem.place.file) == ("F013", str(root / "a"))
    assert files_below(root) == before
