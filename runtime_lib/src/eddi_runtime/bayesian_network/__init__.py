"""Bayesian networks: exact posteriors from hard, virtual and missing evidence (D7.2 3.2)."""

from .engine import NodeSpec, Part, Program
from .monitor import BayesianNetworkMonitor, Source
from .outputs import BayesianNetworkOutput, Monitor, Node, Outcome

FORMAT = 4

__all__ = [
    "FORMAT", "BayesianNetworkMonitor", "BayesianNetworkOutput", "Monitor", "Node", "NodeSpec",
    "Outcome", "Part", "Program", "Source",
]  # fmt: skip
