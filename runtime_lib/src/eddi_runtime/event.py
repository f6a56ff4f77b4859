"""Conditional events: which conditions over time hold, from what is known (SESAME D7.2 3.5)."""

from __future__ import annotations

import math
from typing import Any, Callable, Dict, Iterable, Iterator, List, Mapping, NamedTuple

from . import monitor
from .expressions import Conditions, reduced, scaled, stamp
from .expressions import Value as Number
from .inputs import accepted, look_again, step_time
from .monitor import Monitor, Output, Tree, row_trees
from .plain_values import Absent, exactly, is_nan, plain, read, show
from .why import TEXTS, TRUE, UNKNOWN, Cause, seconds, shown

FORMAT = 1

Rows = List[Dict[str, Any]]
_VERDICTS = (False, None, True)
_REASONS = ("the condition is FALSE", "the condition is not decided yet")
_WANTED = {"number": "a number", "bool": "True or False", "text": "a text", "list": "a list"}


class Event(NamedTuple):
    """One event."""

    id: str  # as in the model
    hazard: bool  # UNKNOWN counts as active
    needs: tuple[int, ...]  # numbers of the inputs that it depends on
    accepts: tuple[str, ...] = ()  # the words by which its text accepts silence


class ConditionMonitor(Conditions, Monitor[Output]):
    """What monitors inherit whose ``step`` evaluates conditions over inputs; not thread-safe."""

    # of each input: ``number``, ``bool``, ``text``, ``list``, the texts of an ENUM, or empty where
    # no condition reads it
    types: tuple[str | tuple[str, ...], ...]
    # of each input that is a number its RANGE, and whether there is ALLOW INF
    limits: tuple[tuple[float, float, bool] | None, ...]
    units: tuple[str, ...] = ()  # of the inputs, as in the model; empty where none has any
    reductions: tuple[int, ...] = ()  # for each reduction of a list the number of its first input
    raw: tuple[object, ...]  # values of the inputs in the last step, None where there is none
    # evaluates once at a time: 0, 1 or 2 for each condition; compiled monitors have it
    step: Callable[[object, int], tuple[Number, ...]]
    _source: Any
    _waited = 0.0  # seconds from the last ``processing`` to the last step
    _reasons: list[str]  # why a reduction is not known

    def read(self, source: object) -> tuple[object, ...]:
        raws = [read(source, spec.attribute, spec.id) for spec in self.inputs]
        values = [None if type(raw) is Absent else raw for raw in raws]
        factors = [spec.factor for spec in self.inputs]
        return tuple([scaled(v, *f) if f is not None else v for v, f in zip(values, factors)])

    def reduce(self, number: int, function: Callable[..., float | bool], *raws: object) -> object:
        """Return a reduction of lists, and keep why it is not known."""
        value, self._reasons[number] = reduced(function, raws)
        return value

    def stamp(self, t: int, input_id: str) -> int:
        try:
            return stamp(t, self._source.states[input_id].age + self._waited)
        except Exception:  # noqa: BLE001 - any object may be given as input
            return t

    def _unit(self, k: int) -> str:
        return self.units[k] if self.units else ""

    def _unusable(self, k: int) -> str:
        """Return why an input has no value that counts, empty where it has one."""
        raw, limits, unit = self.raw[k], self.limits[k], self._unit(k)
        if raw is None or is_nan(raw):
            return "no value"
        value = plain(raw)
        if limits is None or not isinstance(value, (int, float)) or not self._fault(k):
            return self._fault(k)
        low, high, _ = limits
        return f"{shown(value, unit)} is outside {low:.9g} .. {high:.9g} {unit}".rstrip()

    def faults(self) -> Mapping[str, str]:
        reasons = {
            self.inputs[k].id: reason
            for k, reason in zip(self.reductions, self._reasons)
            if self.raw[k] is not None and reason
        }
        unusable = map(self._fault, range(len(self.inputs)))
        reasons.update((spec.id, text) for spec, text in zip(self.inputs, unusable) if text)
        return reasons

    def _fault(self, k: int) -> str:
        value, limits, factor = plain(self.raw[k]), self.limits[k], self.inputs[k].factor
        beyond = ""
        if limits is not None and isinstance(value, (int, float)):
            low, high, infinite = limits
            if value in (math.inf, -math.inf):
                beyond = "" if infinite else f"{show(value)}, without ALLOW INF"
            elif value < low or value > high:
                beyond = f"{show(value)} is outside RANGE {low:.15g} .. {high:.15g}"
        if beyond and factor is not None:
            given = scaled(self.raw[k], factor[1], factor[0])
            beyond = f"{given:.15g}, times {factor[0] / factor[1]:.9g}: {beyond}"
        return fault(self.types[k], self.raw[k]) or beyond

    def reset(self) -> None:
        self.restart()
        self._reasons = [""] * len(self.reductions)
        self.raw = (None,) * len(self.inputs)
        self._source = None


class EventMonitor(ConditionMonitor[Rows]):
    """What the class ``Monitor`` of compiled events inherits; not thread-safe."""

    kind = "event"
    events: tuple[Event, ...]  # in file order
    _verdicts: tuple[Number, ...]
    # event -> when its verdict became what it is, and the values of the inputs then
    _changes: dict[int, tuple[int | None, tuple[object, ...]]]
    _jumped: int | None = None  # time before the clock went back

    def __init__(self) -> None:
        self.hazards = frozenset([event.id for event in self.events if event.hazard])
        self.reset()

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> Rows:
        """Return ``{"id", "verdict", "active", "raised", "cleared"}`` of each event.

        What is no value for a variable is UNKNOWN; so is all without a time, which windows do not
        see. An EVIDENCE event is active when TRUE, a HAZARD unless FALSE. ``verdict`` may be None:
        UNKNOWN.
        """
        self._waited = look_again(eddi_input, t_ns)
        self._source, self._at = eddi_input, t_ns
        t = step_time(t_ns)
        before, now = self._verdicts, self._unknown
        if t is None:
            self.raw = self.read(eddi_input)
        else:
            stands, now = t == self.last, self.step(eddi_input, t)
            if not stands:
                self._taken = self.raw
            elif any(raw is None is not taken for raw, taken in zip(self.raw, self._taken)):
                now = self._unknown  # a simulation's clock stands: no step is taken, silence shows
        self._verdicts = now
        if now != before:
            for k, (value, last) in enumerate(zip(now, before)):
                if value != last:
                    self._changes[k] = t, self.raw
        return [
            {
                "id": event.id,
                "verdict": _VERDICTS[int(value)],
                "active": value == 2 or (event.hazard and value == 1),
                "raised": value == 2 != last,
                "cleared": value != 2 == last,
            }
            for event, value, last in zip(self.events, now, before)
        ]

    def series(self, output: Rows) -> Mapping[str, monitor.Value]:
        return {str(row["id"]): row["verdict"] for row in output}

    def message(self, output: object) -> list[Tree]:
        accepts = self._accepted()

        def tree_of(row: Any) -> Tree:
            name, verdict = exactly(str, row["id"]), row["verdict"]
            flags = {key: exactly(bool, row[key]) for key in ("active", "raised", "cleared")}
            truth = 1 if verdict is None else 2 if exactly(bool, verdict) else 0
            accepted = list(accepts.get(name, ()))
            return "EventOutput", {"id": name, "verdict": truth, **flags, "accepted": accepted}

        trees, faults = row_trees(output, tree_of)
        self._output_faults = tuple(faults)
        return trees or []

    def _whys(self) -> Iterator[tuple[str, int, Iterable[Cause]]]:
        for k, (event, value) in enumerate(zip(self.events, self._verdicts)):
            verdict = int(2 - value if event.hazard else value)
            yield event.id, verdict, () if verdict == TRUE else self._causes(k, event)

    def _causes(self, number: int, event: Event) -> list[Cause]:
        began, raw = self._changes.get(number, (None, self.raw))
        if self._verdicts[number] != UNKNOWN:
            values = [(self.inputs[k].id, shown(raw[k], self._unit(k))) for k in event.needs]
            detail = ", ".join([f"{name} {value}" for name, value in values if value][:3])
            text = "true for {since}" if event.hazard else TEXTS["false"]
            return [Cause((), "false", text, since=self._lasting(began), detail=detail)]
        unknown = [k for k in event.needs if self._unusable(k)]
        faults = {self.inputs[k].id: self._unusable(k) for k in unknown}
        causes = self._of_unknown([self.inputs[k] for k in unknown], faults)
        filled = self._known_for(*(self.inputs[k] for k in event.needs))
        since = min(filled, self._lasting(self.since), *([self._lasting(began)] if began else []))
        jumped = 0 if self._jumped is None else self._jumped - self.since
        back = f", the clock went back {seconds(jumped / 1e9)}" if jumped > 0 else ""
        return causes or [Cause((), "window", TEXTS["window"] + back, since=since)]

    def accepted(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(word for words in self._accepted().values() for word in words))

    def _accepted(self) -> dict[str, list[str]]:
        """Return event -> the acceptances in use that it may rest on."""
        of_events: dict[str, list[str]] = {}
        for event, value in zip(self.events, self._verdicts):
            words = event.accepts if value == (0 if event.hazard else 2) else ()
            of_inputs = accepted([self.inputs[k] for k in event.needs], self._source)
            of_events[event.id] = [*of_inputs, *(f"{event.id}: {word}" for word in words)]
        return of_events

    def restart(self) -> None:
        self._jumped = getattr(self, "last", None)
        super().restart()

    def reset(self) -> None:
        super().reset()
        self._changes, self._jumped = {}, None
        self._unknown: tuple[Number, ...] = (1,) * len(self.events)
        self._verdicts = self._unknown
        self._taken = self.raw


def fault(kind: str | tuple[str, ...], raw: object) -> str:
    """Return what is wrong with a raw value of a type, empty when it is fine or simply missing."""
    if raw is None or kind == "":
        return ""
    value = plain(raw)
    if kind == "list":
        fine = hasattr(type(raw), "__len__") and not issubclass(type(raw), str)
    elif isinstance(value, bool):
        fine = kind == "bool"
    elif isinstance(value, str):
        fine = kind == "text" or (isinstance(kind, tuple) and value in kind)
    else:
        fine = value is not None and (kind == "number" or value != value)  # noqa: PLR0124 - NaN
    if fine:
        return ""
    wanted = _WANTED[kind] if isinstance(kind, str) else ", ".join(kind)
    return f"expected {wanted}, got {show(raw)}"
