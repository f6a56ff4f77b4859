"""What the page shows, as texts: of a snapshot, without HTML."""

from __future__ import annotations

import zlib
from collections import Counter
from dataclasses import dataclass

from eddi_scaffold.watch.fleet import Change, MonitorView, RobotView, Snapshot, VerdictView
from eddi_scaffold.watch.text import Clock, because

SHOWN_CHANGES = 50


@dataclass(frozen=True)
class Row:
    """One verdict.

    Attributes:
        id: of its row in the page.
        monitor: its monitor.
        kind: of the monitor.
        name: id of the verdict.
        state: in words.
        why: why it is not active, or further facts.
        since: since when.
    """

    id: str
    monitor: str
    kind: str
    name: str
    state: str
    why: str
    since: str

    @property
    def parts(self) -> tuple[str, str, str]:
        """What may change while the row stays."""
        return self.state, self.why, self.since


@dataclass(frozen=True)
class Group:
    """One robot.

    Attributes:
        id: of its section in the page.
        number: its place.
        name: of the robot.
        summary: how many verdicts are in which state.
        rows: its verdicts.
        facts: lines about its monitors: what is accepted, what nodes report.
        graph: another number when its graph is another one.
    """

    id: str
    number: int
    name: str
    summary: str
    rows: tuple[Row, ...]
    facts: tuple[str, ...]
    graph: int


@dataclass(frozen=True)
class View:
    """The page.

    Attributes:
        time: of the snapshot.
        shape: another number when robots, monitors or verdicts came or went.
        groups: the robots.
        changes: number and line of the last changes, the newest first.
        notes: what else a person should know.
    """

    time: str
    shape: int
    groups: tuple[Group, ...]
    changes: tuple[tuple[int, str], ...]
    notes: tuple[str, ...]


def view_of(snapshot: Snapshot, clock: Clock, notes: tuple[str, ...] = ()) -> View:
    """Return what the page shows of a snapshot.

    Args:
        snapshot: of the fleet.
        clock: writes times.
        notes: of the source.
    """
    groups = tuple(_group(number, robot, clock) for number, robot in enumerate(snapshot.robots))
    names = [(one.name, [(r.monitor, r.kind, r.name) for r in one.rows]) for one in groups]
    changes = tuple(
        (snapshot.changed - k, _change(one, clock))
        for k, one in enumerate(snapshot.changes[:SHOWN_CHANGES])
    )
    return View(
        clock(snapshot.t).strip(), _number(names), groups, changes, (*notes, *snapshot.notes)
    )


def _group(number: int, robot: RobotView, clock: Clock) -> Group:
    rows = tuple(
        _row(f"v{number}-{k}-{n}", monitor, one, clock)
        for k, monitor in enumerate(robot.monitors)
        for n, one in enumerate(monitor.verdicts)
    )
    counted = Counter(one.state for one in rows)
    summary = ", ".join(f"{counted[s]} {s}" for s in ("active", "not active", "unknown"))
    facts = tuple(fact for monitor in robot.monitors for fact in _facts(monitor))
    drawn = [
        (one.name, one.silent, v.id, v.state, v.reasons)
        for one in robot.monitors
        for v in one.verdicts
    ]
    return Group(
        f"r{number}", number, robot.name, summary, rows, facts, _number([robot.name, drawn])
    )


def _row(id_: str, monitor: MonitorView, one: VerdictView, clock: Clock) -> Row:
    reasons = because(one.reasons)
    if one.state != "active" and monitor.report is not None:
        reasons = monitor.report.reasons.get(one.id, reasons)  # the same, with topics and ages
    why = "; ".join(part for part in (reasons, one.text) if part)
    since = clock(one.since).strip()
    return Row(
        id_,
        monitor.name,
        monitor.title,
        one.id,
        one.state,
        why,
        since if one.seen else f"≤ {since}",
    )


def _facts(monitor: MonitorView) -> list[str]:
    found = [f"{monitor.name} accepts {text}" for text in monitor.accepted]
    if monitor.report is not None:
        found.append(f"{monitor.name}: {monitor.report.message}")
    return found


def _change(one: Change, clock: Clock) -> str:
    why = f" ({because(one.reasons)})" if one.reasons else ""
    who = f"{one.robot} {one.monitor} {one.id}"
    return f"{clock(one.t).strip()} {who} is {one.state}{why}"


def _number(value: object) -> int:
    return zlib.crc32(repr(value).encode())
