"""Where the templates of an installed eddi-scaffold are kept, and where a command renders."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest

from eddi_scaffold.packages import rendering, unpacking


def placed(tmp_path: Path, data: bytes) -> Path:
    bundle = tmp_path / "from-wheel.bundle"
    bundle.write_bytes(data)
    template = rendering.Template(rendering._shelved(), None, bundle)
    template.keep()
    return Path(template.location)


def test_the_bundle_of_the_wheel_is_put_on_the_shelf(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    shelf = tmp_path / "data" / "eddi-scaffold"
    assert placed(tmp_path, b"one") == shelf / "templates.bundle"
    assert (shelf / "templates.bundle").read_bytes() == b"one"
    placed(tmp_path, b"two")
    assert (shelf / "templates.bundle").read_bytes() == b"two"
    (shelf / "templates.version").write_text("900.0.0")
    placed(tmp_path, b"older")
    assert (shelf / "templates.bundle").read_bytes() == b"two", "that of a newer release stays"


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
