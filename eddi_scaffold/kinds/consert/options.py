"""Options of a ConSert in a configuration: published ids, filters of inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from eddi_scaffold.common.claims import Acceptance
from eddi_scaffold.common.problems import Problem, error
from eddi_scaffold.kinds import JsonValue, Options
from eddi_scaffold.kinds.consert.model import ConSertModel
from eddi_scaffold.kinds.consert.names import published_class

KEYS = ("guarantee_ids", "debounce", "filter")
_IDS = ("source", "class")
_NO_FILTER: Mapping[str, JsonValue] = {"kind": "none"}


def configure(model: ConSertModel, options: Options) -> tuple[ConSertModel | None, list[Problem]]:
    """Take the ConSert's own keys of ``Model:`` into the model.

    ``guarantee_ids`` chooses between the ids of the model (``source``) and SESAME D7.2's class
    names (``class``); ``debounce: n`` lets a leaf count as TRUE again in the n-th step in a
    row in which it is; ``filter`` is the general form, which the runtime checks.
    """
    values = options.values
    problems = list(_wrong(options))
    filtering = values.get("filter")
    if filtering is None and values.get("debounce") is not None:
        filtering = {"kind": "debounce", "regain_after": values["debounce"]}
    chosen = {
        "guarantee_ids": values.get("guarantee_ids", "source"),
        "filter": dict(filtering if isinstance(filtering, Mapping) else _NO_FILTER),
    }
    return (None if problems else replace(model, options=chosen)), problems


def settings(model: ConSertModel) -> dict[str, JsonValue]:
    """Return the ``settings`` part of ``config/model.json``."""
    return dict(model.options or {"guarantee_ids": "source", "filter": dict(_NO_FILTER)})


def published_ids(model: ConSertModel) -> dict[str, str]:
    """Return the ids that guarantees have in messages -> their ids in the model."""
    publish = publishing(settings(model))
    return {publish(guarantee.id): guarantee.id for guarantee in model.data.guarantees}


def publishing(settings: Mapping[str, Any]) -> Callable[[str], str]:
    """Return what gives a guarantee its id in messages."""
    return published_class if settings["guarantee_ids"] == "class" else str


def accepted(document: Mapping[str, Any], frequency: float) -> Sequence[Acceptance]:
    """Return what a filter by majority accepts: the majority of old steps."""
    seconds = lag(document, frequency)
    if not seconds:
        return ()
    key, what = "filter: majority", "the majority of old steps"
    return [Acceptance(key, what, f"for {seconds:g} s", seconds, path=("Model", "filter"))]


def lag(document: Mapping[str, Any], frequency: float) -> float:
    """Return for how many seconds a majority may hold after it was lost: half of its window."""
    filtering = document["settings"]["filter"]
    return filtering.get("window", 1) // 2 / frequency if filtering["kind"] == "majority" else 0.0


def _wrong(options: Options) -> Iterable[Problem]:
    values = options.values
    ids, debounce, filtering = (values.get(key) for key in KEYS)
    if ids is not None and ids not in _IDS:
        message = "Model.guarantee_ids: must be 'source' or 'class'"
        yield error("K005", message, options.place("guarantee_ids"))
    if debounce is not None and (type(debounce) is not int or debounce < 1):
        message = "Model.debounce: a whole number of steps from 1 on is expected"
        yield error("K005", message, options.place("debounce"))
    if filtering is not None and not isinstance(filtering, Mapping):
        yield error("K005", "Model.filter: a map is expected", options.place("filter"))
    if debounce is not None and filtering is not None:
        message = "debounce and filter exclude each other"
        yield error("K011", message, options.place("filter"), "keep one of them")
