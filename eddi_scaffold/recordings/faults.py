"""Faults of what a monitor listens to, put into a recording."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.node import SECOND

_USUAL_DELAY_S = 0.1
_KEPT = frozenset({"header", "stamp", "layout", "message_type"})  # what is no measurement


@dataclass(frozen=True)
class Fault:
    """One fault, as a configuration has it."""

    name: str
    value: float = 0.0  # seconds of a delay, what is added, or the factor

    @property
    def text(self) -> str:
        """How it is written."""
        unit = " s" if self.name == "delay" else ""
        return f"{self.name} {self.value:g}{unit}" if self.value else self.name


def read_fault(text: str) -> Fault:
    """Return a fault of a configuration."""
    name, _, value = text.partition(" ")
    if value:
        unit = 1e-3 if value.endswith("ms") else 1.0
        return Fault(name, float(value.rstrip("ms ")) * unit)
    return Fault(name, _USUAL_DELAY_S if name == "delay" else 0.0)


def without_values(message: Any) -> Any:
    """Return a message in which nothing is known: NaN, or None where no number is."""
    return _changed(message, lambda _: math.nan, None)


def is_number(message: Any) -> bool:
    """Return whether there is a number in a message, which may be biased or scaled."""
    return repr(without_values(message)) != repr(_changed(message, lambda _: None, None))


def _changed(value: Any, change: Callable[[float], object], *other: object) -> Any:
    """Return a value with other numbers, and in place of texts and truth values ``other``."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_changed(item, change, *other) for item in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return change(value)
    if value is None or isinstance(value, bool | str):
        return other[0] if other else value
    message = copy.copy(value)
    for name, part in vars(value).items():
        if name not in _KEPT:
            setattr(message, name, _changed(part, change, *other))
    return message


@dataclass(frozen=True)
class Injection:
    """What happens to some topics, or columns, of a recording."""

    fault: Fault
    topics: Sequence[str]
    since: int  # time of the first message with another value, of drop of the last one
    # topic -> the message that comes from then on, where that is not the recorded one
    bad: Mapping[str, Any]
    onset: int  # time of the first message that comes late or twice

    def into(self, recording: Recording) -> Recording:
        """Return a recording with the fault."""
        samples = [sample for sample in recording.samples if sample.topic not in self.topics]
        for topic in self.topics:
            own = [sample for sample in recording.samples if sample.topic == topic]
            samples += self._received([*self._published(own)])
        return replace(recording, samples=tuple(sorted(samples, key=lambda sample: sample.t)))

    def _published(self, samples: Sequence[Sample]) -> Iterator[Sample]:
        last, value = None, self.fault.value
        changes: dict[str, Callable[[Any], Any]] = {
            "nan": without_values,
            "freeze": lambda _: last,
            "bias": lambda message: _changed(message, lambda number: number + value),
            "scale": lambda message: _changed(message, lambda number: number * value),
        }
        change = changes.get(self.fault.name, lambda message: message)
        for sample in samples:
            if sample.t < self.since:
                last = sample.message
                yield sample
            else:
                message = change(self.bad.get(sample.topic, sample.message))
                yield replace(sample, message=message)

    def _received(self, samples: Sequence[Sample]) -> Iterator[Sample]:
        delay = round(self.fault.value * SECOND) if self.fault.name == "delay" else 0
        for sample in samples:
            yield replace(sample, t=sample.t + delay) if sample.t >= self.onset else sample
        for sample, following in pairwise(samples) if self.fault.name == "duplicate" else ():
            if sample.t >= self.onset:
                yield replace(sample, t=(sample.t + following.t) // 2)
