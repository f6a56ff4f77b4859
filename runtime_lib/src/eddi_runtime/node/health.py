"""Facts about the steps of one monitor: logged when they change, kept for the diagnostics."""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import Any, Callable, Mapping, NamedTuple, Sequence

from ..inputs import UNKNOWN_AGE, EDDIInputBase
from ..monitor import Monitor, Tree, __version__
from ..plain_values import is_nan, one_line, read
from . import report
from .report import FRESH, INVALID, LATCHED, NEVER, OK, WAITING, GraphFact, Report
from .start import LOG, Waker
from .topics import Receipt

PERIOD_S = 1.0  # between two reports without a new level
_CALM_S = 0.1  # between two reports, so that a level that flaps does not flood the topic
_ERROR_GAP_S = 1.0  # at most one error line per second and input
_CHANGES_PER_S = 20  # guarantee lines; a flapping guarantee must not fill the disk
_REFRESH_S = 0.5  # reasons cost more than a step: only then, or when a state or the output changed


class _Seen(NamedTuple):
    """The last step, replaced as a whole: the diagnostics thread needs no lock."""

    at: float  # monotonic seconds of its begin
    states: tuple[tuple[str, str], ...] = ()  # of each input, as in a report, and the reason
    receipts: Mapping[str, Receipt] = {}  # what had been received
    error: str = ""  # an exception of the step, else empty


class Health:
    """What the loop notes after each step and the thread of the diagnostics reads."""

    def __init__(
        self, monitor: Monitor[Any], eddi_input: EDDIInputBase, period: float, grace: float
    ) -> None:
        self._monitor = monitor
        self._eddi_input, self._period, self._grace = eddi_input, period, grace
        self._inputs = tuple(monitor.inputs)
        self._last_step = time.monotonic()
        self._first_step: float | None = None
        self._seen = _Seen(self._last_step)
        self._known = report.MonitorFact()
        self._kinds: Sequence[str] = ()  # states of the inputs when the monitor was asked
        self._asked_at = -_REFRESH_S
        self._changes = Changes()
        self._errors: dict[str, int] = {}
        self._logged: dict[str, tuple[str, float]] = {}
        self._level = OK
        self._steps, self._longest, self._reported_overruns = 0, 0.0, 0

    def after_step(
        self, output: object, receipts: Mapping[str, Receipt], error: str, duration: float
    ) -> bool:
        """Note a finished step; ``True`` when the level of the inputs changed."""
        self._last_step = now = time.monotonic()
        if self._first_step is None:
            self._first_step = now
        self._steps += 1
        self._longest = max(self._longest, duration)
        states = self._input_states(receipts, waiting=now - self._first_step < self._grace)
        for spec, (state, reason) in zip(self._inputs, states):
            if state == INVALID:
                self._errors[spec.id] = self._errors.get(spec.id, 0) + 1
            about, wrong = f"input {spec.id}", reason if state == INVALID else ""
            if wrong or about in self._logged:
                known = self._eddi_input.states.get(spec.id)
                self.log_error(about, wrong, getattr(known, "detail", ""))
        kinds = tuple(state for state, _ in states)
        changed = self._changes.note(output) or kinds != self._kinds
        if changed or now - self._asked_at >= _REFRESH_S:
            self._kinds, self._asked_at = kinds, now
            pairs, core = zip(self._inputs, kinds), self._monitor
            unknown = [spec.id for spec, kind in pairs if kind not in (FRESH, LATCHED)]
            facts = tuple(core.standings()), tuple(core.accepted()), dict(core.blocked(unknown))
            self._known = report.MonitorFact(*facts, tuple(core.doubts()))
        self._seen = _Seen(now - duration, states, receipts, error)
        before = self._level
        self._level = report.level_of(kinds, error, self._known.accepted + self._known.doubts)
        return self._level != before

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

    def _input_states(
        self, receipts: Mapping[str, Receipt], *, waiting: bool
    ) -> tuple[tuple[str, str], ...]:
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
            elif state == NEVER and waiting:
                state = WAITING
            states.append((state, reason))
        return tuple(states)

    def collect(
        self,
        receipts: Mapping[str, Receipt],
        overruns: int,
        graph: GraphFact,
        topics: Mapping[str, str],
        *,
        periodic: bool,
    ) -> Report:
        """Return the present report; called by the diagnostics thread."""
        now = time.monotonic()
        seen, known = self._seen, self._known
        then = {name: receipt.age_at(seen.at) for name, receipt in seen.receipts.items()}
        receipts = {**seen.receipts, **receipts}  # the words of other robots are in the first only
        reasons = {**graph.reasons, **graph.wrong_types}
        facts = []
        for spec, (state, reason) in zip(self._inputs, seen.states):
            here = [receipts[name] for name in spec.requires if name in receipts]
            complete = len(here) == len(spec.requires)
            named = [(name, topics.get(name, name)) for name in spec.requires]
            fact = report.InputFact(
                id=spec.id,
                state=state,
                reason=reason,
                age=max((receipt.age_at(now) for receipt in here), default=None),
                received=min((receipt.received for receipt in here), default=0) if complete else 0,
                errors=self._errors.get(spec.id, 0),
                blocks=tuple(known.blocks.get(spec.id, ())) if state != FRESH else (),
                limit=spec.max_age,
                sources=tuple(
                    report.SourceFact(t, then.get(n), reasons.get(t, "")) for n, t in named
                ),
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
        return report.report(identity, facts, known, node)


def diagnostics_tree(statuses: Sequence[Report], level: Callable[[int], object] = int) -> Tree:
    """Return statuses as a ``DiagnosticArray``, with levels as the transport writes a byte."""
    rows: list[Any] = []
    for worst, message, pairs, name, node in statuses:
        values = [("KeyValue", {"key": key, "value": value}) for key, value in pairs]
        fields = {"level": level(worst), "name": name, "message": message, "values": values}
        rows.append(("DiagnosticStatus", {**fields, "hardware_id": node}))
    return "DiagnosticArray", {"status": rows}


Collect = Callable[[bool], Report]
"""Returns the report of one monitor; ``True``: the periodic one."""


class Diagnostics:
    """A thread that reports all monitors once a second, and at once those with a new level."""

    def __init__(self, publish: Callable[[list[Report]], None]) -> None:
        self._publish = publish
        self._sources: list[Collect] = []
        self._changed: deque[Collect] = deque()
        self._waker = Waker()
        self._stopped = False

    def add(self, collect: Collect) -> Callable[[], None]:
        """Report for one more monitor; return what has it reported at once."""

        def changed() -> None:
            self._changed.append(collect)
            self._waker.wake()

        self._sources.append(collect)
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
            asked = self._sources if periodic else changed
            statuses = [status for collect in asked for status in self._tried(collect, periodic)]
            if statuses:
                self._tried(self._publish, statuses)
            time.sleep(_CALM_S)
            self._waker.wait(due - time.monotonic())

    def _tried(self, function: Callable[[Any], Any], argument: object) -> list[Any]:
        """Return the result of a call; a report must never end the reporting."""
        try:
            return [function(argument)]
        except Exception as error:  # noqa: BLE001 - whatever it is
            if not self._stopped:
                LOG.error("diagnostics: %s", one_line(error))
            return []


class Changes:
    """Logs which guarantees became active or inactive, at most 20 lines per second."""

    def __init__(self) -> None:
        self._last: dict[str, bool] = {}
        self._output: object = None
        self._window, self._lines = -1.0, 0

    def note(self, output: object) -> bool:
        """Return whether an output is another one than before; other shapes are passed over."""
        if output == self._output:
            return False
        self._output = output
        for row in output if isinstance(output, (list, tuple)) else ():
            if isinstance(row, dict) and "id" in row and "active" in row:
                name, active = str(row["id"]), bool(row["active"])
                if self._last.get(name, active) is not active:
                    self._log_change(name, active)
                self._last[name] = active
        return True

    def _log_change(self, name: str, active: bool) -> None:
        second = time.monotonic()
        if second - self._window >= 1.0:
            hidden = self._lines - _CHANGES_PER_S
            self._window, self._lines = second, 0
            if hidden > 0:
                LOG.info("%d more changes of guarantees were not logged", hidden)
        self._lines += 1
        if self._lines <= _CHANGES_PER_S:
            LOG.info("%s is now %s", name, "active" if active else "inactive")
