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
# How much each observed node changes the outputs (total variation), with `explain: true`.
string[] relevance_nodes
float32[] relevance
"""
MESSAGES = {
    "BayesianNetworkOutput": OUTPUT,
    "BayesianNetworkStatus": STATUS,
    "NodeOutput": NODE,
    "OutcomeOutput": OUTCOME,
}
"""ROS message name -> text of its ``.msg`` file."""
