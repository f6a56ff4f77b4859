"""ROS message of event monitors: one message for each event and step."""

from __future__ import annotations

EVENT_OUTPUT = """\
# One conditional event in one step.
std_msgs/Header header
# Name as in the model.
string id
uint8 FALSE=0
uint8 UNKNOWN=1
uint8 TRUE=2
uint8 verdict
# EVIDENCE: the verdict is TRUE. HAZARD: it is not FALSE.
bool active
# The verdict became TRUE in this step.
bool raised
# The verdict was TRUE before this step and is no longer.
bool cleared
# What is accepted in this step, and the event may rest on: `temp: max_age: none`, `hot: KNOWN`.
string[] accepted
"""

MESSAGES = {"EventOutput": EVENT_OUTPUT}
"""ROS message name -> text of its ``.msg`` file."""
