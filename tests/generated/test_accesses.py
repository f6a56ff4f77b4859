"""What a package takes out of messages, and publishes, passes the shapes of the answers."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.command import run
from tests.data_files import data_text

pytestmark = pytest.mark.slow

MODEL = data_text("generated/robo.yml")
CONFIG = data_text("generated/robo_config.yml")


def test_elements_by_name_and_by_key(tmp_path: Path) -> None:
    (tmp_path / "robo.yml").write_text(MODEL, "utf-8")
    (tmp_path / "config.yml").write_text(CONFIG, "utf-8")
    (tmp_path / "ws" / "src").mkdir(parents=True)
    done = run("generate", "-w", "ws", "-m", "robo.yml", "-c", "config.yml", cwd=tmp_path)
    assert done.status == 0, done.err
    package = tmp_path / "ws" / "src" / "eddi_monitor" / "robo" / "src" / "robo"
    text = (package / "EDDIInput.py").read_text("utf-8")
    assert "self.P = by_name(js.position, js.name, 'arm')" in text
    assert "self.Q = by_key(dg.status, 'name', '/Power: battery').level" in text
