"""``deployment.yml`` by itself: robots, their monitors, and who may fulfil whose demands."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, StrictInt, ValidationError
from pydantic import StrictStr as Text

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import Place, Problem, has_errors, in_order, problem
from eddi_scaffold.config.file import (
    Placed,
    Places,
    existing_file,
    has_section,
    plain_values,
    violations,
)
from eddi_scaffold.config.schema import (
    PEERS_LEASE,
    PEERS_TOPIC,
    FileName,
    Lease,
    Line,
    Name,
    Section,
    Topic,
    text,
)
from eddi_scaffold.yaml_text.nodes import Map, items_of, read_map

LAST_DOMAIN = 232  # of DDS: the ports of the next one would be beyond 65535


def _is_namespace(text: str) -> bool:
    is_name = text == "/" or (text.startswith("/") and is_ros_name(text))
    return is_name and not any(part[:1].isdigit() for part in text.split("/"))


def _providers(value: object) -> object:
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
        raise ValueError("the word any, the name of a robot, or a list of such names is expected")
    return value if value == "any" else tuple(names)


_some = text(len, "at least one entry")
_word = text(
    re.compile("[A-Za-z][A-Za-z0-9_]*").fullmatch,  # DDS takes `*` and `?` as patterns
    "a name of letters, digits and `_` that begins with a letter",
)
_absolute = text(
    lambda topic: topic.startswith("/"),
    "one topic for all robots, such as /eddi/peers,",
    "without / at its begin each namespace has one of its own",
)
_namespace = text(_is_namespace, "a namespace such as /robot1, or / for none,")
RobotName = Annotated[Text, _word]
Domain = Annotated[StrictInt, Field(ge=0, le=LAST_DOMAIN)]
Providers = Annotated[Literal["any"] | tuple[Text, ...], BeforeValidator(_providers)]


class FleetSection(Section):
    """What all robots share."""

    # on which robots publish their guarantees for each other
    topic: Annotated[Topic, _absolute] = PEERS_TOPIC
    lease: Lease = PEERS_LEASE  # seconds after which a guarantee of another robot is unknown


class MonitorEntry(Section):
    """One monitor of a robot."""

    config: FileName  # file of its configuration, relative to the deployment file
    # file of its model, likewise; without it, the one that the configuration names
    model: FileName | None = None
    # what counts on this robot in place of parts of the configuration
    override: dict[Text, Any] = Field({})


class Robot(Section):
    """One robot."""

    name: RobotName
    platform: Text = "ros1"
    namespace: Annotated[Text, _namespace] | None = None  # of its nodes; by default its name
    master: Line | None = None  # URI of its ROS 1 master; robots without one share a master
    domain: Domain | None = None  # id of its DDS domain, as in `ROS_DOMAIN_ID`
    partition: RobotName | None = None  # of DDS inside the domain; ROS 2 has none
    monitors: Annotated[list[MonitorEntry], _some]

    @property
    def prefix(self) -> str:
        """Its namespace before the name of a topic: empty for none."""
        return (f"/{self.name}" if self.namespace is None else self.namespace).rstrip("/")


class StationSection(Section):
    """The control station, which sees all guarantees."""

    name: RobotName = "station"
    platform: Text | None = None
    master: Line | None = None
    domain: Domain | None = None
    partition: RobotName | None = None


class Binding(Section):
    """Whose guarantees may fulfil a demand."""

    demand: Name  # its id
    robot: Text | None = None  # that demands it; by default every robot that has such a demand
    monitor: Name | None = None  # `Model: id:` of its monitor, where several have such a demand
    # robots that may fulfil it, or any that offers it
    from_: Providers = Field("any", alias="from")
    # the only guarantee that may; by default each that fulfils the demand
    guarantee: Name | None = None


class FleetForm(Section):
    """The whole file, checked for form."""

    Fleet: FleetSection = FleetSection()
    Robots: Annotated[list[Robot], _some]
    Station: StationSection = StationSection()
    Bindings: list[Binding] = Field([])


ROBOTS = "Robots"


@dataclass(frozen=True)
class FleetFile(Placed):
    """A deployment file as it was read."""

    form: FleetForm  # its content
    # number of a robot and of one of its monitors -> its `override`
    overrides: Mapping[tuple[int, int], Map]

    def files(self, robot: int, monitor: int) -> tuple[Path, Path | None]:
        """Return where configuration and model of a monitor are (EddiError as `existing_file`)."""
        entry = self.form.Robots[robot].monitors[monitor]
        path = (ROBOTS, robot, "monitors", monitor)
        config = existing_file(self.name, entry.config, self.place(*path, "config"))
        if entry.model is None:
            return config, None
        return config, existing_file(self.name, entry.model, self.place(*path, "model"))


def is_fleet(source: Source) -> bool:
    """Return whether a file is a deployment file."""
    return has_section(source, {ROBOTS, "Bindings"})


def read_fleet(source: Source) -> tuple[FleetFile | None, list[Problem]]:
    """Read a deployment file; the result is ``None`` when a problem is an error."""
    document, problems = read_map(source, "K001")
    if document is None:
        return None, problems
    places: Places = {}
    data = plain_values(document, places)
    data = {key: value for key, value in data.items() if value is not None or key == ROBOTS}
    try:
        form = FleetForm.model_validate(data)
    except ValidationError as failed:
        wrong = violations(failed, places, source.name, FleetForm)
        return None, in_order([*problems, *wrong])
    file = FleetFile(source.name, places, form, dict(_overrides(document)))
    problems += _repeated(file)
    return (None if has_errors(problems) else file), in_order(problems)


def _overrides(document: Map) -> Iterator[tuple[tuple[int, int], Map]]:
    for robot, entry in enumerate(items_of(document.get(ROBOTS))):
        monitors = entry.get("monitors") if isinstance(entry, Map) else None
        for number, monitor in enumerate(items_of(monitors)):
            override = monitor.get("override") if isinstance(monitor, Map) else None
            if isinstance(override, Map):
                yield (robot, number), override


def _repeated(file: FleetFile) -> Iterator[Problem]:
    """Report robots that nobody could tell apart (D010)."""
    robots = enumerate(file.form.Robots)
    names = [(robot.name, file.place(ROBOTS, k, "name")) for k, robot in robots]
    first: dict[str, Place] = {}
    for name, place in [*names, (file.form.Station.name, file.place("Station", "name"))]:
        before = first.setdefault(name.casefold(), place)
        if before is not place:
            yield problem("D010.same_name", place, name=name, line=before.line)
