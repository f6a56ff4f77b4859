"""Packages as the tools of SESAME D7.2 wrote them, with what people wrote into them."""

from __future__ import annotations

from pathlib import Path

EDDI_INPUT = '''import math
import rospy

LIMIT = 20  # degrees; the wheels lift at 28


# measured on the old rover
@staticmethod
def level(message):
    return message.data


class EDDIInput:
    """EDDI input."""

    def __init__(self):
        self.RtE_A_D0 = False
        self.RtE_A_E0 = False

    def process_RtE_A_D0(self, consertb):
        # TODO
        for guarantee in consertb.guarantees:
            if guarantee.id == 'System_A_G0_c2':
                # the one that matters
                self.RtE_A_D0 = guarantee.active

    def process_RtE_A_E0(self, RtE_E0):
        """-----Manual edit begin-----"""
        self.RtE_A_E0 = RtE_E0.data and not math.isnan(self.tilt())
        """-----Manual edit end-----"""

    def processing(self, simulator_outputs):
        if 'consertb' in simulator_outputs:
            self.process_RtE_A_D0(simulator_outputs['consertb'])
        if 'RtE_E0' in simulator_outputs:
            self.process_RtE_A_E0(simulator_outputs['RtE_E0'])
'''
ROS_NODE = """#!/usr/bin/env python3
import rospy
from EDDIInput import EDDIInput
from std_msgs.msg import Bool
from eddi_messages.msg import Guarantee, ConSertOutput
from EDDIMonitor import EDDIMonitor


class RosNode():

    def __init__(self, monitor):
        self.monitor = monitor
        self.rate = rospy.Rate(20)
        self.eddi_input = EDDIInput()
        self.simulator_values = {}

    def RtE_E0_callback(self, data):
        self.simulator_values['RtE_E0'] = data

    def consertb_callback(self, data):
        self.simulator_values['consertb'] = data

    def init_publisher(self):
        self.conserta_pub = rospy.Publisher('/conserta/guarantees', ConSertOutput)

    def init_subscriber(self):
        rospy.Subscriber('/consertb/guarantees', ConSertOutput, self.consertb_callback)
        rospy.Subscriber('/rte/e0a', Bool, self.RtE_E0_callback)


def main():
    RosNode(EDDIMonitor()).ros_main()


if __name__ == '__main__':
    main()
"""


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
