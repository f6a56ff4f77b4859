"""ROS messages of reliability monitors; field names fit ROS 1 and ROS 2."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.common.claims import Listen, StatusReading, Verdict, state_of

RELIABILITY_OUTPUT = """\
std_msgs/Header header
string model
# Everything on which the numbers depend is known, and no error occurred.
bool valid
# Failure from now to the horizon; the worst case of what is unknown.
float64 p_fail
float64 p_fail_low
float64 p_fail_high
# No failure from now to the horizon.
float64 reliability
# Remaining mean time to failure; inf: failure is not certain; NaN: not computed.
float64 mttf_hours
float64 horizon_seconds
string[] unknown_inputs
# Why it is not valid; of a valid one, what was missed and still counts, or which thresholds are
# not decided. Empty: those that are not active are known not to be.
string reason
ReliabilityEvidence[] evidence
# What the configuration accepts in this step, and the result may rest on: `link: max_age: none`.
string[] accepted
"""

RELIABILITY_EVIDENCE = """\
# A threshold of p_fail with hysteresis: what the evidence of a ConSert can be made of.
string id
bool active
"""

MESSAGES = {
    "ReliabilityEvidence": RELIABILITY_EVIDENCE,
    "ReliabilityOutput": RELIABILITY_OUTPUT,
}
"""ROS message name -> text of its ``.msg`` file."""


def _said(output: Any) -> StatusReading:
    reasons = tuple(output.unknown_inputs) or ((output.reason,) if output.reason else ())
    text = f"p_fail {output.p_fail:.3g}"
    valid = Verdict("valid", state_of(active=output.valid, known=False), reasons, text)
    thresholds = (
        Verdict(
            one.id,
            state_of(active=one.active, known=not output.reason),
            () if one.active else reasons,
        )
        for one in output.evidence
    )
    return StatusReading((valid, *thresholds), output.model, accepted=tuple(output.accepted))


VERDICTS: dict[str, Listen] = {"ReliabilityOutput": _said}
