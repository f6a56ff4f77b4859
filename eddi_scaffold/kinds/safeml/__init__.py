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
from eddi_scaffold.kinds import Kind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from eddi_scaffold.common.files import Source

VIOLATION_FIELD = "violation_field"
"""Key of ``Model:`` in a configuration."""
VIOLATION_FIELDS = ("odd_violation", "oddViolation")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:window_size|reference_sample_file|distance_metric)["']?\s*:"""
)
_OUTPUT = "bool omission\nbool odd_violation\nfloat32 significance_level\n"
_STATUS = """\
# The facts behind a SafeMLOutput. Numbers that do not exist are NaN.
std_msgs/Header header
bool omission
bool odd_violation
# There is no verdict now, odd_violation is the last one.
bool held
string metric
# The largest distance of all tests, and from which on it is a violation.
float64 statistic
float64 threshold
# The same for independent samples.
float64 threshold_theoretical
# Which test that was, -1 for none.
int32 component
# Bound on the probability of such a distance without a change, all tests together.
float64 p_value_bound
# Samples since the start that entered the window, and that did not; how many it holds now.
uint64 accepted
uint64 rejected
uint32 filled
uint32 window_size
# Of an omission: filling, empty, not_finite, wrong_length or stale.
string reason
# Neither an omission nor a violation: what the evidence of a ConSert can be made of.
bool in_scope
# What the configuration accepts in this step: `sample: max_age: none`.
string[] acceptances
"""
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
    return {"SafeMLOutput": _OUTPUT.replace(usual, printed)}


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
    messages={"SafeMLOutput": _OUTPUT, "SafeMLStatus": _STATUS},
    output_message="SafeMLOutput",
    options=(VIOLATION_FIELD,),
    respelt=_respelt,
    verdicts={"SafeMLStatus": _status},
    model="safeml_model.SafeMLModel",
    topic="safeml",
    in_eddi='descendant-or-self::*[local-name()="keyValueMaps"][@key="eddi.safeml"]',
    requirements=("numpy",),
    named_by_config=True,
)
"""What the generator knows of SafeML."""
