"""Checks of names that generated code derives from ids, and of services: C007, C008, C014, C018."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.kinds.consert import names
from eddi_scaffold.yaml_text.nodes import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from eddi_scaffold.kinds.consert.model import ConSert


_IMAGES: tuple[tuple[str, Callable[[str], str]], ...] = (
    ("class name", names.class_name),
    ("field name", names.field_name),
)


def check_names(consert: ConSert) -> list[Problem]:
    """Check that every node can have names of its own in generated code."""
    groups = (consert.evidence, consert.demands, consert.guarantees, consert.gates)
    ids = {node.id: node.place for group in groups for node in group}
    inputs = {node.id for group in groups[:2] for node in group}
    return [
        *(p for id_, place in ids.items() for p in _name(id_, place, is_input=id_ in inputs)),
        *_collisions(ids, inputs),
    ]


def _name(id_: str, place: Place, *, is_input: bool) -> Iterator[Problem]:
    if not id_:
        yield problem("C018.empty", place)
        return
    if not names.is_usable(id_):
        yield problem("C018.no_identifier", place, id=shown(id_))
        return
    if not names.is_identifier(id_):
        derived = names.attribute(id_) if is_input else names.identifier(id_)
        yield problem("C018.no_python_name", place, id=shown(id_), identifier=derived)
        return
    yield from _reserved(id_, place, is_input=is_input)


def _reserved(id_: str, place: Place, *, is_input: bool) -> Iterator[Problem]:
    name = names.attribute(id_) if is_input else names.identifier(id_)
    if name != id_:
        yield problem("C018.reserved", place, id=shown(id_), identifier=name)
        return
    for title, image in _IMAGES:
        name = image(id_)
        if names.is_reserved(name):
            message = f"the {title} {name!r} of the id {shown(id_)} is a reserved word"
            yield problem("C018.changed", place, message=message, name=names.escaped(name))


def _collisions(ids: dict[str, Place], inputs: set[str]) -> Iterator[Problem]:
    """Report ids that would have one name, once per pair (C007)."""
    reported: set[str] = set()
    for title, image in (*_IMAGES, ("attribute", names.attribute)):
        first: dict[str, str] = {}
        for id_, place in ids.items():
            if title == "attribute" and id_ not in inputs:
                continue
            name = image(id_)
            before = first.setdefault(name, id_)
            if name and before != id_ and id_ not in reported:
                reported.add(id_)
                yield problem(
                    "C007.same_identifier",
                    place,
                    before=shown(before),
                    id=shown(id_),
                    kind=title,
                    identifier=name,
                )


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
        yield problem("C014.nothing_inside", place, name=name, element=kind)
    known_ids, near = set(known), SimilarNames(known)
    for member in dict.fromkeys(members):
        if member not in known_ids:
            yield problem(
                "C008.unknown_member",
                place,
                hint=near.hint(member),
                name=name,
                kind=kind,
                member=shown(member),
            )


def _demands_alone(consert: ConSert) -> Iterator[Problem]:
    grouped = {id_ for service in consert.required_services for id_ in service.demands}
    for demand in consert.demands:
        if demand.id not in grouped:
            yield problem("C014.no_service", demand.place, demand=shown(demand.id))
