"""Meaning of the messages of a network's monitor."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.common.claims import Acceptance, Claim, Meaning, Meanings
from eddi_scaffold.kinds.bayesian_network.discretisation import UNOBSERVED
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
from eddi_scaffold.program.input_expressions import BoundInput

_EVIDENCE = "`field: evidence[ID].active` of BayesianNetworkEvidence"
_VALID = Meaning((False,), refused="`valid` is false when an input is unknown", instead=_EVIDENCE)
MEANINGS: Meanings = {
    "BayesianNetworkOutput": {
        "output_nodes": Meaning(
            refused="a raw posterior is not evidence: it is the prior when nothing is known",
            instead=_EVIDENCE,
        ),
    },
    "BayesianNetworkStatus": {"valid": _VALID},
    "BayesianNetworkEvidence": {
        "valid": _VALID,
        "evidence[].active": Meaning(
            (False,),
            refused="`active` of a threshold is false also when it is unknown",
            instead="the opposite threshold",
            known=((".reason", ""),),
        ),
    },
}
"""Message -> field, with all below it -> its meaning."""


def acceptances(
    settings: NetworkOptions, bound: Sequence[BoundInput], frequency: float
) -> Sequence[Acceptance]:
    """Return what the declarations of the nodes accept in place of a known state."""
    inputs = {input_.id: input_ for input_ in bound}
    accepted = []
    for entry in settings.declarations:
        path = ("Model", "discretisation", entry.node)
        policy, source = entry.data.get("missing", UNOBSERVED), inputs[entry.input]
        if policy in _POLICIES and (policy != "default" or source.default is not None):
            age = source.max_age
            seconds = age + 1 / frequency if policy == "hold" and isinstance(age, float) else None
            lasts = "while it is unknown" if seconds is None else f"for {seconds:g} s"
            text, key = f"{_POLICIES[policy]} of {entry.node}", f"missing: {policy}"
            accepted.append(Acceptance(key, text, lasts, seconds, entry.input, (*path, "missing")))
        for name, value, what in _BEYOND:
            if entry.data.get(name) == value:
                text, key = f"{what} of {entry.node}", f"{name}: {value}".lower()
                accepted.append(
                    Acceptance(key, text, "while it is so", None, entry.input, (*path, name))
                )
    return accepted


def claims(
    settings: NetworkOptions, bound: Sequence[BoundInput], frequency: float
) -> Sequence[Claim]:
    """Return the thresholds: they rest on every input; raw posteriors claim nothing.

    They may outlive their inputs for as long as a state is held.
    """
    held = [entry.seconds or 0.0 for entry in acceptances(settings, bound, frequency)]
    inputs, hold_s = frozenset(input_.id for input_ in bound), max(held, default=0.0)
    return [Claim(threshold.id, inputs, hold_s) for threshold in settings.thresholds]


_POLICIES = {"prior": "the prior", "default": "the state of the default", "hold": "the last state"}
_BEYOND = (
    ("out_of_range", "clamp", "the nearest value in range"),
    ("allow_inf", True, "the outermost bin"),
)
