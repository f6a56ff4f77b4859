"""The monitor of a perception scope: does the running window still look like the reference?"""

from __future__ import annotations

import math
from typing import Any, Iterable, Iterator, Mapping, NamedTuple

import numpy as np

from ..history import Messages
from ..inputs import NO_TIME, look_again, step_time
from ..monitor import Monitor, Tree, finite
from ..plain_values import Absent, read
from ..why import FALSE, TRUE, UNKNOWN, Cause, figure
from .arrays import NUMPY, Array, Axes, Numbers, array_of, take, torch_or_numpy
from .comparison import Comparison, Tail, Window

FILLING = "filling"
STALE = "stale"
OMITTED = -1  # index of no test


class SafeMLResult(NamedTuple):
    """The verdict of one step. Numbers that do not exist are NaN."""

    omission: bool  # there is no verdict now: the window is not full, or an input was not usable
    odd_violation: bool  # some distance is significant; while ``omission``, the last verdict
    significance_level: float  # probability of a false violation in one step
    statistic: float  # the largest distance of all tests (D for Kolmogorov-Smirnov)
    threshold: float  # from which on it is a violation
    threshold_theoretical: float  # the same for independent samples
    component: int  # index of the test with the largest distance; -1 while ``omission``
    # bound on its probability in all tests, asymptotic and for independent samples
    p_value_bound: float
    accepted: int  # samples so far that could be used
    rejected: int  # samples so far that could not
    # of the omission: ``filling``, ``empty``, ``not_finite``, ``wrong_length`` or ``stale``
    reason: str = ""


_SPOILT = "the output has no Booleans omission and odd_violation; it is an omission"


class SafeML(Monitor[SafeMLResult]):
    """What the class ``Monitor`` of compiled SafeML inherits; it takes every message."""

    kind = "safeml"
    metric: str  # ``ks``, ``cvm`` or ``ad``
    metric_name: str  # its name in the configuration
    window_size: int  # samples in a window
    stride: int  # only every so manieth sample enters the window
    significance_level: float  # per step, over all tests
    threshold: int | float  # of every test; n m D for ``ks``
    threshold_theoretical: int | float  # the same for independent samples
    tail: Tail  # statistic of one test -> probability of at least this
    hold: bool  # the last verdict is kept while there is none; else it becomes false
    # seconds without a sample after which the window is emptied; ``None``: never
    max_age: float | None
    single: bool  # samples come as float32
    axes: Axes | None = None  # ``None`` when the features themselves are tested
    # without axes the features, each ascending; with axes the rows of the sample
    reference: Numbers
    array_backend = "numpy"  # library of the arrays that the configuration asks for
    _phase: int
    _statistics: Array | None

    def __init__(self) -> None:
        arrays = NUMPY if self.array_backend == "numpy" else torch_or_numpy()
        self.backend = arrays.name  # name of the one that is used
        reference = array_of(self.reference)
        if self.axes is None:
            self._features = len(reference)
        else:
            self._features = len(self.axes.centre)
            reference = np.sort(self.axes.series(reference), axis=1)
        self._comparison = Comparison(self.metric, reference, self.window_size, arrays)
        self._window = Window(self._comparison)
        self._value = self._comparison.value(self.threshold)
        self._theoretical = self._comparison.value(self.threshold_theoretical)
        self.reset()

    def reset(self) -> None:
        self._clear()
        self._accepted = self._rejected = 0
        self._accepted_ns: int | None = None
        self._violation = self._judged = False
        self._violated: int | None = None  # when it began
        self._fault, self._timeless = "", False
        self._source = None
        self._last = self._result(FILLING)

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> SafeMLResult:
        """Take over new samples and compare once; never raises an Exception.

        The input holds the ``Messages`` since the last step, or one message of (d,) or (r, d)
        numbers; None: nothing is known of the source. Time is asked for ``max_age`` only.
        """
        look_again(eddi_input, t_ns)
        self._source, self._at = eddi_input, t_ns
        now = step_time(t_ns)
        self._timeless = now is None and self.max_age is not None
        if self._timeless:
            self._last = self._result(STALE)
            return self._last
        value: Any = read(eddi_input, self.inputs[0].attribute, self.inputs[0].id)
        if self._accepted_ns is not None and self.max_age is not None:
            self._accepted_ns = min(self._accepted_ns, now or 0)
            age = ((now or 0) - self._accepted_ns) / 1e9
            if age > self.max_age * (1 + 1e-9) and self._window.filled > 0:
                self._clear()
                self._last = self._result(STALE)
        if value is None or isinstance(value, Absent):
            self._fault = ""
            self._last = self._result(FILLING if self._accepted_ns is None else STALE)
        elif not (isinstance(value, Messages) and not value):
            taken = take(value, self._features, single=self.single)
            self._push(taken.rows, now or 0)
            self._rejected += len(taken.bad)
            self._fault = taken.fault
            complete = not taken.bad and self._window.is_full
            self._last = self._verdict() if complete else self._result((*taken.bad, FILLING)[0])
        return self._last

    def _push(self, rows: list[Array], now: int) -> None:
        entering = rows[-self._phase % self.stride :: self.stride]
        self._phase = (self._phase + len(rows)) % self.stride
        self._accepted += len(rows)
        self._accepted_ns = now if rows else self._accepted_ns
        for row in entering[-self.window_size :]:
            self._window.push(row if self.axes is None else self.axes.values(row))
        if entering:
            self._statistics = None  # of another window

    def _verdict(self) -> SafeMLResult:
        if self._statistics is None:
            self._statistics = self._window.statistics()
        test = int(self._statistics.argmax())
        largest = self._statistics[test]
        violation = bool(largest >= self.threshold)
        if violation and not self._violation:
            self._violated = step_time(self._at)
        self._judged, self._violation = True, violation
        value = self._comparison.value(largest)
        return self._result("", value, test, min(1.0, self._comparison.tests * self.tail(value)))

    def _result(
        self, reason: str, value: float = math.nan, test: int = OMITTED, bound: float = math.nan
    ) -> SafeMLResult:
        violation = self._violation and (self.hold or not reason)
        return SafeMLResult(
            reason != "", violation, self.significance_level, value, self._value,
            self._theoretical, test, bound, self._accepted, self._rejected, reason,
        )  # fmt: skip

    def _clear(self) -> None:
        self._window.clear()
        self._phase = 0
        self._statistics = None

    def omission(self) -> tuple[str, str]:
        """Return why there is no verdict: as in the status, and for people; else both empty."""
        reason, words = self._last.reason, self._fault
        if reason == FILLING:
            words = f"the window has {self._window.filled} of {self.window_size} samples"
        elif reason == STALE:
            limit = "its limit" if self.max_age is None else f"{self.max_age:g} s"
            words = NO_TIME if self._timeless else f"the last sample is older than {limit}"
        return reason, words if reason else ""

    def as_json(self, output: SafeMLResult) -> Mapping[str, bool | int | float | str | None]:
        return {name: finite(value) for name, value in output._asdict().items()}

    def series(self, output: SafeMLResult) -> Mapping[str, bool | float | str | None]:
        known = self.as_json(output)
        names = ("statistic", "threshold", "odd_violation", "omission")
        return {name: known[name] for name in names}

    def decided(self, output: SafeMLResult) -> Mapping[str, bool | float | str | None]:
        return {"in_scope": None if output.omission else not output.odd_violation}

    def message(self, output: object) -> Tree:
        omission = getattr(output, "omission", None)
        violation = getattr(output, "odd_violation", None)
        sound = isinstance(omission, bool) and isinstance(violation, bool)
        self._output_faults = () if sound else (_SPOILT,)
        flags = {
            "omission": omission is not False or not sound,
            "odd_violation": violation is True,
        }
        return "SafeMLOutput", {**flags, "significance_level": self.significance_level}

    def status_message(self) -> Tree:
        last = self._last
        fields: dict[str, Any] = {
            **last._asdict(),
            "held": last.omission and self.hold and self._judged,
            "metric": self.metric_name,
            "filled": self._window.filled,
            "window_size": self.window_size,
            "in_scope": not last.omission and not last.odd_violation,
            "acceptances": list(self.accepted()),
        }
        del fields["significance_level"]
        return "SafeMLStatus", fields

    def _whys(self) -> Iterator[tuple[str, int, Iterable[Cause]]]:
        last, spec = self._last, self.inputs[0]
        if not last.omission:
            limit, since = last.threshold, self._lasting(self._violated)
            text = f"statistic {figure(last.statistic)} for {{since}}, limit {figure(limit)}"
            wrong = [Cause((), "false", text, since=since, limit=limit)]
            yield "in_scope", FALSE if last.odd_violation else TRUE, wrong
            return
        reason, words = self.omission()
        own = Cause((), "invalid", words or "no value")
        since = self._known_for(spec)
        causes = self._of_input(spec, UNKNOWN, since if math.isfinite(since) else 0.0, own)
        if reason == FILLING and causes[0].text == own.text:  # its messages come
            text = f"window has {self._window.filled} of {self.window_size} samples"
            causes = [Cause((), "window", text, since=causes[0].since)]
        yield "in_scope", UNKNOWN, causes

    def faults(self) -> dict[str, str]:
        return {self.inputs[0].id: self._fault} if self._fault else {}
