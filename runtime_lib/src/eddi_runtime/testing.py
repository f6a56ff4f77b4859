"""Helpers for tests of monitors: a manual clock and inputs without a robot."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Iterable, Iterator, Mapping

from .monitor import Monitor, Output


class FakeClock:
    """A clock in seconds that only moves when it is set: ``clock()`` reads it."""

    def __init__(self, now: float = 0.0) -> None:
        self.now = now

    def __call__(self) -> float:
        """Return the time in seconds."""
        return self.now

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        self.now += seconds


def inputs(monitor: Monitor[Output], values: Mapping[str, object]) -> SimpleNamespace:
    """Return an object with values by input id (else LookupError); the other inputs are None."""
    attributes = {spec.id: spec.attribute for spec in monitor.inputs}
    unknown = [name for name in values if name not in attributes]
    if unknown:
        raise LookupError(f"no input {', '.join(unknown)}; there: {', '.join(attributes)}")
    return SimpleNamespace(
        **{attributes[attribute]: values.get(attribute) for attribute in attributes}
    )


def script(monitor: Monitor[Output], rows: Iterable[Mapping[str, object]]) -> Iterator[Output]:
    """Yield the output of one step for each row of values by input id."""
    for row in rows:
        yield monitor.execute_step(inputs(monitor, row))
