"""The messages that are watched: those that monitors publish about themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Protocol

from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.verdicts import Listen

DIAGNOSTICS = "diagnostic_msgs/DiagnosticArray"
DIAGNOSTICS_TOPIC = "/diagnostics"
GATHER_S = 0.03
"""Seconds in which messages are gathered once one has come: to wake up for each costs more than to
read it."""


@dataclass(frozen=True)
class Message:
    """One message as it was received.

    Attributes:
        topic: its full name.
        type: ``package/Name``.
        content: its fields as attributes, under the names of the ``.msg`` file.
        t: seconds on the clock of the receiver.
        node: full name of the node that published it, empty where that is not known.
        kept: the publisher had kept it for who comes later: it may be of any age.
    """

    topic: str
    type: str
    content: Any
    t: float
    node: str = ""
    kept: bool = False


class Source(Protocol):
    """Where messages come from."""

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]] | None:
        """Wait for messages, and return the time and what came; ``None``: there is no more.

        Args:
            seconds: to wait at most when there are none.
        """

    def notes(self) -> Sequence[str]:
        """Return what hinders the source now, as sentences."""

    def close(self) -> None:
        """End it."""


@dataclass(frozen=True)
class Heard:
    """How messages of one type are understood.

    Attributes:
        title: of the kind of monitor.
        listen: what a message says.
    """

    title: str
    listen: Listen


@cache
def heard() -> Mapping[str, Heard]:
    """Return type of message -> how it is understood, for every kind."""
    return {
        f"{MESSAGE_PACKAGE}/{name}": Heard(kind.title, listen)
        for kind in kinds().values()
        for name, listen in kind.verdicts.items()
    }


def is_watched(topic: str, type_: str) -> bool:
    """Return whether messages of a topic are read."""
    return type_ in heard() or (type_ == DIAGNOSTICS and topic == DIAGNOSTICS_TOPIC)
