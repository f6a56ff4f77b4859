"""What a step of a reliability monitor gives, and its explanation."""

from __future__ import annotations

from typing import Mapping, NamedTuple

from .component import Importance


class ReliabilityResult(NamedTuple):
    """The reliability over the horizon."""

    valid: bool  # everything on which the result depends is known, and no error occurred
    # probability of failure from now to the horizon; the worst case of what is unknown, and of
    # what was missed before
    p_fail: float
    p_fail_low: float  # in the best case of that
    p_fail_high: float  # in the worst case
    reliability: float  # probability of no failure from now to the horizon
    mttf: float  # remaining mean time to failure in hours; inf; NaN: not computed
    horizon: float  # hours from now
    evidence: Mapping[str, bool]  # id of a threshold -> active
    unknown: tuple[str, ...]  # inputs that are not known
    # why the result is not valid; of a valid one, what was missed before and is still open, so
    # that the bounds differ
    reason: str
    contributions: Mapping[str, float]  # model -> its p_fail_high


_SHOWN = 5


class Explanation(NamedTuple):
    """Explanation of the result of one step."""

    result: ReliabilityResult  # of the step
    known: Mapping[str, object]  # input -> its value
    unknown: Mapping[str, str]  # input -> why it is not known; empty where nothing came
    # input -> what is wrong with its value, also where the value is known
    faults: Mapping[str, str]
    # (model, its p_fail_high), the most probable failure first
    contributions: tuple[tuple[str, float], ...]
    # events of the top fault tree, those that decide most often first
    importances: tuple[Importance, ...]
    # model -> how often a claim was ignored that something failed works again
    ignored: Mapping[str, int]

    def text(self) -> str:
        """Return the explanation as lines for people, without a line end behind the last."""
        return "\n".join(self._lines())

    def _lines(self) -> list[str]:
        one = self.result
        bounds = f" ({one.p_fail_low:.3g} to {one.p_fail_high:.3g})"
        shown = bounds if one.p_fail_low != one.p_fail_high else ""
        because = f": {one.reason}" if one.reason else ""
        why = f"{'valid' if one.valid else 'not valid'}{because}"
        lines = [f"p_fail {one.p_fail:.3g}{shown} within {one.horizon:g} h, {why}"]
        lines += [f"  {name} is {'' if on else 'not '}active" for name, on in one.evidence.items()]
        lines += [f"  {name} is unknown{_because(why)}" for name, why in self.unknown.items()]
        lines += [f"  {name}: {why}" for name, why in self.faults.items() if name in self.known]
        for name, p in self.contributions[:_SHOWN]:
            lines.append(f"  model {name}: p_fail {p:.3g}")
        for event in self.importances[:_SHOWN]:
            decides = f"decides {event.criticality:.3g} of p_fail"
            lines.append(f"  event {event.event}: p {event.probability:.3g}, {decides}")
        for name, count in self.ignored.items():
            times = "once" if count == 1 else f"{count} times"
            lines.append(f"  model {name}: ignored {times} that something failed works again")
        return lines


def _because(reason: str) -> str:
    return f": {reason}" if reason else ""
