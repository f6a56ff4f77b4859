"""What a node says of itself on ``/diagnostics``: its inputs with their ages, and its steps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.watch.limits import MAX_INPUTS, plain

_AGE = ".age_s"
_OURS = "runtime_version"
"""A value that the status of no other node has."""
_INACTIVE = "inactive: "
_STANDINGS = ("guarantee", "threshold", "event", "in_scope")


@dataclass(frozen=True)
class InputReport:
    """One input of a monitor.

    Attributes:
        id: as in the model.
        state: in a word: ok, waiting, latched, missing, stale or invalid.
        age: of its oldest message in seconds, ``None``: not known, or there is none.
        reason: why it is not ok.
    """

    id: str
    state: str
    age: float | None
    reason: str


@dataclass(frozen=True)
class NodeReport:
    """One node, as it reported itself last.

    Attributes:
        t: when, in seconds on the clock of the receiver.
        node: its full name.
        model: id of its model.
        message: what is wrong, or that all is in order.
        inputs: in the order of the model.
        reasons: guarantee, threshold or event that is inactive -> why, in words.
        steps: so far.
        overruns: steps that were left out so far.
        longest_step: seconds.
    """

    t: float
    node: str
    model: str
    message: str
    inputs: tuple[InputReport, ...] = ()
    reasons: Mapping[str, str] = field(default_factory=dict)
    steps: int = 0
    overruns: int = 0
    longest_step: float = 0.0


def reports_of(array: Any, t: float) -> Iterator[NodeReport]:
    """Yield the reports of monitors in a ``diagnostic_msgs/DiagnosticArray``.

    Raises:
        AttributeError, TypeError: it is none.
    """
    for status in array.status:
        values = {str(one.key): str(one.value) for one in status.values}
        if _OURS not in values:
            continue
        inputs = [key.removesuffix(_AGE) for key in values if key.endswith(_AGE)]
        yield NodeReport(
            t=t,
            node=plain(status.hardware_id),
            model=plain(str(status.name).rpartition(": ")[2]),
            message=plain(status.message),
            inputs=tuple(_input(name, values) for name in inputs[:MAX_INPUTS]),
            reasons=dict(_reasons(values)),
            steps=int(_number(values.get("steps"))),
            overruns=int(_number(values.get("overruns"))),
            longest_step=_number(values.get("longest_step_ms")) / 1e3,
        )


def _input(name: str, values: Mapping[str, str]) -> InputReport:
    age = _number(values[f"{name}{_AGE}"], math.nan)
    return InputReport(
        plain(name),
        plain(values.get(name, "")),
        None if math.isnan(age) else age,
        plain(values.get(f"{name}.reason", "")),
    )


def _reasons(values: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield id and words of what is inactive: ``guarantee.ID``, or ``in_scope`` by itself."""
    for key, text in values.items():
        what, _, id_ = key.partition(".")
        if text.startswith(_INACTIVE) and what in _STANDINGS:
            yield plain(id_ or what), plain(text.removeprefix(_INACTIVE))


def _number(text: str | None, otherwise: float = 0.0) -> float:
    try:
        found = float(text or "")
    except ValueError:
        return otherwise
    return found if math.isfinite(found) else otherwise
