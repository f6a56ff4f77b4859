"""A model, a robot and a configuration that may be there: files in, the text of a draft out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import (
    TODO,
    attribute,
    free_name,
    full_topic,
    is_ros_name,
    key_text,
    package_name,
)
from eddi_scaffold.common.problems import EddiError, Problem, has_errors, in_order, problem
from eddi_scaffold.config.field_types import Fields, MessageFields, declared
from eddi_scaffold.config.file import undecided
from eddi_scaffold.config.topic_block import ConfigText, extended, read_block
from eddi_scaffold.connect.draft import Age, age_line, entry
from eddi_scaffold.connect.keeping import Draft, model_id, topics_of, with_draft
from eddi_scaffold.connect.matching import Decision, Fulfilment, decide
from eddi_scaffold.connect.robot import robot_of
from eddi_scaffold.connect.rossystem import ConfigChange, parse, read_config_text
from eddi_scaffold.connect.topics import InputNeed, RobotTopic, words
from eddi_scaffold.deployments.joining import join
from eddi_scaffold.eddi_xml.links import events_of
from eddi_scaffold.kinds import DeclaredInput, JsonValue, Model, ModelInput, Options, kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.config_reading import read_configs
from eddi_scaffold.monitors.loading import checked_models, is_config, select_models
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.monitors.publications import messages_of
from eddi_scaffold.mros.topics import slug
from eddi_scaffold.yaml_text.nodes import Map, items_of, scalars_of, text_of, value_11

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


def fulfilments(
    monitors: Sequence[BoundMonitor],
    model: Model,
    inputs: Sequence[ModelInput],
    topics: Sequence[RobotTopic],
) -> tuple[dict[str, list[Fulfilment]], list[RobotTopic]]:
    """Return input -> what fulfils it, and the topics that are not among those of the robot yet.

    It is what has the id of evidence, or what the EDDI names for it. For evidence that nothing
    fulfils, every claim of the others is one that a person may choose.
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
    for output in monitor.config.config.EDDIOutputs if monitor.config is not None else ():
        if output.field is not None:
            continue
        meanings = model.meanings(monitor.facts.claims_on(output.event))
        on_topic = [output.event] if output.event is not None else parts
        only = on_topic if len(on_topic) == 1 else []
        for name, type_ in messages_of(monitor).items():
            topic_name = f"{output.topic}/{name}" if name else output.topic
            topic = RobotTopic(output.id, type_, topic_name)
            for path, meaning in meanings.get(topic.message, {}).items():
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


@dataclass(frozen=True)
class DraftResult(ConfigChange):
    """A draft."""

    decisions: Sequence[Decision]  # one for each input of the model
    kept: frozenset[str]  # inputs that were decided before
    problems: Sequence[Problem]  # of the robot, and of the configuration
    todo: int  # how many values are still to be decided

    def state(self, decision: Decision) -> str:
        """Return ``taken``, ``listed`` or ``none``, or ``kept`` where a person has decided."""
        return "kept" if decision.need.id in self.kept else decision.state

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
    path: Path, name: str | None, config: Path | None, surroundings: Surroundings
) -> DraftResult:
    """Draft the configuration of a model, or add to one what it does not say yet.

    A name chooses among several models of the file; the configuration need not exist.

    Raises:
        EddiError: something cannot be read, or the configuration cannot be changed.
    """
    defaults, ages_of = surroundings.default_guarantees, surroundings.ages
    models = checked_models(path, defaults).models
    file = config or Path("eddi_config.yml")
    document = read_config_text(file) if config else ConfigText(str(file), "", is_new=True)
    original = document
    root, problems = document.root, list[Problem]()
    model = _chosen_model(models, name, root)
    _refuse_other(document, model, models)
    package = package_name(model_id(root) or model.name)
    types = {**surroundings.types, **known_messages()}
    robot = robot_of(surroundings.system, surroundings.models)
    if robot is not None:
        types |= robot.message_types()
    if robot is not None and robot.path is not None:  # its topics, as parse-rossystem has them
        parsed = parse(robot, document, writes=lambda topic: is_ros_name(topic.topic))
        document = read_block(Source(document.name, parsed.after.encode()))
        problems = robot.located(parsed.problems)
    entries = [(item, text_of(item, "id")) for item in items_of(root.get("EDDIInputs"))]
    ids = [id_ for _, id_ in entries if id_ is not None]
    section = root.get("Model")
    values = value_11(section) if isinstance(section, Map) else {}
    declared_inputs = tuple(DeclaredInput(id_, None, None, None, model.place) for id_ in ids)
    drafted = model.draft(Options(values=values, inputs=declared_inputs))
    topics = topics_of(document)
    recorded = _recorded(surroundings.topics, topics, package)
    topics += recorded
    others: list[BoundMonitor] = []
    if surroundings.configs:
        configs, _ = read_configs(surroundings.configs)
        others, faults = join(models, configs, lambda of: checked_models(of, defaults), defaults)
        if has_errors(faults):
            raise EddiError(*faults)
    others = [monitor for monitor in others if monitor.package != package]
    fulfilled, published = fulfilments(others, model, drafted.inputs, topics)
    types |= _declared_types(root)
    decisions = decide(_needs(model, drafted.inputs, root), topics, types.get, fulfilled)
    named = {candidate.topic for decision in decisions for candidate in decision.candidates}
    new = [topic for topic in (*recorded, *published) if topic in named]
    document = read_block(Source(document.name, extended(document, new).encode()))
    full_names = {topic.topic: full_topic(topic.topic, "", package) for topic in topics}
    limits = {topic: ages_of[full] for topic, full in full_names.items() if full in ages_of}
    start: dict[str, JsonValue] = {"id": model.name, "type": kinds()[model.kind].config_types[0]}
    if path.resolve().is_relative_to(file.resolve().parent):
        start["model"] = path.resolve().relative_to(file.resolve().parent).as_posix()
    draft = Draft(
        {**start, "frequency": 10},
        drafted.options,
        drafted.notes,
        [entry(decision, limits) for decision in decisions],
        {topic.id: age_line(topic, limits) for topic in topics},
    )
    after = with_draft(document, draft)
    kept = frozenset(id_ or "" for item, id_ in entries if not any(undecided(item)))
    todo = len(list(undecided(read_block(Source(document.name, after.encode())).root)))
    return DraftResult(original, after, decisions, kept, in_order(problems), todo)


def _chosen_model(models: Sequence[Model], name: str | None, root: Map) -> Model:
    """Return the model: by its name, else that of the configuration, else the only one."""
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


def _refuse_other(document: ConfigText, model: Model, models: Sequence[Model]) -> None:
    """Refuse a file to which the draft of a model must not be added."""
    root = document.root
    if root.entries and not is_config(Source(document.name, document.text.encode())):
        raise EddiError(problem("K001.nothing_added", root.place))
    section = root.get("Model") or root
    kind, type_, id_ = kinds()[model.kind], text_of(section, "type"), model_id(root)
    known_types = {known.casefold() for known in kind.config_types}
    if type_ not in (None, TODO) and str(type_).casefold() not in known_types:
        raise EddiError(problem("K010.kind", section.place, kind=kind.title, declared=type_))
    others = {package_name(other.name) for other in models} - {package_name(model.name)}
    if id_ is not None and package_name(id_) in others:
        raise EddiError(problem("K026.other_model", section.place, id=id_, requested=model.name))


def _recorded(
    types: Mapping[str, str], known: Sequence[RobotTopic], package: str
) -> list[RobotTopic]:
    """Return the topics of a bag that are not known without it, each with an id of its own."""
    there, taken = {full_topic(of.topic, "", package) for of in known}, {of.id for of in known}
    recorded = []
    for topic, message in sorted(types.items()):
        if topic not in there:
            recorded.append(RobotTopic(free_name(slug(topic), taken), message, topic))
            taken.add(recorded[-1].id)
    return recorded


def _declared_types(root: Map) -> Mapping[str, Fields]:
    """Return the message types that the configuration declares itself."""
    types = root.get("MessageTypes")
    return {
        name.text: declared(
            ((text_of(fields, key.text) or "", key.text) for key, _ in fields.entries),
            name.text.partition("/")[0],
        )
        for name, fields in (types.entries if isinstance(types, Map) else ())
        if isinstance(fields, Map)
    }


def _needs(model: Model, inputs: Sequence[ModelInput], root: Map) -> list[InputNeed]:
    """Return what the inputs need, with words that mean the same on this robot."""
    section = root.get("connect")
    groups = items_of(section.get("synonyms")) if isinstance(section, Map) else ()
    texts = [" ".join(scalar.text for scalar in scalars_of(group)) for group in groups]
    synonyms = frozenset(frozenset(words(text)) for text in texts)
    return [
        InputNeed(**vars(item), synonyms=synonyms, events=events_of(model.links, item.id))
        for item in inputs
    ]
