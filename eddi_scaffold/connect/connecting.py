"""A model, a robot and a configuration that may be there: files in, the text of a draft out."""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.identifiers import free_name, full_topic, package_name
from eddi_scaffold.common.problems import Problem, in_order, with_excerpts
from eddi_scaffold.config.message_types import known_messages
from eddi_scaffold.config.topic_block import (
    ConfigText,
    TopicEntry,
    extended,
    new_document,
    read_block,
)
from eddi_scaffold.config.undecided import undecided
from eddi_scaffold.connect import draft as drafts
from eddi_scaffold.connect.keeping import (
    Draft,
    content,
    declared_types,
    model_id,
    section_of,
    synonyms_of,
    text_of,
    topics_of,
    with_draft,
)
from eddi_scaffold.connect.matching import Decision, decide
from eddi_scaffold.connect.needs import InputNeed
from eddi_scaffold.connect.offers import offers
from eddi_scaffold.connect.surroundings import (
    Around,
    chosen_model,
    monitors_beside,
    refuse_other,
    unknown_inputs,
    with_robot,
)
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.eddi_xml.links import events_of
from eddi_scaffold.kinds import DeclaredInput, JsonValue, Kind, Model, ModelDraft, Options, kinds
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.mros.topics import slug
from eddi_scaffold.yaml_text.nodes import Map, items_of


@dataclass(frozen=True)
class DraftResult:
    """A draft.

    Attributes:
        name: of the configuration.
        before: its text, ``None`` when there is no file.
        after: its new text.
        decisions: one for each input of the model.
        kept: inputs that were decided before.
        problems: of the robot, and of the configuration.
        todo: how many values are still to be decided.
    """

    name: str
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
    def has_topics(self) -> bool:
        """Whether the configuration names topics of a robot."""
        return bool(topics_of(content(ConfigText(self.name, self.after, 0, 0))))

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
                    "id": decision.need.id,
                    "state": self.state(decision),
                    "candidates": [
                        {
                            "output": found.topic.id,
                            found.access.key: found.access.text,
                            "unit": found.access.unit,
                            "score": found.score,
                            "parts": dict(found.parts),
                            "why": list(found.reasons),
                        }
                        for found in decision.candidates
                    ],
                }
                for decision in self.decisions
            ],
            "todo": self.todo,
        }


def connect(model: Path, name: str | None, config: Path | None, around: Around) -> DraftResult:
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
    chosen = chosen_model(models, name, root)
    kind = kinds()[chosen.kind]
    refuse_other(document, root, chosen, models)
    package = package_name(model_id(root) or chosen.name)
    robot = with_robot(document, around)
    document = robot.document
    model_draft = _model_draft(chosen, root)
    topics = topics_of(content(document))
    recorded = _recorded(around.topics, topics, package)
    topics += recorded
    others = [one for one in monitors_beside(models, around) if one.package != package]
    offered = offers(others, chosen, model_draft.inputs, topics)
    types = {**around.types, **known_messages(), **robot.types, **declared_types(root)}
    synonyms = synonyms_of(root)
    needs = [
        InputNeed.of(input_, synonyms, events_of(chosen.links, input_.id))
        for input_ in model_draft.inputs
    ]
    decisions = decide(needs, topics, types.get, offered.by_input)
    named = {found.topic for decision in decisions for found in decision.candidates}
    new = [
        TopicEntry(one.id, one.type.replace("/", "."), one.topic)
        for one in (*recorded, *offered.topics)
        if one in named
    ]
    document = read_block(Source(document.name, extended(document, new).encode()))
    full = {topic.topic: full_topic(topic.topic, "", package) for topic in topics}
    known = {**robot.ages, **around.ages}
    ages = {topic: known[name] for topic, name in full.items() if name in known}
    draft = Draft(
        _model(chosen, kind, model, config),
        model_draft.options,
        model_draft.notes,
        [drafts.entry(decision, ages) for decision in decisions],
        drafts.outputs(package, kind.topic, chosen.separate_outputs()),
        {topic.id: drafts.age_line(topic, ages) for topic in topics},
    )
    after = with_draft(document, draft)
    ids = [input_.id for input_ in model_draft.inputs]
    unknown = with_excerpts(unknown_inputs(root, ids), before or "")
    left = undecided(content(ConfigText(document.name, after, 0, 0)))
    kept = frozenset(
        text_of(item, "id") or ""
        for item in items_of(root.get("EDDIInputs"))
        if not undecided(item)
    )
    problems = in_order([*robot.problems, *unknown])
    return DraftResult(document.name, before, after, decisions, kept, problems, len(left))


def _recorded(
    topics: Mapping[str, str], known: Sequence[RobotTopic], package: str
) -> list[RobotTopic]:
    """Return the topics of a bag that are not known without it, each with an id of its own."""
    there = {full_topic(one.topic, "", package) for one in known}
    taken = {one.id for one in known}
    found = []
    for topic, of in sorted(topics.items()):
        if topic not in there:
            found.append(RobotTopic(free_name(slug(topic), taken), of, topic))
            taken.add(found[-1].id)
    return found


def _document(config: Path | None) -> tuple[ConfigText, str | None]:
    """Return the configuration to be changed, and its text where there is one."""
    if config is None or not (config.exists() or config.is_symlink()):
        return new_document(str(config or "eddi_config.yml")), None
    document = read_block(read_source(config))
    return document, document.text


def _model_draft(model: Model, root: Map) -> ModelDraft:
    """Return what the configuration has to say of the model.

    Raises:
        EddiError: no monitor can be made of the model.
    """
    ids = [text_of(item, "id") for item in items_of(root.get("EDDIInputs"))]
    inputs = tuple(
        DeclaredInput(id_, None, None, None, model.place) for id_ in ids if id_ is not None
    )
    return model.draft(Options(values=section_of(root), inputs=inputs))


def _model(model: Model, kind: Kind, path: Path, config: Path | None) -> dict[str, JsonValue]:
    """Return ``Model:`` of a new configuration; the file is named where it lies beside it."""
    section: dict[str, JsonValue] = {
        "id": model.name, "type": kind.config_types[0], "frequency": 10
    }  # fmt: skip
    folder = (config or Path("eddi_config.yml")).resolve().parent
    if path.resolve().is_relative_to(folder):
        name = path.resolve().relative_to(folder).as_posix()
        section["parameters"] = [{"model": name}]
    return section
