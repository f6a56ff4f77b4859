"""What other monitors publish for the inputs of a model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from eddi_scaffold.common.identifiers import attribute, free_name, key_text
from eddi_scaffold.connect.matching import Offer
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.eddi_xml.links import events_of
from eddi_scaffold.kinds import Model, ModelInput
from eddi_scaffold.monitors.binding import BoundMonitor

_SILENT = (False,)
"""What a field may be while nothing is known, that evidence may be made of."""


@dataclass(frozen=True)
class Offers:
    """What the monitors that are given beside a model have for it.

    Attributes:
        by_input: input -> what fulfils it.
        topics: those that are not topics of the robot yet.
    """

    by_input: dict[str, list[Offer]]
    topics: tuple[RobotTopic, ...]


def offers(
    monitors: Sequence[BoundMonitor],
    model: Model,
    inputs: Sequence[ModelInput],
    robot: Sequence[RobotTopic],
) -> Offers:
    """Return what fulfils demands, and evidence: what has its id, or what the EDDI names for it.

    For evidence that nothing fulfils, every claim of the others is one that a person may choose.

    Args:
        monitors: with their configurations.
        model: whose inputs are sought.
        inputs: of the model.
        robot: topics whose ids stay.
    """
    by_topic = {one.topic: one for one in robot}
    new: list[RobotTopic] = []
    found: dict[str, list[Offer]] = {}
    claims = [(one, claim) for one in monitors for claim in _claims(one)]
    for item in inputs:
        sure = [(one, claim) for one, claim in claims if _fulfils(one, claim.key, model, item)]
        may_be = claims if item.type == "bool" and not item.is_demand else []
        for monitor, one in sure or may_be:
            if one.topic not in by_topic:
                name = free_name(attribute(one.output), {have.id for have in by_topic.values()})
                by_topic[one.topic] = RobotTopic(name, one.type, one.topic)
                new.append(by_topic[one.topic])
            why = f"{one.key} fulfils it" if sure else f"{one.key} of {monitor.model.name}"
            offer = Offer(by_topic[one.topic], one.field, why, one.key, is_sure=bool(sure))
            found.setdefault(item.id, []).append(offer)
    return Offers(found, tuple(new))


@dataclass(frozen=True)
class _Claim:
    """Something that a monitor publishes and that is false while it is not known.

    Attributes:
        output: id of the output on which it is published.
        key: id of the guarantee, threshold or event.
        field: its path in the message.
    """

    output: str
    type: str
    topic: str
    key: str
    field: str


def _claims(monitor: BoundMonitor) -> Iterator[_Claim]:
    config = monitor.config
    if config is None:
        return
    model = monitor.model
    ids, parts = model.element_keys(), list(model.separate_outputs())
    own = {claim.id: [claim.id] for claim in monitor.facts.claims}
    messages = {"": monitor.kind.output_message, **model.companion_messages()}
    for output in config.config.EDDIOutputs:
        if output.field is not None:
            continue
        meanings = model.meanings(monitor.facts.claims_on(output.event))
        on_topic = [output.event] if output.event is not None else parts
        only = on_topic if len(on_topic) == 1 else []
        for name, message in messages.items():
            type_ = f"eddi_messages/{message}"
            topic = f"{output.topic}/{name}" if name else output.topic
            for path, meaning in meanings.get(message, {}).items():
                if meaning.silent != _SILENT:
                    continue
                head, is_list, tail = path.partition("[].")
                for key in ids.get(head, ()) if is_list else own.get(path, only):
                    field = f"{head}[{key_text(key)}].{tail}" if is_list else path
                    yield _Claim(output.id, type_, topic, key, field)


def _fulfils(monitor: BoundMonitor, key: str, model: Model, item: ModelInput) -> bool:
    if not item.is_demand:
        ids = {item.id, *(event.partition(" (")[0] for event in events_of(model.links, item.id))}
        named = {claim for name, claim in monitor.model.observes if name in ids}
        return item.type == "bool" and (key in ids or not named.isdisjoint((key, "")))
    if monitor.model.kind != model.kind:
        return False
    return monitor.model.why_not_fulfilled(key, model, item.id) is None
