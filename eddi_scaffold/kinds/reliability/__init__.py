"""The kind ``reliability``: Markov chains and fault trees that follow what is observed (D7.2 3.3).

SESAME D7.2 names SafeDrones and announces its integration; here are its models, corrected, and
any chain or fault tree of an EDDI.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from eddi_scaffold.kinds import Kind
from eddi_scaffold.kinds.reliability.claims import MEANINGS, support
from eddi_scaffold.kinds.reliability.messages import MESSAGES

if TYPE_CHECKING:
    from eddi_scaffold.source import Source

_SUFFIXES = (".yml", ".yaml")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:horizon|mission_time|models|thresholds|on_unknown|max_gap)"""
    rb"""["']?\s*:"""
)
_TYPE = re.compile(rb"\btype[\"']?\s*:\s*[\"']?(?:propulsion|k_out_of_n|fault_tree|markov)\b")
_CONFIG = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:Model|SimulatorOutputs?|EDDIInputs|EDDIOutputs)["']?\s*:"""
)
_KEYS = ("horizon", "mission_time", "top", "models", "thresholds", "on_unknown", "max_gap")


def _later(name: str) -> Callable[..., Any]:
    """Return a function of the kind; numpy, which it needs, is imported when it is called."""

    def call(*values: Any) -> Any:
        return getattr(importlib.import_module(f"{__name__}.functions"), name)(*values)

    return call


def _sniff(source: Source) -> bool:
    if not source.name.lower().endswith(_SUFFIXES):
        return False
    data = source.data
    is_own = _OWN_KEY.search(data) is not None or _TYPE.search(data) is not None
    return is_own and _CONFIG.search(data) is None


KIND = Kind(
    name="reliability",
    title="Reliability",
    config_types=("Reliability", "DynamicReliability"),
    read_eddi=_later("read_eddi"),
    sniff=_sniff,
    read_file=_later("read_file"),
    check=_later("check"),
    counts=_later("counts"),
    outline=_later("outline"),
    export=_later("export"),
    inputs=_later("inputs"),
    outputs=_later("outputs"),
    runtime_model=_later("model_part"),
    messages=MESSAGES,
    output_message="ReliabilityOutput",
    options=_KEYS,
    without_input="p_fail is the worst case of it, and not valid",
    inputs_of_model=False,  # `observe` and `observed` of a configuration make inputs
    configure=_later("configure"),
    requirements=("numpy",),
    readme=_later("readme"),
    diagram=_later("diagram"),
    ids=_later("ids"),
    support=support,
    meanings=lambda _document, _part: MEANINGS,
)
"""What the generator knows of reliability."""
