"""Meaning of the messages of a network's monitor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from eddi_scaffold.common.claims import Acceptance, Claim, Meaning, Meanings
from eddi_scaffold.compiling.monitor import BoundInput
from eddi_scaffold.kinds.bayesian_network.discretisation import UNOBSERVED
from eddi_scaffold.kinds.bayesian_network.options import NetworkModel, settings_of

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


def support(document: Mapping[str, Any]) -> Mapping[str, frozenset[str]]:
    """Return what the thresholds rest on: the inputs; raw posteriors claim nothing."""
    inputs = frozenset(spec["id"] for spec in document["inputs"])
    return {threshold["id"]: inputs for threshold in document["model"].get("thresholds", ())}


def accepted(document: Mapping[str, Any], frequency: float) -> Sequence[Acceptance]:
    """Return what the declarations of the nodes accept in place of a known state."""
    specs = {spec["id"]: spec for spec in document["inputs"]}
    return [
        one
        for node, declared in document["model"].get("discretisation", {}).items()
        for one in _of_node(node, declared, specs[declared["input"]], frequency)
    ]


def lag(document: Mapping[str, Any], frequency: float) -> float:
    """Return for how many seconds a state is held after its input became unknown."""
    held = [one.seconds for one in accepted(document, frequency) if one.key == "missing: hold"]
    return max((one for one in held if one is not None), default=0.0)


def _of_node(
    node: str, declared: Mapping[str, Any], spec: Mapping[str, Any], frequency: float
) -> Iterator[Acceptance]:
    path = ("Model", "discretisation", node)
    policy, age = declared.get("missing", "unobserved"), spec["max_age"]
    if policy in _POLICIES and (policy != "default" or spec["default"] is not None):
        seconds = age + 1 / frequency if policy == "hold" and isinstance(age, float) else None
        lasts = "while it is unknown" if seconds is None else f"for {seconds:g} s"
        text = f"{_POLICIES[policy]} of {node}"
        key = f"missing: {policy}"
        yield Acceptance(key, text, lasts, seconds, declared["input"], (*path, "missing"))
    for name, value, what in _BEYOND:
        if declared.get(name) == value:
            text, lasts = f"{what} of {node}", "while it is so"
            key = f"{name}: {value}".lower()
            yield Acceptance(key, text, lasts, None, declared["input"], (*path, name))


def acceptances(
    model: NetworkModel, bound: Sequence[BoundInput], frequency: float
) -> Sequence[Acceptance]:
    """Return what the declarations of the nodes accept in place of a known state."""
    inputs = {input_.id: input_ for input_ in bound}
    accepted = []
    for entry in settings_of(model).declarations:
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


def claims(model: NetworkModel, bound: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
    """Return the thresholds: they rest on every input; raw posteriors claim nothing.

    They may outlive their inputs for as long as a state is held.
    """
    held = [entry.seconds or 0.0 for entry in acceptances(model, bound, frequency)]
    inputs, hold_s = frozenset(input_.id for input_ in bound), max(held, default=0.0)
    return [Claim(threshold.id, inputs, hold_s) for threshold in settings_of(model).thresholds]


_POLICIES = {"prior": "the prior", "default": "the state of the default", "hold": "the last state"}
_BEYOND = (
    ("out_of_range", "clamp", "the nearest value in range"),
    ("allow_inf", True, "the outermost bin"),
)
