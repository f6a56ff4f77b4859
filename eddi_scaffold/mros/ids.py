"""Ids of topics: Python names that stay when the robot's system changes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from eddi_scaffold.identifiers import RESERVED, free_name, is_identifier
from eddi_scaffold.problems import Place, Problem, warning


@dataclass(frozen=True)
class Existing:
    """An entry that a configuration already has."""

    id: str
    topic: str
    place: Place


@dataclass(frozen=True)
class Wish:
    """What an id is made of: the name in the model, and the topic."""

    model_name: str
    topic: str


def slug(name: str) -> str:
    """Return a Python name for a name of ROS."""
    words = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_") or "topic"
    if words[0].isdigit():
        words = f"_{words}"
    return f"{words}_" if words in RESERVED else words


def give_ids(
    published: Sequence[Wish],
    included: Sequence[Wish],
    existing: Iterable[Existing],
    reserved: Collection[str] = (),
) -> tuple[list[str], list[Problem]]:
    """Give each topic an id, the included ones after the published ones.

    A topic that has an id already keeps it. Otherwise it is the name in the model if no other
    topic has the same one, else the topic; and a number behind what is taken or reserved.
    """
    wishes = [*published, *included]
    old = list(existing)
    kept = _kept(wishes, old)
    problems: list[Problem] = []
    taken = {*kept.values(), *reserved}
    found: dict[str, str] = {}
    for group in (published, included):
        found |= _given([one for one in group if one.topic not in kept], group, taken)
    by_id = {entry.id: entry for entry in old}
    current = {one.topic for one in wishes}
    for topic, name in found.items():
        before = by_id.get(name)
        if before is not None and before.topic != topic and before.topic not in current:
            message = f"the id {name!r} was that of {before.topic} and is now that of {topic}"
            problems.append(warning("M020", message, before.place))
    changed = [entry for entry in old if entry.topic in found and found[entry.topic] != entry.id]
    for entry in changed:
        message = f"the id {entry.id!r} of {entry.topic} becomes {found[entry.topic]!r}"
        problems.append(warning("M021", message, entry.place))
    return [kept.get(one.topic) or found[one.topic] for one in wishes], problems


def _kept(wishes: Iterable[Wish], existing: Sequence[Existing]) -> dict[str, str]:
    """Return topic -> id of the entries whose id can stay."""
    topics = {wish.topic for wish in wishes}
    counts = Counter(entry.id for entry in existing)
    kept: dict[str, str] = {}
    for entry in existing:
        if entry.topic in topics and counts[entry.id] == 1 and is_identifier(entry.id):
            kept.setdefault(entry.topic, entry.id)
    return kept


def _given(new: Iterable[Wish], group: Iterable[Wish], taken: set[str]) -> dict[str, str]:
    """Give ids to the new ones of a group; ``taken`` grows."""
    new = list(new)
    common = Counter(slug(one.model_name) for one in group)
    found: dict[str, str] = {}
    for one in new:
        wanted = slug(one.model_name)
        if common[wanted] == 1 and wanted not in taken:
            found[one.topic] = wanted
    taken |= set(found.values())
    for one in new:
        if one.topic not in found:
            found[one.topic] = free_name(slug(one.topic), taken)
            taken.add(found[one.topic])
    return found
