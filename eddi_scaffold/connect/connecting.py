"""A model, a robot and a configuration that may be there: files in, the text of a draft out."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.config.block import (
    ConfigText,
    TopicEntry,
    extended,
    new_document,
    read_block,
)
from eddi_scaffold.config.message_types import MessageFields, known_messages
from eddi_scaffold.config.reading import RobotAdditions, read_configs
from eddi_scaffold.config.undecided import undecided
from eddi_scaffold.connect import draft as drafts
from eddi_scaffold.connect.draft import Age
from eddi_scaffold.connect.keeping import Draft, with_draft
from eddi_scaffold.connect.matching import Decision, decide
from eddi_scaffold.connect.needs import Need
from eddi_scaffold.connect.offers import offers
from eddi_scaffold.connect.reading import (
    content,
    declared_types,
    items,
    model_id,
    open_inputs,
    section_of,
    text_of,
    topics_of,
)
from eddi_scaffold.connect.scoring import Candidate
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.deployments.joining import join
from eddi_scaffold.identifiers import full_topic, is_ros_name, package_name
from eddi_scaffold.kinds import (
    TODO,
    DeclaredInput,
    JsonValue,
    Kind,
    Model,
    Options,
    Skeleton,
    kinds,
)
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.choosing import select
from eddi_scaffold.monitors.loading import checked_models, is_config
from eddi_scaffold.mros.directory import load_models
from eddi_scaffold.positioned_yaml.nodes import Map
from eddi_scaffold.problems import (
    EddiError,
    Problem,
    error,
    has_errors,
    in_order,
    listed,
    nearest,
    warning,
    with_excerpts,
)
from eddi_scaffold.robot.robot_models import message_types
from eddi_scaffold.robot.rossystem import read_robot, with_topics
from eddi_scaffold.source import Source, read_source


@dataclass(frozen=True)
class Around:
    """What is given beside the model.

    Attributes:
        system: a ``.rossystem``.
        models: the directory of its node models.
        configs: of other monitors.
        marks: default guarantees.
        ages: full name of a topic -> when its messages are too old.
        answers: input -> the candidate that a person took.
    """

    system: Path | None = None
    models: Path | None = None
    configs: Sequence[Path] = ()
    marks: Sequence[str] = ()
    ages: Mapping[str, Age] = field(default_factory=dict)
    answers: Mapping[str, Candidate] = field(default_factory=dict)


@dataclass(frozen=True)
class Connected:
    """A draft.

    Attributes:
        name: of the configuration.
        package: of the monitor.
        before: its text, ``None`` when there is no file.
        after: its new text.
        decisions: one for each input of the model.
        kept: inputs that were decided before.
        problems: of the robot, and of the configuration.
        todo: how many values are still to be decided.
    """

    name: str
    package: str
    before: str | None
    after: str
    decisions: Sequence[Decision]
    kept: frozenset[str]
    problems: Sequence[Problem]
    todo: int

    @property
    def is_changed(self) -> bool:
        """Whether there is something to write."""
        return self.after != self.before

    def state(self, decision: Decision) -> str:
        """Return ``taken``, ``listed`` or ``none``, or ``kept`` where a person has decided."""
        return "kept" if decision.need.id in self.kept else decision.state

    @property
    def unanswered(self) -> list[Decision]:
        """The decisions that are a person's and still open."""
        open_ = open_inputs(self._content, "expression", "requires", "field")
        return [one for one in self.decisions if one.state == "listed" and one.need.id in open_]

    @property
    def without_age(self) -> frozenset[str]:
        """The inputs whose age limit is open."""
        return open_inputs(self._content, "max_age")

    def full_name(self, topic: RobotTopic) -> str:
        """Return the name of a topic as the node of the monitor has it."""
        return full_topic(topic.topic, "", self.package)

    @property
    def _content(self) -> Map:
        return content(ConfigText(self.name, self.after, 0, 0))

    def diff(self) -> str:
        """Return the change as a unified diff."""
        old = (self.before or "").splitlines(keepends=True)
        name = self.name if self.before is not None else os.devnull
        new = self.after.splitlines(keepends=True)
        lines = difflib.unified_diff(old, new, name, self.name)
        return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)

    def as_json(self) -> dict[str, JsonValue]:
        """Return the decisions for programs."""
        return {
            "inputs": [
                {
                    "id": one.need.id,
                    "state": self.state(one),
                    "candidates": [
                        {
                            "output": found.topic.id,
                            found.access.key: found.access.text,
                            "unit": found.access.unit,
                            "score": found.score,
                            "parts": dict(found.parts),
                            "why": list(found.reasons),
                        }
                        for found in one.candidates
                    ],
                }
                for one in self.decisions
            ],
            "todo": self.todo,
        }


def connect(model: Path, name: str | None, config: Path | None, around: Around) -> Connected:
    """Draft the configuration of a model, or add to one what it does not say yet.

    Args:
        model: its file.
        name: of the model, where the file has several.
        config: the configuration, which need not exist; ``None`` reads none.
        around: what is given beside the model.

    Raises:
        EddiError: something cannot be read, or the configuration cannot be changed.
    """
    models = checked_models(model, around.marks).models
    document, before = _document(config)
    root = content(document)
    chosen = _chosen(models, name, root)
    kind = kinds()[chosen.kind]
    _refuse_other(document, root, chosen, models)
    package = package_name(model_id(root) or chosen.name)
    document, types, problems = _with_robot(document, around)
    skeleton = _skeleton(chosen, kind, root)
    topics = topics_of(content(document))
    others = [one for one in _monitors(models, around) if one.package != package]
    offered = offers(others, chosen, skeleton.inputs, topics)
    new = [TopicEntry(one.id, one.type.replace("/", "."), one.topic) for one in offered.topics]
    document = read_block(Source(document.name, extended(document, new).encode()))
    types = {**known_messages(), **types, **declared_types(root)}
    decisions = decide(
        [Need.of(one) for one in skeleton.inputs], topics, types.get, offered.by_input
    )
    decisions = [_answered(one, around.answers) for one in decisions]
    full = {one.topic: full_topic(one.topic, "", package) for one in topics}
    ages = {topic: around.ages[name] for topic, name in full.items() if name in around.ages}
    ages = {**offered.ages, **ages}
    draft = Draft(
        _model(chosen, kind, model, config),
        skeleton.options,
        skeleton.notes,
        [drafts.entry(one, ages) for one in decisions],
        drafts.outputs(package, kind.topic, kind.functions.parts(chosen)),
        {one.id: drafts.known_age(ages.get(one.topic)) for one in topics},
    )
    after = with_draft(document, draft)
    problems += with_excerpts(_unknown_inputs(root, skeleton), before or "")
    left = undecided(content(ConfigText(document.name, after, 0, 0)))
    kept = frozenset(
        text_of(one, "id") or "" for one in items(root.get("EDDIInputs")) if not undecided(one)
    )
    return Connected(
        document.name, package, before, after, decisions, kept, in_order(problems), len(left)
    )


def _answered(decision: Decision, answers: Mapping[str, Candidate]) -> Decision:
    answer = answers.get(decision.need.id)
    return decision if answer is None else replace(decision, state="chosen", candidates=(answer,))


def _document(config: Path | None) -> tuple[ConfigText, str | None]:
    """Return the configuration to be changed, and its text where there is one."""
    if config is None or not (config.exists() or config.is_symlink()):
        return new_document(str(config or "eddi_config.yml")), None
    document = read_block(read_source(config))
    return document, document.text


def _chosen(models: Sequence[Model], name: str | None, root: Map) -> Model:
    """Return the model: by its name, else the one that the configuration is of, else the only one.

    Raises:
        EddiError: there is none of that name (F005), or several (G005).
    """
    id_ = model_id(root)
    if name is not None:
        models = select(models, name)
    elif id_ is not None:
        models = [one for one in models if package_name(one.name) == package_name(id_)] or models
    if len(models) > 1:
        names = ", ".join(one.name for one in models)
        message = f"the file contains several models: {names}"
        raise EddiError(error("G005", message, hint="choose one with --name"))
    return models[0]


def _refuse_other(document: ConfigText, root: Map, chosen: Model, models: Sequence[Model]) -> None:
    """Refuse a file to which the draft of a model must not be added.

    Raises:
        EddiError: it is no configuration (K001), or that of another kind (K010) or model (K026).
    """
    if root.entries and not is_config(Source(document.name, document.text.encode())):
        message = "this is not an eddi_config.yml, so nothing is added to it"
        raise EddiError(error("K001", message, root.place, "choose another file for -o"))
    section = root.get("Model") or root
    kind, type_, id_ = kinds()[chosen.kind], text_of(section, "type"), model_id(root)
    if type_ not in (None, TODO) and str(type_).casefold() not in map(
        str.casefold, kind.config_types
    ):
        message = f"the model is a {kind.title}, the configuration declares {type_!r}"
        raise EddiError(error("K010", message, section.place))
    owner = package_name(id_) if id_ is not None else None
    if owner != package_name(chosen.name) and owner in {package_name(one.name) for one in models}:
        message = f"the configuration is that of {id_!r}, not of {chosen.name!r}"
        raise EddiError(error("K026", message, section.place, "choose another file for -o"))


def _with_robot(
    document: ConfigText, around: Around
) -> tuple[ConfigText, MessageFields, list[Problem]]:
    """Return the configuration with the topics of the system, and the types next to the models.

    Raises:
        EddiError: one of them cannot be read, or the models of a system are missing (G017).
    """
    if around.models is None:
        if around.system is not None:
            hint = "--models DIR: the directory of its .ros, .ros1 and .ros2 files"
            raise EddiError(error("G017", "--system needs the models of its nodes", hint=hint))
        return document, {}, []
    if around.system is None:
        return document, message_types(load_models(around.models)), []
    robot = read_robot(around.system, around.models)
    parsed = with_topics(robot, document, wants=lambda one: is_ros_name(one.topic))
    after = read_block(Source(document.name, parsed.after.encode()))
    return after, message_types(robot.models), robot.located(parsed.problems)


def _skeleton(model: Model, kind: Kind[Model], root: Map) -> Skeleton:
    """Return what the configuration has to say of the model.

    Raises:
        EddiError: no monitor can be made of the model.
    """
    if kind.functions.skeleton is None:
        configured, problems = kind.functions.configure(model, Options())
        if configured is None:
            raise EddiError(*problems)
        return Skeleton(kind.functions.inputs(configured))
    ids = [text_of(one, "id") for one in items(root.get("EDDIInputs"))]
    inputs = tuple(
        DeclaredInput(id_, None, None, None, model.place) for id_ in ids if id_ is not None
    )
    return kind.functions.skeleton(model, Options(values=section_of(root), inputs=inputs))


def _monitors(models: Sequence[Model], around: Around) -> list[BoundMonitor]:
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


def _model(
    model: Model, kind: Kind[Model], path: Path, config: Path | None
) -> dict[str, JsonValue]:
    """Return ``Model:`` of a new configuration; the file is named where it lies beside it."""
    section: dict[str, JsonValue] = {
        "id": model.name, "type": kind.config_types[0], "frequency": 10
    }  # fmt: skip
    folder = (config or Path("eddi_config.yml")).resolve().parent
    if path.resolve().is_relative_to(folder):
        name = path.resolve().relative_to(folder).as_posix()
        section["parameters"] = [{"model": name}]
    return section


def _unknown_inputs(root: Map, skeleton: Skeleton) -> Iterable[Problem]:
    """Warn of entries that the model has no input for (K061)."""
    ids = [one.id for one in skeleton.inputs]
    entries = root.get("EDDIInputs")
    there = [(one, text_of(one, "id")) for one in items(entries)]
    new = sorted({*ids} - {id_ for _, id_ in there})
    for one, id_ in there:
        if id_ is None or id_ in ids:
            continue
        near = nearest(id_, new)
        hint = (
            f"where it is {near!r} now, write `id: {near}` and `renamed_from: {id_}`"
            if near is not None
            else f"its inputs: {listed(ids)}"
        )
        message = f"the model has no input {id_!r}; its entry stays"
        yield warning("K061", message, one.place, hint)
