"""Inputs that are computed by an expression over messages (``expression:`` in eddi_config.yml).

The window state lives here, so that a regenerated package and a hand-written region never meet it.
"""

from __future__ import annotations

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ..access import Step, follow, gather
from ..documents import ModelError, take
from ..plain_values import one_line
from .engine import Engine, build_engine, stamp_at
from .form import BOOL
from .sampling import Sampling

TYPES = ("bool", "float", "int", "state")


class Source(NamedTuple):
    """Where a variable comes from.

    Attributes:
        id: of the SimulatorOutput, or of another input.
        path: into its message (``access.follow``); empty: the value itself.
        checks: when it is a measurement: ``within`` with the paths of two limits, ``unless`` with
            a path and the value that marks that it is none.
    """

    id: str
    path: Tuple[Step, ...]
    checks: Tuple[Any, ...] = ()


class InputExpression:
    """One input's expression. Not thread-safe.

    Attributes:
        type: ``bool``, ``float``, ``int`` or ``state``.
        sources: what it reads; one tuple for each form.
        requires: the ids of all sources, in order and once each.
        reason: why a value could not be read in the last step, empty when all could be.
    """

    def __init__(self, document: Mapping[str, Any]) -> None:
        """Compile what ``eddi_scaffold.language.input_expressions`` made.

        Raises:
            ModelError: the document is damaged.
        """
        where = "an expression"
        self.type: str = take(document, "type", str, where)
        if self.type not in TYPES:
            raise ModelError("", f"{where} has the unknown type {self.type!r}")
        self._hazard = document.get("polarity") == "HAZARD"
        self.reason = ""
        paths: Mapping[str, Any] = document.get("paths", {})
        checks: Mapping[str, Any] = document.get("checks", {})
        self._names: List[str] = []
        self._engines: List[Engine] = []
        self._samplings: List[Sampling] = []
        self._reduced: Dict[Tuple[int, int], Tuple[Any, Any]] = {}
        self.sources: List[Tuple[Source, ...]] = []
        for part in take(document, "parts", list, where):
            self._names.append(take(part, "state", str, where) if self.type == "state" else "")
            engine = build_engine(take(part, "form", dict, where))
            self._engines.append(engine)
            sampling = Sampling(engine.form)
            self._samplings.append(sampling)
            self.sources.append(
                tuple(
                    _source(one.name, paths)._replace(checks=tuple(checks.get(one.name, ())))
                    for one in sampling.inputs
                )
            )
            kind = engine.form.nodes[engine.form.outputs[0].node].type
            if (kind == BOOL) != (self.type in ("bool", "state")):
                raise ModelError("", f"{where} of type {self.type} gives a {kind}")
        if not self._engines or (self.type != "state" and len(self._engines) != 1):
            raise ModelError("", f"{where} has {len(self._engines)} parts")
        ids = (source.id for sources in self.sources for source in sources)
        self.requires = tuple(dict.fromkeys(ids))

    def value(
        self,
        t: int,
        messages: Mapping[str, Any],
        ages: Optional[Mapping[str, float]] = None,
    ) -> Union[bool, float, int, str, None]:
        """Evaluate once and return the input's value, None for UNKNOWN; never raises.

        A boolean HAZARD is True when UNKNOWN. A state is the one whose condition is TRUE while
        all others are FALSE.

        Args:
            t: time in nanoseconds.
            messages: id -> latest message or value; absent: none yet.
            ages: id -> seconds since it was received; absent: fresh.
        """
        self.reason = ""
        found = [self._step(part, t, messages, ages) for part in range(len(self._engines))]
        if self.type == "state":
            return self._state(found)
        if self.type == "bool":
            unknown = True if self._hazard else None
            return unknown if found[0] == 1 else found[0] == 2
        if math.isnan(found[0]):
            return None
        if self.type == "float":
            return float(found[0])
        return round(found[0]) if math.isfinite(found[0]) else None

    def reset(self) -> None:
        """Forget everything of former steps."""
        self._reduced = {}
        for engine in self._engines:
            engine.reset()

    def _step(
        self,
        part: int,
        t: int,
        messages: Mapping[str, Any],
        ages: Optional[Mapping[str, float]],
    ) -> Union[float, int]:
        """Return the value of one form."""
        engine, sampling, sources = self._engines[part], self._samplings[part], self.sources[part]
        raws, stamps = [], []
        for k, variable in enumerate(engine.form.variables):
            used = [sources[one] for one in sampling.uses[k]]
            message = messages.get(used[0].id)
            if variable.reduction is None:
                raws.append(self._read(message, used[0]))
            else:
                raws.append(self._reduction(part, k, message, used))
            stamps.append(None if ages is None else stamp_at(t, ages.get(used[0].id)))
        return engine.step(t, raws, None if ages is None else stamps)[0]

    def _reduction(self, part: int, k: int, message: Any, used: Sequence[Source]) -> Any:
        """Return a reduction of a message; that of the same message as before is not done anew."""
        before = self._reduced.get((part, k))
        if before is not None and before[0] is message and message is not None:
            return before[1]
        sampling = self._samplings[part]
        value = sampling.raw(k, [self._read(message, source) for source in used])
        if message is not None:
            self.reason = self.reason or sampling.reasons[k]
        self._reduced[part, k] = (message, value)
        return value

    def _read(self, message: Any, source: Source) -> Any:
        """Return a value, None when it cannot be read; the first reason is kept."""
        if message is None:
            return None
        try:
            return _measured(message, source)
        except Exception as problem:  # noqa: BLE001 - messages are what the robot sends
            self.reason = self.reason or one_line(problem)
            return None

    def _state(self, truths: Sequence[Union[float, int]]) -> Optional[str]:
        if truths.count(2) == 1 and truths.count(0) == len(truths) - 1:
            return self._names[truths.index(2)]
        return None


def source_of(name: str) -> Source:
    """Split the name of a variable: ``temps.data[1]`` -> id ``temps``, path ``data``, 1."""
    pieces = name.replace("[", ".[").split(".")
    parts = [int(one[1:-1]) if one.startswith("[") else one for one in pieces]
    return Source(str(parts[0]), tuple(parts[1:]))


def _source(name: str, paths: Mapping[str, Any]) -> Source:
    """Return where a variable comes from; names with keys are in the document."""
    head = source_of(name.partition(".")[0].partition("[")[0]).id
    return Source(head, tuple(paths[name])) if name in paths else source_of(name)


def read_path(message: Any, path: Sequence[Step]) -> Any:
    """Return a field of a message; a time or duration of ROS is its seconds.

    Raises:
        Exception: it is not there, or the message is of any other kind.
    """
    if any(isinstance(step, (list, tuple)) and step[0] == "*" for step in path):
        return gather(message, path)
    value = follow(message, path)
    to_sec = getattr(value, "to_sec", None)
    return value if to_sec is None else to_sec()


def _measured(message: Any, source: Source) -> Any:
    """Return a value of a message.

    Raises:
        LookupError: it is missing, or the message marks it as not measured.
    """
    value = read_path(message, source.path)
    for check in source.checks:
        if not _is_measurement(message, value, check):
            field = ".".join(str(step) for step in check[1])
            raise LookupError(f"no measurement, by {field} of {source.id}")
    return value


def _is_measurement(message: Any, value: Any, check: Sequence[Any]) -> bool:
    """Return whether a message marks a value of it as measured."""
    if check[0] == "unless":
        return bool(follow(message, check[1]) != check[2])
    low, high = (follow(message, path) for path in check[1:])
    return bool(math.isinf(value) or low <= value <= high)
