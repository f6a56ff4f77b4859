"""The monitor of conditional events: which conditions over time hold, from what is known."""

from __future__ import annotations

import math
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple, Union

from ..clock import step_time
from ..documents import ModelError, take
from ..expressions.engine import Engine, fault, stamp_at
from ..expressions.form import BOOL, read_form, used_variables
from ..expressions.sampling import Sampling
from ..inputs import InputSpec, accepted
from ..model_file import ModelFile, texts
from ..monitor import Standing, Tree
from ..plain_values import plain
from .messages import output_messages

Rows = List[Dict[str, Any]]
_VERDICTS = (False, None, True)
_REASONS = ("the condition is FALSE", "the condition is not decided yet")


def build(
    model_file: ModelFile,
    hooks: object = None,  # noqa: ARG001 - part of the interface of every kind
) -> EventMonitor:
    """Compile events.

    Args:
        model_file: the model.
        hooks: not used: all hand-written code is in EDDIInput.

    Raises:
        ModelError: the model is wrong.
    """
    return EventMonitor(model_file)


class EventMonitor:
    """Compiled events. Not thread-safe: the thread that steps it also asks it.

    Attributes:
        model_id: id of the model.
        digest: SHA-256 of the model file's content.
        kind: ``event``.
        inputs: what ``execute_step`` reads, one attribute for each variable.
        engine: the events without attributes and polarity.
    """

    kind = "event"

    def __init__(self, model_file: ModelFile) -> None:
        form = read_form(take(model_file.model, "form", dict, "the model"))
        self.model_id = model_file.id
        self.digest = model_file.digest
        self.inputs: Tuple[InputSpec, ...] = model_file.inputs
        self.engine = Engine(form)
        self._sampling = Sampling(form)
        self._sources = _sources(self._sampling, self.inputs)
        self._stamped = any(variable.stamped for variable in form.variables)
        self._outputs = [(output.id, output.hazard) for output in form.outputs]
        self._accepts = _accepts(model_file)
        self._needs = {
            output.id: [
                self._sources[number]
                for number in sorted({one for k in used for one in self._sampling.uses[k]})
            ]
            for output, used in zip(form.outputs, used_variables(form))
        }
        if any(form.nodes[output.node].type != BOOL for output in form.outputs):
            raise ModelError("", "an event is no truth value")
        self._output_faults: Tuple[str, ...] = ()
        self._unknown: Tuple[Union[float, int], ...] = tuple(1 for _ in self._outputs)
        self._verdicts = self._unknown
        self._raw: List[Any] = []
        self._source: object = None
        self._forget()

    def execute_step(self, eddi_input: object, t_ns: Optional[int] = None) -> Rows:
        """Evaluate once; never raises an Exception.

        Reads one attribute per input. Absent, None, NaN and whatever is no value for the variable
        is UNKNOWN. An EVIDENCE event is active when TRUE, a HAZARD unless FALSE.

        Args:
            eddi_input: holds one attribute per input; its ``states`` hold the age of each.
            t_ns: time in nanoseconds; None: the machine's monotonic clock. What is no whole number
                is no time: all events are UNKNOWN in this step, which the windows do not see.

        Returns:
            A new list of ``{"id", "verdict", "active", "raised", "cleared"}`` in file order;
            ``verdict`` is True, False, or None for UNKNOWN.
        """
        self._source = eddi_input
        t = step_time(t_ns)
        raw = self._raw = [_read(eddi_input, spec) for spec in self._sources]
        before, now = self._verdicts, self._unknown
        if t is not None:
            stamps = self._stamps(eddi_input, t) if self._stamped else None
            now = self.engine.step(t, self._sampling.raws(raw), stamps)
        self._verdicts = now
        return [
            {
                "id": name,
                "verdict": _VERDICTS[int(value)],
                "active": value == 2 or (hazard and value == 1),
                "raised": value == 2 and last != 2,
                "cleared": value != 2 and last == 2,
            }
            for (name, hazard), value, last in zip(self._outputs, now, before)
        ]

    def as_json(self, output: Rows) -> Rows:
        """Return the rows: they are JSON already."""
        return output

    def series(self, output: Rows) -> Dict[str, Union[bool, float, str, None]]:
        """Return event id -> verdict, None for UNKNOWN."""
        return {str(row["id"]): row["verdict"] for row in output}

    def decided(self, output: Rows) -> Dict[str, Union[bool, float, str, None]]:
        """Return the same: there is nothing but verdicts."""
        return self.series(output)

    def message(self, output: Any) -> List[Tree]:
        """Return an output as ``EventOutput`` trees without header; never raises."""
        trees, self._output_faults = output_messages(output, self._accepted())
        return trees

    def output_faults(self) -> Tuple[str, ...]:
        """Return what was wrong with the output that ``message`` was given last."""
        return self._output_faults

    def status_message(self) -> Optional[Tree]:
        """Return None: the outputs are complete."""
        return None

    def standings(self) -> List[Standing]:
        """Return every event after the last step; a HAZARD that is UNKNOWN is active, too."""
        waits: Dict[str, List[Tuple[str, str]]] = {name: [] for name, _ in self._outputs}
        for one, events in self.blocked().items():
            for name in events:
                waits[name].append((one, "not known"))
        return [
            Standing(
                "event",
                name,
                value == 2 or (hazard and value == 1),
                tuple(waits[name]),
                "" if value == 2 or waits[name] else _REASONS[int(value)],
            )
            for (name, hazard), value in zip(self._outputs, self._verdicts)
        ]

    def accepted(self) -> Tuple[str, ...]:
        """Return ``input: key`` for each acceptance that was in use in the last step."""
        return tuple(dict.fromkeys(one for found in self._accepted().values() for one in found))

    def _accepted(self) -> Dict[str, List[str]]:
        """Return event -> the acceptances in use that it may rest on.

        What the text of an event accepts is in use while the event claims something: an EVIDENCE
        that is TRUE, a HAZARD that is FALSE.
        """
        found: Dict[str, List[str]] = {}
        for (name, hazard), value in zip(self._outputs, self._verdicts):
            words = self._accepts.get(name, ()) if value == (0 if hazard else 2) else ()
            of_inputs = accepted(self._needs[name], self._source)
            found[name] = [*of_inputs, *(f"{name}: {word}" for word in words)]
        return found

    def blocked(self, not_known: Iterable[str] = ()) -> Mapping[str, Tuple[str, ...]]:
        """Return input id -> events that are UNKNOWN and depend on it, for inputs not known now.

        Args:
            not_known: inputs that count as not known whatever they hold.
        """
        unknown = set(not_known)
        unknown.update(
            spec.id
            for spec, one, raw in zip(self._sources, self._sampling.inputs, self._raw)
            if raw is None or _is_nan(raw) or fault(one, raw)
        )
        found: Dict[str, Tuple[str, ...]] = {}
        for spec in self.inputs:
            events = tuple(
                name
                for (name, _), value in zip(self._outputs, self._verdicts)
                if value == 1 and spec in self._needs[name]
            )
            if spec.id in unknown and events:
                found[spec.id] = events
        return found

    def faults(self) -> Mapping[str, str]:
        """Return input id -> what was wrong with its value in the last step."""
        unusable = (
            (spec.id, fault(one, raw))
            for spec, one, raw in zip(self._sources, self._sampling.inputs, self._raw)
        )
        reduced = (
            (self._sources[used[0]].id, reason)
            for used, reason in zip(self._sampling.uses, self._sampling.reasons)
            if self._raw[used[0]] is not None
        )
        return {name: reason for name, reason in (*reduced, *unusable) if reason}

    def _stamps(self, eddi_input: object, t: int) -> List[Optional[int]]:
        """Return when each variable was sampled."""
        return [_stamp(eddi_input, self._sources[used[0]].id, t) for used in self._sampling.uses]

    def reset(self) -> None:
        """Forget everything of former steps."""
        self.engine.reset()
        self._forget()

    def _forget(self) -> None:
        self._verdicts = self._unknown
        self._raw = [None] * len(self._sources)
        self._source = None


def _accepts(model_file: ModelFile) -> Dict[str, Tuple[str, ...]]:
    """Return event -> the words by which its text accepts silence."""
    given = model_file.model.get("accepts", {})
    if not isinstance(given, dict):
        raise ModelError("", "'accepts' of the model is no object")
    return {name: texts(words, f"'accepts' of {name!r}") for name, words in given.items()}


def _sources(sampling: Sampling, inputs: Tuple[InputSpec, ...]) -> List[InputSpec]:
    """Return the input of the model for each that the form asks for."""
    by_id = {spec.id: spec for spec in inputs}
    missing = [one.name for one in sampling.inputs if one.name not in by_id]
    if missing:
        raise ModelError("", f"there is no input for the variable {missing[0]!r}")
    return [by_id[one.name] for one in sampling.inputs]


def _is_nan(raw: Any) -> bool:
    return isinstance(raw, float) and math.isnan(raw)


def _read(eddi_input: object, spec: InputSpec) -> Any:
    """Return a raw value in the unit of the variable, None when it cannot be read."""
    try:
        raw = getattr(eddi_input, spec.attribute, None)
        if spec.factor is None:
            return raw
        value = plain(raw)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return value * spec.factor[0] / spec.factor[1]
    except Exception:  # noqa: BLE001 - a hostile object: whatever it raises, it is no evidence
        return None
    return raw


def _stamp(eddi_input: Any, input_id: str, t: int) -> Optional[int]:
    """Return when the input's sample was received, None when that is not known."""
    try:
        return stamp_at(t, eddi_input.states[input_id].age)
    except Exception:  # noqa: BLE001 - any object may be given as input
        return None
