"""What the messages of a monitor say, for who only looks on: each verdict, and why it is none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

State = Literal["active", "not active", "unknown"]


@dataclass(frozen=True)
class Verdict:
    """One guarantee, threshold or event in one message.

    Attributes:
        id: as in the model.
        state: active and nothing else is good; of a hazard, that it may be there.
        reasons: why it is not active: ids of inputs, or words.
        text: further facts in a few words, such as a number.
    """

    id: str
    state: State
    reasons: tuple[str, ...] = ()
    text: str = ""


@dataclass(frozen=True)
class Said:
    """What one message says.

    Attributes:
        verdicts: in the order of the model.
        model: id of the model, empty where the message has none.
        digest: of the model, empty where the message has none.
        accepted: what the configuration accepts in place of what is not known.
        whole: these are all verdicts of its topic; else others came in messages of their own.
    """

    verdicts: tuple[Verdict, ...]
    model: str = ""
    digest: str = ""
    accepted: tuple[str, ...] = ()
    whole: bool = True


Listen = Callable[[Any], Said]
"""A message, with its fields as attributes -> what it says."""


def state_of(*, active: bool, known: bool = True) -> State:
    """Return the state of something that is active, or known not to be, or neither."""
    if active:
        return "active"
    return "not active" if known else "unknown"
