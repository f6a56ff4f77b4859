"""What happens to a deployment, from outside of it. Times are milliseconds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from eddi_scaffold.recordings.node import Message


class Sample(NamedTuple):
    """A message of a source; latched: it came on subscription."""

    t: int
    topic: str
    message: Message
    latched: bool = False


@dataclass(frozen=True)
class History:
    """What happens to a deployment.

    Attributes:
        dead: name, from, to: the process does not run, and begins anew at the end.
        restarts: time, name: it has forgotten everything, also what it had received.
        clock: time, offset: the clock of the steps is set, ages of messages do not change.
        latching: who begins anew receives the last message of each topic whose publisher lives.
    """

    until: int
    samples: tuple[Sample, ...] = ()
    dead: tuple[tuple[str, int, int], ...] = ()
    restarts: tuple[tuple[int, str], ...] = ()
    clock: tuple[tuple[int, int], ...] = ()
    latching: bool = False

    def at(self, t: int) -> Sequence[Sample]:
        """Return the samples of a time."""
        return self._by_time.get(t, ())

    @cached_property
    def _by_time(self) -> Mapping[int, Sequence[Sample]]:
        found: dict[int, list[Sample]] = {}
        for sample in self.samples:
            found.setdefault(sample.t, []).append(sample)
        return found

    def is_dead(self, name: str, t: int) -> bool:
        """Tell whether a process does not run."""
        return any(who == name and begin <= t < end for who, begin, end in self.dead)

    def begins(self, name: str, t: int) -> bool:
        """Tell whether a process begins anew."""
        ends = any(who == name and end == t for who, _, end in self.dead)
        return ends or (t, name) in self.restarts

    def offset(self, t: int) -> int:
        """Return by how much the clock of the steps is off."""
        return sum(by for since, by in self.clock if since <= t)
