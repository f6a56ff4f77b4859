"""The view as numbers for other tools (OpenMetrics)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.openmetrics.exposition import CONTENT_TYPE_LATEST, generate_latest

from eddi_scaffold.watch.fleet import MonitorView, Snapshot, VerdictView

STATES = ("active", "not active", "unknown")
"""From good to bad."""
MAX_REASONS = 5
"""Of one guarantee; the label of all others is ``other``."""
SILENT, OTHER = "silent", "other"

Labels = tuple[str, ...]


@dataclass
class Family:
    """One metric.

    Attributes:
        name: without ``_total``.
        type: of it.
        help: what it is, in a line.
        labels: their names.
        samples: values of the labels -> number.
    """

    name: str
    type: Literal["gauge", "counter"]
    help: str
    labels: tuple[str, ...]
    samples: dict[Labels, float] = field(default_factory=dict)


def families(snapshot: Snapshot) -> Iterator[Family]:
    """Yield the metrics of a fleet.

    Monitors of one name on one robot are one here: the worst of them counts.
    """
    monitors = [(robot.name, monitor) for robot in snapshot.robots for monitor in robot.monitors]
    yield from _guarantees(snapshot.t, monitors)
    yield from _monitors(snapshot.t, monitors)
    yield from _inputs(snapshot.t, monitors)
    changes = Family("eddi_changes", "counter", "Changes of guarantees that were seen.", ())
    changes.samples[()] = snapshot.changed
    yield changes


_Monitors = list[tuple[str, MonitorView]]


def _guarantees(now: float, monitors: _Monitors) -> Iterator[Family]:
    names = ("robot", "monitor", "guarantee")
    worst: dict[Labels, tuple[VerdictView, bool]] = {}
    labels: Labels
    for robot, monitor in monitors:
        for one in monitor.verdicts:
            labels = (robot, monitor.name, one.id)
            before = worst.get(labels)
            if before is None or STATES.index(one.state) > STATES.index(before[0].state):
                worst[labels] = (one, monitor.silent)
    state = Family("eddi_guarantee_state", "gauge", "1 for the state it is in.", (*names, "state"))
    age = Family("eddi_guarantee_state_seconds", "gauge", "Since it came into its state.", names)
    reason = Family("eddi_guarantee_reason", "gauge", "Why it is not active.", (*names, "reason"))
    for labels, (one, silent) in worst.items():
        for name in STATES:
            state.samples[(*labels, name)] = float(one.state == name)
        age.samples[labels] = now - one.since
        for text in _reasons(one, silent=silent):
            reason.samples[(*labels, text)] = 1.0
    yield from (state, age, reason)


def _reasons(one: VerdictView, *, silent: bool) -> Iterator[str]:
    """Yield labels, so few that they can be kept: inputs of the model, or words."""
    if one.state == "active":
        return
    if silent or any(reason.startswith("no message") for reason in one.reasons):
        yield SILENT
        return
    yield from one.reasons[:MAX_REASONS]
    if len(one.reasons) > MAX_REASONS:
        yield OTHER


def _monitors(now: float, monitors: _Monitors) -> Iterator[Family]:
    names = ("robot", "monitor")
    silent = Family("eddi_monitor_silent", "gauge", "1 while it sends nothing.", names)
    age = Family("eddi_monitor_message_age_seconds", "gauge", "Since its last message.", names)
    longest = Family("eddi_monitor_longest_step_seconds", "gauge", "Of its node so far.", names)
    steps = Family("eddi_monitor_steps", "counter", "Steps of its node.", names)
    overruns = Family("eddi_monitor_overruns", "counter", "Steps left out by its node.", names)
    for robot, monitor in monitors:
        labels = (robot, monitor.name)
        _worst(silent, labels, float(monitor.silent))
        _worst(age, labels, now - monitor.last)
        if monitor.report is not None:
            _worst(longest, labels, monitor.report.longest_step)
            _worst(steps, labels, monitor.report.steps)
            _worst(overruns, labels, monitor.report.overruns)
    yield from (silent, age, longest, steps, overruns)


def _inputs(now: float, monitors: _Monitors) -> Iterator[Family]:
    names = ("robot", "monitor", "input")
    age = Family("eddi_input_age_seconds", "gauge", "Of its oldest message.", names)
    state = Family("eddi_input_state", "gauge", "1 for the state it is in.", (*names, "state"))
    for robot, monitor in monitors:
        for one in monitor.report.inputs if monitor.report is not None else ():
            labels = (robot, monitor.name, one.id)
            if one.age is not None and monitor.report is not None:
                _worst(age, labels, one.age + now - monitor.report.t)
            state.samples[(*labels, one.state)] = 1.0
    yield from (age, state)


def _worst(family: Family, labels: Labels, value: float) -> None:
    family.samples[labels] = max(value, family.samples.get(labels, value))


CONTENT_TYPE: str = CONTENT_TYPE_LATEST


class _Collected:
    """What the library calls a registry."""

    def __init__(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot

    def collect(self) -> Iterator[Any]:
        for family in families(self._snapshot):
            made = CounterMetricFamily if family.type == "counter" else GaugeMetricFamily
            found: Any = made(family.name, family.help, labels=family.labels)
            for labels, value in family.samples.items():
                found.add_metric(labels, value)
            yield found


def exposed(snapshot: Snapshot) -> bytes:
    """Return the metrics of a fleet in the format OpenMetrics."""
    text: bytes = generate_latest(_Collected(snapshot))
    return text
