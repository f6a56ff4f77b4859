"""Packages of networks as they are in use: adopted with their names, and ready at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.adopting.old_networks import write_old_ros_network
from tests.cli.command import run

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with two adopted packages of networks with the same id."""
    folder = tmp_path_factory.mktemp("world")
    (folder / "ws" / "src").mkdir(parents=True)
    for name in ("harm_risk", "fire_risk"):
        old = write_old_ros_network(folder / name, name)
        if name == "fire_risk":  # another network in a file of the same name
            network = old / "scripts" / "files" / "network1" / "network1.xdsl"
            network.write_text(network.read_text().replace("0.3 0.7", "0.2 0.8"))
        result = run("adopt", name, "-w", "ws", cwd=folder)
        assert result.status == 0, result.err
        assert "kept in .eddi/kept" not in result.err
        assert result.err.count("the body is in its region") == 9
    return folder


def test_nothing_is_left_to_do(world: Path) -> None:
    result = run("status", "-w", "ws", cwd=world)
    assert result.status == 0, result.out
    assert result.out.count("_risk: up to date (regions: 5 edited, 17 untouched)") == 2
    assert run("check", "ws/harm_risk_config.yml", cwd=world).err.count("K014") == 0
