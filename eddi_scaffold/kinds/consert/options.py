"""Options of a ConSert in a configuration: published ids, filters of inputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.kinds.consert.model import ConSertOptions

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Options

KEYS = ("guarantee_ids", "debounce", "filter")
_FILTERS = {"debounce": "regain_after", "majority": "window"}
_MAX_SAMPLES = 100_000
"""Longest history of a filter; at 1 kHz that is 100 s."""


def read_options(options: Options) -> tuple[ConSertOptions | None, list[Problem]]:
    """Read the ConSert's own keys of ``Model:``.

    ``guarantee_ids`` chooses between the ids of the model (``source``) and SESAME D7.2's class
    names (``class``); ``debounce: n`` lets a leaf count as TRUE again in the n-th step in a
    row in which it is; ``filter`` is the general form.
    """
    problems = list(_wrong(options))
    if problems:
        return None, problems
    values: Mapping[str, Any] = options.values
    debounce, filter_ = values.get("debounce"), values.get("filter")
    if filter_ is None and debounce is not None:
        filter_ = {"kind": "debounce", "regain_after": debounce}
    kind = filter_["kind"] if filter_ is not None else "none"
    steps = filter_.get(_FILTERS[kind], 1) if filter_ is not None and kind != "none" else 1
    ids = values.get("guarantee_ids") or "source"
    return ConSertOptions(ids, kind if steps > 1 else "", steps), []


def _wrong(options: Options) -> Iterator[Problem]:
    ids, debounce, filter_ = (options.values.get(key) for key in KEYS)
    if ids is not None and ids not in ("source", "class"):
        yield problem("K003.guarantee_ids", options.place("guarantee_ids"))
    if debounce is not None and (type(debounce) is not int or debounce < 1):
        yield problem("K003.debounce", options.place("debounce"))
    elif isinstance(debounce, int) and debounce > _MAX_SAMPLES:
        place = options.place("debounce")
        yield problem("K028.steps", place, key="regain_after", limit=_MAX_SAMPLES)
    if debounce is not None and filter_ is not None:
        yield problem("K003.debounce_and_filter", options.place("filter"))
    if filter_ is None:
        return
    if not isinstance(filter_, Mapping):
        yield problem("K003.filter", options.place("filter"))
        return
    kind = filter_.get("kind")
    key = _FILTERS.get(kind) if isinstance(kind, str) else None
    if key is None and kind != "none":
        yield problem("K028.filter", options.place("filter"), kind=kind)
    steps = filter_.get(key, 1) if key is not None else 1
    if type(steps) is not int or not 1 <= steps <= _MAX_SAMPLES:
        yield problem("K028.steps", options.place("filter"), key=key, limit=_MAX_SAMPLES)
