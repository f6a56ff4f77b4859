"""From a source to what is shown: lines of changes, a page kept new, numbers for other tools."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict

from eddi_runtime.why import TRUE, ClaimWhy

from eddi_scaffold.recordings.results import no_claim
from eddi_scaffold.watch.fleet import Change, FleetState, MonitorView, Snapshot, VerdictView
from eddi_scaffold.watch.messages import Source

Clock = Callable[[float], str]  # seconds of a source -> as a person reads them
WAIT_S = 0.1  # after which silence is looked for
_FIRST_NOTES_S = 1.5
_NOTES = 1000
_LISTEN_S, _LISTEN_LONGEST_S = 3.0, 10.0  # until everybody who tells is known
_SHOW_S = 0.5  # between two views of a page, at least
_ORIGIN_S = time.time() - time.monotonic()
"""Of the monotonic clock, the same for all times, so that no text changes by itself."""


def changes(source: Source, state: FleetState, note: Callable[[str], None]) -> Iterator[Change]:
    """Yield the changes of verdicts until the source ends; note what hinders, each thing once."""
    noted: set[str] = set()

    def note_new() -> None:
        for text in (*source.notes(), *state.notes):
            if text not in noted and len(noted) < _NOTES:
                noted.add(text)
                note(text)

    due = time.monotonic() + _FIRST_NOTES_S
    for _, new in _steps(source, state):
        yield from new
        if time.monotonic() >= due:
            note_new()
    note_new()


def follow(
    source: Source, state: FleetState, show: Callable[[Snapshot, Sequence[str]], None]
) -> None:
    """Show a snapshot, and notes on the source, again and again until it ends."""
    now, due = 0.0, 0.0
    for now, _ in _steps(source, state):
        if time.monotonic() >= due:
            due = time.monotonic() + _SHOW_S
            show(state.snapshot(now), source.notes())
    show(state.snapshot(now), ("The recording has ended.",))


def ask(
    source: Source, state: FleetState, claim: str, note: Callable[[str], None]
) -> dict[str, tuple[float, ClaimWhy]]:
    """Listen until every monitor that has a claim, ``ID`` or ``MONITOR.ID``, has told why it is so.

    Returns:
        Name of a monitor -> when, and why.

    Raises:
        EddiError: none has told it (G008); what hinders is noted.
    """
    began, now = time.monotonic(), 0.0
    views: list[tuple[str, VerdictView]] = []
    meant: dict[str, ClaimWhy | None] = {}
    for now, _ in _steps(source, state):
        passed = time.monotonic() - began
        if passed < _LISTEN_S:
            continue
        views = [
            (f"{robot.name}/{monitor.name}".lstrip("/"), verdict)
            for robot in state.snapshot(now).robots
            for monitor in robot.monitors
            for verdict in monitor.verdicts
        ]
        meant = {name: of.why for name, of in views if claim in (of.id, f"{name}.{of.id}")}
        told = [why for why in meant.values() if why and (why.causes or why.verdict == TRUE)]
        if 0 < len(meant) == len(told) or passed > _LISTEN_LONGEST_S:
            break
    if not any(meant.values()):
        for text in (*source.notes(), *state.notes):
            note(text)
        raise no_claim(claim, {of.id for _, of in views})
    return {name: (now, why) for name, why in meant.items() if why}


def _steps(source: Source, state: FleetState) -> Iterator[tuple[float, list[Change]]]:
    while (received := source.receive(WAIT_S)) is not None:
        now, messages = received
        new = state.look(now - 1e-9 if messages else now)
        for message in messages:
            new += state.take(message)
        yield now, new


def line(change: Change, clock: Clock) -> str:
    """Return a change as a line: when, which robot, monitor and verdict, its state, why."""
    why = f"   {', '.join(change.reasons)}" if change.reasons else ""
    what = f"{change.robot}  {change.monitor}  {change.id}  {change.state}"
    return f"{clock(change.t)}  {what}{why}"


def document(change: Change, clock: Clock) -> dict[str, object]:
    """Return a change for programs."""
    return {**asdict(change), "reasons": list(change.reasons), "time": clock(change.t).strip()}


def time_of_day(t: float) -> str:
    """Return a time of the monotonic clock as the time of day here."""
    at = t + _ORIGIN_S
    return f"{time.strftime('%H:%M:%S', time.localtime(at))}.{int(at * 1000) % 1000:03d}"


CONTENT_TYPE = "application/openmetrics-text; version=1.0.0; charset=utf-8"
STATES = ("active", "not active", "unknown")  # from good to bad
MAX_REASONS = 5  # of one guarantee; the label of all others is `other`
_GUARANTEE = ("robot", "monitor", "guarantee")
_MONITOR = ("robot", "monitor")
_INPUT = ("robot", "monitor", "input")
METRICS: dict[str, tuple[str, tuple[str, ...]]] = {
    "eddi_guarantee_state": ("1 for the state it is in.", (*_GUARANTEE, "state")),
    "eddi_guarantee_state_seconds": ("Since it came into its state.", _GUARANTEE),
    "eddi_guarantee_reason": ("Why it is not active.", (*_GUARANTEE, "reason")),
    "eddi_monitor_silent": ("1 while it sends nothing.", _MONITOR),
    "eddi_monitor_message_age_seconds": ("Since its last message.", _MONITOR),
    "eddi_monitor_longest_step_seconds": ("Of its node so far.", _MONITOR),
    "eddi_monitor_steps_total": ("Steps of its node.", _MONITOR),
    "eddi_monitor_overruns_total": ("Steps left out by its node.", _MONITOR),
    "eddi_input_age_seconds": ("Of its oldest message.", _INPUT),
    "eddi_input_state": ("1 for the state it is in.", (*_INPUT, "state")),
    "eddi_changes_total": ("Changes of guarantees that were seen.", ()),
}
"""Name -> what it is, and its labels; a counter ends in ``_total``."""
Samples = dict[str, dict[tuple[str, ...], float]]
"""Name of a metric -> values of its labels -> number."""


def samples_of(snapshot: Snapshot) -> Samples:
    """Return the metrics of a fleet.

    Monitors of one name on one robot are one here: the worst of them counts.
    """
    samples: Samples = {name: {} for name in METRICS}

    def worst(name: str, value: float, *labels: str) -> None:
        samples[name][labels] = max(value, samples[name].get(labels, value))

    verdicts: dict[tuple[str, ...], tuple[VerdictView, MonitorView]] = {}
    for robot in snapshot.robots:
        for monitor in robot.monitors:
            key = (robot.name, monitor.name)
            for verdict in monitor.verdicts:
                known, _ = verdicts.setdefault((*key, verdict.id), (verdict, monitor))
                if STATES.index(verdict.state) > STATES.index(known.state):
                    verdicts[(*key, verdict.id)] = (verdict, monitor)
            worst("eddi_monitor_silent", float(monitor.silent), *key)
            worst("eddi_monitor_message_age_seconds", snapshot.t - monitor.last, *key)
            report = monitor.report
            if report is None or monitor.silent:
                continue
            worst("eddi_monitor_longest_step_seconds", report.longest_step, *key)
            worst("eddi_monitor_steps_total", report.steps, *key)
            worst("eddi_monitor_overruns_total", report.overruns, *key)
            for entry in report.inputs:
                worst("eddi_input_state", 1.0, *key, entry.id, entry.state)
                if entry.age is not None:
                    age = entry.age + snapshot.t - report.t
                    worst("eddi_input_age_seconds", age, *key, entry.id)
    for labels, (verdict, monitor) in verdicts.items():
        for state in STATES:
            worst("eddi_guarantee_state", float(verdict.state == state), *labels, state)
        worst("eddi_guarantee_state_seconds", snapshot.t - verdict.since, *labels)
        for reason in _reasons(verdict, monitor):
            worst("eddi_guarantee_reason", 1.0, *labels, reason)
    samples["eddi_changes_total"][()] = snapshot.changed
    return samples


def _reasons(verdict: VerdictView, monitor: MonitorView) -> tuple[str, ...]:
    """Return labels, so few that they can be kept: inputs of the model, or words."""
    if verdict.state == "active":
        return ()
    if monitor.silent or any(reason.startswith("no message") for reason in verdict.reasons):
        return ("silent",)
    others = ("other",) if len(verdict.reasons) > MAX_REASONS else ()
    return verdict.reasons[:MAX_REASONS] + others


def metrics_text(snapshot: Snapshot) -> str:
    """Return the metrics of a fleet in the format OpenMetrics."""
    lines = []
    for name, samples in samples_of(snapshot).items():
        text, labels = METRICS[name]
        family = name.removesuffix("_total")
        lines.append(f"# HELP {family} {text}")
        lines.append(f"# TYPE {family} {'gauge' if family == name else 'counter'}")
        for values, number in samples.items():
            pairs = (f'{k}="{_escaped(v)}"' for k, v in zip(labels, values, strict=True))
            lines.append(f"{name}{{{','.join(pairs)}}} {float(number)}")
    return "\n".join([*lines, "# EOF\n"])


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace("\n", r"\n").replace('"', r"\"")
