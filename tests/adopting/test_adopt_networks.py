"""An old package of a network: bodies with five and ten dashes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from eddi_scaffold.kinds.bayesian_network.write import to_xdsl
from eddi_scaffold.packages import assembly
from tests.adopting.old_networks import write_old_network
from tests.cli.command import ROOT, run
from tests.kinds.bayesian_network.networks import read_path

pytestmark = pytest.mark.slow


@pytest.fixture
def old(tmp_path: Path) -> Path:
    network = read_path(ROOT / "examples" / "pedestrian" / "pedestrian.xml").data
    return write_old_network(tmp_path / "bn_monitor", to_xdsl(network))


def test_every_body_is_in_its_method(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assembly, "cross_checked", lambda monitor, _: monitor)  # takes seconds
    result = run("adopt", "bn_monitor", "-o", "out", cwd=old.parent)
    assert result.status == 3, result.err  # a helper, and a body without a node
    package = old.parent / "out" / "pedestrianrisk"
    text = (package / "bayesian_network_config.py").read_text("utf-8")
    for body in (
        "        kmh = self.to_kmh(self.dra_data.vehicleSpeed)\n        if kmh < 0.05:\n",
        "        pedestrian_distance = self.dra_data.pedestrianDistance\n",
        "        is_bn_output = True\n",
    ):
        assert text.count(body) == 1
    kept = (package / ".eddi" / "kept" / "bayesian_network_config.py.adopted").read_text("utf-8")
    assert "return value * 3.6" in kept
    (orphan,) = (package / ".eddi" / "kept").glob("*.region")
    assert "of a node that is not in the network" in orphan.read_text("utf-8")
    assert "is kept in .eddi/kept/node_Gone.region" in result.err
    config = yaml.safe_load((old.parent / "out" / "pedestrianrisk_config.yml").read_text("utf-8"))
    assert config["Model"] == {
        "id": "PedestrianRisk",
        "type": "BayesianNetwork",
        "observed": ["AV_Shuttle_Speed", "Distance_to_Pedestrian"],
        "outputs": ["Critical"],
        "model": "PedestrianRisk.xdsl",
    }
    path = package / "bayesian_network_config.py"  # it gives the old answers
    path.write_text(text.replace("self.to_kmh(self.dra_data.vehicleSpeed)", "4.0"), "utf-8")
    code = (
        "from types import SimpleNamespace as S\n"
        "from pedestrianrisk.bn_monitor import BayesianNetworkMonitor\n"
        "monitor = BayesianNetworkMonitor()\n"
        "for distance in (0.4, 5.3):\n"
        "    (one,) = monitor.execute_step(S(pedestrianDistance=distance))\n"
        "    print(one.output_nodes[0].outcomes[0].value)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=old.parent / "out",
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "0.7\n0.2\n"
