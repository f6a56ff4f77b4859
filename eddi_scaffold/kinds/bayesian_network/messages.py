"""ROS messages of Bayesian network monitors.

``BayesianNetworkOutput``, ``NodeOutput`` and ``OutcomeOutput`` are frozen: packages made by the
tools of SESAME D7.2 use them, and any change of a field changes the MD5 and cuts them off.
"""

from __future__ import annotations

from typing import Any

from eddi_scaffold.common.claims import Listen, StatusReading, Verdict, state_of

OUTPUT = "NodeOutput[] output_nodes\n"
NODE = "string title\nOutcomeOutput[] outcomes\n"
OUTCOME = "string outcome_name\nfloat32 outcome_value\n"
STATUS = """\
# The facts behind a BayesianNetworkOutput.
std_msgs/Header header
string bayesian_network_id
# All inputs are observed; some are not; none is; the evidence has probability zero; a hand-written
# method failed.
uint8 OK=0
uint8 PARTIAL=1
uint8 PRIOR=2
uint8 INCONSISTENT=3
uint8 ERROR=4
uint8 status
string[] unobserved
# Every input that the network observes is known, and the state of its node as well.
bool valid
# Inputs without a usable value, whatever the configuration accepts in their place; a node that
# only a hand-written method observes is listed here by its own name.
string[] unknown_inputs
# Nodes that may be in one of several states, because a value lies within the hysteresis after a
# gap: `Near: Yes, No`. The posterior takes the first.
string[] undecided
# What the configuration accepts in this step: `human: missing: prior`.
string[] accepted
# How much each observed node changes the outputs (total variation), with `explain: true`.
string[] relevance_nodes
float32[] relevance
"""
EVIDENCE = """\
# Thresholds of posteriors: what the evidence of a ConSert can be made of.
std_msgs/Header header
string bayesian_network_id
# As in BayesianNetworkStatus.
bool valid
string[] unknown_inputs
BayesianNetworkThreshold[] evidence
"""
THRESHOLD = """\
# A threshold of the probability of states of one node.
string id
# It holds for every state that the unknown inputs may have.
bool active
# Bounds of the probability over these states; NaN: not computed.
float64 low
float64 high
# Why it is not active: `unknown inputs`, `too many unknown inputs`, `inconsistent`, `hold`,
# `between limits` (not known before), `no time`, `error`; empty: it is active, or known not to be.
string reason
"""
MESSAGES = {
    "BayesianNetworkEvidence": EVIDENCE,
    "BayesianNetworkOutput": OUTPUT,
    "BayesianNetworkStatus": STATUS,
    "BayesianNetworkThreshold": THRESHOLD,
    "NodeOutput": NODE,
    "OutcomeOutput": OUTCOME,
}
"""ROS message name -> text of its ``.msg`` file."""


WORDS = {
    "between limits": "it lies between its limits, and was not known before",
    "error": "a hand-written method failed",
    "hold": "it holds, but not for long enough yet",
    "inconsistent": "the evidence has probability zero",
    "no time": "the step has no time",
}
"""Reason of a threshold -> what the node's diagnostics say."""


def _facts(status: Any) -> StatusReading:
    reasons = (*status.unknown_inputs, *status.undecided)
    valid = Verdict("valid", state_of(active=status.valid, known=False), reasons)
    return StatusReading((valid,), status.bayesian_network_id, accepted=tuple(status.accepted))


def _thresholds(evidence: Any) -> StatusReading:
    """Return the thresholds; one without a reason lies on the wrong side for certain."""
    unknown = tuple(evidence.unknown_inputs)
    verdicts = tuple(
        Verdict(
            one.id,
            state_of(active=one.active, known=not one.reason),
            _reasons(one, unknown),
            "" if one.low != one.low else f"P {one.low:.3g} to {one.high:.3g}",
        )
        for one in evidence.evidence
    )
    return StatusReading(verdicts, evidence.bayesian_network_id)


def _reasons(one: Any, unknown: tuple[str, ...]) -> tuple[str, ...]:
    if one.active or not one.reason:
        return ()
    if one.reason == "unknown inputs" and unknown:
        return unknown
    return (WORDS.get(one.reason, one.reason),)


VERDICTS: dict[str, Listen] = {
    "BayesianNetworkEvidence": _thresholds,
    "BayesianNetworkStatus": _facts,
}
