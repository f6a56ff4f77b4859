"""What other monitors publish for the inputs of a model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.message_types import known_messages
from eddi_scaffold.connect.draft import Age, age_of
from eddi_scaffold.connect.matching import Offer
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.identifiers import attribute, free_name, key_text
from eddi_scaffold.kinds import Model, ModelInput, kinds
from eddi_scaffold.monitors.binding import BoundMonitor

_CLAIMS = ("guarantees", "evidence")
"""Lists of messages whose elements have ``active``."""


@dataclass(frozen=True)
class Offers:
    """What the monitors that are given beside a model have for it.

    Attributes:
        by_input: input -> what fulfils it.
        topics: those that are not topics of the robot yet.
        ages: topic -> when its messages are too old.
    """

    by_input: dict[str, list[Offer]]
    topics: tuple[RobotTopic, ...]
    ages: dict[str, Age]


def offers(
    monitors: Sequence[BoundMonitor],
    model: Model,
    inputs: Sequence[ModelInput],
    robot: Sequence[RobotTopic],
) -> Offers:
    """Return what fulfils the demands of a model, and evidence of the same id.

    Args:
        monitors: with their configurations.
        model: whose inputs are sought.
        inputs: of the model.
        robot: topics whose ids stay.
    """
    by_topic = {one.topic: one for one in robot}
    new: list[RobotTopic] = []
    found = Offers({}, (), {})
    for monitor in monitors:
        config = monitor.config
        if config is None:
            continue
        for id_, type_, topic, path, key in _claims(monitor, config):
            fulfilled = [one for one in inputs if _fulfils(monitor, key, model, one)]
            if not fulfilled:
                continue
            if topic not in by_topic:
                name = free_name(attribute(id_), {one.id for one in by_topic.values()})
                by_topic[topic] = RobotTopic(name, type_, topic)
                new.append(by_topic[topic])
            period = 1.0 / config.config.Model.frequency
            found.ages[topic] = age_of(period, 0.0, f"2.5 periods of {monitor.model.name}")
            offer = Offer(by_topic[topic], f"{path}[{key_text(key)}].active", f"{key} fulfils it")
            for one in fulfilled:
                found.by_input.setdefault(one.id, []).append(offer)
    return Offers(found.by_input, tuple(new), found.ages)


def _claims(monitor: BoundMonitor, config: ConfigFile) -> Iterator[tuple[str, str, str, str, str]]:
    """Yield id of the output, type and topic of the message, list in it, key of the element."""
    ids = monitor.kind.functions.ids(monitor.model)
    messages = {"": monitor.kind.output_message, **monitor.kind.functions.beside(monitor.model)}
    for output in config.config.EDDIOutputs:
        if output.field is not None or output.event is not None:
            continue
        for path in (one for one in _CLAIMS if one in ids):
            for name, message in messages.items():
                type_ = f"eddi_messages/{message}"
                if path in known_messages()[type_]:
                    topic = f"{output.topic}/{name}" if name else output.topic
                    yield from ((output.id, type_, topic, path, key) for key in ids[path])
                    break


def _fulfils(monitor: BoundMonitor, key: str, model: Model, item: ModelInput) -> bool:
    if not item.is_demand:
        return item.type == "bool" and item.id == key
    unfulfilled = kinds()[model.kind].functions.unfulfilled
    if monitor.model.kind != model.kind or unfulfilled is None:
        return False
    return unfulfilled(monitor.model, key, model, item.id) is None
