"""Packages as the tools of SESAME D7.2 wrote them, with what people wrote into them."""

from __future__ import annotations

from pathlib import Path

from tests.data_files import data_text

EDDI_INPUT = data_text("adopting/eddi_input.txt")
ROS_NODE = data_text("adopting/ros_node.txt")


def write_old_ros_package(folder: Path, model: str, name: str = "ConSertA.yml") -> Path:
    """Write an old ROS package of a ConSert with its model beside it."""
    scripts = folder / "scripts"
    scripts.mkdir(parents=True)
    (scripts / "EDDIInput.py").write_text(EDDI_INPUT, "utf-8")
    (scripts / "RosNode.py").write_text(ROS_NODE, "utf-8")
    (scripts / "EDDIMonitor.py").write_text("class EDDIMonitor:\n    pass\n", "utf-8")
    (folder / "package.xml").write_text("<package/>\n", "utf-8")
    (folder / name).write_text(model, "utf-8")
    return folder
