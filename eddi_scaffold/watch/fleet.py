"""What is known of a fleet now, of the messages that have come. No input, no output, no clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from statistics import median

from eddi_scaffold.common.claims import State, StatusReading, Verdict
from eddi_scaffold.watch.messages import (
    DIAGNOSTICS,
    MAX_MONITORS,
    MAX_REASONS,
    MAX_VERDICTS,
    Message,
    NodeReport,
    base_topic,
    heard,
    is_below,
    plain,
    reports_of,
    robot_of,
)

PATIENCE = 3.0
"""Seconds without a message after which a verdict counts as unknown, at least."""
_MISSED = 3
"""As many usual periods without a message mean silence, where these are longer."""
_GAPS = 5
_CHANGES = 200
_UNREADABLE = (AttributeError, TypeError, ValueError)
"""What a message raises that has the name of ours, and other fields."""


@dataclass(frozen=True)
class VerdictView:
    """One guarantee, threshold or event.

    Attributes:
        id: as in the model.
        state: now; silence makes it unknown.
        reasons: why it is not active.
        text: further facts.
        since: seconds, when it came into this state.
        seen: it was seen to change; else it may have been in this state for longer.
    """

    id: str
    state: State
    reasons: tuple[str, ...]
    text: str
    since: float
    seen: bool


@dataclass(frozen=True)
class MonitorView:
    """One monitor.

    Attributes:
        name: of its model, else of its node, else of its topic.
        title: of its kind.
        topic: of its result.
        node: that publishes it, empty where that is not known.
        digest: of its model, empty where it does not say.
        verdicts: in the order of its messages.
        accepted: what its configuration accepts in place of what is not known.
        last: when its last message came.
        silent: it sends nothing any more.
        report: of its node, ``None`` where none came, or where it is silent.
    """

    name: str
    title: str
    topic: str
    node: str
    digest: str
    verdicts: tuple[VerdictView, ...]
    accepted: tuple[str, ...]
    last: float
    silent: bool
    report: NodeReport | None


@dataclass(frozen=True)
class RobotView:
    """One robot and its monitors, sorted by name."""

    name: str
    monitors: tuple[MonitorView, ...]


@dataclass(frozen=True)
class Change:
    """One verdict in a new state, or of a monitor that fell silent or is back.

    Attributes:
        t: seconds.
        before: the state before, which is the same when the monitor falls silent or is back;
            ``None``: it is seen for the first time.
    """

    t: float
    robot: str
    monitor: str
    id: str
    state: State
    before: State | None
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Snapshot:
    """The fleet at one time.

    Attributes:
        t: seconds.
        robots: sorted by name.
        changes: the last ones, the newest first.
        changed: how many there were in all.
        notes: what else a person should know, as sentences.
    """

    t: float
    robots: tuple[RobotView, ...]
    changes: tuple[Change, ...]
    changed: int
    notes: tuple[str, ...]


@dataclass
class _Stream:
    """The messages of one topic of one monitor."""

    last: float
    begun: bool = False  # a message came that was not kept
    said: StatusReading | None = None  # what the verdicts come from, unless it is silent
    kept: StatusReading | None = None  # a message of unknown age, until the next one comes
    content: object = None  # of the last message
    usual: float = 0.0  # seconds between two messages
    gaps: deque[float] = field(default_factory=lambda: deque(maxlen=_GAPS))
    verdicts: dict[str, VerdictView] = field(default_factory=dict)
    accepted: tuple[str, ...] = ()
    silent: bool = False

    def came(self, t: float) -> None:
        """Note that a message came that was not kept."""
        if self.begun:
            self.gaps.append(max(0.0, t - self.last))
            self.usual = median(self.gaps)
        self.last, self.begun, self.silent, self.kept = t, True, False, None

    def patience(self, least: float) -> float:
        """Return the seconds without a message after which it is silent."""
        return max(least, _MISSED * self.usual)


@dataclass
class _Monitor:
    robot: str
    title: str
    topic: str
    node: str
    model: str = ""
    digest: str = ""
    streams: dict[str, _Stream] = field(default_factory=dict)
    is_alone: bool = True  # the only one of its node: else the node has no name of it

    @property
    def name(self) -> str:
        of_topic = self.topic.strip("/").split("/")[-2:][0]  # cart of /robot1/cart/guarantees
        of_node = self.node.rpartition("/")[2] if self.is_alone else ""
        return self.model or of_node or of_topic

    def again(self, message: Message) -> bool:
        """Take a message that is the same as the last one: the same object; else return False."""
        stream = self.streams.get(message.topic)
        if stream is None or stream.content is not message.content or message.kept:
            return False
        if stream.silent or stream.kept is not None:
            return False
        stream.came(message.t)
        return True

    def verdicts(self) -> Iterator[VerdictView]:
        for _, stream in sorted(self.streams.items()):
            yield from stream.verdicts.values()


class FleetState:
    """Takes messages in the order of their times, and says what is known.

    Args:
        robots: namespace -> name of those that are wanted; empty: all.
        patience: seconds without a message after which a verdict counts as unknown; three usual
            periods of its topic where these are longer.
    """

    def __init__(self, robots: Mapping[str, str] | None = None, patience: float = PATIENCE) -> None:
        self._robots = robots or {}
        self._patience = patience
        self._monitors: dict[tuple[str, str], _Monitor] = {}
        self._reports: dict[str, dict[str, NodeReport]] = {}  # by node and model
        self._reporting = 0
        self._changes: deque[Change] = deque(maxlen=_CHANGES)
        self._notes: dict[str, None] = {}
        self._changed = self._count = 0

    @property
    def has_monitors(self) -> bool:
        """A monitor was heard of."""
        return bool(self._monitors)

    @property
    def notes(self) -> tuple[str, ...]:
        """What else a person should know, as sentences."""
        return tuple(self._notes)

    def take(self, message: Message) -> list[Change]:
        """Take one message; return what changed by it."""
        known = self._monitors.get((base_topic(message.topic), message.node))
        if known is not None and known.again(message):
            return []
        try:
            if message.type == DIAGNOSTICS:
                self._take_reports(message)
                return []
            of = heard().get(message.type)
            if of is None:
                return []
            said = of.listen(message.content)
        except _UNREADABLE:
            self._note(f"{plain(message.topic)}: not a message {message.type} as known here")
            return []
        monitor = self._monitor(message, of.title)
        return [] if monitor is None else self._noted(self._heard(monitor, message, said))

    def look(self, now: float) -> list[Change]:
        """Notice what has been silent for too long; return what changed by it."""
        found: list[Change] = []
        for monitor in self._monitors.values():
            for stream in monitor.streams.values():
                limit = stream.patience(self._patience)
                if not stream.silent and now - stream.last > limit:
                    found += self._silence(monitor, stream, now, limit)
        return self._noted(found)

    def snapshot(self, now: float) -> Snapshot:
        """Return what is known."""
        robots: dict[str, list[MonitorView]] = {}
        for monitor in self._monitors.values():
            robots.setdefault(monitor.robot, []).append(self._view(monitor))
        return Snapshot(
            now,
            tuple(
                RobotView(name, tuple(sorted(found, key=lambda one: (one.name, one.topic))))
                for name, found in sorted(robots.items())
            ),
            tuple(reversed(self._changes)),
            self._changed,
            self.notes,
        )

    def _take_reports(self, message: Message) -> None:
        for report in reports_of(message.content, message.t):
            if report.model not in self._reports.get(report.node, {}):
                if self._reporting >= MAX_MONITORS:
                    continue
                self._reporting += 1
            self._reports.setdefault(report.node, {})[report.model] = report

    def _monitor(self, message: Message, title: str) -> _Monitor | None:
        """Return the monitor of a message; ``None``: of a robot that nobody asked for."""
        topic = base_topic(message.topic)
        key = (topic, message.node)
        if key in self._monitors:
            return self._monitors[key]
        robot = robot_of(message.topic, message.node, self._robots)
        if robot is None:
            return None
        if len(self._monitors) >= MAX_MONITORS and not self._forget():
            self._note(f"only the first {MAX_MONITORS} monitors are shown")
            return None
        made = _Monitor(plain(robot), title, plain(topic), plain(message.node))
        for other in self._monitors.values() if made.node else ():
            if other.node == made.node:
                made.is_alone = other.is_alone = False
        self._monitors[key] = made
        return made

    def _forget(self) -> bool:
        """Drop the monitor that has been silent for longest; return False when none is silent."""
        silent = [
            (max(stream.last for stream in monitor.streams.values()), key)
            for key, monitor in self._monitors.items()
            if monitor.streams and all(stream.silent for stream in monitor.streams.values())
        ]
        if not silent:
            return False
        gone = self._monitors.pop(min(silent)[1])
        self._count -= sum(len(stream.verdicts) for stream in gone.streams.values())
        return True

    def _heard(self, monitor: _Monitor, message: Message, said: StatusReading) -> Iterable[Change]:
        stream = monitor.streams.get(message.topic)
        if stream is None:
            stream = monitor.streams[message.topic] = _Stream(message.t)
        if message.kept:  # it prolongs nothing
            stream.kept = said
            return []
        back = stream.silent
        stream.came(message.t)
        stream.content = message.content
        if said.whole and said == stream.said:
            return []
        stream.said = said
        monitor.model = plain(said.model) or monitor.model
        monitor.digest = plain(said.digest) or monitor.digest
        stream.accepted = tuple(plain(one) for one in said.accepted[:MAX_REASONS])
        return list(self._told(monitor, stream, said, message.t, back=back))

    def _told(
        self,
        monitor: _Monitor,
        stream: _Stream,
        said: StatusReading,
        t: float,
        *,
        back: bool = False,
    ) -> Iterator[Change]:
        """Take what was said; every verdict is told of a monitor that is back after silence."""
        told: dict[str, VerdictView] = {} if said.whole else stream.verdicts
        for verdict in said.verdicts:
            id_ = plain(verdict.id)
            before = stream.verdicts.get(id_)
            if before is None and self._count >= MAX_VERDICTS:
                self._note(f"only the first {MAX_VERDICTS} verdicts are shown")
                continue
            now = _next(before, id_, verdict, t)
            self._count += id_ not in stream.verdicts
            told[id_] = now
            if before is None or before.state != now.state or back:
                was = None if before is None else before.state
                yield _change(monitor, now, was, t)
        if said.whole:
            self._count -= len(stream.verdicts.keys() - told.keys())
            stream.verdicts = told

    def _silence(
        self, monitor: _Monitor, stream: _Stream, now: float, limit: float
    ) -> Iterator[Change]:
        stream.silent, stream.said = True, None
        reason = f"no message for more than {limit:.3g} s"
        if stream.kept is not None:
            said, stream.kept = stream.kept, None
            monitor.model = monitor.model or plain(said.model)
            reason = f"its last message is of unknown age, {reason}"
            unknown = tuple(
                replace(verdict, state="unknown", reasons=()) for verdict in said.verdicts
            )
            told = replace(said, verdicts=unknown, whole=False)
            for change in self._told(monitor, stream, told, now):
                yield replace(change, reasons=(reason,))
        for id_, verdict in stream.verdicts.items():
            since = verdict.since if verdict.state == "unknown" else now
            seen = verdict.seen if verdict.state == "unknown" else True
            new = VerdictView(id_, "unknown", (reason,), verdict.text, since, seen)
            stream.verdicts[id_] = new
            if verdict.since != now or verdict.state != "unknown":  # else it was told just now
                yield _change(monitor, new, verdict.state, now)

    def _view(self, one: _Monitor) -> MonitorView:
        accepted = dict.fromkeys(a for stream in one.streams.values() for a in stream.accepted)
        silent = all(stream.silent for stream in one.streams.values())
        return MonitorView(
            one.name,
            one.title,
            one.topic,
            one.node,
            one.digest,
            tuple(one.verdicts()),
            tuple(accepted),
            max(stream.last for stream in one.streams.values()),
            silent,
            None if silent else self._report_of(one),
        )

    def _report_of(self, one: _Monitor) -> NodeReport | None:
        """Return the report of a monitor's node: by its name, else by its model on that robot."""
        of_node = self._reports.get(one.node)
        if of_node is not None:  # one process may run several
            is_only = one.is_alone and len(of_node) == 1
            return of_node.get(one.name, *of_node.values()) if is_only else of_node.get(one.name)
        spaces = {space for space, name in self._robots.items() if name == one.robot} or {one.robot}
        fitting = [
            report
            for of_node in self._reports.values()
            for report in of_node.values()
            if report.model in (one.model, one.node.rpartition("/")[2] or one.model)
            and any(is_below(report.node, space) for space in spaces)
        ]
        return fitting[0] if len(fitting) == 1 else None

    def _noted(self, changes: Iterable[Change]) -> list[Change]:
        found = list(changes)
        self._changes.extend(found)
        self._changed += len(found)
        return found

    def _note(self, text: str) -> None:
        if len(self._notes) < MAX_REASONS:
            self._notes[text] = None


def _next(before: VerdictView | None, id_: str, one: Verdict, t: float) -> VerdictView:
    same = before is not None and before.state == one.state
    since = before.since if before is not None and same else t
    seen = before is not None and (before.seen or not same)
    reasons = tuple(plain(reason) for reason in one.reasons[:MAX_REASONS])
    return VerdictView(id_, one.state, reasons, plain(one.text), since, seen)


def _change(monitor: _Monitor, one: VerdictView, before: State | None, t: float) -> Change:
    return Change(t, monitor.robot, monitor.name, one.id, one.state, before, one.reasons)
