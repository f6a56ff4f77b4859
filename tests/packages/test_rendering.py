"""Where the templates of an installed eddi-scaffold are kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.packages import rendering


@pytest.fixture
def shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path / "data" / "eddi-scaffold"


def placed(tmp_path: Path, data: bytes) -> Path:
    bundle = tmp_path / "from-wheel.bundle"
    bundle.write_bytes(data)
    template = rendering.Template(rendering._shelved(), None, bundle)
    template.keep()
    return Path(template.location)


def test_the_bundle_of_the_wheel_is_put_on_the_shelf(tmp_path: Path, shelf: Path) -> None:
    assert placed(tmp_path, b"one") == shelf / "templates.bundle"
    assert (shelf / "templates.bundle").read_bytes() == b"one"
    placed(tmp_path, b"two")
    assert (shelf / "templates.bundle").read_bytes() == b"two"


def test_an_older_release_leaves_the_bundle_of_a_newer_one(tmp_path: Path, shelf: Path) -> None:
    placed(tmp_path, b"newer")
    (shelf / "templates.version").write_text("900.0.0")
    placed(tmp_path, b"older")
    assert (shelf / "templates.bundle").read_bytes() == b"newer"
