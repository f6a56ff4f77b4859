"""Read ``eddi_config.yml``.

Values follow YAML 1.1, as D7.2's tools and roslaunch do.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterable, Sequence
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
    did_you_mean,
    has_errors,
    in_order,
    problem,
)
from eddi_scaffold.config.file import ConfigFile, about_file, overridden
from eddi_scaffold.config.message_types import MessageFields, used
from eddi_scaffold.config.options import plain_values, unknown_options, violations
from eddi_scaffold.config.schema import Config, Entry
from eddi_scaffold.config.undecided import undecided
from eddi_scaffold.eddi_xml.xml_text import looks_like_xml
from eddi_scaffold.kinds import kinds
from eddi_scaffold.yaml_text.nodes import Map, read_map

_ALIASES = {
    "EDDIOoutputs": "EDDIOutputs",
    "EDDIOOutputs": "EDDIOutputs",
    "SimulatorOutput": "SimulatorOutputs",
}
_NO_OUTPUTS = (
    "SimulatorOutputs has none: `--system FILE --models DIR` takes them from the robot's models"
)


@dataclass(frozen=True)
class RobotAdditions:
    """What models of a robot add to a configuration.

    Attributes:
        outputs: the entries of ``SimulatorOutputs`` as they are written -> those that count.
        types: message type -> fields, of the specifications next to the node models.
    """

    outputs: Callable[[Any], Any] = lambda entries: entries
    types: MessageFields = field(default_factory=dict)


def read_config(
    source: Source,
    robot: RobotAdditions | None = None,
    override: Map | None = None,
    *,
    partly: bool = False,
) -> tuple[ConfigFile | None, list[Problem]]:
    """Read a configuration; the result is ``None`` when a problem is an error.

    Args:
        source: the file.
        robot: models of the robot, whose topics and message types are used in addition to the file.
        override: what counts in place of parts of the file.
        partly: return one with unknown keys as it is without them, to look for what else is wrong.
    """
    if looks_like_xml(source.data):
        return None, [problem("K001.xml", Place(source.name))]
    document, problems = read_map(source, "K001")
    if document is None:
        return None, problems
    if {"Model"}.isdisjoint(document.keys()):
        title = next((kind.title for kind in kinds().values() if kind.recognises(source)), None)
        if title is not None:
            return None, [problem("K001.model", Place(source.name), title=title)]
    places: dict[tuple[str | int, ...], Place] = {}
    data = plain_values(overridden(_renamed(document, problems), override), places, problems)
    # an empty section is an empty list, as D7.2's tools read it
    data = {key: [] if value is None and key != "Model" else value for key, value in data.items()}
    if robot is not None:
        data["SimulatorOutputs"] = robot.outputs(data.get("SimulatorOutputs") or [])
    problems += unknown_options(data.get("Model"), places, source.name)
    wrong: list[Problem] = []
    open_ = undecided(document)
    problems += open_
    try:
        config = Config.model_validate(data)
    except ValidationError as failed:
        at = {problem.place for problem in open_}
        wrong = [
            violation
            for violation in violations(failed, places, source.name)
            if violation.place not in at
        ]
        known = _of_known_keys(data, failed) if partly else None
        if known is None:
            return None, in_order([*problems, *wrong])
        config = known
    text = source.data.decode("utf-8-sig", "replace")
    types = robot.types if robot is not None else {}
    file = with_types(ConfigFile(config, source.name, places, text=text), types)
    files, unread = _event_files(file)
    file = replace(file, event_files=files)
    problems += [*_repeated_ids(file), *unread]
    return (None if has_errors(problems) else file), in_order([*problems, *wrong])


def _of_known_keys(data: dict[str, Any], failed: ValidationError) -> Config | None:
    """Return a configuration without its unknown keys, ``None`` where more is wrong with it.

    A section of another name is more: all that it says would be missing.
    """
    wrong = [found["loc"] for found in failed.errors() if found["type"] == "extra_forbidden"]
    if len(wrong) < failed.error_count() or any(len(one) == 1 for one in wrong):
        return None
    known = copy.deepcopy(data)
    for *path, key in wrong:
        of: Any = known
        for one in path:
            of = of[one]
        del of[key]
    try:
        return Config.model_validate(known)
    except ValidationError:
        return None


def read_configs(
    files: Iterable[Path], robot: RobotAdditions | None = None
) -> tuple[list[ConfigFile], list[Problem]]:
    """Read the configurations of a command that needs them whole; return the warnings, too.

    Raises:
        EddiError: a file cannot be used.
    """
    problems: list[Problem] = []
    configs: list[ConfigFile] = []
    for path in dict.fromkeys(files):  # the same one twice is one monitor
        config, found = read_config(read_source(path), robot)
        problems += found
        configs += [config] if config is not None else []
    if has_errors(problems):
        raise EddiError(*problems)
    return configs, problems


def _event_files(file: ConfigFile) -> tuple[dict[str, str], list[Problem]]:
    """Read the files of events that inputs name (F001, E001)."""
    texts: dict[str, str] = {}
    problems: list[Problem] = []
    for index, entry in enumerate(file.config.EDDIInputs):
        name = entry.expression_file
        if name is None or name in texts:
            continue
        try:
            source = file.read(name)
        except EddiError as failure:
            (problem,) = failure.problems
            place = file.place("EDDIInputs", index, "expression_file")
            hint = problem.hint if problem.code == "F009" else _near(Path(file.path(name)))
            problems.append(about_file(replace(problem, hint=hint), name, place))
            continue
        try:
            texts[name] = source.text("E001")
        except EddiError as failure:
            problems += failure.problems
    return texts, problems


def _near(path: Path) -> str | None:
    there = [one.name for one in path.parent.glob("*.events")] if path.parent.is_dir() else []
    return did_you_mean(path.name, sorted(there))


def with_types(file: ConfigFile, known: MessageFields) -> ConfigFile:
    """Take in those of the message types that the inputs need, to be remembered."""
    config = file.config
    required = {name for item in config.EDDIInputs for name in item.requires}
    types = [source.type for source in config.SimulatorOutputs if source.id in required]
    found = {**used(types, known), **config.MessageTypes}
    return replace(file, config=config.model_copy(update={"MessageTypes": found}))


def _renamed(document: Map, problems: list[Problem]) -> Map:
    """Give the sections that D7.2's figures misspell their names."""
    entries = []
    for key, value in document.entries:
        if key.text in _ALIASES:
            name = _ALIASES[key.text]
            problems.append(problem("K002", key.place, key=key.text, name=name))
            key = replace(key, text=name)  # noqa: PLW2901 - the same key, spelt right
        entries.append((key, value))
    return replace(document, entries=tuple(entries))


def _words(file: ConfigFile) -> set[str]:
    """Return every word that may be the id of a message in the expressions of inputs.

    A word too many makes an error of a warning; one too few would let the wrong topic be read.
    """
    inputs = file.config.EDDIInputs
    texts = [
        *file.config.declarations,
        *file.event_files.values(),
        *(input_.expression or "" for input_ in inputs),
        *(text for input_ in inputs for text in (input_.states or {}).values()),
    ]
    return {word for text in texts for word in re.findall(r"\w+", text)}


def _repeated_ids(file: ConfigFile) -> Iterable[Problem]:
    config = file.config
    words = _words(file)
    used = {name for item in config.EDDIInputs for name in item.requires} | words
    sections: dict[str, Sequence[Entry]] = {
        "SimulatorOutputs": config.SimulatorOutputs,
        "EDDIInputs": config.EDDIInputs,
        "EDDIOutputs": config.EDDIOutputs,
    }
    for section, entries in sections.items():
        first: dict[str, int] = {}
        for index, entry in enumerate(entries):
            if entry.id in first:
                before = file.place(section, first[entry.id], "id").line
                # A parsed robot system may hold one id twice: harmless until an input uses it.
                harmless = section == "SimulatorOutputs" and not used & {
                    entry.id,
                    attribute(entry.id),
                }
                yield problem(
                    "K006.twice_unused" if harmless else "K006.twice",
                    file.place(section, index, "id"),
                    id=entry.id,
                    section=section,
                    line=before,
                )
            first.setdefault(entry.id, index)
    by_name: dict[str, str] = {}
    for index, entry in enumerate(config.SimulatorOutputs):
        name = attribute(entry.id)
        other = by_name.setdefault(name, entry.id)
        if other != entry.id and name in words:
            yield problem(
                "K006.one_name",
                file.place("SimulatorOutputs", index, "id"),
                first=other,
                second=entry.id,
                name=name,
            )
    known = {entry.id for entry in config.SimulatorOutputs}
    near = SimilarNames(known)
    for index, item in enumerate(config.EDDIInputs):
        for position, required in enumerate(item.requires):
            if required not in known:
                yield problem(
                    "K007",
                    file.place("EDDIInputs", index, "requires", position),
                    hint=near.hint(required) or (None if known else _NO_OUTPUTS),
                    input=item.id,
                    source=required,
                )
