"""Who publishes what: monitors, and their topics with full names."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.wiring.support import Participant, Published, published
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import Publication, publications


@dataclass(frozen=True)
class Member:
    """A monitor of a deployment that is at hand with its model.

    Attributes:
        monitor: it has a configuration.
        namespace: of its robot, such as ``/robot1``; empty for none.
    """

    monitor: BoundMonitor
    namespace: str = ""

    @cached_property
    def participant(self) -> Participant:
        """The same, as far as a package remembers it."""
        monitor = self.monitor
        return Participant(
            self.name,
            monitor.package,
            self.namespace,
            monitor.kind,
            self.config,
            json.loads(monitor.model_json),
            monitor.model.source.name,
        )

    @property
    def config(self) -> ConfigFile:
        """Its configuration."""
        assert self.monitor.config is not None
        return self.monitor.config

    @property
    def name(self) -> str:
        """Its id, with the namespace where it has one: for people."""
        id_ = self.config.config.Model.id
        return f"{self.namespace}/{id_}" if self.namespace else id_

    def topic(self, name: str) -> str:
        """Return the full name of a topic, as ROS resolves it for this monitor's node."""
        return self.participant.topic(name)


@dataclass(frozen=True)
class Publisher:
    """A topic that a member publishes."""

    member: Member
    publication: Publication

    @property
    def message(self) -> str:
        """Name of our message on it, or of the one that contains its value."""
        return self.publication.message.partition("/")[2]


@dataclass(frozen=True)
class Deployment:
    """Monitors that run together.

    Attributes:
        members: those that are at hand.
        publishers: full name of a topic -> the members that publish it.
        others: those that run with them.
    """

    members: tuple[Member, ...]
    publishers: Mapping[str, Sequence[Publisher]]
    others: tuple[Participant, ...] = ()

    @property
    def participants(self) -> Sequence[Participant]:
        """All monitors, as far as a package remembers them."""
        return [*(member.participant for member in self.members), *self.others]

    def publisher(self, member: Member, source: SimulatorOutput) -> Publisher | None:
        """Return who publishes what a member listens to, ``None`` when no other member does."""
        found = self.publishers.get(member.topic(source.topic), ())
        return next((one for one in found if one.publication.type == source.type), None)

    def other(self, member: Member, source: SimulatorOutput) -> Published | None:
        """Return who of the others publishes what a member listens to."""
        topic = member.topic(source.topic)
        found = (item for one in self.others for at, item in published(one) if at == topic)
        return next(found, None)


def deployment(members: Sequence[Member], others: Sequence[Participant] = ()) -> Deployment:
    """Return the members with what each of them publishes where."""
    publishers: dict[str, list[Publisher]] = {}
    for member in members:
        for one in publications(member.monitor, member.config)[0]:
            topic = member.topic(one.output.topic)
            publishers.setdefault(topic, []).append(Publisher(member, one))
    return Deployment(tuple(members), publishers, tuple(others))
