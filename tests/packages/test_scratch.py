"""Where a command renders and merges: in memory where there is room, and where it is told to."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.packages import scratch


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


def test_the_user_says_where(memory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", "/somewhere")
    assert scratch._memory() is None


def test_a_small_or_missing_memory_is_not_used(
    memory: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scratch, "_ENOUGH", 2**80)
    assert scratch._memory() is None
    monkeypatch.setattr(scratch, "_ENOUGH", 0)
    monkeypatch.setattr(scratch, "_MEMORY", memory / "none")
    assert scratch._memory() is None
