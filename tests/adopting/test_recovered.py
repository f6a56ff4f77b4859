"""What is recovered from an old package, as a value: nothing is rendered."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.adopting.adopt import Adoption, adopt
from tests.adopting.old_networks import write_old_ros_network
from tests.adopting.old_packages import write_old_ros_package
from tests.cli.command import EXAMPLE, edit
from tests.data_files import data_text

CONSERT = data_text("adopting/conserta.yml")
MONITOR = """class EDDIMonitor:
    def execute_step(self, eddi_input):
        guarantees = []
        guarantees.append({'id': 'ID', 'active': True})
        return guarantees
"""


def config_of(found: Adoption) -> dict[str, dict[str, object]]:
    return dict(yaml.safe_load(found.config()))


def test_the_package_keeps_its_name_or_gets_another(tmp_path: Path) -> None:
    old = write_old_ros_network(tmp_path / "old", "harm_risk")
    other = adopt(old, None, "other")
    assert (other.id, other.model_name) == ("other", "other.xdsl")
    found = adopt(old, None, None)
    assert (found.id, found.model.name, found.model_name) == (
        "harm_risk",
        "network1",
        "harm_risk.xdsl",
    )
    assert config_of(found)["Model"] == {
        "id": "harm_risk",
        "type": "BayesianNetwork",
        "frequency": 0.2,
        "observed": ["Density", "Distance", "Heat", "Fire"],
        "outputs": ["Harm"],
        "model": "harm_risk.xdsl",
    }


def test_the_name_of_the_package_chooses_among_models(tmp_path: Path) -> None:
    old = write_old_ros_package(tmp_path / "old", "")
    (old / "package.xml").write_text("<package><name>consertb</name></package>\n")
    eddi = EXAMPLE / "two_conserts.xml"
    assert adopt(old, eddi, None).id == "ConSertB"
    assert adopt(old, eddi, "ConSertA").id == "ConSertA"
    with pytest.raises(EddiError, match="no model 'other'"):
        adopt(old, eddi, "other")
    (old / "package.xml").unlink()
    with pytest.raises(EddiError, match="several models: ConSertA, ConSertB"):
        adopt(old, eddi, None)


def test_bodies_of_the_same_inputs_and_states_need_no_look(tmp_path: Path) -> None:
    old = write_old_ros_network(tmp_path / "old", "harm_risk")
    found = adopt(old, None, None)
    bodies = {body.region.id for body in found.bodies}
    assert bodies <= found.fitting
    network = old / "scripts" / "files" / "network1" / "network1.xdsl"
    edit(network, 'id="Hot"', 'id="Warm"')
    (old / "scripts" / "RosNode.py").unlink()
    changed = found.fitting - adopt(old, None, None).fitting
    inputs = {f"process_{name}" for name in ("dense", "heat", "fire", "distance")}
    assert changed == {"node_Heat", *inputs}


def test_without_a_class_of_inputs_they_are_what_the_methods_read(tmp_path: Path) -> None:
    scripts = write_old_ros_network(tmp_path / "old", "harm_risk") / "scripts"
    (scripts / "EDDIInput.py").unlink()
    found = adopt(scripts / "files", None, None)
    assert config_of(found)["EDDIInputs"] == [
        {"id": "dense", "requires": []},
        {"id": "distance", "requires": []},
        {"id": "heat", "requires": []},
        {"id": "fire", "requires": []},
    ]
    assert found.id == "network1"


def test_class_names_in_use_stay_what_is_published(tmp_path: Path) -> None:
    old = write_old_ros_package(tmp_path / "old", CONSERT)
    script = old / "scripts" / "EDDIMonitor.py"
    script.write_text(MONITOR.replace("ID", "System_A_G0"))
    assert "guarantee_ids" not in config_of(adopt(old, None, None))["Model"]
    script.write_text(MONITOR.replace("ID", "SystemAG0"))
    found = adopt(old, None, None)
    assert config_of(found)["Model"]["guarantee_ids"] == "class"
    assert "guarantee_ids: class: the old monitor publishes SystemAG0" in found.notes


def test_the_file_of_a_consert_keeps_its_name(tmp_path: Path) -> None:
    """It is the name of the ConSert."""
    old = write_old_ros_package(tmp_path / "old", CONSERT, "Base.yml")
    (old / "package.xml").write_text("<package><name>base_monitor</name></package>\n")
    found = adopt(old, None, None)
    assert (found.id, found.model_name) == ("base_monitor", "Base.yml")


def test_a_plain_package_of_a_network_is_named_after_its_file(tmp_path: Path) -> None:
    folder = write_old_ros_network(tmp_path / "old", "harm_risk", "LaneEnds") / "scripts" / "files"
    network = folder / "LaneEnds" / "LaneEnds.xdsl"
    edit(network, 'id="LaneEnds"', 'id="Network2"')
    found = adopt(folder, None, None)
    assert (found.id, found.model.name, found.model_name) == (
        "LaneEnds",
        "Network2",
        "LaneEnds.xdsl",
    )
