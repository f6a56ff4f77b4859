"""A network's package as the tools of SESAME D7.2 wrote it (Figs 13 to 20)."""

from __future__ import annotations

from pathlib import Path

CONFIG = '''
from typing import Dict, Tuple


class BayesianNetworkConfig:
    """Bayesian network config to change the node's outcomes dependent
    on the received DRA data.
    """

    # ===== Initialization methods =====
    def __init__(self) -> None:
        self.dra_data = None

    # ===== Update methods =====
    def update_dra_data(self, dra_data) -> None:
        self.dra_data = dra_data

    # ===== Bayesian network's node methods =====
    def node_AV_Shuttle_Speed(self):
        is_bn_output = False
        outcome_NotDriving = 0.0
        outcome_range_0_to_2_kmh = 0.0
        outcome_range_2_to_4_kmh = 0.0
        outcome_more_than_4_kmh = 0.0
        """----------Manual edit begin----------"""
        kmh = self.to_kmh(self.dra_data.vehicleSpeed)
        if kmh < 0.05:
            outcome_NotDriving = 1.0
        elif kmh <= 2:
            outcome_range_0_to_2_kmh = 1.0
        elif kmh <= 4:
            outcome_range_2_to_4_kmh = 1.0
        else:
            outcome_more_than_4_kmh = 1.0
        """----------Manual edit end----------"""
        return is_bn_output, \\
               {'NotDriving': outcome_NotDriving,
                'range_0_to_2_kmh': outcome_range_0_to_2_kmh,
                'range_2_to_4_kmh': outcome_range_2_to_4_kmh,
                'more_than_4_kmh': outcome_more_than_4_kmh}

    def node_Distance_to_Pedestrian(self):
        is_bn_output = False
        outcome_range_0_to_1_m = 0.0
        outcome_range_1_to_2_m = 0.0
        outcome_more_than_2_m = 0.0
        # -----Manual edit begin-----
        pedestrian_distance = self.dra_data.pedestrianDistance
        if pedestrian_distance <= 1.0:
            outcome_range_0_to_1_m = 1.0
        elif 1.0 < pedestrian_distance <= 2.0:
            outcome_range_1_to_2_m = 1.0
        elif 2.0 < pedestrian_distance:
            outcome_more_than_2_m = 1.0
        # -----Manual edit end-----
        return is_bn_output, \\
               {'range_0_to_1_m': outcome_range_0_to_1_m,
                'range_1_to_2_m': outcome_range_1_to_2_m,
                'more_than_2_m': outcome_more_than_2_m}

    def node_Critical(self):
        is_bn_output = False
        outcome_Yes = 0.0
        outcome_No = 0.0
        \'\'\'-----Manual edit begin-----\'\'\'
        is_bn_output = True
        \'\'\'-----Manual edit end-----\'\'\'
        return is_bn_output, \\
               {'Yes': outcome_Yes,
                'No': outcome_No}

    def node_Gone(self):
        is_bn_output = False
        outcome_Yes = 0.0
        \'\'\'-----Manual edit begin-----\'\'\'
        outcome_Yes = 1.0  # of a node that is not in the network
        \'\'\'-----Manual edit end-----\'\'\'
        return is_bn_output, {'Yes': outcome_Yes}

    def to_kmh(self, value):
        return value * 3.6
'''


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
LICENCE = """##### BEGIN LICENSE BLOCK #####
#
# Copyright (C) 2021 An institute
#
##### END LICENSE BLOCK #####
"""


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
