"""Meaning of the messages of a ConSert monitor, and dependencies of its guarantees."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import Claim, Meaning, Meanings
from eddi_scaffold.common.graphs import reached
from eddi_scaffold.kinds.consert.graph import constants, inputs_of, leaves_of
from eddi_scaffold.kinds.consert.matching import mismatch
from eddi_scaffold.kinds.consert.model import options_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eddi_scaffold.kinds.consert.model import ConSert, ConSertModel

_ACTIVE = Meaning(
    (False,),
    refused="`active` of a guarantee is false also when it is unknown",
    instead="`guarantees[ID].verdict == 0` of its ConSertStatus: known to be false",
)

MEANINGS: Meanings = {
    "ConSertOutput": {"guarantees[].active": _ACTIVE},
    "RobotGuarantees": {"guarantees[].active": replace(_ACTIVE, instead=None)},
    "ConSertStatus": {
        "guarantees[].verdict": Meaning(
            (1,),
            refused="the verdict is 1 when it is unknown",
            instead="`verdict == 2`, known to be true, or `verdict == 0`, known to be false",
            known=(0, 2),
        )
    },
}
"""Message -> field -> its meaning."""


def claims(model: ConSertModel, _inputs: object, frequency: float) -> Sequence[Claim]:
    """Return each guarantee, by its id in messages, with the evidence and demands it rests on."""
    consert, options = model.data, options_of(model)
    sources, leaves = inputs_of(consert), frozenset(leaves_of(consert))
    return [
        Claim(
            options.published(guarantee.id),
            frozenset() if guarantee.default else leaves & reached(sources, [guarantee.id]),
            options.hold_s(frequency),
        )
        for guarantee in consert.guarantees
    ]


def unfulfilled(provider: ConSert, guarantee_id: str, user: ConSert, demand_id: str) -> str | None:
    """Return why a guarantee does not fulfil a demand that it is wired to, ``None`` if it does.

    Evidence asks for nothing that a guarantee could fulfil; it is not judged.
    """
    demand = next((one for one in user.demands if one.id == demand_id), None)
    guarantee = next((one for one in provider.guarantees if one.id == guarantee_id), None)
    if demand is None or guarantee is None:
        return None
    name = f"{provider.name}/{guarantee_id}"
    wanted = _services(user.required_services, "demands", demand_id)
    given = _services(provider.provided_services, "guarantees", guarantee_id)
    if wanted and not wanted & given:
        kinds = " or ".join(sorted(wanted))
        return f"{name} is not in a service of type {kinds}, which {demand_id} requires"
    if constants(provider)[guarantee_id] is False:
        return f"{name} can never be active"
    found = mismatch(guarantee, demand, name)
    return None if found is None else found.text


def _services(services: Any, members: str, id_: str) -> set[str]:
    return {
        service.functional_service_type for service in services if id_ in getattr(service, members)
    }
