"""Which topic an interface has in the running system: connections, labels and namespaces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Literal

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.mros.interface_definitions import SystemFile
from eddi_scaffold.mros.model import Connection, InterfaceKind
from eddi_scaffold.mros.resolving import ResolvedInterface
from eddi_scaffold.mros.topics import topic_name

_GIVING: tuple[InterfaceKind, ...] = ("publisher", "serviceserver", "actionserver")
_TAKING: tuple[InterfaceKind, ...] = ("subscriber", "serviceclient", "actionclient")


class Naming:
    """The names of one system's topics.

    Attributes:
        problems: what was noticed, each time that :meth:`topic` was asked.
    """

    def __init__(
        self,
        systems: Sequence[SystemFile],
        resolved: Sequence[ResolvedInterface],
        names: Literal["label", "model"],
    ) -> None:
        self.problems: list[Problem] = []
        self._names = names
        self._renamed: dict[str, str] = {}
        """End of a named connection -> its name."""
        self._sources: dict[str, ResolvedInterface] = {}
        """End of a connection that takes -> who gives."""
        if names == "label":
            self._connect(systems, resolved)

    def topic(self, one: ResolvedInterface) -> str | None:
        """Return the topic of an interface; ``None``, and a problem, where it has none."""
        source = self._sources.get(one.end) if one.kind == "subscriber" else None
        if source is not None:
            return self._absolute(source)[0]
        topic, problems = self._absolute(one)
        self.problems += problems
        return topic

    def _absolute(self, one: ResolvedInterface) -> tuple[str | None, list[Problem]]:
        given = one.model_name
        if self._names == "label":
            is_topic = one.kind in ("publisher", "subscriber")
            given = (self._renamed.get(one.end) if is_topic else None) or one.name
        found = topic_name(given, one.namespace, one.component.name)
        if found.is_empty:
            return None, [problem("M015.empty", one.place, name=given)]
        problems = []
        if found.glued:
            problems.append(problem("M015.namespace", one.place, name=given, corrected=found.text))
        if found.illegal:
            problems.append(
                problem("M015.illegal", one.place, name=found.text, illegal=found.illegal)
            )
        return found.text, problems

    def _connect(
        self, systems: Sequence[SystemFile], resolved: Sequence[ResolvedInterface]
    ) -> None:
        givers: dict[str, ResolvedInterface] = {}
        for one in resolved:
            if one.kind == "publisher":
                givers.setdefault(one.end, one)
        gives = _labels(systems, _GIVING)
        takes = _labels(systems, _TAKING)
        for file in systems:
            for connection in file.system.connections:
                if file.system.dialect == "indent":
                    self._check_labels(connection, file.file, gives, takes)
                elif connection.kind != "topic":
                    continue
                self._take(connection, givers)

    def _take(self, connection: Connection, givers: dict[str, ResolvedInterface]) -> None:
        for end in (*connection.sources, *connection.targets):
            if connection.name:
                self._renamed.setdefault(end, connection.name)
        giver = next((givers[end] for end in connection.sources if end in givers), None)
        for end in connection.targets:
            if giver is not None:
                self._sources.setdefault(end, giver)

    def _check_labels(
        self, connection: Connection, file: str, gives: Counter[str], takes: Counter[str]
    ) -> None:
        for labels, known in ((connection.sources, gives), (connection.targets, takes)):
            for label in labels:
                if known[label] > 1:
                    place = Place(file, connection.line, connection.col)
                    self.problems.append(problem("M018", place, label=label, count=known[label]))


def _labels(systems: Sequence[SystemFile], kinds: tuple[InterfaceKind, ...]) -> Counter[str]:
    return Counter(
        interface.name
        for file in systems
        if file.system.dialect == "indent"
        for component in file.system.components
        for interface in component.interfaces
        if interface.kind in kinds
    )
