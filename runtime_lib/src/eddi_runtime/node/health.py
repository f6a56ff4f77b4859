"""Facts about the steps of one monitor: logged when they change, kept for the diagnostics."""

import time
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from .logs import LOG
from .receipts import Receipt
from .report import OK, InputFact, NodeFact, Report, level_of, report

_GOOD = ("ok", "latched")
_ERROR_GAP_S = 1.0  # at most one error line per second and input
_CHANGES_PER_S = 20  # guarantee lines; a flapping guarantee must not fill the disk


class Health:
    """What the loop notes after each step and the diagnostics thread reads.

    The loop replaces whole values and never changes one in place, so no lock is needed.

    Args:
        monitor: the runtime monitor (``inputs``, ``faults()``, ``blocked()``).
        eddi_input: the generated EDDIInput (``states``).
        period: seconds between two steps.
    """

    def __init__(self, monitor: Any, eddi_input: Any, period: float) -> None:
        self._monitor = monitor
        self._eddi_input = eddi_input
        self._period = period
        self._inputs: Tuple[Any, ...] = tuple(monitor.inputs)
        self._states: Tuple[Tuple[str, str], ...] = ()
        self._kinds: Tuple[str, ...] = ()
        self._blocks: Mapping[str, Sequence[str]] = {}
        self._blocks_wanted = True
        self._errors: Dict[str, int] = {}
        self._logged: Dict[str, Tuple[str, float]] = {}
        self._level = OK
        self._error = ""
        self._steps = 0
        self._last_step = time.monotonic()
        self._longest = 0.0
        self._reported_overruns = 0

    def after_step(self, receipts: Mapping[str, Receipt], error: str, duration: float) -> bool:
        """Note a finished step; ``True`` when the level of the inputs changed.

        Args:
            receipts: what had been received when the step began.
            error: exception of the step, else empty.
            duration: seconds.
        """
        self._steps += 1
        self._last_step = time.monotonic()
        self._longest = max(self._longest, duration)
        states = self._input_states(receipts)
        for spec, (state, reason) in zip(self._inputs, states):
            if state == "invalid":
                self._errors[spec.id] = self._errors.get(spec.id, 0) + 1
            self._log_input(spec.id, reason if state == "invalid" else "")
        kinds = tuple(state for state, _ in states)
        if self._blocks_wanted or kinds != self._kinds:
            self._blocks_wanted = False
            bad = [s.id for s, kind in zip(self._inputs, kinds) if kind not in _GOOD]
            self._blocks = dict(self._monitor.blocked(bad))
        self._states, self._kinds, self._error = states, kinds, error
        before, self._level = self._level, level_of(kinds, error)
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

    def _log_input(self, name: str, reason: str) -> None:
        about = f"input {name}"
        if reason or about in self._logged:
            state = self._eddi_input.states.get(name)
            self.log_error(about, reason, getattr(state, "detail", ""))

    def _input_states(self, receipts: Mapping[str, Receipt]) -> Tuple[Tuple[str, str], ...]:
        faults = self._monitor.faults()
        found: List[Tuple[str, str]] = []
        for spec in self._inputs:
            known = self._eddi_input.states.get(spec.id)
            state, reason = ("missing", "") if known is None else (known.state, known.reason)
            if spec.id in faults and state in ("ok", "invalid"):
                state, reason = "invalid", faults[spec.id] if state == "ok" else reason
            elif state == "ok" and _latched(spec, receipts):
                state = "latched"
            found.append((state, reason))
        return tuple(found)

    def collect(
        self,
        *,
        identity: Mapping[str, str],
        receipts: Mapping[str, Receipt],
        overruns: int,
        master: str,
        wrong_types: Sequence[str],
        periodic: bool,
    ) -> Report:
        """Return the present report; called by the diagnostics thread."""
        now = time.monotonic()
        states = self._states
        facts = [
            self._fact(spec, state, receipts, now) for spec, state in zip(self._inputs, states)
        ]
        silent = now - self._last_step
        node = NodeFact(
            steps=self._steps,
            overruns=overruns,
            recent_overruns=overruns - self._reported_overruns,
            longest_step=self._longest,
            error=self._error,
            master=master,
            wrong_types=tuple(wrong_types),
            silent_for=silent if silent > max(1.0, 3 * self._period) else None,
        )
        if periodic:
            self._reported_overruns = overruns
            self._blocks_wanted = True
        return report(identity, facts, node)

    def _fact(
        self, spec: Any, state: Tuple[str, str], receipts: Mapping[str, Receipt], now: float
    ) -> InputFact:
        here = [receipts[name] for name in spec.requires if name in receipts]
        whole = len(here) == len(spec.requires)
        return InputFact(
            id=spec.id,
            state=state[0],
            reason=state[1],
            age=max(now - receipt.at for receipt in here) if here else None,
            received=min((receipt.received for receipt in here), default=0) if whole else 0,
            errors=self._errors.get(spec.id, 0),
            blocks=tuple(self._blocks.get(spec.id, ())) if state[0] != "ok" else (),
            no_limit=spec.max_age == "none",
        )


def _latched(spec: Any, receipts: Mapping[str, Receipt]) -> bool:
    return any(name in receipts and receipts[name].latched for name in spec.requires)


class Changes:
    """Logs which guarantees became active or inactive, at most 20 lines per second."""

    def __init__(self) -> None:
        self._last: Optional[Dict[str, bool]] = None
        self._output: object = None
        self._window = -1.0
        self._lines = 0

    def note(self, output: object) -> None:
        """Compare an output with the one before; outputs of other shapes are passed over."""
        if output == self._output:
            return
        self._output = output
        now = activity(output)
        before, self._last = self._last, now
        for name, active in now.items():
            if before is not None and before.get(name, active) is not active:
                self._say(name, active)

    def _say(self, name: str, active: bool) -> None:
        second = time.monotonic()
        if second - self._window >= 1.0:
            hidden = self._lines - _CHANGES_PER_S
            self._window, self._lines = second, 0
            if hidden > 0:
                LOG.info("%d more changes of guarantees were not logged", hidden)
        self._lines += 1
        if self._lines <= _CHANGES_PER_S:
            LOG.info("%s is now %s", name, "active" if active else "inactive")


def one_line(error: BaseException) -> str:
    """Return type and text of an exception as one line."""
    text = " ".join(str(error).split())[:300]
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def activity(output: object) -> Dict[str, bool]:
    """Return id -> active of an output that is a list of ``{"id", "active"}``, else nothing."""
    if not isinstance(output, (list, tuple)):
        return {}
    return {
        str(item["id"]): bool(item["active"])
        for item in output
        if isinstance(item, dict) and "id" in item and "active" in item
    }
