"""What is given beside the model: the robot, and other monitors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import is_ros_name, package_name
from eddi_scaffold.common.problems import (
    EddiError,
    Problem,
    has_errors,
    most_similar,
    problem,
    shortened_list,
)
from eddi_scaffold.config.message_types import MessageFields
from eddi_scaffold.config.reading import RobotAdditions, read_configs
from eddi_scaffold.config.topic_block import ConfigText, read_block
from eddi_scaffold.connect.draft import Age, deadline_age
from eddi_scaffold.connect.keeping import model_id, text_of
from eddi_scaffold.connect.robot import message_types
from eddi_scaffold.connect.rossystem import read_robot, with_topics
from eddi_scaffold.deployments.joining import join
from eddi_scaffold.kinds import TODO, Model, kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import checked_models, is_config, select_models
from eddi_scaffold.mros.directory import load_models
from eddi_scaffold.yaml_text.nodes import Map, items_of


@dataclass(frozen=True)
class Around:
    """What is given beside the model.

    Attributes:
        system: a ``.rossystem``.
        models: the directory of its node models.
        configs: of other monitors.
        marks: default guarantees.
        ages: full name of a topic -> when its messages are too old.
        topics: full name -> type, of those that were recorded.
        types: of their messages.
    """

    system: Path | None = None
    models: Path | None = None
    configs: Sequence[Path] = ()
    marks: Sequence[str] = ()
    ages: Mapping[str, Age] = field(default_factory=dict)
    topics: Mapping[str, str] = field(default_factory=dict)
    types: MessageFields = field(default_factory=dict)


@dataclass(frozen=True)
class OnRobot:
    """A configuration with the topics of a robot.

    Attributes:
        types: of the messages, next to the models.
        ages: full name of a topic -> when its messages are too old, by the models.
    """

    document: ConfigText
    types: MessageFields = field(default_factory=dict)
    ages: Mapping[str, Age] = field(default_factory=dict)
    problems: Sequence[Problem] = ()


def with_robot(document: ConfigText, around: Around) -> OnRobot:
    """Return the configuration with the topics of the system, and what the models say of them.

    Raises:
        EddiError: one of them cannot be read, or the models of a system are missing (G017).
    """
    if around.models is None:
        if around.system is not None:
            raise EddiError(problem("G017"))
        return OnRobot(document)
    if around.system is None:
        return OnRobot(document, message_types(load_models(around.models)))
    robot = read_robot(around.system, around.models)
    parsed = with_topics(robot, document, wants=lambda one: is_ros_name(one.topic))
    after = read_block(Source(document.name, parsed.after.encode()))
    ages = {topic.topic: deadline_age(topic.deadlines) for topic in parsed.outputs.topics}
    known = {topic: age for topic, age in ages.items() if age is not None}
    return OnRobot(after, message_types(robot.models), known, robot.located(parsed.problems))


def monitors_beside(models: Sequence[Model], around: Around) -> list[BoundMonitor]:
    """Return the monitors of the other configurations.

    Raises:
        EddiError: one of them cannot be used.
    """
    if not around.configs:
        return []
    configs, _ = read_configs(around.configs, RobotAdditions())
    monitors, problems = join(
        models, configs, lambda path: checked_models(path, around.marks), around.marks
    )
    if has_errors(problems):
        raise EddiError(*problems)
    return monitors


def chosen_model(models: Sequence[Model], name: str | None, root: Map) -> Model:
    """Return the model: by its name, else the one that the configuration is of, else the only one.

    Raises:
        EddiError: there is none of that name (F005), or several (G005).
    """
    id_ = model_id(root)
    if name is not None:
        models = select_models(models, name)
    elif id_ is not None:
        models = [
            model for model in models if package_name(model.name) == package_name(id_)
        ] or models
    if len(models) > 1:
        names = ", ".join(model.name for model in models)
        raise EddiError(problem("G005.several", names=names))
    return models[0]


def refuse_other(document: ConfigText, root: Map, chosen: Model, models: Sequence[Model]) -> None:
    """Refuse a file to which the draft of a model must not be added.

    Raises:
        EddiError: it is no configuration (K001), or that of another kind (K010) or model (K026).
    """
    if root.entries and not is_config(Source(document.name, document.text.encode())):
        raise EddiError(problem("K001.nothing_added", root.place))
    section = root.get("Model") or root
    kind, type_, id_ = kinds()[chosen.kind], text_of(section, "type"), model_id(root)
    if type_ not in (None, TODO) and str(type_).casefold() not in map(
        str.casefold, kind.config_types
    ):
        raise EddiError(problem("K010.kind", section.place, kind=kind.title, declared=type_))
    owner = package_name(id_) if id_ is not None else None
    if owner != package_name(chosen.name) and owner in {
        package_name(model.name) for model in models
    }:
        raise EddiError(problem("K026.other_model", section.place, id=id_, requested=chosen.name))


def unknown_inputs(root: Map, ids: Sequence[str]) -> Iterable[Problem]:
    """Warn of entries that the model has no input for (K013)."""
    entries = root.get("EDDIInputs")
    there = [(item, text_of(item, "id")) for item in items_of(entries)]
    new = sorted({*ids} - {id_ for _, id_ in there})
    for one, id_ in there:
        if id_ is None or id_ in ids:
            continue
        near = most_similar(id_, new)
        hint = (
            f"where it is {near!r} now, write `id: {near}` and `renamed_from: {id_}`"
            if near is not None
            else f"its inputs: {shortened_list(ids)}"
        )
        yield problem("K013.entry_stays", one.place, hint=hint, input=id_)
