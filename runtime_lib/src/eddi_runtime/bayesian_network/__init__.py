"""Bayesian networks: exact posteriors from hard, virtual and missing evidence (D7.2 3.2)."""

from ..thresholds import Threshold
from .claims import Claim
from .direct import DirectReader
from .evidence import EvidenceError, InconsistentEvidenceError
from .explain import Explanation
from .knowledge import Facts, Source
from .monitor import BayesianNetworkMonitor
from .outputs import BayesianNetworkOutput, Monitor, Node, Outcome
from .program import NodeSpec, Part, Program, Schedule, StateThreshold, Steps, Table, Tables
from .readers import Declaration, Discretiser

FORMATS = (1,)

__all__ = [
    "FORMATS",
    "BayesianNetworkMonitor",
    "BayesianNetworkOutput",
    "Claim",
    "Declaration",
    "DirectReader",
    "Discretiser",
    "EvidenceError",
    "Explanation",
    "Facts",
    "InconsistentEvidenceError",
    "Monitor",
    "Node",
    "NodeSpec",
    "Outcome",
    "Part",
    "Program",
    "Schedule",
    "Source",
    "StateThreshold",
    "Steps",
    "Table",
    "Tables",
    "Threshold",
]
