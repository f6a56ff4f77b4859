"""Read ``eddi_config.yml``, with values of YAML 1.1, as D7.2's tools and roslaunch do."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    SimilarNames,
    has_errors,
    in_order,
    problem,
)
from eddi_scaffold.config.field_types import MessageFields, used
from eddi_scaffold.config.file import (
    KEY,
    MODEL_KEYS,
    ConfigFile,
    Places,
    existing_file,
    plain_values,
    undecided,
    violations,
)
from eddi_scaffold.config.schema import Config, ModelSection
from eddi_scaffold.eddi_xml.parsing import looks_like_xml
from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.spellings import kinds_of_type, spelt_out
from eddi_scaffold.yaml_text.nodes import Map, read_maps, text_of

_NO_OUTPUTS = (
    "SimulatorOutputs has none: `--system FILE --models DIR` takes them from the robot's models"
)


@dataclass(frozen=True)
class RobotAdditions:
    """What models of a robot add to a configuration."""

    # the entries of `SimulatorOutputs` as they are written -> those that count
    outputs: Callable[[Any], Any] = lambda entries: entries
    # message type -> fields, of the specifications next to the node models
    types: MessageFields = field(default_factory=dict)


def read_config(source: Source) -> tuple[ConfigFile | None, list[Problem]]:
    """Read the only configuration of a file; the result is ``None`` when a problem is an error."""
    configs, problems = read_file(source)
    if len(configs) > 1:
        return None, [*problems, several(configs, configs[1].place("Model"))]
    return next(iter(configs), None), problems


def several(configs: Sequence[ConfigFile], place: Place) -> Problem:
    """Return the problem of a file that holds several configurations where it should hold one."""
    names = ", ".join(config.config.Model.id for config in configs)
    return problem("K001.several", place, number=len(configs), names=names)


def read_file(
    source: Source, robot: RobotAdditions | None = None, override: Map | None = None
) -> tuple[list[ConfigFile], list[Problem]]:
    """Read the configurations of a file, of each monitor a document; without those with errors.

    Topics and message types of a robot are used in addition to the file, and values of ``override``
    in place of its own.
    """
    if looks_like_xml(source.data):
        return [], [problem("K001.xml", Place(source.name))]
    documents, problems = read_maps(source, "K001")
    if all(document.get("Model") is None for document in documents):
        title = next((kind.title for kind in kinds().values() if kind.recognises(source)), None)
        if title is not None and documents:
            return [], [problem("K001.model", Place(source.name), title=title)]
    documents, unclear = spelt_out(documents, source, override)
    problems += unclear
    configs: list[ConfigFile] = []
    ids = [text_of(document.get("Model"), "id") or "" for document in documents]
    for document, id_ in zip(documents, ids, strict=True):
        monitors = {other for other in ids if other != id_}
        config, reported = _read(document, source, robot, monitors)
        configs += [config] if config is not None and not has_errors(problems) else []
        problems += reported
    return configs, in_order(problems)


def _read(
    document: Map, source: Source, robot: RobotAdditions | None, monitors: Collection[str]
) -> tuple[ConfigFile | None, list[Problem]]:
    places: Places = {}
    data = plain_values(document, places)
    # an empty section is an empty list, as D7.2's tools read it
    data = {key: [] if value is None and key != "Model" else value for key, value in data.items()}
    if robot is not None:
        data["SimulatorOutputs"] = robot.outputs(data.get("SimulatorOutputs") or [])
    open_values = list(undecided(document))
    problems = [*_unknown_options(data.get("Model"), places, source.name), *open_values]
    try:
        config = Config.model_validate(data)
    except ValidationError as failed:
        reported = {problem.place for problem in open_values}
        broken = violations(failed, places, source.name, Config)
        return None, [*problems, *(fault for fault in broken if fault.place not in reported)]
    text = source.data.decode("utf-8-sig", "replace")
    file = ConfigFile(source.name, places, config, text=text)
    file = with_types(file, robot.types if robot is not None else {})
    files, unread = _event_files(file)
    file = replace(file, event_files=files)
    problems += [*unread, *_repeated_ids(file), *_unknown_sources(file, monitors)]
    return (None if has_errors(problems) else file), problems


def read_configs(
    files: Iterable[Path], robot: RobotAdditions | None = None
) -> tuple[list[ConfigFile], list[Problem]]:
    """Read the configurations of a command that needs all of them; an EddiError has the errors."""
    results = [read_file(read_source(path), robot) for path in dict.fromkeys(files)]
    problems = [problem for _, problems in results for problem in problems]
    if has_errors(problems):
        raise EddiError(*problems)
    return [config for configs, _ in results for config in configs], problems


def with_types(file: ConfigFile, known: MessageFields) -> ConfigFile:
    """Take in those of the message types that the inputs need, to be remembered."""
    config = file.config
    required = {name for entry in config.EDDIInputs for name in entry.requires}
    types = [source.type for source in config.SimulatorOutputs if source.id in required]
    fields = {**used(types, known), **config.MessageTypes}
    return replace(file, config=config.model_copy(update={"MessageTypes": fields}))


def _unknown_options(section: object, places: Places, file: str) -> Iterator[Problem]:
    """Find keys of ``Model`` that the kind of its model does not understand (K003)."""
    if not isinstance(section, Mapping):
        return
    fitting = kinds_of_type(str(section.get("type")))  # all kinds if it is unknown
    options = {key for kind in fitting or kinds().values() for key in kind.options}
    known = {"model", *ModelSection.model_fields, *options}
    similar = SimilarNames(sorted(known), "known keys")
    for key in (key for key in section if key not in known):
        place = places.get(("Model", key, KEY), Place(file))
        hint = similar.hint(key)
        if key in MODEL_KEYS and isinstance(section[key], str):
            hint = f"write `model: {section[key]}`"
        yield problem("K003.unknown_key", place, hint=hint, key=key)


def _event_files(file: ConfigFile) -> tuple[dict[str, str], list[Problem]]:
    """Read the files of events that inputs name (F001, E001)."""
    texts: dict[str, str] = {}
    problems: list[Problem] = []
    for index, entry in enumerate(file.config.EDDIInputs):
        name = entry.expression_file
        if name is None or name in texts:
            continue
        place = file.place("EDDIInputs", index, "expression_file")
        try:
            texts[name] = read_source(existing_file(file.name, name, place)).text("E001")
        except EddiError as failure:
            problems += failure.problems
    return texts, problems


def _words(file: ConfigFile) -> set[str]:
    """Return every word that may be the id of a message in the expressions of inputs.

    A word too many makes an error of a warning; one too few would let the wrong topic be read.
    """
    inputs = file.config.EDDIInputs
    texts = [
        *file.config.declarations,
        *file.event_files.values(),
        *(entry.expression or "" for entry in inputs),
        *(text for entry in inputs for text in (entry.states or {}).values()),
    ]
    return {word for text in texts for word in re.findall(r"\w+", text)}


def _repeated_ids(file: ConfigFile) -> Iterator[Problem]:
    config, words = file.config, _words(file)
    used_ids = {name for entry in config.EDDIInputs for name in entry.requires} | words
    for section in ("SimulatorOutputs", "EDDIInputs", "EDDIOutputs"):
        lines: dict[str, int | None] = {}
        for index, entry in enumerate(getattr(config, section)):
            place = file.place(section, index, "id")
            if entry.id in lines:
                # A parsed robot system may hold one id twice: harmless until an input uses it.
                is_named = not used_ids.isdisjoint({entry.id, attribute(entry.id)})
                is_used = section != "SimulatorOutputs" or is_named
                case = "K006.twice" if is_used else "K006.twice_unused"
                yield problem(case, place, id=entry.id, section=section, line=lines[entry.id])
            lines.setdefault(entry.id, place.line)
    by_name: dict[str, str] = {}
    for index, entry in enumerate(config.SimulatorOutputs):
        name = attribute(entry.id)
        other = by_name.setdefault(name, entry.id)
        if other != entry.id and name in words:
            place = file.place("SimulatorOutputs", index, "id")
            yield problem("K006.one_name", place, first=other, second=entry.id, name=name)


def _unknown_sources(file: ConfigFile, monitors: Collection[str]) -> Iterator[Problem]:
    known = [entry.id for entry in file.config.SimulatorOutputs]
    names = dict.fromkeys([*known, *sorted(monitors)])
    similar = SimilarNames(names, "there are" if names else None)
    for index, entry in enumerate(file.config.EDDIInputs):
        for position, required in enumerate(entry.requires):
            if required not in known:
                place = file.place("EDDIInputs", index, "requires", position)
                hint = similar.hint(required) or _NO_OUTPUTS
                yield problem("K007", place, hint=hint, input=entry.id, source=required)
