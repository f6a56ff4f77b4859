"""What is done with events, what they rest on, and what their messages mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common.claims import Acceptance, Claim, Element, Meaning, Meanings
from eddi_scaffold.conditions.uses import Silence, accepted, inputs_of, lasts, nodes_below
from eddi_scaffold.kinds import Functions
from eddi_scaffold.kinds.event.compile import compile_events
from eddi_scaffold.kinds.event.events import (
    EventModel,
    configure,
    counts,
    export,
    form_of,
    inputs,
    outline,
    parts,
    read_file,
    readme,
    skeleton,
)
from eddi_scaffold.kinds.event.read_eddi import in_map, read_eddi

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
        Acceptance(
            silence.word,
            silence.accepts,
            lasts(silence),
            silence.seconds,
            at=silence.at,
            outputs=tuple(ids),
        )
        for silence, ids in events.items()
    ]


def input_timeouts(model: EventModel) -> Mapping[str, float]:
    """Return the TIMEOUT of each variable that has one."""
    return {
        name: variable["timeout"] / 1e9
        for variable in form_of(model)["variables"]
        if variable.get("timeout") is not None
        for name in inputs_of(variable)
    }


def elements(model: EventModel) -> Sequence[Element]:
    """Return the events, in a file of their own with the line of each condition."""
    form = form_of(model)
    in_eddi = model.place.path is not None
    return [
        Element(
            "event",
            output["id"],
            line=None if in_eddi else form["nodes"][output["node"]]["at"][0],
        )
        for output in form["outputs"]
    ]


FUNCTIONS = Functions(
    in_map=in_map,
    read_eddi=read_eddi,
    read_file=read_file,
    counts=counts,
    outline=outline,
    export=export,
    inputs=inputs,
    configure=configure,
    readme=readme,
    parts=parts,
    compile=compile_events,
    claims=claims,
    acceptances=acceptances,
    input_timeouts=input_timeouts,
    field_meanings=field_meanings,
    elements=elements,
    skeleton=skeleton,
)
