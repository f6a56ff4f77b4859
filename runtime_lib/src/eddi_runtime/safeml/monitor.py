"""The monitor of a perception scope: does the running window still look like the reference?"""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple, Union

from ..clock import NO_TIME, step_time
from ..documents import ModelError
from ..inputs import InputSpec, Messages, accepted
from ..model_file import ModelFile
from ..monitor import Standing, Tree
from . import limits, result
from .arrays import Array, backend
from .comparison import Comparison
from .design import Design
from .model import SafeMLModel, read_safeml
from .result import FILLING, OMITTED, STALE, OneTest, SafeMLResult
from .samples import Taken, take
from .window import Window

_NAN = float("nan")


def build(
    model_file: ModelFile,
    hooks: object = None,  # noqa: ARG001 - part of the interface of every kind
) -> SafeMLMonitor:
    """Make the monitor: axes and sorted references are found anew from the reference file.

    Args:
        model_file: the model.
        hooks: not used: all hand-written code is in EDDIInput.

    Raises:
        ModelError: the model is wrong, or the reference is not the one of the thresholds.
    """
    return SafeMLMonitor(model_file)


class SafeMLMonitor:
    """Compares the last samples with a reference. Not thread-safe.

    Attributes:
        model_id: id of the model.
        digest: SHA-256 of the model file's content.
        kind: ``safeml``.
        inputs: the one input, which takes every message.
        labels: name of each test for people.
        backend: name of the library of the arrays.
    """

    kind = "safeml"

    def __init__(self, model_file: ModelFile) -> None:
        self.model_id = model_file.id
        self.digest = model_file.digest
        self.inputs: Tuple[InputSpec, ...] = model_file.inputs
        if len(self.inputs) != 1:
            raise ModelError("", f"one input is expected, not {len(self.inputs)}")
        self._model: SafeMLModel = read_safeml(model_file)
        arrays = backend(self._model.array_backend)
        self._design = Design(self._model.rows, self._model.spec)
        self._model = self._model._replace(rows=None)  # the sorted reference is enough from here
        self.labels = self._design.labels
        self.backend = arrays.name
        model = self._model
        self._comparison = Comparison(
            model.metric, self._design.reference, model.window_size, arrays
        )
        self._window = Window(self._comparison)
        self._threshold = self._comparison.value(model.threshold)
        self._theoretical = self._comparison.value(model.threshold_theoretical)
        self._tail = limits.tail(model.metric, self._comparison.n, model.window_size)
        self._output_faults: Tuple[str, ...] = ()
        self.reset()

    def reset(self) -> None:
        """Forget all samples and verdicts."""
        self._window.clear()
        self._phase = 0
        self._accepted = self._rejected = 0
        self._accepted_ns: Optional[int] = None
        self._violation = self._judged = False
        self._statistics: Optional[Array] = None
        self._fault, self._timeless = "", False
        self._source: object = None
        self._last = self._omitted(FILLING)

    def execute_step(self, eddi_input: object, t_ns: Optional[int] = None) -> SafeMLResult:
        """Take over new samples and compare once; never raises an Exception.

        Args:
            eddi_input: its attribute holds the messages since the last step (``Messages``, as
                EDDIInput makes it), or one message: (d,) or (r, d) numbers. None: nothing is
                known of the source.
            t_ns: time in nanoseconds, only for ``max_age``; what is no whole number is no time, and
                the step is omitted then.
        """
        self._source = eddi_input
        time = step_time(t_ns)
        self._timeless = time is None and self._model.max_age is not None
        if self._timeless:
            self._last = self._omitted(STALE)
            return self._last
        now = time or 0
        try:
            value = getattr(eddi_input, self.inputs[0].attribute, None)
        except Exception:  # noqa: BLE001 - a property may raise anything
            value = None
        if self._too_old(now):
            self._clear()
            self._last = self._omitted(STALE)
        if value is None:
            self._fault = ""
            self._last = self._omitted(FILLING if self._accepted_ns is None else STALE)
        elif not (isinstance(value, Messages) and not value):
            taken = take(value, self._design.features, single=self._model.spec.single)
            self._last = self._judge(taken, now)
        return self._last

    def _judge(self, taken: Taken, now: int) -> SafeMLResult:
        self._push(taken.rows)
        self._accepted += len(taken.rows)
        self._rejected += len(taken.bad)
        self._fault = taken.fault
        if taken.rows:
            self._accepted_ns = now
        if not taken.bad and self._window.is_full:
            return self._verdict()
        return self._omitted(taken.bad[0] if taken.bad else FILLING)

    def _push(self, rows: List[Array]) -> None:
        stride = self._model.stride
        entering = rows[-self._phase % stride :: stride]
        self._phase = (self._phase + len(rows)) % stride
        for row in entering[-self._model.window_size :]:
            self._window.push(self._design.values(row))
        if entering:
            self._statistics = None  # of another window

    def _verdict(self) -> SafeMLResult:
        if self._statistics is None:
            self._statistics = self._window.statistics()
        test = int(self._statistics.argmax())
        largest = self._statistics[test]
        self._judged = True
        self._violation = bool(largest >= self._model.threshold)
        value = self._comparison.value(largest)
        return SafeMLResult(
            omission=False,
            odd_violation=self._violation,
            significance_level=self._model.significance_level,
            statistic=value,
            threshold=self._threshold,
            threshold_theoretical=self._theoretical,
            component=test,
            p_value_bound=min(1.0, self._comparison.tests * self._tail(value)),
            accepted=self._accepted,
            rejected=self._rejected,
        )

    def _omitted(self, reason: str) -> SafeMLResult:
        return SafeMLResult(
            omission=True,
            odd_violation=self._violation and self._model.hold,
            significance_level=self._model.significance_level,
            statistic=_NAN,
            threshold=self._threshold,
            threshold_theoretical=self._theoretical,
            component=OMITTED,
            p_value_bound=_NAN,
            accepted=self._accepted,
            rejected=self._rejected,
            reason=reason,
        )

    def _too_old(self, now: int) -> bool:
        """Return whether the window is too old; a clock that jumped back begins the age anew."""
        if self._accepted_ns is None or self._model.max_age is None:
            return False
        self._accepted_ns = min(self._accepted_ns, now)
        age = (now - self._accepted_ns) / 1e9
        return age > self._model.max_age * (1 + 1e-9) and self._window.filled > 0

    def _clear(self) -> None:
        self._window.clear()
        self._phase = 0
        self._statistics = None

    def omission(self) -> Tuple[str, str]:
        """Return why there is no verdict now: as in the status, and in words for people.

        Both are empty when there is one.
        """
        reason, model = self._last.reason, self._model
        words = self._fault
        if reason == FILLING:
            words = f"the window has {self._window.filled} of {model.window_size} samples"
        elif reason == STALE:
            limit = "its limit" if model.max_age is None else f"{model.max_age:g} s"
            words = NO_TIME if self._timeless else f"the last sample is older than {limit}"
        return reason, words if reason else ""

    def explain(self) -> Tuple[OneTest, ...]:
        """Return every test of the present window, the largest distance first.

        Empty while there is no verdict.
        """
        if self._last.omission or self._statistics is None:
            return ()
        outcomes = [self._outcome(test) for test in range(self._comparison.tests)]
        return tuple(sorted(outcomes, key=lambda one: -one.statistic))

    def _outcome(self, test: int) -> OneTest:
        assert self._statistics is not None
        value = self._comparison.value(self._statistics[test])
        return OneTest(
            test,
            self.labels[test],
            value,
            self._threshold,
            violated=bool(self._statistics[test] >= self._model.threshold),
            p_value=self._tail(value),
            weights=tuple(self._design.weights(test)),
        )

    def as_json(self, output: SafeMLResult) -> Mapping[str, Union[bool, int, float, str, None]]:
        """Return a result with its names; NaN becomes None."""
        return result.as_json(output)

    def series(self, output: SafeMLResult) -> Mapping[str, Union[bool, float, str, None]]:
        """Return statistic, threshold, verdict and omission."""
        return result.series(output)

    def decided(self, output: SafeMLResult) -> Mapping[str, Union[bool, float, str, None]]:
        """Return verdict and omission."""
        return {"odd_violation": output.odd_violation, "omission": output.omission}

    def message(self, output: Any) -> Tree:
        """Return a result as a ``SafeMLOutput`` tree; never raises.

        What hand-written code has spoilt is published as an omission; ``output_faults`` reports it.
        """
        tree, faults = result.output_message(output, self._model.significance_level)
        self._output_faults = tuple(faults)
        return tree

    def output_faults(self) -> Tuple[str, ...]:
        """Return what was wrong with the output that ``message`` was given last."""
        return self._output_faults

    def status_message(self) -> Tree:
        """Return the facts behind the last step as a ``SafeMLStatus`` tree without header."""
        return result.status_message(
            self._last,
            self._model.metric_name,
            self._window.filled,
            self._model.window_size,
            held=self._last.omission and self._model.hold and self._judged,
            acceptances=self.accepted(),
        )

    def standings(self) -> List[Standing]:
        """Return whether the window is in scope after the last step."""
        if self._last.omission:
            return [Standing("", "in_scope", False, ((self.inputs[0].id, self.omission()[1]),))]
        reason = "the samples differ from the reference" if self._last.odd_violation else ""
        return [Standing("", "in_scope", not reason, (), reason)]

    def accepted(self) -> Tuple[str, ...]:
        """Return ``input: key`` for each acceptance that was in use in the last step."""
        return accepted(self.inputs, self._source)

    def blocked(self, not_known: Iterable[str] = ()) -> Dict[str, Tuple[str, ...]]:
        """Return the input and what is not known because of it, while there is no verdict."""
        name = self.inputs[0].id
        return {name: ("odd_violation",)} if self._last.omission or name in set(not_known) else {}

    def faults(self) -> Dict[str, str]:
        """Return what was wrong with a message of the last step."""
        return {self.inputs[0].id: self._fault} if self._fault else {}
