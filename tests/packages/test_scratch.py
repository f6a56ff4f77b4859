"""Where a command renders and merges: in memory where there is room, and where it is told to."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest

from eddi_scaffold.packages import unpacking as scratch


@pytest.fixture
def memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("TMPDIR", "TEMP", "TMP"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(scratch, "_MEMORY", tmp_path)
    monkeypatch.setattr(scratch, "_ENOUGH", 0)
    return tmp_path


def test_it_is_in_memory_and_goes_at_the_end(memory: Path) -> None:
    with scratch.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == memory
        assert Path(folder).stat().st_mode & 0o777 == 0o700
    assert not list(memory.iterdir())


def test_elsewhere_if_the_user_says_so_or_memory_is_short(
    memory: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    other = tmp_path_factory.mktemp("other")
    monkeypatch.setattr(tempfile, "tempdir", str(other))
    monkeypatch.setattr(scratch, "_ENOUGH", 2**80)
    with scratch.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == other
    monkeypatch.setattr(scratch, "_ENOUGH", 0)
    monkeypatch.setenv("TMPDIR", str(other))
    with scratch.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == other
    assert not list(memory.iterdir())
