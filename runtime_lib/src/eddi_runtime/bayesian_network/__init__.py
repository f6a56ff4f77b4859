"""Bayesian networks: exact posteriors from hard, virtual and missing evidence (D7.2 section 3.2).

A network is compiled once, when its model is loaded; a step puts evidence in and reads posteriors.
"""

from .bounds import COMBINATIONS
from .claims import Claim
from .evidence import EvidenceError, InconsistentEvidenceError
from .explain import Explanation
from .graph import Shape
from .inference import Inference
from .knowledge import Facts
from .model import Network, read_network
from .monitor import BayesianNetworkMonitor, build
from .outputs import BayesianNetworkOutput, Monitor, Node, Outcome
from .width import LARGE, TOO_LARGE, TooWideError, Width, width_of

__all__ = [
    "COMBINATIONS",
    "LARGE",
    "TOO_LARGE",
    "BayesianNetworkMonitor",
    "BayesianNetworkOutput",
    "Claim",
    "EvidenceError",
    "Explanation",
    "Facts",
    "InconsistentEvidenceError",
    "Inference",
    "Monitor",
    "Network",
    "Node",
    "Outcome",
    "Shape",
    "TooWideError",
    "Width",
    "build",
    "read_network",
    "width_of",
]
