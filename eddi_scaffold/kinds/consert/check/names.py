"""Checks of the names that generated code derives from ids: C018 and C019."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.kinds.consert import names
from eddi_scaffold.positioned_yaml.nodes import shown
from eddi_scaffold.problems import Place, Problem, error, warning

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

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
        yield error("C018", "the id is empty", place)
        return
    if not names.is_usable(id_):
        message = f"no identifier can be derived from the id {shown(id_)}"
        yield error("C018", message, place, "use at least one of the letters A-Z, a-z, 0-9")
        return
    if not names.is_identifier(id_):
        derived = names.attribute(id_) if is_input else names.identifier(id_)
        message = (
            f"the id {shown(id_)} is not an identifier: code uses {derived!r}, messages the id"
        )
        yield warning("C018", message, place)
        return
    yield from _reserved(id_, place, is_input=is_input)


def _reserved(id_: str, place: Place, *, is_input: bool) -> Iterator[Problem]:
    name = names.attribute(id_) if is_input else names.identifier(id_)
    if name != id_:
        message = f"the id {shown(id_)} is a reserved word: code uses {name!r}"
        yield warning("C018", message, place)
        return
    for title, image in _IMAGES:
        name = image(id_)
        if names.is_reserved(name):
            message = f"the {title} {name!r} of the id {shown(id_)} is a reserved word"
            yield warning("C018", f"{message}: code uses {names.escaped(name)!r}", place)


def _collisions(ids: dict[str, Place], inputs: set[str]) -> Iterator[Problem]:
    """Report ids that would have one name, once per pair (C019)."""
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
                message = f"the ids {shown(before)} and {shown(id_)} have the same {title} {name!r}"
                yield error("C019", message, place, "rename one of them")
