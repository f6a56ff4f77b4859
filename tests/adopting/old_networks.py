"""A network's package as the tools of SESAME D7.2 wrote it (Figs 13 to 20)."""

from __future__ import annotations

from pathlib import Path

from tests.data_files import data_text

CONFIG = data_text("adopting/old_config.txt")


def write_old_network(folder: Path, xdsl: str, name: str = "PedestrianRisk") -> Path:
    """Write an old plain package with its network beside the configuration."""
    inner = folder / "files" / name
    inner.mkdir(parents=True)
    (inner / "bayesian_network_config.py").write_text(CONFIG, "utf-8")
    (inner / f"{name}.xdsl").write_text(xdsl, "utf-8")
    (folder / "bn_monitor.py").write_text("class BayesianNetworkMonitor:\n    pass\n", "utf-8")
    return folder


_TRUE_OR_FALSE = """        if self.dra_data.{input}:
            outcome_{high} = 1.0
        else:
            outcome_{low} = 1.0
"""
_BODIES = {
    "Density": ("Dense", "Broad", _TRUE_OR_FALSE.format(input="dense", high="Dense", low="Broad")),
    "Distance": (
        "Close",
        "Far",
        _TRUE_OR_FALSE.format(input="distance <= 500", high="Close", low="Far"),
    ),
    "Heat": (
        "Hot",
        "Normal",
        _TRUE_OR_FALSE.format(input="heat >= 50.0", high="Hot", low="Normal"),
    ),
    "Fire": ("Yes", "No", _TRUE_OR_FALSE.format(input="fire", high="Yes", low="No")),
    "Cover": ("Dense", "Thin", "\n"),
    "Harm": ("High", "Low", "        is_bn_output = True\n"),
}
_PARENTS = {"Cover": ("Density", "Fire"), "Harm": ("Distance", "Heat", "Cover")}
_INPUTS = (
    ("dense", "Bool", "True", "station/dense"),
    ("heat", "Float32", "60.0", "drone/heat"),
    ("fire", "Bool", "True", "station/fire"),
    ("distance", "Float32", "10.0", "distance"),
)
LICENCE = data_text("adopting/licence.txt")


def config_text() -> str:
    """Return a configuration of a network in the form that the tools write beside a ROS node."""
    return f"{LICENCE}class BayesianNetworkConfig:\n" + "".join(
        f"""
    def node_{name}(self):
        \"\"\"Method for the CPT node '{name}'.\"\"\"
        is_bn_output = False
        outcome_{high} = 0.0
        outcome_{low} = 0.0
        '''----------Manual edit begin----------'''
{body}        '''----------Manual edit end----------'''
        return is_bn_output, \\
            {{'{high}': outcome_{high},
            '{low}': outcome_{low}}}
"""
        for name, (high, low, body) in _BODIES.items()
    )


def xdsl_text(network: str) -> str:
    """Return the network of these nodes."""
    nodes = "".join(
        f'<cpt id="{name}"><state id="{high}"/><state id="{low}"/>'
        f"<parents>{' '.join(_PARENTS.get(name, ()))}</parents>"
        f"<probabilities>{'0.3 0.7 ' * 2 ** len(_PARENTS.get(name, ()))}</probabilities></cpt>\n"
        for name, (high, low, _) in _BODIES.items()
    )
    return f'<smile version="1.0" id="{network}">\n<nodes>\n{nodes}</nodes>\n</smile>\n'


def write_old_ros_network(folder: Path, package: str, network: str = "network1") -> Path:
    """Write an old ROS package of a network, with nothing written by hand but the nodes' bodies."""
    scripts = folder / "scripts"
    inner = scripts / "files" / network
    inner.mkdir(parents=True)
    (inner / "bayesian_network_config.py").write_text(config_text(), "utf-8")
    (inner / f"{network}.xdsl").write_text(xdsl_text(network), "utf-8")
    manifest = f'<package format="2">\n  <name>{package}</name>\n</package>\n'
    (folder / "package.xml").write_text(manifest, "utf-8")
    text = "\n\nclass EDDIInput:\n    def __init__(self):\n"
    text += "".join(f"        self.{name} = {value}\n" for name, _, value, _ in _INPUTS)
    for number, (name, *_) in enumerate(_INPUTS):
        text += f"\n    def process_{name} (self, out_{number}):\n"
        text += f"        self.{name} = out_{number}.data\n"
    text += "\n\n    def processing (self, simulator_outputs):\n"
    for number, (name, _, value, _) in enumerate(_INPUTS):
        text += f"        if 'out_{number}' in simulator_outputs:\n"
        text += f"            self.process_{name}(simulator_outputs['out_{number}'])\n"
        text += f"        else:\n            self.{name} = {value}\n\n"
    (scripts / "EDDIInput.py").write_text(text, "utf-8")
    callbacks = "".join(
        f"    def out_{number}_callback (self, data):\n"
        f"        self.simulator_values['out_{number}'] = data\n\n"
        for number in range(len(_INPUTS))
    )
    subscribers = "".join(
        f"        rospy.Subscriber('{topic}', {of}, self.out_{number}_callback)\n"
        for number, (_, of, _, topic) in enumerate(_INPUTS)
    )
    node = f"""#!/usr/bin/env python3
import rospy
from std_msgs.msg import Bool
from std_msgs.msg import Float32
from eddi_messages.msg import BayesianNetworkOutput
from bn_monitor import BayesianNetworkMonitor as EDDIMonitor

class RosNode():

    def __init__(self, monitor):
        rospy.init_node('{package}')
        self.rate = rospy.Rate(0.2)

{callbacks}    def init_publisher(self):
        self.eddi_out_0_pub = rospy.Publisher('eddi/harm', BayesianNetworkOutput)

    def init_subscriber(self):
{subscribers}"""
    (scripts / "RosNode.py").write_text(node, "utf-8")
    return folder
