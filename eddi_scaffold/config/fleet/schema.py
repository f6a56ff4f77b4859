"""The form of ``deployment.yml``: its sections, keys and values."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, StrictInt
from pydantic import StrictStr as Text

from eddi_scaffold.config.schema import PEERS_LEASE, PEERS_TOPIC, FileName, Lease, Line, Name, Topic
from eddi_scaffold.identifiers import is_ros_name
from eddi_scaffold.problems import HintedError

LAST_DOMAIN = 232
"""Of DDS: the ports of the next one would be beyond 65535."""
_ROBOT = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def _robot_name(text: str) -> str:
    if _ROBOT.fullmatch(text) is None:
        raise HintedError(
            "a name of letters, digits and `_` that begins with a letter is expected",
            "it is the name of a folder, and by default that of the namespace",
        )
    return text


def _partition(text: str) -> str:
    if _ROBOT.fullmatch(text) is None:  # DDS takes `*` and `?` as patterns
        raise ValueError("a name of letters, digits and `_` that begins with a letter is expected")
    return text


def _namespace(text: str) -> str:
    legal = text == "/" or (text.startswith("/") and is_ros_name(text))
    if not legal or any(part[:1].isdigit() for part in text.split("/")):
        raise ValueError("a namespace such as /robot1 is expected, or / for none")
    return text


def _absolute(topic: str) -> str:
    if not topic.startswith("/"):
        message = "one topic for all robots is expected, such as /eddi/peers"
        raise HintedError(message, f"write /{topic}: without / each namespace has one of its own")
    return topic


def _some(entries: list[Any]) -> list[Any]:
    if not entries:
        raise ValueError("at least one entry is expected")
    return entries


def _providers(value: object) -> object:
    if value == "any":
        return value
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
        raise ValueError("the word any, the name of a robot, or a list of such names is expected")
    return tuple(names)


RobotName = Annotated[Text, AfterValidator(_robot_name)]
Partition = Annotated[Text, AfterValidator(_partition)]
Providers = Annotated[Literal["any"] | tuple[Text, ...], BeforeValidator(_providers)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class FleetSection(_Section):
    """What all robots share.

    Attributes:
        topic: on which robots publish their guarantees for each other.
        lease: seconds after which a guarantee of another robot is unknown.
    """

    topic: Annotated[Topic, AfterValidator(_absolute)] = PEERS_TOPIC
    lease: Lease = PEERS_LEASE


class MonitorEntry(_Section):
    """One monitor of a robot.

    Attributes:
        config: file of its configuration, relative to the deployment file.
        model: file of its model, likewise; without it, the one that the configuration names.
        override: what counts on this robot in place of parts of the configuration.
    """

    config: FileName
    model: FileName | None = None
    override: dict[Text, Any] = {}


class Robot(_Section):
    """One robot.

    Attributes:
        namespace: of its nodes; by default its name.
        master: URI of its ROS 1 master; robots without one share a master.
        domain: id of its DDS domain, as in ``ROS_DOMAIN_ID``.
        partition: of DDS inside the domain; ROS 2 has none.
    """

    name: RobotName
    platform: Text = "ros1"
    namespace: Annotated[Text, AfterValidator(_namespace)] | None = None
    master: Line | None = None
    domain: Annotated[StrictInt, Field(ge=0, le=LAST_DOMAIN)] | None = None
    partition: Partition | None = None
    monitors: Annotated[list[MonitorEntry], AfterValidator(_some)]

    @property
    def prefix(self) -> str:
        """Its namespace before the name of a topic: empty for none."""
        given = f"/{self.name}" if self.namespace is None else self.namespace
        return given.rstrip("/")


class StationSection(_Section):
    """The control station, which sees all guarantees."""

    name: RobotName = "station"
    platform: Text | None = None
    master: Line | None = None
    domain: Annotated[StrictInt, Field(ge=0, le=LAST_DOMAIN)] | None = None
    partition: Partition | None = None


class Binding(_Section):
    """Whose guarantees may fulfil a demand.

    Attributes:
        demand: its id.
        robot: that demands it; by default every robot that has such a demand.
        monitor: ``Model: id:`` of its monitor, where several have such a demand.
        from_: robots that may fulfil it, or any that offers it.
        guarantee: the only guarantee that may; by default each that fulfils the demand.
    """

    demand: Name
    robot: Text | None = None
    monitor: Name | None = None
    from_: Providers = Field("any", alias="from")
    guarantee: Name | None = None


class FleetForm(_Section):
    """The whole file, checked for form."""

    Fleet: FleetSection = FleetSection()
    Robots: Annotated[list[Robot], AfterValidator(_some)]
    Station: StationSection = StationSection()
    Bindings: list[Binding] = []


_SECTIONS: dict[str, type[BaseModel]] = {
    "Fleet": FleetSection,
    "Robots": Robot,
    "Station": StationSection,
    "Bindings": Binding,
}


def known_keys(path: tuple[str | int, ...]) -> set[str]:
    """Return the keys that a section has; none for what is below a section."""
    section = _SECTIONS.get(str(path[0])) if path else FleetForm
    if "monitors" in path:
        section = MonitorEntry
    fields = section.model_fields.items() if section else ()
    return {field.alias or name for name, field in fields}
