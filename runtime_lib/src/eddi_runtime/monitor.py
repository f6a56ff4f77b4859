"""What every monitor offers, and whether a compiled one and this runtime fit."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable
from types import ModuleType
from typing import Any, Mapping, Protocol, Sequence, Tuple, TypeVar, Union

from .inputs import EDDIInputBase, InputSpec, accepted, of_topic, step_time
from .plain_values import is_nan, one_line, read
from .why import UNKNOWN, Cause, ClaimWhy, claim_why

__version__ = "1.0.0"
"""Of this runtime."""

_MARK = b"\n# sha256 of the lines below: "


class ModelError(ValueError):
    """A monitor cannot run."""

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(f"{path}: {reason}" if path else reason)
        # the file of the compiled monitor, or another name for where it came from
        self.path = path
        self.reason = reason  # what is wrong, one sentence without a full stop


def needs(file: str, formats: Mapping[ModuleType, int]) -> None:
    """Refuse a compiled monitor that was changed, or needs another runtime (``ModelError``)."""
    for part, wanted in formats.items():
        if wanted != part.FORMAT:
            reason = (
                f"compiled for format {wanted} of {part.__name__}, but eddi_runtime {__version__}"
                f" runs {part.FORMAT}: run `eddi-scaffold upgrade`"
            )
            raise ModelError(file, reason)
    try:
        with open(file, "rb") as opened:  # noqa: PTH123 - pathlib would double the time of a start
            _, mark, rest = opened.read().partition(_MARK)
    except OSError:
        return  # byte code alone, or a text that was compiled in memory
    digest, _, below = rest.partition(b"\n")
    if not mark or digest.decode("ascii", "replace") != hashlib.sha256(below).hexdigest():
        reason = "the file was changed after it was generated: run `eddi-scaffold upgrade`"
        raise ModelError(file, f"{reason} or `copier recopy --trust --force` in the package")


Field = Union[str, bool, int, float, Sequence["Field"], "Tree"]
Tree = Tuple[str, Mapping[str, Field]]
"""A message without ROS: (name, field -> str, bool, int, float, list or Tree)."""
Trees = Union[Tree, "list[Tree]", None]
"""What one step gives: a message, several, or none."""

Json = Union[str, bool, int, float, None, Sequence["Json"], Mapping[str, "Json"]]
"""What ``json`` can write."""

Output = TypeVar("Output")  # what a step of one kind of monitor gives

Value = Union[bool, float, str, None]  # a named result for people and plots; None is unknown


def row_trees(
    output: object, tree_of: Callable[[Any], Tree]
) -> tuple[list[Tree] | None, list[str]]:
    """Return the tree of each row of an output (None: it has none), and what is wrong."""
    rows: Any = output
    # "isinstance" would believe what calls itself a list
    if not issubclass(type(output), (list, tuple)):
        return None, ["the output is not a list"]
    trees: list[Tree] = []
    faults: list[str] = []
    for row in rows:
        try:
            trees.append(tree_of(row))
        except Exception as problem:  # noqa: BLE001, PERF203 - whatever it raises
            faults.append(f"a row of the output is left out: {one_line(problem)}")
    return trees, faults


def finite(value: Any) -> Any:
    """Return a number as ``json`` can write it: None for one that is none."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _has_states(source: object) -> bool:
    return issubclass(type(source), EDDIInputBase)


class Steps(Protocol):
    """What a node steps: the generated ``EDDIMonitor``, or a monitor itself."""

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> object:
        """Evaluate once, see ``Monitor``."""


class Monitor(Protocol[Output]):
    """One compiled model. Not thread-safe: the thread that steps it also asks it."""

    model_id: str  # id of the model
    digest: str  # SHA-256 of what the monitor computes; robots compare it
    kind: str  # name of the kind (``consert``)
    inputs: tuple[InputSpec, ...]  # what ``execute_step`` reads, one attribute each
    topics: Mapping[str, str] = {}  # SimulatorOutput id -> its topic; a node sets full names
    hazards: frozenset[str] = frozenset()  # claims of which the absence holds
    unlogged: frozenset[str] = frozenset()  # claims that change as a matter of course
    deferred: bool = False  # who runs it calls ``published``
    _source: object = None  # what the last step was given
    _at: object = None  # the time that it was given
    _output_faults: tuple[str, ...] = ()

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> Output:
        """Evaluate once; never raises, whatever the attributes of ``eddi_input`` are.

        ``t_ns``: time in nanoseconds by any one clock; None: the machine's monotonic clock.
        """

    def as_json(self, output: Output) -> Json:
        """Return what ``execute_step`` gave as ``json`` can write it: as it is, where it can."""
        made: Json = output  # type: ignore[assignment]
        return made

    def series(self, output: Output) -> Mapping[str, Value]:
        """Return what ``execute_step`` gave as named values, always the same names."""

    def decided(self, output: Output) -> Mapping[str, Value]:
        """Return the verdicts in an output, always the same names; no number that drifts."""
        return self.series(output)

    def message(self, output: object) -> Trees:
        """Return what ``execute_step`` gave as checked message trees, None for nothing.

        It never raises, whatever a person's code has made of the output.
        """

    def published(
        self, warn: Callable[[str], object], error: Callable[[str, str, str], object]
    ) -> None:
        """Do what is due now that the result is published; never raises.

        ``error``: takes what went wrong: where, why (empty: no longer), and a traceback.
        """

    def output_faults(self) -> tuple[str, ...]:
        """Return what was wrong with the output that ``message`` was given last."""
        return self._output_faults

    def status_message(self) -> Tree | None:
        """Return the facts behind the last step, without a header; None for none.

        What a kind publishes beside its result has a method of its own: ``<name>_message``.
        """
        return None

    def why(self) -> Mapping[str, ClaimWhy]:
        """Return claim id -> why it is as it is after the last step; never raises.

        Claims are guarantees without ``default``, events, thresholds, and the scope of SafeML.
        """
        try:
            return {row[0]: claim_why(self.model_id, *row) for row in self._whys()}
        except Exception:  # noqa: BLE001 - what people read must not end what robots rely on
            return {}

    def _whys(self) -> Iterable[tuple[str, int, Iterable[Cause]]]:
        """Return id, verdict and causes of each claim, as the claim sees them."""
        return ()

    def _of_input(self, spec: InputSpec, verdict: int, since: float, own: Cause) -> list[Cause]:
        """Return why an input is FALSE or UNKNOWN for some seconds; ``own``: by its value."""
        source: Any = self._source
        causes: list[Cause] = []
        if _has_states(source):
            causes = source.why(spec, verdict, since, self.topics)
        causes = causes or [of_topic(spec, self.topics, own._replace(since=since))]
        return [cause.under(spec.id) for cause in causes]

    def _of_unknown(
        self, specs: Iterable[InputSpec], faults: Mapping[str, str], detail: str = ""
    ) -> list[Cause]:
        """Return why inputs are not known, first those that have long been so.

        ``faults``: input id -> what is wrong with its value; ``detail``: for the brackets.
        """
        causes: list[Cause] = []
        for spec in sorted(specs, key=lambda spec: -self._known_for(spec)):
            nan = is_nan(read(self._source, spec.attribute, spec.id))
            text = "NaN" if nan else faults.get(spec.id) or "no value"
            since = self._known_for(spec)
            causes += self._of_input(spec, UNKNOWN, since, Cause((), "invalid", text))
        return [cause.because(cause.state, cause.text, detail) for cause in causes]

    def _known_for(self, *specs: InputSpec) -> float:
        """Return for how many seconds inputs have been known, or unknown, as they are."""
        source: Any = self._source
        return source.known_for(specs) if _has_states(source) else math.inf

    def _lasting(self, began: float | None) -> float:
        """Return for how many seconds it has been so since a time in nanoseconds."""
        now = step_time(self._at)
        if now is None or began is None:
            return 0.0
        # where the clock went back, no longer than since then
        return (now - began) / 1e9 if now >= began else self._known_for(*self.inputs)

    def accepted(self) -> Sequence[str]:
        """Return ``input: key`` for each acceptance that was in use in the last step."""
        return accepted(self.inputs, self._source)

    def faults(self) -> Mapping[str, str]:
        """Return input id -> what was wrong with its value in the last step."""

    def reset(self) -> None:
        """Forget everything of former steps."""
