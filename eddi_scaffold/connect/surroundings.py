"""What is known beside the model: the robot, and what other monitors publish for its inputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.common.identifiers import attribute, free_name, key_text
from eddi_scaffold.common.problems import EddiError, has_errors
from eddi_scaffold.config.field_types import MessageFields
from eddi_scaffold.connect.draft import Age
from eddi_scaffold.connect.matching import Fulfilment
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.deployments.joining import join
from eddi_scaffold.eddi_xml.links import events_of
from eddi_scaffold.kinds import Model, ModelInput
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.config_reading import RobotAdditions, read_configs
from eddi_scaffold.monitors.loading import checked_models

_SILENT = (False,)  # what a field may be while nothing is known, that evidence may be made of


@dataclass(frozen=True)
class Surroundings:
    """What is given beside the model."""

    system: Path | None = None  # a `.rossystem`
    models: Path | None = None  # the directory of its node models
    configs: Sequence[Path] = ()  # of other monitors
    default_guarantees: Sequence[str] = ()  # their names
    # full name of a topic -> when its messages are too old
    ages: Mapping[str, Age] = field(default_factory=dict)
    # full name -> type, of those that were recorded
    topics: Mapping[str, str] = field(default_factory=dict)
    types: MessageFields = field(default_factory=dict)  # of their messages


def other_monitors(
    models: Sequence[Model], surroundings: Surroundings, package: str
) -> list[BoundMonitor]:
    """Return the monitors of the other configurations, without that of a package.

    Raises:
        EddiError: one of them cannot be used.
    """
    if not surroundings.configs:
        return []
    defaults = surroundings.default_guarantees
    configs, _ = read_configs(surroundings.configs, RobotAdditions())
    monitors, problems = join(
        models, configs, lambda path: checked_models(path, defaults), defaults
    )
    if has_errors(problems):
        raise EddiError(*problems)
    return [monitor for monitor in monitors if monitor.package != package]


def fulfilments(
    monitors: Sequence[BoundMonitor],
    model: Model,
    inputs: Sequence[ModelInput],
    topics: Sequence[RobotTopic],
) -> tuple[dict[str, list[Fulfilment]], list[RobotTopic]]:
    """Return what fulfils demands, and evidence: what has its id, or what the EDDI names for it.

    For evidence that nothing fulfils, every claim of the others is one that a person may choose.

    Returns:
        Input -> what fulfils it; the topics that are not among those of the robot yet.
    """
    by_topic = {topic.topic: topic for topic in topics}
    by_input: dict[str, list[Fulfilment]] = {}
    claims = [(monitor, claim) for monitor in monitors for claim in _claims(monitor)]
    for item in inputs:
        sure = [pair for pair in claims if _fulfils(pair[0], pair[1].key, model, item)]
        possible = claims if item.type == "bool" and not item.is_demand else []
        for monitor, claim in sure or possible:
            name = claim.topic.topic
            if name not in by_topic:
                taken = {topic.id for topic in by_topic.values()}
                id_ = free_name(attribute(claim.topic.id), taken)
                by_topic[name] = replace(claim.topic, id=id_)
            why = f"{claim.key} fulfils it" if sure else f"{claim.key} of {monitor.model.name}"
            fulfilment = replace(claim, topic=by_topic[name], why=why, is_sure=bool(sure))
            by_input.setdefault(item.id, []).append(fulfilment)
    return by_input, list(by_topic.values())[len({topic.topic for topic in topics}) :]


def _claims(monitor: BoundMonitor) -> Iterator[Fulfilment]:
    """Yield what a monitor publishes and is false while not known, with topics named as outputs."""
    model = monitor.model
    ids, parts = model.element_keys(), list(model.separate_outputs())
    own = {claim.id: [claim.id] for claim in monitor.facts.claims}
    messages = {"": monitor.kind.output_message, **model.companion_messages()}
    for output in monitor.config.config.EDDIOutputs if monitor.config is not None else ():
        if output.field is not None:
            continue
        meanings = model.meanings(monitor.facts.claims_on(output.event))
        on_topic = [output.event] if output.event is not None else parts
        only = on_topic if len(on_topic) == 1 else []
        for name, message in messages.items():
            topic_name = f"{output.topic}/{name}" if name else output.topic
            topic = RobotTopic(output.id, f"eddi_messages/{message}", topic_name)
            for path, meaning in meanings.get(message, {}).items():
                if meaning.silent != _SILENT:
                    continue
                head, is_list, tail = path.partition("[].")
                for key in ids.get(head, ()) if is_list else own.get(path, only):
                    field = f"{head}[{key_text(key)}].{tail}" if is_list else path
                    yield Fulfilment(topic, field, "", key)


def _fulfils(monitor: BoundMonitor, key: str, model: Model, item: ModelInput) -> bool:
    if not item.is_demand:
        ids = {item.id, *(event.partition(" (")[0] for event in events_of(model.links, item.id))}
        named = {claim for name, claim in monitor.model.observes if name in ids}
        return item.type == "bool" and (key in ids or not named.isdisjoint((key, "")))
    is_same_kind = monitor.model.kind == model.kind
    return is_same_kind and monitor.model.why_not_fulfilled(key, model, item.id) is None
