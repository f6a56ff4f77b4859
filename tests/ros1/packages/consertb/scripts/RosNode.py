#!/usr/bin/env python3
# ruff: noqa: EXE001, I001 - as catkin installs it: no x bit
import sys

import eddi_messages.msg
from eddi_messages.msg import ConSertOutput
from std_msgs.msg import Bool

from eddi_runtime.transports.ros1 import Input, MonitorNode, Output, reported

from consertb.EDDIInput import EDDIInput

with reported("consertb"):
    from consertb.EDDIMonitor import EDDIMonitor


class RosNode(MonitorNode):
    NAME = "consertb"
    FREQUENCY = 10.0
    MODE = "on_change"
    INPUTS = (Input("RtE_E0", "rte/e0b", Bool),)
    OUTPUTS = (Output("consertb", "consertb/guarantees", ConSertOutput),)
    MESSAGES = eddi_messages.msg


if __name__ == "__main__":
    sys.exit(RosNode.main(EDDIInput, EDDIMonitor))
