"""What ``.rossystem`` and ``.ros*`` files describe, whatever their dialect.

Lines and columns count from 1; a column is a character, a tab is one. Types are kept as they are
written (``pkg.Type``, ``pkg/msg/Type``).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from eddi_scaffold.common.problems import Place, Problem

_TYPE = re.compile(r"([A-Za-z]\w*)(?:\.|/(?:(?:msg|srv|action)/)?)([A-Za-z]\w*)", re.ASCII)

Dialect = Literal["brace", "indent"]
InterfaceKind = Literal[
    "publisher", "subscriber", "serviceserver", "serviceclient", "actionserver", "actionclient"
]


class Section(NamedTuple):
    """How the dialects write interfaces of one kind."""

    kind: InterfaceKind  # with indentation its section in a node model, or with an `s`
    title: str  # for people, as is `verb`
    verb: str
    arrow: str  # in a system with indentation
    entry: str  # in a node model with braces, where its section has an `s` more
    type_word: str  # there, before the type
    system_section: str  # in a system with braces
    system_entries: tuple[str, ...]  # there; the section of 2018 is the last one with an `s`
    reference: str  # there, before the reference


SECTIONS: dict[str, Section] = {
    section.kind: section
    for section in (
        Section("publisher", "a publisher", "publishes", "pub->", "Publisher", "message",
            "RosPublishers", ("RosPublisher", "RosTopicPublisher"), "RefPublisher"),
        Section("subscriber", "a subscriber", "subscribes", "sub->", "Subscriber", "message",
            "RosSubscribers", ("RosSubscriber", "RosTopicSubscriber"), "RefSubscriber"),
        Section("serviceserver", "a service server", "serves", "ss->", "ServiceServer", "service",
            "RosSrvServers", ("RosServiceServer",), "RefServer"),
        Section("serviceclient", "a service client", "calls", "sc->", "ServiceClient", "service",
            "RosSrvClients", ("RosServiceClient",), "RefClient"),
        Section("actionserver", "an action server", "acts", "as->", "ActionServer", "action",
            "RosActionServers", ("RosActionServer", "RosServer"), "RefServer"),
        Section("actionclient", "an action client", "commands", "ac->", "ActionClient", "action",
            "RosActionClients", ("RosActionClient", "RosClient"), "RefClient"),
    )
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class SystemInterface:
    """A publisher, subscriber, ... of one component as a system names it."""

    kind: InterfaceKind
    name: str  # the name in the system; without one the last part of the reference
    ref: str  # `package.artifact.node.interface` or `artifact::interface`
    ns: str | None  # namespace of this interface alone, `None` for none
    place: Place


@dataclass(slots=True)
class Component:
    """One running node."""

    name: str
    place: Place
    namespace: str | None = None
    from_node: str | None = None  # `package.artifact.node` or `package.node` that it is one of
    interfaces: list[SystemInterface] = field(default_factory=list)
    parameters: int = 0  # how many parameters are set


@dataclass(frozen=True, slots=True)
class Connection:
    """Who talks to whom."""

    kind: str  # `topic`, `service`, `action`, or `""` where the dialect does not specify it
    name: str | None  # `None` for none
    sources: tuple[str, ...]  # `component.interface` or labels, from publisher or server
    targets: tuple[str, ...]  # the same of subscriber or client
    place: Place


@dataclass(frozen=True, slots=True)
class SubSystem:
    """The name of a system that is part of another one."""

    name: str
    place: Place


@dataclass(slots=True)
class System:
    """A ``.rossystem``: which components run, under which names."""

    file: str  # its name, as the reader was given it
    dialect: Dialect
    name: str
    components: list[Component] = field(default_factory=list)
    connections: list[Connection] = field(default_factory=list)
    subsystems: list[SubSystem] = field(default_factory=list)
    from_file: str | None = None  # the file that the system refers to
    processes: int = 0  # how many processes are listed
    # components are names of `.componentinterface` files (2018 to 2021)
    references_only: bool = False
    problems: list[Problem] = field(default_factory=list)  # what was not read, though the rest was


@dataclass(frozen=True, slots=True)
class Interface:
    """A publisher, subscriber, ... of a node as its model names it."""

    kind: InterfaceKind
    name: str
    type: str
    ns: str | None
    place: Place
    type_place: Place

    @property
    def ros_type(self) -> str | None:
        """The type as ``package/Type``; ``None`` when it is none."""
        match = _TYPE.fullmatch(self.type)
        return f"{match[1]}/{match[2]}" if match else None


@dataclass(slots=True)
class Artifact:
    """An executable; the name of its node, if it has one, and what that offers and needs."""

    name: str
    node: str | None = None
    interfaces: list[Interface] = field(default_factory=list)
    parameters: int = 0


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message."""

    type: str  # as written; `T[]` for arrays of any length
    name: str  # name of the field or constant
    value: str | None = None  # text of a constant's value, `None` for a field


@dataclass(frozen=True, slots=True)
class Spec:
    """A message, service or action."""

    kind: str  # `topic`, `service` or `action`; `""` where the dialect does not specify it
    name: str
    # `message`, or `request` and `response`, or `goal`, `result` and `feedback` -> fields
    sections: tuple[tuple[str, tuple[Field, ...]], ...]


@dataclass(slots=True)
class Package:
    """A ROS package: executables and message specifications."""

    name: str
    artifacts: list[Artifact] = field(default_factory=list)
    specs: list[Spec] = field(default_factory=list)


@dataclass(slots=True)
class RosModel:
    """A ``.ros``, ``.ros1`` or ``.ros2`` file."""

    file: str
    dialect: Dialect
    packages: list[Package] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
