"""ROS message of event monitors: one message for each event and step."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.common.claims import Listen, StatusReading, Verdict, state_of

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


_FALSE, _UNKNOWN = 0, 1


def _said(event: Any) -> StatusReading:
    unknown = event.verdict == _UNKNOWN  # also of a hazard, which is active then
    reasons = ("unknown counts as there",) if unknown and event.active else ()
    if event.verdict == _FALSE:
        reasons = ("the condition is FALSE",)
    one = Verdict(event.id, state_of(active=event.active, known=not unknown), reasons)
    return StatusReading((one,), accepted=tuple(event.accepted), whole=False)


VERDICTS: dict[str, Listen] = {"EventOutput": _said}
