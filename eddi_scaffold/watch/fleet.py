"""What is known of a fleet now, from the messages that came. No input, no output, no clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from statistics import median
from typing import NamedTuple

from eddi_runtime.why import FALSE, MOST_AGE_S, TRUE, UNKNOWN, ClaimWhy, Why, read_why

from eddi_scaffold.common.claims import State, StatusReading, Verdict
from eddi_scaffold.kinds import WHY
from eddi_scaffold.watch.messages import (
    DIAGNOSTICS,
    DIAGNOSTICS_TOPIC,
    MAX_MONITORS,
    MAX_REASONS,
    MAX_VERDICTS,
    Message,
    NodeReport,
    base_topic,
    is_below,
    plain,
    reports_of,
    robot_of,
    status_messages,
)

PATIENCE_S = 3.0  # without a message, after which a verdict counts as unknown, at least
_MISSED = 3  # as many usual periods without a message mean silence, where these are longer
_GAPS = 5
_CHANGES = 200

_HOLDS: Mapping[int, State] = {FALSE: "not active", UNKNOWN: "unknown", TRUE: "active"}
_HAZARDS: Mapping[State, str] = {"active": "absent", "not active": "present"}


@dataclass(frozen=True)
class VerdictView(Verdict):
    """One guarantee, threshold or event now; silence makes it unknown."""

    since: float = 0.0  # seconds, when it came into this state
    seen: bool = False  # it was seen to change; else it may have been in this state for longer
    why: ClaimWhy | None = None  # as its monitor told it last, after it came into this state

    @property
    def good(self) -> State:
        """Whether the claim holds; of a hazard, whether its absence does."""
        return self.state if self.why is None else _HOLDS[self.why.verdict]

    @property
    def word(self) -> str:
        """Its state in a word; a hazard is present or absent."""
        is_hazard = {self.state, self.good} == {"active", "not active"}
        return (_HAZARDS if is_hazard else {}).get(self.good, self.good)


@dataclass(frozen=True)
class MonitorView:
    """One monitor."""

    name: str  # of its model, else of its node, else of its topic
    title: str  # of its kind
    topic: str  # of its result
    node: str  # that publishes it, empty where that is not known
    verdicts: tuple[VerdictView, ...]  # in the order of its messages
    accepted: tuple[str, ...]  # what its configuration accepts in place of what is not known
    last: float  # when its last message came
    silent: bool  # it sends nothing any more
    report: NodeReport | None  # the last one of its node
    situation: str = ""  # of the system, empty where it tells none


@dataclass(frozen=True)
class RobotView:
    """One robot and its monitors, sorted by name."""

    name: str
    monitors: tuple[MonitorView, ...]


@dataclass(frozen=True)
class Change:
    """One verdict in a new state, or of a monitor that fell silent or is back."""

    t: float  # seconds
    robot: str
    monitor: str
    id: str
    state: State
    # the state before, which is the same when the monitor falls silent or is back; `None`: it is
    # seen for the first time
    before: State | None
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Snapshot:
    """The fleet at one time."""

    t: float  # seconds
    robots: tuple[RobotView, ...]  # sorted by name
    changes: tuple[Change, ...]  # the last ones, the newest first
    changed: int  # how many there were in all
    notes: tuple[str, ...]  # what else a person should know, as sentences


@dataclass
class _Stream:
    """The messages of one topic of one monitor."""

    last: float
    begun: bool = False  # a message came that was not kept
    reading: StatusReading | None = None  # what the verdicts come from, unless it is silent
    kept: StatusReading | None = None  # of a message of unknown age, until the next one comes
    usual: float = 0.0  # seconds between two messages
    gaps: deque[float] = field(default_factory=lambda: deque(maxlen=_GAPS))
    verdicts: dict[str, VerdictView] = field(default_factory=dict)
    accepted: tuple[str, ...] = ()
    situation: str = ""
    silent: bool = False

    def receive(self, t: float) -> None:
        """Note that a message came that was not kept."""
        if self.begun:
            self.gaps.append(max(0.0, t - self.last))
            self.usual = median(self.gaps)
        self.last, self.begun, self.silent, self.kept = t, True, False, None


@dataclass
class _Monitor:
    robot: str
    title: str
    topic: str
    node: str
    model: str = ""
    streams: dict[str, _Stream] = field(default_factory=dict)
    is_alone: bool = True  # the only one of its node: else the node has no name of it

    @property
    def name(self) -> str:
        of_topic = self.topic.strip("/").split("/")[-2:][0]  # cart of /robot1/cart/guarantees
        of_node = self.node.rpartition("/")[2] if self.is_alone else ""
        return self.model or of_node or of_topic

    @property
    def is_silent(self) -> bool:
        return all(stream.silent for stream in self.streams.values())

    @property
    def last(self) -> float:
        return max(stream.last for stream in self.streams.values())

    def change(self, verdict: VerdictView, before: State | None, t: float) -> Change:
        return Change(t, self.robot, self.name, verdict.id, verdict.state, before, verdict.reasons)

    def view(self, report: NodeReport | None, told: _Told, now: float) -> MonitorView:
        streams = [stream for _, stream in sorted(self.streams.items())]
        return MonitorView(
            self.name,
            self.title,
            self.topic,
            self.node,
            tuple(told.of(v, now) for stream in streams for v in stream.verdicts.values()),
            tuple(dict.fromkeys(text for stream in streams for text in stream.accepted)),
            self.last,
            self.is_silent,
            report,
            " ".join(stream.situation for stream in streams if not stream.silent),
        )


class _Told(NamedTuple):
    """What a monitor told last of why its claims are as they are."""

    t: float  # seconds, when
    whys: Why

    def of(self, verdict: VerdictView, now: float) -> VerdictView:
        """Return a verdict with it, unless it is of before, or of a monitor that fell silent."""
        why = self.whys.get(verdict.id) or self.whys.get(verdict.id.removeprefix("not "))
        if why is None or (verdict.seen and self.t < verdict.since):
            return verdict
        is_old = now - self.t > MOST_AGE_S
        causes = () if is_old else tuple(cause.later(now - self.t) for cause in why.causes)
        return replace(verdict, why=why._replace(causes=causes))


_NOTHING_TOLD = _Told(0.0, {})


def _first(why: ClaimWhy | None) -> object:
    return [(cause.path, cause.state) for cause in (why.causes[:1] if why is not None else ())]


class FleetState:
    """Takes messages in the order of their times, and tells what is known.

    Args:
        robots: namespace -> name of those that are requested; empty: all.
        patience_s: seconds without a message after which a verdict counts as unknown; three usual
            periods of its topic where these are longer.
    """

    def __init__(
        self, robots: Mapping[str, str] | None = None, patience_s: float = PATIENCE_S
    ) -> None:
        self._robots = robots or {}
        self._patience_s = patience_s
        self._monitors: dict[tuple[str, str], _Monitor] = {}
        self._reports: dict[str, dict[str, NodeReport]] = {}  # by node and model
        self._changes: deque[Change] = deque(maxlen=_CHANGES)
        self._notes: dict[str, None] = {}
        self._told: dict[tuple[str, str], _Told] = {}  # by topic and node
        self._changed = self._verdicts = 0

    @property
    def notes(self) -> tuple[str, ...]:
        """What else a person should know, as sentences."""
        return (*self._notes, *(() if self._monitors else ("no monitor has been heard of yet",)))

    def take(self, message: Message) -> list[Change]:
        """Take one message; return what changed by it."""
        try:
            if message.type == DIAGNOSTICS:
                prefix = message.topic.removesuffix(DIAGNOSTICS_TOPIC)
                for report in reports_of(message.content, message.t, prefix):
                    self._take_report(report)
            if message.type == WHY:
                return self._take_why(message)
            if message.type not in status_messages():
                return []
            title, listen = status_messages()[message.type]
            reading = listen(message.content)
        except (AttributeError, TypeError, ValueError):  # the name of ours, and other fields
            self._note(f"{plain(message.topic)}: not a message {message.type} as known here")
            return []
        key = base_topic(message.topic), message.node
        monitor = self._monitors.get(key) or self._new_monitor(message, title)
        if monitor is None:
            return []
        stream = monitor.streams.setdefault(message.topic, _Stream(message.t))
        if message.kept:  # it prolongs nothing
            stream.kept = reading
            return []
        was_silent = stream.silent
        stream.receive(message.t)
        if reading.is_complete and reading == stream.reading:
            return []
        stream.reading = reading
        monitor.model = plain(reading.model) or monitor.model
        stream.accepted = tuple(plain(text) for text in reading.accepted[:MAX_REASONS])
        stream.situation = plain(reading.situation)
        changes = self._changes_by(monitor, stream, reading, message.t, is_back=was_silent)
        return self._remember(list(changes))

    def look(self, now: float) -> list[Change]:
        """Notice what has been silent for too long; return what changed by it."""
        changes: list[Change] = []
        for monitor in self._monitors.values():
            for stream in monitor.streams.values():
                limit = max(self._patience_s, _MISSED * stream.usual)
                if not stream.silent and now - stream.last > limit:
                    changes += self._silence(monitor, stream, now, limit)
        return self._remember(changes)

    def snapshot(self, now: float) -> Snapshot:
        """Return what is known."""
        robots: dict[str, list[MonitorView]] = {}
        for key, monitor in self._monitors.items():
            told = _NOTHING_TOLD if monitor.is_silent else self._told.get(key, _NOTHING_TOLD)
            view = monitor.view(self._report_of(monitor), told, now)
            robots.setdefault(monitor.robot, []).append(view)
        views = (
            RobotView(name, tuple(sorted(monitors, key=lambda view: (view.name, view.topic))))
            for name, monitors in sorted(robots.items())
        )
        last = tuple(reversed(self._changes))
        return Snapshot(now, tuple(views), last, self._changed, self.notes)

    def _take_why(self, message: Message) -> list[Change]:
        """Take why claims are as they are; what is told of one anew goes to who follows changes."""
        key = base_topic(message.topic), message.node
        before = self._told.get(key, _NOTHING_TOLD).whys
        if key not in self._told and len(self._told) >= MAX_MONITORS:
            return []
        self._told[key] = _Told(message.t, read_why(message.content))
        monitor = self._monitors.get(key)
        if monitor is None:
            return []
        verdicts = {k: v for one in monitor.streams.values() for k, v in one.verdicts.items()}
        return [
            replace(monitor.change(verdicts[id_], verdicts[id_].state, message.t), reasons=(text,))
            for id_, why in self._told[key].whys.items()
            if why.causes and id_ in verdicts and _first(why) != _first(before.get(id_))
            for text in [why.sentence]
        ]

    def _take_report(self, report: NodeReport) -> None:
        is_new = report.model not in self._reports.get(report.node, {})
        if not is_new or sum(map(len, self._reports.values())) < MAX_MONITORS:
            self._reports.setdefault(report.node, {})[report.model] = report

    def _new_monitor(self, message: Message, title: str) -> _Monitor | None:
        """Return the monitor of a message; ``None``: of a robot that nobody requested."""
        topic = base_topic(message.topic)
        robot = robot_of(message.topic, message.node, self._robots)
        if robot is None:
            return None
        if len(self._monitors) >= MAX_MONITORS:
            self._note(f"only the first {MAX_MONITORS} monitors are shown")
            return None
        monitor = _Monitor(plain(robot), title, plain(topic), plain(message.node))
        for other in self._monitors.values() if monitor.node else ():
            if other.node == monitor.node:
                monitor.is_alone = other.is_alone = False
        self._monitors[topic, message.node] = monitor
        return monitor

    def _changes_by(
        self,
        monitor: _Monitor,
        stream: _Stream,
        reading: StatusReading,
        t: float,
        *,
        is_back: bool = False,
    ) -> Iterator[Change]:
        """Take a reading; every verdict of a monitor that is back after silence is a change."""
        verdicts: dict[str, VerdictView] = {} if reading.is_complete else stream.verdicts
        for verdict in reading.verdicts:
            id_ = plain(verdict.id)
            before = stream.verdicts.get(id_)
            if before is None and self._verdicts >= MAX_VERDICTS:
                self._note(f"only the first {MAX_VERDICTS} verdicts are shown")
                continue
            stays = before is not None and before.state == verdict.state
            since = before.since if before is not None and stays else t
            seen = before is not None and (before.seen or not stays)
            reasons = tuple(plain(reason) for reason in verdict.reasons[:MAX_REASONS])
            view = VerdictView(id_, verdict.state, reasons, plain(verdict.text), since, seen)
            self._verdicts += id_ not in stream.verdicts
            verdicts[id_] = view
            if not stays or is_back:
                yield monitor.change(view, None if before is None else before.state, t)
        if reading.is_complete:
            self._verdicts -= len(stream.verdicts.keys() - verdicts.keys())
            stream.verdicts = verdicts

    def _silence(
        self, monitor: _Monitor, stream: _Stream, now: float, limit: float
    ) -> Iterator[Change]:
        stream.silent, stream.reading = True, None
        reason = f"no message for more than {limit:.3g} s"
        if stream.kept is not None:
            kept, stream.kept = stream.kept, None
            monitor.model = monitor.model or plain(kept.model)
            reason = f"its last message is of unknown age, {reason}"
            verdicts = tuple(replace(v, state="unknown", reasons=()) for v in kept.verdicts)
            reading = replace(kept, verdicts=verdicts, is_complete=False)
            for change in self._changes_by(monitor, stream, reading, now):
                yield replace(change, reasons=(reason,))
        for id_, before in stream.verdicts.items():
            view = replace(before, state="unknown", reasons=(reason,))
            if before.state != "unknown":
                view = replace(view, since=now, seen=True)
            stream.verdicts[id_] = view
            if before.since != now or before.state != "unknown":  # else it was told just now
                yield monitor.change(view, before.state, now)

    def _report_of(self, monitor: _Monitor) -> NodeReport | None:
        """Return the report of a monitor's node: by its name, else by its model on that robot."""
        of_node = self._reports.get(monitor.node)
        if of_node is not None:  # one process may run several
            is_only = monitor.is_alone and len(of_node) == 1
            return of_node.get(monitor.name, *(of_node.values() if is_only else ()))
        spaces = [space for space, name in self._robots.items() if name == monitor.robot]
        models = (monitor.model, monitor.node.rpartition("/")[2] or monitor.model)
        fitting = [
            report
            for node, of_node in self._reports.items()
            if any(is_below(node, space) for space in spaces or [monitor.robot])
            for report in of_node.values()
            if report.model in models
        ]
        return fitting[0] if len(fitting) == 1 else None

    def _remember(self, changes: list[Change]) -> list[Change]:
        self._changes.extend(changes)
        self._changed += len(changes)
        return changes

    def _note(self, text: str) -> None:
        if len(self._notes) < MAX_REASONS:
            self._notes[text] = None
