"""What the messages beside the posteriors of a network say."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.verdicts import Listen, Said, Verdict, state_of


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
    return unknown if one.reason == "unknown inputs" and unknown else (one.reason,)


VERDICTS: dict[str, Listen] = {
    "BayesianNetworkEvidence": _thresholds,
    "BayesianNetworkStatus": _facts,
}
