"""Why a threshold of a network is not active, in words for people."""

from __future__ import annotations

import math
from typing import Dict, List, Sequence, Tuple

from ..monitor import Standing
from .claims import ERROR, HOLD, INCONSISTENT, NO_TIME, UNKNOWN, Claim
from .knowledge import Facts

_REASONS = {
    ERROR: "a hand-written method failed",
    HOLD: "it holds, but not for long enough yet",
    INCONSISTENT: "the evidence has probability zero",
    NO_TIME: "the step has no time",
}


def standings(claims: Sequence[Claim], facts: Facts) -> List[Standing]:
    """Return every threshold of the last step.

    Args:
        claims: of the thresholds.
        facts: what was known of the inputs.
    """
    return [Standing("threshold", one.id, one.active, *_why(one, facts)) for one in claims]


def _why(one: Claim, facts: Facts) -> Tuple[Tuple[Tuple[str, str], ...], str]:
    if one.active:
        return (), ""
    if one.reason in UNKNOWN:
        return tuple(_lacks(facts).items()), "" if _lacks(facts) else one.reason
    if one.reason:
        return (), _REASONS[one.reason]
    if math.isnan(one.low):
        return (), ""
    bounds = f"{one.low:.4g}" if one.low == one.high else f"{one.low:.4g} to {one.high:.4g}"
    return (), f"the probability is {bounds}"


def _lacks(facts: Facts) -> Dict[str, str]:
    """Return input or node -> why its state is not known and not accepted either."""
    accepted = {text.partition(": ")[0] for text in facts.accepted}
    found = {name: "not known" for name in facts.unknown_inputs if name not in accepted}
    for node, states in facts.undecided.items():
        found[node] = f"may be {' or '.join(states)} after a gap"
    return found
