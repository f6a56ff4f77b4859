"""What the messages beside the posteriors of a network say."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.verdicts import Listen, Said, Verdict, state_of

WORDS = {
    "between limits": "it lies between its limits, and was not known before",
    "error": "a hand-written method failed",
    "hold": "it holds, but not for long enough yet",
    "inconsistent": "the evidence has probability zero",
    "no time": "the step has no time",
}
"""Reason of a threshold -> what the node's diagnostics say."""


def _facts(status: Any) -> Said:
    reasons = (*status.unknown_inputs, *status.undecided)
    valid = Verdict("valid", state_of(active=status.valid, known=False), reasons)
    return Said((valid,), status.bayesian_network_id, accepted=tuple(status.accepted))


def _thresholds(evidence: Any) -> Said:
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
    return Said(verdicts, evidence.bayesian_network_id)


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
