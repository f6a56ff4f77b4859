"""What a monitor publishes, and what of it claims something good."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from eddi_runtime import Monitor as RunningMonitor

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.recordings.node import Message
from eddi_scaffold.recordings.node import Publications as ProductPublisher

Published = Sequence[tuple[str, Message]]


def resolved(topic: str, namespace: str = "") -> str:
    """Return the full name of a topic, as ROS finds it for a node of a namespace."""
    if topic.startswith("/"):
        return topic
    return f"/{namespace}/{topic}".replace("//", "/")


class Publisher(ProductPublisher):
    """The publications of one monitor in one namespace.

    Attributes:
        hazards: events whose `active` claims nothing, and whose absence does.
    """

    def __init__(
        self, monitor: BoundMonitor, rename: Mapping[str, str], namespace: str = ""
    ) -> None:
        """Take over the outputs of the configuration.

        Args:
            rename: topic in the configuration -> another one, as a launch file remaps it.
        """

        def full(topic: str) -> str:
            for old, new in rename.items():
                if topic == old or topic.startswith(f"{old}/"):  # also what stands beside a result
                    return resolved(new + topic.removeprefix(old), namespace)
            return resolved(topic, namespace)

        super().__init__(monitor)
        self.channels = [
            one._replace(topic=full(one.publication.output.topic)) for one in self.channels
        ]
        self.hazards = _hazards(monitor)
        claims = {"safeml": "status", "bayesian_network": "evidence"}.get(monitor.kind.name, "")
        self._claiming = {one.topic for one in self.channels if one.publication.of == claims}

    def messages(self, running: RunningMonitor, output: Any, wanted: Collection[str]) -> Any:
        """Return the messages of a step that somebody reads, and those that claim something."""
        return super().messages(running, output, {*wanted, *self._claiming})

    def claims(self, told: Published) -> Mapping[str, bool]:
        """Return output -> whether what was published claims something good."""
        found: dict[str, bool] = {}
        for _, message in told:
            kind = message.message_type.partition("/")[2]
            if kind == "ConSertOutput":
                found.update((one.id, one.active) for one in message.guarantees)
            elif kind == "EventOutput":
                hazard = message.id in self.hazards
                found[message.id] = not message.active if hazard else message.active
            elif kind in ("ReliabilityOutput", "BayesianNetworkEvidence"):
                found.update((one.id, one.active) for one in message.evidence)
            elif kind == "SafeMLStatus":
                found["in_scope"] = message.in_scope
        return found


def _hazards(monitor: BoundMonitor) -> frozenset[str]:
    if monitor.kind.name != "event":
        return frozenset()
    events = monitor.model.data.analysis.events
    return frozenset(event.id for event in events if event.polarity == "HAZARD")
