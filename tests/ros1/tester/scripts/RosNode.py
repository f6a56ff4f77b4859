#!/usr/bin/env python3
# ruff: noqa: EXE001, I001 - as catkin installs it: no x bit
"""A node with relative topics, so that tests give each one a namespace of its own."""

import os
import sys

import eddi_messages.msg
from eddi_messages.msg import ConSertOutput
from std_msgs.msg import Bool, String

from eddi_runtime.transports.ros1 import Input, MonitorNode, Output, reported

from tester.EDDIInput import EDDIInput

with reported("tester"):
    from tester.EDDIMonitor import EDDIMonitor


class RosNode(MonitorNode):
    NAME = "tester"
    FREQUENCY = 10.0
    MODE = "rate"
    INPUTS = (
        Input("how", "how", String),
        Input("flag", "flag", Bool),
    )
    OUTPUTS = (Output("tester", "guarantees", ConSertOutput),)
    MESSAGES = eddi_messages.msg


class HandMade(RosNode):
    """Overrides what D7.2 names, and does it wrong: None in a field."""

    def create_ros_msg(self, eddi_output):
        message = super().create_ros_msg(eddi_output)
        if any(item["id"] == "G_F" and item["active"] for item in eddi_output):
            message.guarantees[0].active = None
        return message


if __name__ == "__main__":
    node = HandMade if "TESTER_HAND_MADE" in os.environ else RosNode
    sys.exit(node.main(EDDIInput, EDDIMonitor))
