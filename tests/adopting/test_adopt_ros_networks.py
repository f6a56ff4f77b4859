"""Packages of networks as they are in use: adopted with their names, and ready at once."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.adopting.old_networks import LICENCE, write_old_ros_network
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
        assert result.err.count("the body is in its region") == 10  # nine, and the licence
    return folder


def test_nothing_is_left_to_do(world: Path) -> None:
    result = run("status", "-w", "ws", cwd=world)
    assert result.status == 0, result.out
    assert result.out.count("_risk: up to date (regions: 6 edited, 16 untouched)") == 2
    assert run("check", "ws/harm_risk_config.yml", cwd=world).err.count("K014") == 0


def test_a_licence_survives_the_next_configuration(world: Path) -> None:
    package = world / "ws" / "src" / "eddi_monitor" / "harm_risk"
    module = package / "src" / "harm_risk" / "bayesian_network_config.py"
    before = module.read_text("utf-8")
    region = re.compile(r"# region: bayesian_network_config\.module .*\n" + re.escape(LICENCE))
    assert region.search(before)
    config = world / "ws" / "harm_risk_config.yml"
    entry = "  frequency: 0.2\n  discretisation: {Heat: {input: heat, bins: [50]}}\n"
    config.write_text(config.read_text().replace("  frequency: 0.2\n", entry))
    result = run("generate", "-w", "ws", "-c", "ws/harm_risk_config.yml", cwd=world)
    assert result.status == 0, result.err
    after = module.read_text("utf-8")
    assert after != before
    assert region.search(after)
