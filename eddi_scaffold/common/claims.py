"""What a monitor claims, which values bring a claim nearer, and what its messages say.

A claim asserts something good: an active guarantee, a threshold that is kept, a hazard that is
known to be absent. Silence must never bring a claim nearer: neither the silence of a sensor, nor
that of the sensors behind another monitor, which continues to publish. The terms here are shared by
the kinds, which know what their messages mean, and by the check of the wiring between them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Holds = Callable[[object], bool]
"""A test of one value."""


def any_value(_: object) -> bool:
    """Hold for every value: the test of a use that nothing more is known of."""
    return True


@dataclass(frozen=True)
class Use:
    """One way in which the value of an input can bring a claim nearer.

    Attributes:
        holds: value -> whether it does.
        beside: ids of further inputs, each with a test that holds as well whenever the claim is
            made this way (``valid`` with ``p_fail < 0.1`` in ``valid AND p_fail < 0.1``).
    """

    holds: Holds = any_value
    beside: tuple[tuple[str, Holds], ...] = ()


@dataclass(frozen=True)
class ValidityField:
    """A field that indicates whether another one has a meaning.

    Attributes:
        message: name of the message that has the field.
        field: its name.
        value: what it must be.
    """

    message: str
    field: str
    value: bool


@dataclass(frozen=True)
class Meaning:
    """What a field of a monitor's message expresses about what is known.

    Attributes:
        silent: values that it may have while nothing is known; ``None``: any.
        given: the field has a meaning where all of these have one, whatever ``silent`` is.
        refused: why a use is refused that a silent value satisfies; no full stop.
        instead: the line to write in its place; ``{field}`` stands for the field itself.
        bad: the value by which a hazard is known to be there, and that by which it is absent.
        known: values that are no silence; a tuple is another field and those values of it by which
            any value here is known: of the message, or with a dot before it, of the same element.
            For whoever reads it, all others are UNKNOWN. Of a Boolean, the opposite of ``silent``
            is among them; empty: every value counts.
    """

    silent: tuple[object, ...] | None = None
    given: tuple[ValidityField, ...] = ()
    refused: str = "it does not show whether anything is known"
    instead: str | None = None
    bad: tuple[object, object] | None = None
    known: tuple[bool | int | tuple[bool | int | str, ...], ...] = ()


@dataclass(frozen=True)
class Claim:
    """One thing that a monitor claims.

    Attributes:
        id: as it is in messages; empty for the whole result of a kind that names none.
        rests_on: ids of the inputs without which it is not made.
        hold_s: seconds for which it may outlive its inputs, by what its options accept.
        polarity: of an event, ``EVIDENCE`` or ``HAZARD``; empty for others.
    """

    id: str
    rests_on: frozenset[str]
    hold_s: float = 0.0
    polarity: str = ""


@dataclass(frozen=True)
class Acceptance:
    """Less than "active for every value that may be" that a key of its own accepts.

    Attributes:
        key: with its value, as a person finds it (``missing: prior``).
        accepts: what counts in place of what is not known, a noun.
        lasts: for how long, for people.
        seconds: the same as a number, ``None`` where there is no end.
        input: on which it is, empty for all.
        path: its place in the configuration: keys from the top.
        at: line and column of it in the model.
        outputs: claims of the monitor that rest on it; ``None``: all that rest on the input.
    """

    key: str
    accepts: str
    lasts: str = "for ever"
    seconds: float | None = None
    input: str = ""
    path: tuple[str | int, ...] = ()
    at: tuple[int, int] | None = None
    outputs: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Element:
    """An element of the model that can be traced.

    Attributes:
        element: what it is (``guarantee``, ``node``).
        id: as in the model.
        claim: its id in messages, where that is another one.
        line: of the model file.
        path: EMF fragment path in an EDDI.
        sha256: of one that is a file of its own.
    """

    element: str
    id: str
    claim: str | None = None
    line: int | None = None
    path: str | None = None
    sha256: str | None = None


Meanings = Mapping[str, Mapping[str, Meaning]]
"""Message name -> field (``guarantees[].active``) -> what it means."""


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
class StatusReading:
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


Listen = Callable[[Any], StatusReading]
"""A message, with its fields as attributes -> what it says."""


def state_of(*, active: bool, known: bool = True) -> State:
    """Return the state of something that is active, or known not to be, or neither."""
    if active:
        return "active"
    return "not active" if known else "unknown"
