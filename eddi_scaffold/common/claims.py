"""What a monitor claims, which values bring a claim nearer, and what its messages say.

A claim asserts something good: an active guarantee, a threshold that is kept, a hazard that is
known to be absent. Silence must never bring a claim nearer: neither the silence of a sensor, nor
that of the sensors behind another monitor, which continues to publish. The terms here are shared by
the kinds, which know what their messages mean, and by the check of the wiring between them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Holds = Callable[[object], bool]  # a test of one value


@dataclass(frozen=True)
class Use:
    """One way in which the value of an input can bring a claim nearer."""

    holds: Holds = lambda _: True  # value -> whether it does; every one, if nothing more is known
    # ids of further inputs, each with a test that holds as well whenever the claim is made this way
    # (`valid` with `p_fail < 0.1` in `valid AND p_fail < 0.1`)
    companions: tuple[tuple[str, Holds], ...] = ()


@dataclass(frozen=True)
class ValidityField:
    """A field that indicates whether another one has a meaning."""

    message: str  # name of the message that has the field
    field: str  # its name
    value: bool  # what it must be


@dataclass(frozen=True)
class Meaning:
    """What a field of a monitor's message expresses about what is known."""

    # values that it may have while nothing is known; `None`: any
    silent: tuple[object, ...] | None = None
    # the field has a meaning where all of these have one, whatever `silent` is
    valid_where: tuple[ValidityField, ...] = ()
    # why a use is refused that a silent value satisfies; no full stop
    refused: str = "it does not show whether anything is known"
    # the line to write in its place; `{field}` stands for the field itself
    instead: str | None = None
    # the value by which a hazard is known to be there, and that by which it is absent
    bad: tuple[object, object] | None = None
    # values that are no silence; a tuple is another field and those values of it by which any value
    # here is known: of the message, or with a dot before it, of the same element. For whoever reads
    # it, all others are UNKNOWN. Of a Boolean, the opposite of `silent` is among them; empty: every
    # value counts
    known: tuple[bool | int | tuple[bool | int | str, ...], ...] = ()


@dataclass(frozen=True)
class Claim:
    """One thing that a monitor claims."""

    id: str  # as it is in messages; empty for the whole result of a kind that names none
    rests_on: frozenset[str]  # ids of the inputs without which it is not made
    hold_s: float = 0.0  # seconds for which it may outlive its inputs, by what its options accept
    polarity: str = ""  # of an event, `EVIDENCE` or `HAZARD`; empty for others
    gates: tuple[str, ...] = ()  # of the model, between its inputs and it
    # inputs that it may outlive for longer: by windows, by what their keys accept; `None` for ever
    holds: tuple[tuple[str, float | None], ...] = ()

    def held_s(self, input_: str) -> float:
        """Return for how many seconds it may outlive an input, beyond ``hold_s``."""
        return sum(math.inf if s is None else s for name, s in self.holds if name == input_)


def held(seconds: Iterable[tuple[str, float]]) -> tuple[tuple[str, float | None], ...]:
    """Return input and seconds as the ``holds`` of a claim, without those that are zero."""
    return tuple((id_, None if math.isinf(s) else s) for id_, s in seconds if s)


@dataclass(frozen=True)
class Acceptance:
    """Less than "active for every value that may be" that a key of its own accepts."""

    key: str  # with its value, as a person finds it (`missing: prior`)
    accepts: str  # what counts in place of what is not known, a noun
    lasts: str = "for ever"  # for how long, for people
    seconds: float | None = None  # the same as a number, `None` where there is no end
    input: str = ""  # on which it is, empty for all
    path: tuple[str | int, ...] = ()  # its place in the configuration: keys from the top
    at: tuple[int, int] | None = None  # line and column of it in the model
    # claims of the monitor that rest on it; `None`: all that rest on the input
    outputs: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Element:
    """An element of the model that can be traced."""

    element: str  # what it is (`guarantee`, `node`)
    id: str  # as in the model
    claim: str | None = None  # its id in messages, where that is another one
    line: int | None = None  # of the model file
    path: str | None = None  # EMF fragment path in an EDDI
    sha256: str | None = None  # of one that is a file of its own


Meanings = Mapping[str, Mapping[str, Meaning]]
"""Message name -> field (``guarantees[].active``) -> what it means."""


State = Literal["active", "not active", "unknown"]


@dataclass(frozen=True)
class Verdict:
    """One guarantee, threshold or event in one message."""

    id: str  # as in the model
    state: State  # active and nothing else is good; of a hazard, that it may be there
    reasons: tuple[str, ...] = ()  # why it is not active: ids of inputs, or words
    text: str = ""  # further facts in a few words, such as a number


@dataclass(frozen=True)
class StatusReading:
    """What one message says."""

    verdicts: tuple[Verdict, ...]  # in the order of the model
    model: str = ""  # id of the model, empty where the message has none
    digest: str = ""  # of the model, empty where the message has none
    accepted: tuple[str, ...] = ()  # what the configuration accepts in place of what is not known
    # these are all verdicts of its topic; else others came in messages of their own
    is_complete: bool = True
    situation: str = ""  # of the system, in a few words


Listen = Callable[[Any], StatusReading]  # a message, with its fields as attributes -> what it says


def state_of(*, active: bool, known: bool = True) -> State:
    """Return the state of something that is active, or known not to be, or neither."""
    if active:
        return "active"
    return "not active" if known else "unknown"
