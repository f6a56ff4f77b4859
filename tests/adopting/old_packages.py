"""Packages as the tools of SESAME D7.2 wrote them, with what people wrote into them."""

from __future__ import annotations

from pathlib import Path

from tests.data_files import data_text, write_files

EDDI_INPUT = data_text("adopting/eddi_input.txt")
ROS_NODE = data_text("adopting/ros_node.txt")


def write_old_ros_package(folder: Path, model: str, name: str = "ConSertA.yml") -> Path:
    """Write an old ROS package of a ConSert with its model beside it."""
    files = {
        "scripts/EDDIInput.py": EDDI_INPUT,
        "scripts/RosNode.py": ROS_NODE,
        "scripts/EDDIMonitor.py": "class EDDIMonitor:\n    pass\n",
        "package.xml": "<package/>\n",
        name: model,
    }
    return write_files(folder, files)
