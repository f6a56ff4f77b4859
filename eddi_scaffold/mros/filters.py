"""Which topics of a system are wanted, and ids that stay when the system changes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Literal

from eddi_scaffold.common.identifiers import RESERVED, free_name, is_identifier
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem

if TYPE_CHECKING:
    from eddi_scaffold.mros.topics import Topic


Criterion = Literal["topics", "components", "infrastructure"]
OPTIONS: dict[Criterion, str] = {
    "topics": "--only",
    "components": "--component",
    "infrastructure": "--exclude-infrastructure",
}
"""How the command line calls them."""
_SHOWN = 12
_INFRASTRUCTURE = ("dynamic_reconfigure", "rcl_interfaces", "bond", "lifecycle_msgs")


@dataclass(frozen=True)
class Filters:
    """Which topics are wanted; globs are case-sensitive and ``*`` also matches ``/``.

    Attributes:
        topics: any match keeps; empty keeps all.
        components: the same for a component that provides the topic.
        no_infrastructure: leave out types of ``dynamic_reconfigure``, ``rcl_interfaces``, ``bond``
            and ``lifecycle_msgs``.
    """

    topics: tuple[str, ...] = ()
    components: tuple[str, ...] = ()
    no_infrastructure: bool = False

    def leaves_out(self, topic: Topic) -> Criterion | None:
        """Return what keeps a topic out; ``None`` when it is wanted."""
        if self.no_infrastructure and topic.type.partition(".")[0] in _INFRASTRUCTURE:
            return "infrastructure"
        if not self.wants(topic.topic):
            return "topics"
        if self.components and not any(
            matches(topic.components, component) for component in self.components
        ):
            return "components"
        return None

    def __str__(self) -> str:
        """Return the filters as they are given on the command line."""
        words = [f"{OPTIONS['topics']} {topic!r}" for topic in self.topics]
        words += [f"{OPTIONS['components']} {component!r}" for component in self.components]
        return " ".join([*words, OPTIONS["infrastructure"]] if self.no_infrastructure else words)

    def wants(self, name: str) -> bool:
        """Return whether the name of a topic is wanted."""
        return not self.topics or any(matches([name], topic) for topic in self.topics)


def matches(names: Iterable[str], pattern: str) -> bool:
    """Return whether one of some names matches a glob."""
    return any(fnmatchcase(name, pattern) for name in names)


def unmatched(
    filters: Filters, topics: Collection[str], components: Collection[str]
) -> Iterator[Problem]:
    """Return an error for each glob that matches none of the names that there are."""
    for option, globs, what, names in (
        (OPTIONS["topics"], filters.topics, "topic", topics),
        (OPTIONS["components"], filters.components, "component", components),
    ):
        for glob in globs:
            if not matches(names, glob):
                yield problem(
                    "M022.no_match",
                    hint=_there_are(glob, names),
                    kind=what,
                    option=option,
                    pattern=glob,
                )


def _there_are(glob: str, names: Collection[str]) -> str | None:
    """Return the name that is nearest to a glob, else all names or the first of many."""
    near = did_you_mean(re.sub(r"[*?\[\]]", "", glob), names)
    if near is not None or not names:
        return near
    shown = sorted({*names})[:_SHOWN]
    more = len({*names}) - len(shown)
    return f"there are: {', '.join(shown)}{f' and {more} more' if more else ''}"


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
    current = {wish.topic for wish in wishes}
    for topic, name in found.items():
        before = by_id.get(name)
        if before is not None and before.topic != topic and before.topic not in current:
            problems.append(
                problem(
                    "M020.used_before", before.place, name=name, former=before.topic, topic=topic
                )
            )
    problems += [
        problem("M020.changed", entry.place, id=entry.id, topic=entry.topic, new=found[entry.topic])
        for entry in old
        if entry.topic in found and found[entry.topic] != entry.id
    ]
    return [kept.get(wish.topic) or found[wish.topic] for wish in wishes], problems


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
