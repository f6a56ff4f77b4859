"""A network's package as the tools of SESAME D7.2 wrote it (Figs 13 to 20)."""

from __future__ import annotations

from pathlib import Path

from tests.data_files import data_text, write_files

CONFIG = data_text("adopting/old_config.txt")


def write_old_network(folder: Path, xdsl: str, name: str = "PedestrianRisk") -> Path:
    """Write an old plain package with its network beside the configuration."""
    files = {
        f"files/{name}/bayesian_network_config.py": CONFIG,
        f"files/{name}/{name}.xdsl": xdsl,
        "bn_monitor.py": "class BayesianNetworkMonitor:\n    pass\n",
    }
    return write_files(folder, files)


def write_old_ros_network(folder: Path, package: str, network: str = "network1") -> Path:
    """Write an old ROS package of a network, with nothing written by hand but the nodes' bodies."""
    place = f"scripts/files/{network}"
    files = {
        "package.xml": f'<package format="2">\n  <name>{package}</name>\n</package>\n',
        "scripts/EDDIInput.py": data_text("adopting/network_input.txt"),
        "scripts/RosNode.py": data_text("adopting/network_node.txt").replace("PACKAGE", package),
        f"{place}/bayesian_network_config.py": data_text("adopting/network_config.txt"),
        f"{place}/{network}.xdsl": data_text("adopting/network.xdsl").replace("NETWORK", network),
    }
    return write_files(folder, files)
