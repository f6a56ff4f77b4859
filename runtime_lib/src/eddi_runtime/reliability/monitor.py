"""The monitor: how probable is a failure from now to the horizon, and may one go on?"""

from __future__ import annotations

import math
from typing import Callable, Dict, Iterable, Iterator, Mapping, Sequence

from ..inputs import NO_TIME, look_again, step_time
from ..monitor import Json, Monitor, Tree, Value, finite
from ..plain_values import read
from ..thresholds import Evidence, Threshold
from ..why import FALSE, TEXTS, TRUE, UNKNOWN, Cause, figure
from .component import (
    NAN,
    NOTHING,
    Component,
    Estimate,
    Importance,
    Moment,
    ReliabilityResult,
    Rule,
    Taken,
    take,
)

GRID = 256  # how many horizons are prepared when the mission's end is an input
MISSION_END = "mission_end"
_HOUR_NS = 3.6e12
_UNKNOWN_INPUTS = "unknown inputs"
_NUMBERS = ("p_fail", "p_fail_low", "p_fail_high", "reliability", "mttf")
_ROUNDED = 1.0 + 1e-9
_new = tuple.__new__  # twice as fast as the classes of named tuples


class Reliability(Monitor[ReliabilityResult]):
    """What the class ``Monitor`` of a compiled reliability model inherits. Not thread-safe."""

    kind = "reliability"
    rules: Mapping[str, Rule]  # input id -> what it may hold
    top: str  # model whose numbers are published
    uses: tuple[str, ...]  # inputs on which it depends, with those of the models that it uses
    horizon: float  # hours; the longest one when the mission's end is an input
    moving = False  # the mission's end is an input
    quantum_ns: int  # nanoseconds of one step of the chains
    thresholds: tuple[Threshold, ...] = ()  # in the order of the model
    worst_case = False  # evidence follows the worst case of unknown inputs
    max_gap_ns: int  # a longer time between two steps is reported
    _models: Callable[[], Dict[str, Component]]  # by name; each behind those that it uses

    def __init__(self) -> None:
        self.components = self._models()  # the models by name
        self._sources = [spec for spec in self.inputs if spec.id in self.rules]
        self._steps = [(name, component.step) for name, component in self.components.items()]
        self._parts = tuple(self.components.values())
        self._grows = all(part.grows for part in self._parts)
        self._evidence = [Evidence(threshold) for threshold in self.thresholds]
        self._quantum = self.quantum_ns / _HOUR_NS
        self.reset()

    def _read(self, source: object) -> dict[str, Taken]:
        return self._believed([read(source, spec.attribute, spec.id) for spec in self._sources])

    def _believed(self, raws: Sequence[object]) -> dict[str, Taken]:
        """Return values of the inputs of ``rules`` as they are believed; keep what is wrong."""
        values: dict[str, Taken] = {}
        for raw, spec in zip(raws, self._sources):
            rule, factor = self.rules[spec.id], spec.factor
            value, fault = take(rule if factor is None else rule.divided(*factor), raw)
            if factor is not None and isinstance(value, float):
                scaled = value * factor[0] / factor[1]
                if math.isfinite(scaled):  # rounding must not lead out of the range
                    scaled = min(max(scaled, rule.low), rule.high)
                value, fault = take(rule, scaled)
            if fault:
                self._faults[spec.id] = fault
            values[spec.id] = value
        return values

    def reset(self) -> None:
        self._source = None
        self._start: int | None = None
        self._last = self._quanta = self._base = 0
        self._faults: dict[str, str] = {}
        self._result = self._nothing("not started")._replace(evidence={})
        for component in self.components.values():
            component.reset()
        for judge in self._evidence:
            judge.reset()

    def _nothing(self, reason: str) -> ReliabilityResult:
        """Return the worst case."""
        off = {evidence.id: False for evidence in self._evidence}
        numbers = (False, 1.0, 0.0, 1.0, 0.0, NAN, self.horizon)
        return ReliabilityResult(*numbers, off, (), reason, {})

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> ReliabilityResult:
        """Let time pass, take the observations, look ahead; never raises.

        None, NaN and what is of another kind are unknown; without a time the step is not valid.
        """
        look_again(eddi_input, t_ns)
        self._source, self._at = eddi_input, t_ns
        now = step_time(t_ns)
        self._faults = {}
        values = self._read(eddi_input)
        beyond = self._limit_mission(values) if self.moving else ""
        quanta, reason = self._pass(now)
        size, horizon, index = self._quantum, self.horizon, 0
        if self.moving:
            remaining, index = values[MISSION_END], GRID
            if isinstance(remaining, float):
                index = min(GRID, max(0, math.ceil(remaining / 3600.0 / horizon * GRID - 1e-9)))
            horizon = horizon * index / GRID
        moment = _new(Moment, (quanta, quanta * size, self._quanta * size, horizon, index))
        known: dict[str, Estimate] = {}
        for name, step in self._steps:
            known[name] = step(values, moment, known)
        for component in self._parts:
            if component.said:
                self._faults.update(component.said)
                component.said = NOTHING
        low, high, alive, mttf, unknown, why = known[self.top]
        if self.moving and values[MISSION_END] is None:
            unknown, low = (*unknown, MISSION_END), 0.0
            if not self._grows:  # the longest horizon need not be the worst
                high, alive = 1.0, 0.0
        reason = reason or beyond or why
        valid = not unknown and not reason
        told = reason or (_UNKNOWN_INPUTS if unknown else "")
        if valid and high > low * _ROUNDED:
            doubts = [(name, component.doubt()) for name, component in self.components.items()]
            told = "; ".join([f"{name}: {text}" for name, text in doubts if text])
        usable, best = valid or (self.worst_case and not reason), -math.inf if reason else low
        # loops, not comprehensions: those cost a call each before Python 3.12
        contributions: dict[str, float] = {}
        for name, result in known.items():
            contributions[name] = result[1]
        evidence: dict[str, bool] = {}
        for threshold in self._evidence:
            evidence[threshold.id] = threshold.step(self._last, high, usable=usable, best=best)
        numbers = (valid, high, low, high, alive, mttf, moment[3])
        fields = (*numbers, evidence, unknown, told, contributions)
        self._result = _new(ReliabilityResult, fields)
        return self._result

    def _pass(self, now: int | None) -> tuple[int, str]:
        """Return how many quanta to propagate, and what is wrong with the clock."""
        if now is None:  # the next time that is one makes up for it
            return 0, NO_TIME
        if self._start is None:
            self._start = self._last = now
            return 0, ""
        gap = now - self._last
        self._last = now
        if gap < 0:  # a new time base: the state keeps its age
            self._start, self._base = now, self._quanta
            return 0, "the clock went back"
        # rounded up: never behind the clock
        due = self._base - (self._start - now) // self.quantum_ns
        quanta, self._quanta = due - self._quanta, due
        return quanta, "gap" if gap > self.max_gap_ns else ""

    def _limit_mission(self, values: dict[str, Taken]) -> str:
        """Let a mission that is too long be unknown; return why no number bounds it."""
        left, longest = values[MISSION_END], self.horizon * 3600.0
        if not isinstance(left, float) or left <= longest * _ROUNDED:
            return ""
        values[MISSION_END] = None
        shown = f"{left:g} s is above mission_time ({longest:g} s); it counts as unknown"
        self._faults[MISSION_END] = shown
        return "mission_end is above mission_time"

    def importances(self) -> tuple[Importance, ...]:
        return self.components[self.top].importances()

    def as_json(self, output: ReliabilityResult) -> Mapping[str, Json]:
        return {
            **{name: finite(value) for name, value in output._asdict().items()},
            "evidence": dict(output.evidence),
            "unknown": list(output.unknown),
            "contributions": {name: finite(p) for name, p in output.contributions.items()},
        }

    def series(self, output: ReliabilityResult) -> dict[str, Value]:
        numbers = {name: finite(getattr(output, name)) for name in _NUMBERS}
        return {**numbers, **self.decided(output)}

    def decided(self, output: ReliabilityResult) -> dict[str, Value]:
        return {"valid": output.valid, **output.evidence}

    def message(self, output: object) -> Tree:
        given = self._nothing("the output is no result of this monitor")
        if isinstance(output, ReliabilityResult):
            given = output
        # what may hold although it is not active
        open_ = [row.id for row in self._evidence if row.possible and not row.active]
        pairs = given.evidence.items()
        rows: list[Tree] = [("ReliabilityEvidence", {"id": k, "active": on}) for k, on in pairs]
        return "ReliabilityOutput", {
            "model": self.model_id,
            "valid": given.valid,
            "p_fail": given.p_fail,
            "p_fail_low": given.p_fail_low,
            "p_fail_high": given.p_fail_high,
            "reliability": given.reliability,
            "mttf_hours": given.mttf,
            "horizon_seconds": given.horizon * 3600.0,
            "unknown_inputs": list(given.unknown),
            "reason": given.reason or (f"not decided: {', '.join(open_)}" if open_ else ""),
            "evidence": rows,
            "accepted": list(self.accepted()),
        }

    def _whys(self) -> Iterator[tuple[str, int, Iterable[Cause]]]:
        for evidence in self._evidence:
            verdict = TRUE if evidence.active else UNKNOWN if evidence.possible else FALSE
            yield evidence.id, verdict, () if evidence.active else self._causes(evidence)

    def _causes(self, evidence: Evidence) -> list[Cause]:
        result, limit = self._result, evidence.threshold.activate
        low, high, tail = result.p_fail_low, result.p_fail_high, f"limit {figure(limit)}"
        if not evidence.possible:
            text = f"p_fail {figure(low)} for {{since}}, {tail}"
            since = self._lasting(evidence.lost)
            return [Cause((), "false", text, since=since, limit=limit)]
        trouble = "" if result.reason == _UNKNOWN_INPUTS else result.reason
        if not result.valid and (trouble or not self.worst_case):
            detail = f"p_fail {figure(low)} .. {figure(high)}, {tail}"
            unknown = [spec for spec in self.inputs if spec.id in result.unknown]
            causes = self._of_unknown(unknown, self._faults, detail)
            return [*causes, *([Cause((), "invalid", trouble)] if trouble else [])]
        if not high <= limit:
            text = f"p_fail {figure(high)}, {tail}"
            return [Cause((), "window", text, limit=limit, detail=trouble)]
        hold = evidence.threshold.hold_ns / 1e9
        return [Cause((), "hold", TEXTS["hold"], since=self._lasting(evidence.since), limit=hold)]

    def faults(self) -> dict[str, str]:
        return dict(self._faults)
