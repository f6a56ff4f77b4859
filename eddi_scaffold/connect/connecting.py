"""A model, a robot and a configuration that may be there: files in, the text of a draft out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.identifiers import free_name, full_topic, package_name
from eddi_scaffold.common.problems import (
    EddiError,
    Problem,
    in_order,
    most_similar,
    problem,
    shortened_list,
    with_excerpts,
)
from eddi_scaffold.config.message_types import Fields, declared, known_messages
from eddi_scaffold.config.topic_block import (
    ConfigText,
    extended,
    read_block,
)
from eddi_scaffold.config.values import undecided
from eddi_scaffold.connect.draft import age_line, entry
from eddi_scaffold.connect.keeping import (
    Draft,
    model_id,
    text_of,
    topics_of,
    with_draft,
)
from eddi_scaffold.connect.matching import Decision, decide
from eddi_scaffold.connect.needs import InputNeed, words
from eddi_scaffold.connect.rossystem import unified_diff
from eddi_scaffold.connect.surroundings import (
    Surroundings,
    fulfilments,
    other_monitors,
    with_robot,
)
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.eddi_xml.links import events_of
from eddi_scaffold.kinds import (
    TODO,
    DeclaredInput,
    JsonValue,
    Kind,
    Model,
    ModelDraft,
    ModelInput,
    Options,
    kinds,
)
from eddi_scaffold.monitors.loading import checked_models, is_config, select_models
from eddi_scaffold.mros.topics import slug
from eddi_scaffold.yaml_text.nodes import Map, Scalar, items_of, value_11


@dataclass(frozen=True)
class DraftResult:
    """A draft."""

    name: str  # of the configuration
    before: str | None  # its text, `None` when there is no file
    after: str  # its new text
    decisions: Sequence[Decision]  # one for each input of the model
    kept: frozenset[str]  # inputs that were decided before
    problems: Sequence[Problem]  # of the robot, and of the configuration
    todo: int  # how many values are still to be decided

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
        return bool(topics_of(read_block(Source(self.name, self.after.encode())).root))

    def diff(self) -> str:
        """Return the change as a unified diff."""
        return unified_diff(self.before, self.after, self.name)

    def as_json(self) -> dict[str, JsonValue]:
        """Return the decisions for programs."""
        inputs: list[JsonValue] = []
        for decision in self.decisions:
            candidates: list[JsonValue] = [
                {
                    "output": candidate.topic.id,
                    candidate.access.key: candidate.access.text,
                    "unit": candidate.access.unit,
                    "score": candidate.score,
                    "parts": dict(candidate.parts),
                    "why": list(candidate.reasons),
                }
                for candidate in decision.candidates
            ]
            state = self.state(decision)
            inputs.append({"id": decision.need.id, "state": state, "candidates": candidates})
        return {"inputs": inputs, "todo": self.todo}


def connect(
    model: Path, name: str | None, config: Path | None, surroundings: Surroundings
) -> DraftResult:
    """Draft the configuration of a model, or add to one what it does not say yet.

    Args:
        model: its file.
        name: of the model, where the file has several.
        config: the configuration, which need not exist; ``None`` reads none.
        surroundings: what is given beside the model.

    Raises:
        EddiError: something cannot be read, or the configuration cannot be changed.
    """
    models = checked_models(model, surroundings.default_guarantees).models
    if config is not None and (config.exists() or config.is_symlink()):
        document = read_block(read_source(config))
        before: str | None = document.text
    else:
        document, before = ConfigText(str(config or "eddi_config.yml"), ""), None
    root = document.root
    chosen = _chosen_model(models, name, root)
    kind = kinds()[chosen.kind]
    _refuse_other(document, root, chosen, models)
    package = package_name(model_id(root) or chosen.name)
    document, robot_types, robot_ages, robot_problems = with_robot(
        document, surroundings.system, surroundings.models
    )
    model_draft = _model_draft(chosen, root)
    topics = topics_of(document.root)
    recorded = _recorded(surroundings.topics, topics, package)
    topics += recorded
    others = other_monitors(models, surroundings, package)
    fulfilled, published = fulfilments(others, chosen, model_draft.inputs, topics)
    types = {**surroundings.types, **known_messages(), **robot_types, **_declared_types(root)}
    needs = _needs(root, chosen, model_draft.inputs)
    decisions = decide(needs, topics, types.get, fulfilled)
    named = {candidate.topic for decision in decisions for candidate in decision.candidates}
    new = [
        replace(topic, type=topic.type.replace("/", "."))
        for topic in (*recorded, *published)
        if topic in named
    ]
    document = read_block(Source(document.name, extended(document, new).encode()))
    known = {**robot_ages, **surroundings.ages}
    full_names = {topic.topic: full_topic(topic.topic, "", package) for topic in topics}
    ages = {topic: known[full] for topic, full in full_names.items() if full in known}
    parts = chosen.separate_outputs()
    outputs: list[dict[str, JsonValue]] = [{"id": package, "topic": f"{package}/{kind.topic}"}]
    if len(parts) > 1:
        outputs = [{"id": part, "topic": f"{package}/{part}", "event": part} for part in parts]
    draft = Draft(
        _model_section(chosen, kind, model, config),
        model_draft.options,
        model_draft.notes,
        [entry(decision, ages) for decision in decisions],
        outputs,
        {topic.id: age_line(topic, ages) for topic in topics},
    )
    after = with_draft(document, draft)
    unknown = _unknown_inputs(root, [item.id for item in model_draft.inputs])
    problems = in_order([*robot_problems, *with_excerpts(unknown, before or "")])
    items = items_of(root.get("EDDIInputs"))
    kept = frozenset(text_of(item, "id") or "" for item in items if not any(undecided(item)))
    todo = len(list(undecided(read_block(Source(document.name, after.encode())).root)))
    return DraftResult(document.name, before, after, decisions, kept, problems, todo)


def _chosen_model(models: Sequence[Model], name: str | None, root: Map) -> Model:
    """Return the model: by its name, else the one that the configuration is of, else the only one.

    Raises:
        EddiError: there is none of that name (F005), or several (G005).
    """
    id_ = model_id(root)
    if name is not None:
        models = select_models(models, name)
    elif id_ is not None:
        same = [model for model in models if package_name(model.name) == package_name(id_)]
        models = same or models
    if len(models) > 1:
        names = ", ".join(model.name for model in models)
        raise EddiError(problem("G005.several", names=names))
    return models[0]


def _refuse_other(document: ConfigText, root: Map, chosen: Model, models: Sequence[Model]) -> None:
    """Refuse a file to which the draft of a model must not be added.

    Raises:
        EddiError: it is no configuration (K001), or that of another kind (K010) or model (K026).
    """
    if root.entries and not is_config(Source(document.name, document.text.encode())):
        raise EddiError(problem("K001.nothing_added", root.place))
    section = root.get("Model") or root
    kind, type_, id_ = kinds()[chosen.kind], text_of(section, "type"), model_id(root)
    known_types = {known.casefold() for known in kind.config_types}
    if type_ not in (None, TODO) and str(type_).casefold() not in known_types:
        raise EddiError(problem("K010.kind", section.place, kind=kind.title, declared=type_))
    owner = package_name(id_) if id_ is not None else None
    if owner in {package_name(model.name) for model in models} - {package_name(chosen.name)}:
        raise EddiError(problem("K026.other_model", section.place, id=id_, requested=chosen.name))


def _unknown_inputs(root: Map, ids: Sequence[str]) -> Iterator[Problem]:
    """Warn of entries that the model has no input for (K013)."""
    items = [(item, text_of(item, "id")) for item in items_of(root.get("EDDIInputs"))]
    new = sorted({*ids} - {id_ for _, id_ in items})
    for item, id_ in items:
        if id_ is None or id_ in ids:
            continue
        similar = most_similar(id_, new)
        hint = f"its inputs: {shortened_list(ids)}"
        if similar is not None:
            hint = f"where it is {similar!r} now, write `id: {similar}` and `renamed_from: {id_}`"
        yield problem("K013.entry_stays", item.place, hint=hint, input=id_)


def _declared_types(root: Map) -> dict[str, Fields]:
    """Return the message types that a configuration declares itself."""
    types = root.get("MessageTypes")
    return {
        name.text: declared(
            ((text_of(fields, key.text) or "", key.text) for key, _ in fields.entries),
            name.text.partition("/")[0],
        )
        for name, fields in (types.entries if isinstance(types, Map) else ())
        if isinstance(fields, Map)
    }


def _needs(root: Map, model: Model, inputs: Sequence[ModelInput]) -> list[InputNeed]:
    """Return what the inputs need, with the words that the configuration says mean the same."""
    section = root.get("connect")
    groups = items_of(section.get("synonyms")) if isinstance(section, Map) else ()
    synonyms = frozenset(
        frozenset(
            word
            for item in items_of(group)
            if isinstance(item, Scalar)
            for word in words(item.text)
        )
        for group in groups
    )
    return [
        InputNeed(
            item.id,
            item.type,
            item.unit,
            item.description or "",
            item.is_demand,
            item.safety,
            item.states,
            item.timeout,
            synonyms,
            events_of(model.links, item.id),
        )
        for item in inputs
    ]


def _recorded(
    topics: Mapping[str, str], known: Sequence[RobotTopic], package: str
) -> list[RobotTopic]:
    """Return the topics of a bag that are not known without it, each with an id of its own."""
    there = {full_topic(topic.topic, "", package) for topic in known}
    taken = {topic.id for topic in known}
    recorded = []
    for topic, message in sorted(topics.items()):
        if topic not in there:
            recorded.append(RobotTopic(free_name(slug(topic), taken), message, topic))
            taken.add(recorded[-1].id)
    return recorded


def _model_draft(model: Model, root: Map) -> ModelDraft:
    """Return what the configuration has to say of the model.

    Raises:
        EddiError: no monitor can be made of the model.
    """
    ids = [text_of(item, "id") for item in items_of(root.get("EDDIInputs"))]
    inputs = tuple(
        DeclaredInput(id_, None, None, None, model.place) for id_ in ids if id_ is not None
    )
    section = root.get("Model")
    values = value_11(section) if isinstance(section, Map) else {}
    return model.draft(Options(values=values, inputs=inputs))


def _model_section(
    model: Model, kind: Kind, path: Path, config: Path | None
) -> dict[str, JsonValue]:
    """Return ``Model:`` of a new configuration; the file is named where it lies beside it."""
    section: dict[str, JsonValue] = {
        "id": model.name, "type": kind.config_types[0], "frequency": 10
    }  # fmt: skip
    folder = (config or Path("eddi_config.yml")).resolve().parent
    if path.resolve().is_relative_to(folder):
        section["parameters"] = [{"model": path.resolve().relative_to(folder).as_posix()}]
    return section
