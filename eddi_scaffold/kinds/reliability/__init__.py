"""The kind ``reliability``: Markov chains and fault trees that follow what is observed (D7.2 3.3).

SESAME D7.2 names SafeDrones and announces its integration; here are its models, corrected, and
any chain or fault tree of an EDDI.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from eddi_scaffold.eddi_xml.vocabulary import CHAINS_AND_TREES
from eddi_scaffold.kinds import Kind
from eddi_scaffold.kinds.reliability.messages import MESSAGES, VERDICTS

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

_SUFFIXES = (".yml", ".yaml")
_MEF_SUFFIXES = (".xml", ".opsa", ".mef")
_MEF = re.compile(rb"<opsa-mef[\s>/]")
_HEAD = 65536
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:horizon|mission_time|models|thresholds|on_unknown|max_gap)"""
    rb"""["']?\s*:"""
)
_TYPE = re.compile(rb"\btype[\"']?\s*:\s*[\"']?(?:propulsion|k_out_of_n|fault_tree|markov)\b")
_CONFIG = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:Model|SimulatorOutputs?|EDDIInputs|EDDIOutputs)["']?\s*:"""
)
_KEYS = ("horizon", "mission_time", "top", "models", "thresholds", "on_unknown", "max_gap")


def _recognises(source: Source) -> bool:
    name = source.name.lower()
    if name.endswith(_MEF_SUFFIXES):
        with source.open() as stream:
            return _MEF.search(stream.read(_HEAD)) is not None
    if not name.endswith(_SUFFIXES):
        return False
    data = source.data
    is_own = _OWN_KEY.search(data) is not None or _TYPE.search(data) is not None
    return is_own and _CONFIG.search(data) is None


KIND = Kind(
    name="reliability",
    title="Reliability",
    config_types=("Reliability", "DynamicReliability"),
    recognises=_recognises,
    messages=MESSAGES,
    output_message="ReliabilityOutput",
    verdicts=VERDICTS,
    model="reliability_model.ReliabilityModel",
    topic="reliability",
    in_eddi=CHAINS_AND_TREES,
    options=_KEYS,
    without_input="p_fail is the worst case of it, and not valid",
    inputs_of_model=False,  # `observe` and `observed` of a configuration make inputs
    requirements=("numpy",),
)
"""What the generator knows of reliability."""
