"""Posteriors for evidence by name, beside the steps: for comparisons, no monitor needs it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eddi_runtime.bayesian_network import BayesianNetworkMonitor, NodeSpec
from eddi_runtime.bayesian_network.outputs import Answer, EvidenceError, Finding, finding

Evidence = str | Sequence[float] | None
"""Of one node: nothing, the name of a state, or one likelihood per state."""


class InconsistentEvidenceError(ValueError):
    """The evidence has probability zero: it is impossible in the network."""


def posteriors(
    monitor: BayesianNetworkMonitor, evidence: Mapping[str, Evidence]
) -> dict[str, tuple[float, ...]]:
    """Return the posterior of each output, in the order of its states; steps are not touched.

    Raises:
        EvidenceError: an unknown node or state, or numbers that are no likelihoods.
        InconsistentEvidenceError: the evidence has probability zero.
        NotForeseenError: a node was not foreseen, and no inference is there for it.
    """
    numbers = {spec.id: node for node, spec in enumerate(monitor.nodes)}
    given = Answer()
    for name, value in evidence.items():
        if name not in numbers:
            raise EvidenceError(f"there is no node {name!r}")
        judged = _judged(monitor.nodes[numbers[name]], value)
        if judged is not None:
            given.findings[numbers[name]] = judged
    engine = monitor.engine
    if not given.findings.keys() <= set(engine.observable):
        engine = monitor.engine_for({*engine.outputs}, {*engine.observable, *given.findings})
    states = list(engine.missing)
    weights: dict[int, list[float]] = {}
    given.put(engine, states, weights)
    rows = engine.infer(states, weights)
    if rows is None:
        shown = ", ".join(f"{name}={value}" for name, value in evidence.items())
        raise InconsistentEvidenceError(f"the evidence has probability zero: {shown}")
    return {
        monitor.nodes[node].id: tuple(row) for node, row in zip(engine.outputs, rows, strict=True)
    }


def _judged(node: NodeSpec, value: Evidence) -> Finding:
    if isinstance(value, str):
        if value not in node.states:
            raise EvidenceError(f"{node.id}: there is no state {value!r}")
        return node.states.index(value)
    try:
        return None if value is None else finding(value, node.states)
    except EvidenceError as problem:
        raise EvidenceError(f"{node.id}: {problem}") from None
