"""Checks of services: C020 to C022."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.positioned_yaml.nodes import shown
from eddi_scaffold.problems import NearNames, Place, Problem, error, warning

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from eddi_scaffold.kinds.consert.model import ConSert


def check_services(consert: ConSert) -> list[Problem]:
    """Check that services name guarantees and demands, and demands have a service."""
    demands = [demand.id for demand in consert.demands]
    guarantees = [guarantee.id for guarantee in consert.guarantees]
    problems: list[Problem] = []
    for required in consert.required_services:
        name = f"required service {shown(required.id)}"
        problems += _members(name, "demand", required.demands, demands, required.place)
    for provided in consert.provided_services:
        name = f"provided service {shown(provided.id)}"
        problems += _members(name, "guarantee", provided.guarantees, guarantees, provided.place)
    return [*problems, *_demands_alone(consert)]


def _members(
    name: str, kind: str, members: Sequence[str], known: Sequence[str], place: Place
) -> Iterator[Problem]:
    if not members:
        yield error("C022", f"{name} has no {kind}s", place)
    known_ids, near = set(known), NearNames(known)
    for member in dict.fromkeys(members):
        if member not in known_ids:
            message = f"{name} names an unknown {kind} {shown(member)}"
            yield error("C020", message, place, near.hint(member))


def _demands_alone(consert: ConSert) -> Iterator[Problem]:
    grouped = {id_ for service in consert.required_services for id_ in service.demands}
    for demand in consert.demands:
        if demand.id not in grouped:
            message = f"demand {shown(demand.id)} is in no required service"
            hint = "any guarantee of another ConSert may then fulfil it, whatever its service"
            yield warning("C021", message, demand.place, hint)
