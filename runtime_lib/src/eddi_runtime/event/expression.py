"""Inputs that are computed by an expression over messages (``expression:`` in eddi_config.yml).

The window state lives here, so that a regenerated package and a hand-written region never meet it.
"""

from __future__ import annotations

import math
from typing import Any, Callable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from ..model_file import ModelError, take
from .engine import Engine, build_engine
from .form import BOOL

Step = Union[str, int]
"""Name of a field, or index into a list."""
Read = Callable[[Any], Any]
TYPES = ("bool", "float", "int", "state")


class Source(NamedTuple):
    """Where a variable comes from.

    Attributes:
        id: of the SimulatorOutput, or of another input.
        path: fields and indices in its message; empty: the value itself.
    """

    id: str
    path: Tuple[Step, ...]


class InputExpression:
    """One input's expression. Not thread-safe.

    Attributes:
        type: ``bool``, ``float``, ``int`` or ``state``.
        sources: what it reads, by number of the variable; one tuple for each form.
        requires: the ids of all sources, in order and once each.
    """

    def __init__(self, document: Mapping[str, Any]) -> None:
        """Compile what ``eddi_scaffold.events.inputs`` made.

        Raises:
            ModelError: the document is damaged.
        """
        where = "an expression"
        self.type: str = take(document, "type", str, where)
        if self.type not in TYPES:
            raise ModelError("", f"{where} has the unknown type {self.type!r}")
        self._hazard = document.get("polarity") == "HAZARD"
        self._names: List[str] = []
        self._engines: List[Engine] = []
        self.sources: List[Tuple[Source, ...]] = []
        for part in take(document, "parts", list, where):
            self._names.append(take(part, "state", str, where) if self.type == "state" else "")
            engine = build_engine(take(part, "form", dict, where))
            self._engines.append(engine)
            self.sources.append(tuple(source_of(v.name) for v in engine.form.variables))
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
        found = [
            engine.step(
                t,
                [read_path(messages.get(source.id), source.path) for source in sources],
                None if ages is None else [_stamp(t, ages.get(one.id)) for one in sources],
            )[0]
            for engine, sources in zip(self._engines, self.sources)
        ]
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
        for engine in self._engines:
            engine.reset()

    def _state(self, truths: Sequence[Union[float, int]]) -> Optional[str]:
        if truths.count(2) == 1 and truths.count(0) == len(truths) - 1:
            return self._names[truths.index(2)]
        return None


def source_of(name: str) -> Source:
    """Split the name of a variable: ``temps.data[1]`` -> id ``temps``, path ``data``, 1."""
    pieces = name.replace("[", ".[").split(".")
    parts = [int(one[1:-1]) if one.startswith("[") else one for one in pieces]
    return Source(str(parts[0]), tuple(parts[1:]))


def read_path(message: Any, path: Sequence[Step]) -> Any:
    """Return a field of a message, None when it is not there; never raises.

    A time or duration of ROS is its seconds.
    """
    try:
        for step in path:
            message = message[step] if isinstance(step, int) else getattr(message, step)
        to_sec = getattr(message, "to_sec", None)
        return message if to_sec is None else to_sec()
    except Exception:  # noqa: BLE001 - messages are what the robot sends
        return None


def _stamp(t: int, age: Optional[float]) -> Optional[int]:
    return t - round(age * 1e9) if age is not None and math.isfinite(age) else None
