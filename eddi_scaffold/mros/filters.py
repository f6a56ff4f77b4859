"""Which topics of a system are wanted: by name, by component, without infrastructure."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Literal

from eddi_scaffold.problems import Problem, did_you_mean, error

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
        if self.components and not any(matches(topic.components, one) for one in self.components):
            return "components"
        return None

    def __str__(self) -> str:
        """Return the filters as they are given on the command line."""
        words = [f"{OPTIONS['topics']} {one!r}" for one in self.topics]
        words += [f"{OPTIONS['components']} {one!r}" for one in self.components]
        return " ".join([*words, OPTIONS["infrastructure"]] if self.no_infrastructure else words)

    def wants(self, name: str) -> bool:
        """Return whether the name of a topic is wanted."""
        return not self.topics or any(matches([name], one) for one in self.topics)


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
                message = f"no {what} matches {option} {glob!r}"
                yield error("M022", message, hint=_there_are(glob, names))


def _there_are(glob: str, names: Collection[str]) -> str | None:
    """Return the name that is nearest to a glob, else all names or the first of many."""
    near = did_you_mean(re.sub(r"[*?\[\]]", "", glob), names)
    if near is not None or not names:
        return near
    shown = sorted({*names})[:_SHOWN]
    more = len({*names}) - len(shown)
    return f"there are: {', '.join(shown)}{f' and {more} more' if more else ''}"
