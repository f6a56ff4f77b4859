"""Facts about the steps of one monitor: logged when they change, kept for the diagnostics."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from typing import Any, Callable, Mapping, NamedTuple, Sequence

from ..inputs import UNKNOWN_AGE, EDDIInputBase
from ..monitor import Monitor, Tree, __version__
from ..plain_values import is_nan, one_line, read
from ..why import UNKNOWN, Cause, Why
from . import report
from .claim_log import ClaimLog
from .report import FRESH, INVALID, LATCHED, NEVER, OK, WAITING, GraphFact, Report
from .start import LOG, Waker
from .topics import Receipt

PERIOD_S = 1.0  # between two reports without a new level
_CALM_S = 0.1  # between two reports, so that a level that flaps does not flood the topic
_ERROR_GAP_S = 1.0  # at most one error line per second and input
_REFRESH_S = 0.5  # reasons cost more than a step: only then, or when a state or a verdict changed
_MOST_CHANGES = 100  # of claims between two looks of the thread that tells them


class _Seen(NamedTuple):
    """The last step, replaced as a whole: the thread that tells it needs no lock."""

    at: float  # monotonic seconds of its begin
    states: tuple[tuple[str, str], ...] = ()  # of each input, as in a report, and the reason
    receipts: Mapping[str, Receipt] = {}  # what had been received
    error: str = ""  # an exception of the step, else empty


class _Asked(NamedTuple):
    """What the monitor was asked last, replaced as a whole."""

    at: float  # monotonic seconds
    fact: report.MonitorFact
    causes: Mapping[str, Sequence[Cause]] = {}  # input id -> why it is not fresh


class Health:
    """What the loop notes after each step; a thread tells it."""

    def __init__(
        self, monitor: Monitor[Any], eddi_input: EDDIInputBase, period: float, grace: float
    ) -> None:
        self.suspected: frozenset[str] = frozenset()  # sources from which nothing usable comes
        self._monitor = monitor
        self._eddi_input, self._period, self._grace = eddi_input, period, grace
        self._inputs = tuple(monitor.inputs)
        self._reading = [f"{source}/why" for spec in self._inputs for source, _ in spec.claims]
        self._last_step = time.monotonic()
        self._first_step: float | None = None
        self._waiting = True  # for first messages: the grace of the start is not over
        self._seen = _Seen(self._last_step)
        self._asked = _Asked(-math.inf, report.MonitorFact())
        self._output: object = None
        self._decided: object = None  # in that output
        self._basis: object = None  # on which the monitor was asked
        self._claims: object = None  # verdict and first reason of each claim
        self._changes: deque[_Asked] = deque(maxlen=_MOST_CHANGES)
        self._log = ClaimLog()
        self._errors: dict[str, int] = {}
        self._logged: dict[str, tuple[str, float]] = {}
        self._level = OK
        self._steps, self._longest, self._reported_overruns = 0, 0.0, 0

    def after_step(
        self, output: object, receipts: Mapping[str, Receipt], error: str, duration: float
    ) -> tuple[bool, bool]:
        """Note a finished step; return whether the level changed, and whether a claim did."""
        self._last_step = now = time.monotonic()
        if self._first_step is None:
            self._first_step = now
        self._steps += 1
        self._longest = max(self._longest, duration)
        self._waiting = now - self._first_step < self._grace
        states = self._input_states(receipts)
        for spec, (state, reason) in zip(self._inputs, states):
            if state == INVALID:
                self._errors[spec.id] = self._errors.get(spec.id, 0) + 1
            about, wrong = f"input {spec.id}", reason if state == INVALID else ""
            if wrong or about in self._logged:
                known = self._eddi_input.states.get(spec.id)
                self.log_error(about, wrong, getattr(known, "detail", ""))
        kinds = tuple(state for state, _ in states)
        if output != self._output:
            self._output, self._decided = output, self._decided_by(output)
        heard = [receipts[name].received for name in self._reading if name in receipts]
        basis = self._decided, kinds, heard
        before, level = self._claims, self._level
        if basis != self._basis or now - self._asked.at >= _REFRESH_S:
            self._basis = basis
            self._ask(states, now)
        self._seen = _Seen(now - duration, states, receipts, error)
        self._level = report.level_of(kinds, error, self._asked.fact)
        return self._level != level, self._claims != before

    def _decided_by(self, output: Any) -> object:
        """Return the verdicts in an output; of another shape, the output."""
        try:
            return dict(self._monitor.decided(output))
        except Exception:  # noqa: BLE001 - a person may have made it
            return output

    def _ask(self, states: Sequence[tuple[str, str]], now: float) -> None:
        """Have the monitor tell what it makes of its inputs."""
        core, causes = self._monitor, {}
        for spec, (state, reason) in zip(self._inputs, states):
            if state in (INVALID, LATCHED):
                causes[spec.id] = [Cause((), state, reason or "age unknown")]
            elif state != FRESH:
                causes[spec.id] = self._eddi_input.why(spec, UNKNOWN, 0.0, core.topics)
        why, kind = core.why(), core.kind
        fact = report.MonitorFact(kind, why, core.hazards, tuple(core.accepted()))
        self._asked = asked = _Asked(now, fact, causes)
        lacking = [spec for spec, (state, _) in zip(self._inputs, states) if state != FRESH]
        self.suspected = frozenset(name for spec in lacking for name in spec.requires)
        if self._claims != (claims := first_reasons(why)):
            self._claims = claims
            self._changes.append(asked)

    def told(self, graph: GraphFact) -> Why:
        """Return why the claims are as they are now, and log it; called by the thread."""
        while self._changes:
            change = self._changes.popleft()
            self._note(self._explained(change, graph, change.at), change.at)
        now = time.monotonic()
        why = self._explained(self._asked, graph, now)
        self._note(why, now)
        self._log.write(why, now)
        return why

    def _note(self, why: Why, at: float) -> None:
        rows = {name: row for name, row in why.items() if name not in self._monitor.unlogged}
        self._log.note(rows, at, self._waiting)

    @property
    def waits(self) -> bool:
        """Is there a line for the log that is not due yet."""
        return self._log.waits or bool(self._changes)

    def _explained(self, asked: _Asked, graph: GraphFact, now: float) -> Why:
        """Return the claims with what the node knows of its own topics."""
        rows = {}
        for row in asked.fact.why.values():
            causes = [
                self._of_node(cause, graph, now) if len(cause.monitors) < 2 else cause
                for cause in (moved.later(now - asked.at) for moved in row.causes)
            ]
            rows[row.id] = row._replace(causes=tuple(causes))
        return rows

    def _of_node(self, cause: Cause, graph: GraphFact, now: float) -> Cause:
        if cause.state == "never" and self._waiting:
            began = now if self._first_step is None else self._first_step
            since = min(now - began, self._grace)  # the step that ends it may not have come yet
            cause = cause._replace(since=since, limit=self._grace).because("waiting")
        return graph.explained(cause)

    def log_error(self, about: str, reason: str, trace: str = "") -> None:
        """Log an error once per change of its reason, throttled; an empty reason ends it."""
        last, at = self._logged.get(about, ("", -_ERROR_GAP_S))
        if reason == last:
            return  # also the usual case: nothing wrong before, nothing wrong now
        now = time.monotonic()
        if not reason:
            self._logged[about] = ("", at)
        elif now - at >= _ERROR_GAP_S:
            self._logged[about] = (reason, now)
            LOG.error("%s: %s%s", about, reason, "\n" + trace.rstrip() if trace else "")

    def _input_states(self, receipts: Mapping[str, Receipt]) -> tuple[tuple[str, str], ...]:
        faults = self._monitor.faults()
        states: list[tuple[str, str]] = []
        for spec in self._inputs:
            known = self._eddi_input.states.get(spec.id)
            state, reason = (NEVER, "") if known is None else (known.state, known.reason)
            present = [receipts[name] for name in spec.requires if name in receipts]
            if spec.id in faults and state in (FRESH, INVALID):
                reason = faults[spec.id] if state == FRESH else reason
                state = INVALID
            elif state == FRESH and is_nan(read(self._eddi_input, spec.attribute, spec.id)):
                state, reason = INVALID, "the value is NaN"
            elif state == FRESH and any(receipt.age == UNKNOWN_AGE for receipt in present):
                state = LATCHED
            elif state == NEVER and self._waiting:
                state = WAITING
            states.append((state, reason))
        return tuple(states)

    def collect(
        self, receipts: Mapping[str, Receipt], overruns: int, graph: GraphFact, *, periodic: bool
    ) -> Report:
        """Return the present report; called by the thread."""
        now = time.monotonic()
        seen, asked = self._seen, self._asked
        receipts = {**seen.receipts, **receipts}  # the words of other robots are in the first only
        facts = []
        for spec, (state, _) in zip(self._inputs, seen.states):
            here = [receipts[name] for name in spec.requires if name in receipts]
            complete = len(here) == len(spec.requires)
            of_input = asked.causes.get(spec.id, ()) if state != FRESH else ()
            later = (cause.later(now - asked.at) for cause in of_input)
            causes = [row if row.monitors else self._of_node(row, graph, now) for row in later]
            topics, claims = self._monitor.topics, dict(spec.claims)
            whole = [(name, "") for name in spec.requires if name not in claims]
            sources = [
                f"{topics.get(name, name)} {claim}".rstrip()
                for name, claim in (*spec.claims, *whole)
            ]
            fact = report.InputFact(
                id=spec.id,
                state=state,
                reason="; ".join([cause.chain for cause in causes]),
                age=max((receipt.age_at(now) for receipt in here), default=None),
                received=min((receipt.received for receipt in here), default=0) if complete else 0,
                errors=self._errors.get(spec.id, 0),
                limit=spec.max_age,
                mistaken=any(cause.state == "type" for cause in causes),
                sources=", ".join(sources),
            )
            facts.append(fact)
        silent = now - self._last_step
        silent_for = silent if silent > max(1.0, 3 * self._period) else None
        recent, longest = overruns - self._reported_overruns, self._longest
        node = report.NodeFact(
            self._steps, overruns, recent, longest, seen.error, graph, silent_for
        )
        if periodic:
            self._reported_overruns = overruns
        identity = {"model_digest": self._monitor.digest, "runtime_version": __version__}
        known = asked.fact._replace(why=self._explained(asked, graph, now))
        return report.report(identity, facts, known, node)


def first_reasons(why: Why) -> object:
    """Return the verdict and the first reason of each claim."""
    return [
        (row.id, row.verdict, *(cause[:2] for cause in row.causes[:1])) for row in why.values()
    ]


def diagnostics_tree(statuses: Sequence[Report], level: Callable[[int], object] = int) -> Tree:
    """Return statuses as a ``DiagnosticArray``, with levels as the transport writes a byte."""
    rows: list[Any] = []
    for worst, message, pairs, name, node in statuses:
        values = [("KeyValue", {"key": key, "value": value}) for key, value in pairs]
        fields = {"level": level(worst), "name": name, "message": message, "values": values}
        rows.append(("DiagnosticStatus", {**fields, "hardware_id": node}))
    return "DiagnosticArray", {"status": rows}


class Told(NamedTuple):
    """What a monitor has to say now."""

    report: Report | None = None
    waits: bool = False  # has it a line for the log that is not due yet


Tell = Callable[[bool], Told]
"""Publishes and logs why the claims of a monitor are as they are; ``True``: once a second."""


class Diagnostics:
    """A thread in which all monitors tell how they are: each second, and at a change."""

    def __init__(self, publish: Callable[[list[Report]], None]) -> None:
        self._publish = publish
        self._sources: dict[Tell, str] = {}
        self._changed: deque[Tell] = deque()
        self._waker = Waker()
        self._stopped = False

    def add(self, tell: Tell, name: str = "") -> Callable[[], None]:
        """Have one more monitor tell, in a log of several by this name; return what wakes it."""

        def changed() -> None:
            self._changed.append(tell)
            self._waker.wake()

        self._sources[tell] = name
        return changed

    def start(self) -> None:
        threading.Thread(target=self._run, name="diagnostics", daemon=True).start()

    def stop(self) -> None:
        """Report no more; returns at once and may be called in a signal handler."""
        self._stopped = True
        self._waker.wake()

    def _run(self) -> None:
        due = 0.0
        while not self._stopped:
            changed = [self._changed.popleft() for _ in range(len(self._changed))]
            now = time.monotonic()
            periodic = now >= due
            if periodic:
                due = now + PERIOD_S
            told: dict[Tell, Told] = {}
            for tell in [*self._sources] if periodic else dict.fromkeys(changed):
                threading.current_thread().name = (
                    self._sources[tell] or "diagnostics"
                )  # in the log
                told.update((tell, answer) for answer in self._tried(tell, periodic))
            reports = [answer.report for answer in told.values() if answer.report is not None]
            if reports:
                self._tried(self._publish, reports)
            self._changed.extend(tell for tell, answer in told.items() if answer.waits)
            time.sleep(_CALM_S)
            self._waker.wait(0.0 if self._changed else due - time.monotonic())

    def _tried(self, function: Callable[[Any], Any], argument: object) -> list[Any]:
        """Return the result of a call; a report must never end the reporting."""
        try:
            return [function(argument)]
        except Exception as error:  # noqa: BLE001 - whatever it is
            if not self._stopped:
                LOG.error("diagnostics: %s", one_line(error))
            return []
