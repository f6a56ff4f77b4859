"""The kind ``bayesian_network``: exact posteriors, from sensor values (D7.2 3.2).

``BayesianNetworkOutput``, ``NodeOutput`` and ``OutcomeOutput`` are frozen: packages made by the
tools of SESAME D7.2 use them, and any change of a field changes the MD5 and cuts them off.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import StatusReading, Verdict, state_of
from eddi_scaffold.eddi_xml.vocabulary import NETWORKS
from eddi_scaffold.kinds import Alias, ClaimField, Kind, messages_in

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

_SUFFIXES = (".xdsl", ".xmlbif", ".bifxml", ".bif", ".xml")
_ROOT = re.compile(rb"<(?:smile|BIF)[\s>/]")
_KEYS = (
    "outputs", "observed", "discretisation", "evidence_mode", "on_inconsistent", "explain",
    "renamed", "evidence",
)  # fmt: skip


def _recognises(source: Source) -> bool:
    name = source.name.lower()
    if name.endswith(_SUFFIXES[:4]):
        return True
    return name.endswith(_SUFFIXES) and _ROOT.search(source.data[:65536]) is not None


def _facts(status: Any) -> StatusReading:
    reasons = (*status.unknown_inputs, *status.undecided)
    valid = Verdict("valid", state_of(active=status.valid, known=False), reasons)
    return StatusReading((valid,), status.bayesian_network_id, accepted=tuple(status.accepted))


def _thresholds(evidence: Any) -> StatusReading:
    """Return the thresholds; one without a reason lies on the wrong side for certain."""
    from eddi_runtime.bayesian_network.claims import REASONS  # noqa: PLC0415 - only who watches

    verdicts = []
    for entry in evidence.evidence:
        reasons: tuple[str, ...] = (REASONS.get(entry.reason, entry.reason),)
        if entry.active or not entry.reason:
            reasons = ()
        elif entry.reason == "unknown inputs" and evidence.unknown_inputs:
            reasons = tuple(evidence.unknown_inputs)
        bounds = "" if math.isnan(entry.low) else f"P {entry.low:.3g} to {entry.high:.3g}"
        state = state_of(active=entry.active, known=not entry.reason)
        verdicts.append(Verdict(entry.id, state, reasons, bounds))
    return StatusReading(tuple(verdicts), evidence.bayesian_network_id)


KIND = Kind(
    name="bayesian_network",
    title="Bayesian network",
    config_types=("BayesianNetwork", "Bayesian Network", "bayesian_network"),
    recognises=_recognises,
    messages=messages_in(__path__[0]),
    output_message="BayesianNetworkOutput",
    verdicts={"BayesianNetworkEvidence": _thresholds, "BayesianNetworkStatus": _facts},
    model="network_model.NetworkModel",
    topic="posteriors",
    claim=ClaimField(
        "BayesianNetworkEvidence",
        "evidence[{}].active",
        "/evidence",
        options=("thresholds", "evidence"),
    ),
    in_eddi=NETWORKS,
    options=_KEYS,
    inputs_of_model=False,
    aliases=(
        Alias(
            "bn_monitor",
            "bayesian_network",
            ("BayesianNetworkOutput", "Monitor", "Node", "Outcome"),
            ("BayesianNetworkMonitor",),
        ),
    ),
)
"""What the generator knows of Bayesian networks."""
