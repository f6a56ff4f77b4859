"""Where the templates of an installed eddi-scaffold are kept, and where a command renders."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest

from eddi_scaffold.packages import unpacking


def test_it_renders_in_memory_or_where_the_user_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    for name in ("TMPDIR", "TEMP", "TMP"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(unpacking, "_MEMORY", tmp_path)
    monkeypatch.setattr(unpacking, "_ENOUGH", 0)
    with unpacking.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == tmp_path
        assert Path(folder).stat().st_mode & 0o777 == 0o700
    other = tmp_path_factory.mktemp("other")
    monkeypatch.setattr(tempfile, "tempdir", str(other))
    monkeypatch.setattr(unpacking, "_ENOUGH", 2**80)  # memory is short
    with unpacking.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == other
    monkeypatch.setattr(unpacking, "_ENOUGH", 0)
    monkeypatch.setenv("TMPDIR", str(other))
    with unpacking.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == other
    assert not list(tmp_path.iterdir())
