"""ROS messages of Bayesian network monitors.

``BayesianNetworkOutput``, ``NodeOutput`` and ``OutcomeOutput`` are frozen: packages made by the
tools of SESAME D7.2 use them, and any change of a field changes the MD5 and cuts them off.
"""

from __future__ import annotations

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
