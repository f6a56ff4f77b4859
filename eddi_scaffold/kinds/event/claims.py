"""Meaning of the messages of an event monitor, and dependencies of its events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common.claims import Acceptance, Claim, Meaning, Meanings
from eddi_scaffold.conditions.uses import Silence, accepted, inputs_of, lasts, nodes_below
from eddi_scaffold.kinds.event.events import EventModel, form_of

_VERDICT = Meaning(
    (1,),
    refused="the verdict is 1 when it is unknown",
    instead="`verdict == 2`, known to be true, or `verdict == 0`, known to be false",
    known=(0, 2),
)
_KNOWN = (("verdict", 0, 2),)
_SILENT: Mapping[str, tuple[object, ...]] = {"EVIDENCE": (False,), "HAZARD": (True,)}


_REFUSED = {
    "EVIDENCE": "`active` of the EVIDENCE {} is false also when it is unknown",
    "HAZARD": "`active` of the HAZARD {} is true also when it is unknown",
}
_INSTEAD = {
    "EVIDENCE": "`verdict == 0`, or a separate event with NOT",
    "HAZARD": "`expression: NOT {field}`, known to be absent; `verdict == 2` is that it is there",
}


def field_meanings(claims: Sequence[Claim] | None) -> Meanings:
    """Return the meaning of the fields of an ``EventOutput``.

    Args:
        claims: the events on the topic; ``None``: not known.
    """
    polarities = {claim.polarity for claim in claims or ()}
    verdict = replace(_VERDICT, bad=(2, 0)) if polarities == {"HAZARD"} else _VERDICT
    if claims is None:
        active = Meaning((), known=_KNOWN)  # it may have the polarity that the reader has in mind
    elif len(polarities) == 1:
        (polarity,) = polarities
        refused = _REFUSED[polarity].format(" ".join(claim.id for claim in claims))
        active = Meaning(_SILENT[polarity], refused=refused, instead=_INSTEAD[polarity])
    else:
        refused = "the value of `active` when it is unknown depends on the event"
        active = Meaning(refused=refused, instead="`verdict == 2`, or `verdict == 0`")
    return {"EventOutput": {"verdict": verdict, "active": active}}


def claims(model: EventModel, _inputs: object, _frequency: float) -> Sequence[Claim]:
    """Return the events, each with the variables that it rests on."""
    form = form_of(model)
    names = [inputs_of(variable) for variable in form["variables"]]
    return [
        Claim(
            output["id"],
            frozenset(
                name
                for node in nodes_below(form["nodes"], output["node"])
                if node["op"] in ("variable", "age")
                for name in names[node["value"]]
            ),
            polarity=output["polarity"],
        )
        for output in form["outputs"]
    ]


def acceptances(model: EventModel, _inputs: object, _frequency: float) -> Sequence[Acceptance]:
    """Return what the events of a file accept of silence, with the events that do."""
    form = form_of(model)
    events: dict[Silence, list[str]] = {}
    for output in form["outputs"]:
        for silence in accepted(form, output["node"]):
            events.setdefault(silence, []).append(output["id"])
    return [
        Acceptance(one.word, one.accepts, lasts(one), one.seconds, at=one.at, outputs=tuple(ids))
        for one, ids in events.items()
    ]


def input_timeouts(model: EventModel) -> Mapping[str, float]:
    """Return the TIMEOUT of each variable that has one."""
    return {
        name: variable["timeout"] / 1e9
        for variable in form_of(model)["variables"]
        if variable.get("timeout") is not None
        for name in inputs_of(variable)
    }
