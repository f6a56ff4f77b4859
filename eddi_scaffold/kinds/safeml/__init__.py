"""The kind ``safeml``: does what a perception component sees still look like its reference?

SESAME D7.2 section 3.4. The statistics are those of the literature, not the sums of the SafeML
library, whose distribution is not known.

``SafeMLOutput`` is frozen: packages made by the tools of SESAME D7.2 use it, and any change of a
field changes the MD5 and cuts them off. Facts that D7.2 does not publish are in a message of
their own. D7.2 itself prints ``oddViolation``: for subscribers of that message there is an option.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import StatusReading, Verdict, state_of
from eddi_scaffold.kinds import ClaimField, Kind, messages_in

if TYPE_CHECKING:
    from collections.abc import Mapping

    from eddi_scaffold.common.files import Source

VIOLATION_FIELD = "violation_field"  # Key of `Model:` in a configuration
VIOLATION_FIELDS = ("odd_violation", "oddViolation")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:window_size|reference_sample_file|distance_metric)["']?\s*:"""
)
_MESSAGES = messages_in(__path__[0])
_WORDS = {
    "empty": "a message has no samples",
    "filling": "the window is not full yet",
    "not_finite": "a sample is not finite",
    "stale": "the last sample is too old",
    "wrong_length": "a sample has the wrong length",
}
"""Reason of an omission -> words; the node's diagnostics add the numbers."""


def _recognises(source: Source) -> bool:
    is_yaml = source.name.lower().endswith((".yml", ".yaml"))
    return is_yaml and _OWN_KEY.search(source.data) is not None


def _respelt(options: Mapping[str, object]) -> Mapping[str, str]:
    """Return the output as D7.2 prints it, where the options ask for that."""
    usual, printed = VIOLATION_FIELDS
    if options.get(VIOLATION_FIELD) != printed:
        return {}
    return {"SafeMLOutput": _MESSAGES["SafeMLOutput"].replace(usual, printed)}


def _status(status: Any) -> StatusReading:
    distance = "" if math.isnan(status.statistic) else f"distance {status.statistic:.3g}"
    reasons: tuple[str, ...] = ()
    if status.omission and status.reason:
        reasons = (_WORDS.get(status.reason, status.reason),)
    elif not status.omission and not status.in_scope:
        reasons = ("the samples differ from the reference",)
    state = state_of(active=status.in_scope, known=not status.omission)
    verdict = Verdict("in_scope", state, reasons, distance)
    return StatusReading((verdict,), accepted=tuple(status.acceptances))


KIND = Kind(
    name="safeml",
    title="SafeML",
    config_types=("SafeML",),
    recognises=_recognises,
    messages=_MESSAGES,
    output_message="SafeMLOutput",
    options=(VIOLATION_FIELD,),
    wire_of_d72={VIOLATION_FIELD: "oddViolation"},
    respelt=_respelt,
    verdicts={"SafeMLStatus": _status},
    model="safeml_model.SafeMLModel",
    topic="scope",
    claim=ClaimField("SafeMLStatus", "{}", "/status"),
    in_eddi='descendant-or-self::*[local-name()="keyValueMaps"][@key="eddi.safeml"]',
    named_by_config=True,
)
"""What the generator knows of SafeML."""
