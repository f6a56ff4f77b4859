"""The kind ``reliability``: Markov chains and fault trees that follow what is observed (D7.2 3.3).

SESAME D7.2 names SafeDrones and announces its integration; here are its models, corrected, and
any chain or fault tree of an EDDI.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common import claims
from eddi_scaffold.eddi_xml.vocabulary import CHAINS_AND_TREES
from eddi_scaffold.kinds import ClaimField, Kind, messages_in

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

_OPEN_PSA = re.compile(rb"<opsa-mef[\s>/]")
_HEAD = 65536
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:horizon|mission_time|models|thresholds|on_unknown|max_gap)"""
    rb"""["']?\s*:"""
)
_TYPE = re.compile(rb"\btype[\"']?\s*:\s*[\"']?(?:propulsion|k_out_of_n|fault_tree|markov)\b")
_CONFIG = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:Model|SimulatorOutputs?|EDDIInputs|EDDIOutputs)["']?\s*:"""
)
KEYS = ("horizon", "mission_time", "top", "models", "thresholds", "on_unknown", "max_gap")


def _recognises(source: Source) -> bool:
    name = source.name.lower()
    if name.endswith((".xml", ".opsa", ".mef")):
        return _OPEN_PSA.search(source.data[:_HEAD]) is not None
    data = source.data if name.endswith((".yml", ".yaml")) else b""
    is_own = _OWN_KEY.search(data) is not None or _TYPE.search(data) is not None
    return is_own and _CONFIG.search(data) is None


def _status_of(output: Any) -> claims.StatusReading:
    reasons = tuple(output.unknown_inputs) or ((output.reason,) if output.reason else ())
    state, text = claims.state_of(active=output.valid, known=False), f"p_fail {output.p_fail:.3g}"
    verdicts = [claims.Verdict("valid", state, reasons, text)]
    for evidence in output.evidence:
        state = claims.state_of(active=evidence.active, known=not output.reason)
        verdicts.append(claims.Verdict(evidence.id, state, () if evidence.active else reasons))
    return claims.StatusReading(tuple(verdicts), output.model, accepted=tuple(output.accepted))


KIND = Kind(
    name="reliability",
    title="Reliability",
    config_types=("Reliability", "DynamicReliability"),
    recognises=_recognises,
    messages=messages_in(__path__[0]),
    output_message="ReliabilityOutput",
    verdicts={"ReliabilityOutput": _status_of},
    model="reliability_model.ReliabilityModel",
    topic="reliability",
    claim=ClaimField("ReliabilityOutput", "evidence[{}].active"),
    in_eddi=CHAINS_AND_TREES,
    options=KEYS,
    without_input="p_fail is the worst case of it, and not valid",
    inputs_of_model=False,  # `observe` and `observed` of a configuration make inputs
)
"""What the generator knows of reliability."""
