#!/usr/bin/env python3
# ruff: noqa: EXE001, I001 - as catkin installs it: no x bit
import sys

import eddi_messages.msg
from eddi_messages.msg import ConSertOutput, ConSertStatus
from std_msgs.msg import Bool

from eddi_runtime.transports.ros1 import Input, MonitorNode, Output, reported

from conserta.EDDIInput import EDDIInput

with reported("conserta"):
    from conserta.EDDIMonitor import EDDIMonitor


class RosNode(MonitorNode):
    NAME = "conserta"
    FREQUENCY = 10.0
    MODE = "rate"
    INPUTS = (
        Input("consertb", "consertb/guarantees", ConSertOutput),
        Input("RtE_E0", "rte/e0a", Bool),
    )
    OUTPUTS = (
        Output(
            "conserta",
            "conserta/guarantees",
            ConSertOutput,
            "conserta/guarantees/status",
            ConSertStatus,
        ),
    )
    MESSAGES = eddi_messages.msg


if __name__ == "__main__":
    sys.exit(RosNode.main(EDDIInput, EDDIMonitor))
