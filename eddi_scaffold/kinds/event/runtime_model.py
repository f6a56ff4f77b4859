"""Events -> the ``model`` part of ``config/model.json``, and what is read of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from eddi_scaffold.common.claims import Acceptance, Meaning, Meanings
from eddi_scaffold.conditions.uses import Silence, accepted, inputs_of, lasts, nodes_below
from eddi_scaffold.conditions.uses import accepted as silences
from eddi_scaffold.kinds.event.claims import _INSTEAD, _KNOWN, _REFUSED, _SILENT, _VERDICT
from eddi_scaffold.kinds.event.events import EventModel


def model_part(model: EventModel) -> dict[str, Any]:
    """Return the ``model`` part of ``config/model.json``."""
    form = model.data.analysis.form
    assert form is not None
    words = {
        output["id"]: list(
            dict.fromkeys(silence.word for silence in silences(form, output["node"]))
        )
        for output in form["outputs"]
    }
    accepts = {id_: found for id_, found in words.items() if found}
    return {"form": form, "accepts": accepts} if accepts else {"form": form}


def meanings(document: Mapping[str, Any] | None, event: str | None) -> Meanings:
    """Return the meaning of the fields of an ``EventOutput``.

    Args:
        document: the ``model`` part of ``config/model.json``; ``None``: not at hand.
        event: the only one on the topic, ``None`` for any.
    """
    outputs = () if document is None else document["form"]["outputs"]
    on_topic = [output for output in outputs if event in (None, output["id"])]
    polarities = {one["polarity"] for one in on_topic}
    verdict = replace(_VERDICT, bad=(2, 0)) if polarities == {"HAZARD"} else _VERDICT
    active = _active(on_topic, polarities) if document is not None else Meaning((), known=_KNOWN)
    # Not at hand: `active` may have the polarity that the reader has in mind.
    return {"EventOutput": {"verdict": verdict, "active": active}}


def _active(on_topic: Sequence[Mapping[str, Any]], polarities: set[str]) -> Meaning:
    if len(polarities) != 1:
        refused = "the value of `active` when it is unknown depends on the event"
        return Meaning(refused=refused, instead="`verdict == 2`, or `verdict == 0`")
    (polarity,) = polarities
    return Meaning(
        _SILENT[polarity],
        refused=_REFUSED[polarity].format(" ".join(one["id"] for one in on_topic)),
        instead=_INSTEAD[polarity],
    )


def acceptances(document: Mapping[str, Any], _frequency: float) -> Sequence[Acceptance]:
    """Return what the events of a file accept of silence, with the events that do."""
    form = document["model"]["form"]
    found: dict[Silence, list[str]] = {}
    for output in form["outputs"]:
        for one in accepted(form, output["node"]):
            found.setdefault(one, []).append(output["id"])
    return [
        Acceptance(one.word, one.accepts, lasts(one), one.seconds, at=one.at, outputs=tuple(events))
        for one, events in found.items()
    ]


def limits(document: Mapping[str, Any]) -> Mapping[str, float]:
    """Return the TIMEOUT of each variable that has one."""
    return {
        name: variable["timeout"] / 1e9
        for variable in document["model"]["form"]["variables"]
        if variable.get("timeout") is not None
        for name in inputs_of(variable)
    }


def support(document: Mapping[str, Any]) -> Mapping[str, frozenset[str]]:
    """Return the variables on which each event rests."""
    form = document["model"]["form"]
    names = [inputs_of(variable) for variable in form["variables"]]
    return {
        output["id"]: frozenset(
            name
            for node in nodes_below(form["nodes"], output["node"])
            if node["op"] in ("variable", "age")
            for name in names[node["value"]]
        )
        for output in form["outputs"]
    }
