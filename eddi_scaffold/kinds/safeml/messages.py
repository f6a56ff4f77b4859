"""ROS messages of SafeML monitors.

``SafeMLOutput`` is frozen: packages made by the tools of SESAME D7.2 use it, and any change of a
field changes the MD5 and cuts them off. Facts that D7.2 does not publish are in a message of
their own. D7.2 itself prints ``oddViolation``: for subscribers of that message there is an option.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from eddi_scaffold.common.claims import (
    Listen,
    Meaning,
    Meanings,
    StatusReading,
    ValidityField,
    Verdict,
    state_of,
)

VIOLATION_FIELD = "violation_field"
"""Key of ``Model:`` in a configuration."""
VIOLATION_FIELDS = ("odd_violation", "oddViolation")

SAFEML_OUTPUT = "bool omission\nbool odd_violation\nfloat32 significance_level\n"

SAFEML_STATUS = """\
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

MESSAGES = {"SafeMLOutput": SAFEML_OUTPUT, "SafeMLStatus": SAFEML_STATUS}
"""ROS message name -> text of its ``.msg`` file."""


def respelt(options: Mapping[str, object]) -> Mapping[str, str]:
    """Return the output as D7.2 prints it, where the options ask for that."""
    usual, printed = VIOLATION_FIELDS
    if options.get(VIOLATION_FIELD) != printed:
        return {}
    return {"SafeMLOutput": SAFEML_OUTPUT.replace(usual, printed)}


WORDS = {
    "empty": "a message has no samples",
    "filling": "the window is not full yet",
    "not_finite": "a sample is not finite",
    "stale": "the last sample is too old",
    "wrong_length": "a sample has the wrong length",
}
"""Reason of an omission -> words; the node's diagnostics add the numbers."""
_DIFFERS = "the samples differ from the reference"


def _said(status: Any) -> StatusReading:
    text = "" if math.isnan(status.statistic) else f"distance {status.statistic:.3g}"
    reason = status.reason if status.omission else "" if status.in_scope else _DIFFERS
    reasons = (WORDS.get(reason, reason),) if reason else ()
    state = state_of(active=status.in_scope, known=not status.omission)
    return StatusReading(
        (Verdict("in_scope", state, reasons, text),), accepted=tuple(status.acceptances)
    )


VERDICTS: dict[str, Listen] = {"SafeMLStatus": _said}


_IN_SCOPE = "`field: in_scope` of SafeMLStatus"
_VERDICT = (("omission", False),)


def _fields(message: str) -> dict[str, Meaning]:
    return {
        "omission": Meaning(
            (True,), refused="an omission is also silence", instead=f"NOT of it, or {_IN_SCOPE}"
        ),
        "odd_violation": Meaning(
            given=(ValidityField(message, "omission", value=False),),
            refused="`odd_violation` has no meaning while there is no verdict",
            instead=f"{_IN_SCOPE}, or `NOT omission` with it",
            known=_VERDICT,
        ),
    }


MEANINGS: Meanings = {
    "SafeMLOutput": _fields("SafeMLOutput"),
    "SafeMLStatus": {
        **_fields("SafeMLStatus"),
        "in_scope": Meaning(
            (False,),
            refused="`in_scope` is false also when there is no verdict",
            instead="`NOT omission AND odd_violation`: known to be a violation",
            known=_VERDICT,
        ),
    },
}
"""Message -> field -> its meaning."""
